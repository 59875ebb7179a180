"""Hard cases: every formulation is right within its stated error, or stops and says why."""

from __future__ import annotations

import math
import tracemalloc
import warnings
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from crankmbs.errors import FormulationError, InputError
from crankmbs.mechanics.peaks import negligible
from crankmbs.mechanics.variables import VARIABLES
from crankmbs.result import Result
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter import machine_of
from validation.case import Case, driven, shifted
from validation.checks.honest import scales, true_errors
from validation.judge import Outcome
from validation.oracles.arithmetic import LONG, multiprecision
from validation.oracles.many_turns import many_turns

__all__ = ["coarsest", "every_formulation", "flat_memory", "graded", "judged", "refused"]

_FORMULATIONS = ("kinetostatic", "crank_angle", "minimal", "multibody")
_CAP = 3.0  # s, for multibody
_STOPS_OF_MULTIBODY = ("above the cost cap", "Newton iteration does not converge")
_TOO_SMALL = 2.0  # the true error may be this many times the stated one
_USUAL = 1e-3  # of a variable's peak: a larger stated error is no answer unless the case names it
_FLOOR = 1e-12  # of the peak of what has the same unit: rounding
_HEAD = ("| case |" + "".join(f" {name} |" for name in _FORMULATIONS), "|---" * 5 + "|")


class _Answer(NamedTuple):
    """How far a formulation is from the truth in units of what it may be, and what it says."""

    error: float
    text: str


def every_formulation(case: Case) -> Outcome:
    """The worst true error over twice the stated one and a floor, over all formulations and
    variables.

    The floor is 1e-12 of the largest peak of what has the same unit, for the rounding of sums of
    large parts that cancel; the sentence names what is right by it alone.
    A run that stops is measured up to there; infinite for a stop that the case does not know, for
    an error that is no refusal, for a warning, and for a stated error of over 1e-3 of a variable's
    peak that the case does not name. Parameters of the case: `only_to`, by formulation that larger
    share, `inf` where it is not known; `stops`, what the sentence of a stop has to contain;
    `constant_speed`, what kinetostatic is given in place of a free crank; `many_turns`, the oracle
    for long runs; `digits` of the other; `held`, at a stop whose last sample is left out, as the
    oracle cannot hold a speed; `cost_cap` [s] of multibody.
    """
    answers: dict[str, _Answer] = {}
    for name in _FORMULATIONS:
        answers[name] = _answer(case, name)
        if case.mutated and not answers[name].error <= case.tolerance:
            break  # one is enough to turn the claim red
    return _outcome(case, answers)


def refused(case: Case) -> Outcome:
    """Number of values of the key that are not refused with the message of the case.

    The values are all numbers among the parameters.
    """
    key, says = case.word("key"), case.word("says")
    messages, accepted = [], 0
    for name, number in case.parameters.items():
        if isinstance(number, float):
            value = case.number(name)
            try:
                shifted(case.theirs(), key, lambda _, value=value: value)
            except InputError as error:
                messages.append(str(error))
                accepted += says not in str(error)
            else:
                accepted += 1
    answer = _Answer(accepted, "refused: " + "; ".join(messages))
    return _outcome(case, dict.fromkeys(_FORMULATIONS, answer))


def flat_memory(case: Case) -> Outcome:
    """Peak memory of the run over that of a run a tenth as long (every = "none")."""
    scene, name = case.ours(), case.word("formulation")
    until, long = scene.run.until, case.number("length")
    assert isinstance(until, Extent)
    peaks = []
    for length in (0.1 * until.value, long * until.value):
        shorter = replace(scene.run, until=Extent(value=length, unit=until.unit))
        tracemalloc.start()
        simulate(replace(scene, run=shorter), formulation=name)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    short, whole = (peak / 1e6 for peak in peaks)
    return Outcome(whole / short, f"peak {whole:.3g} MB, of a tenth of the run {short:.3g} MB")


def _answer(case: Case, formulation: str) -> _Answer:
    ours, theirs = case.ours(), case.theirs()
    note = ""
    if formulation == "kinetostatic" and case.parameters.get("constant_speed"):
        ours, theirs = driven(ours, "constant"), driven(theirs, "constant")
        note = "at constant speed, "
    limit = float(case.parameters.get("cost_cap", _CAP))
    cap = {"cost_cap": limit} if formulation == "multibody" else {}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            result = simulate(ours, formulation=formulation, **cap)
        return judged(case, result, theirs, note)
    except FormulationError as error:
        return _Answer(0.0, f"refused: {error}")
    except Exception as error:
        return _Answer(math.inf, f"broken: {type(error).__name__}: {error}")


def judged(case: Case, result: Result, scene: Scene, note: str) -> _Answer:
    """How right a run is, and the sentence for it; ``note`` stands before it."""
    worst, right = _compared(case, result, scene)
    if result.status == 0:
        return _Answer(worst, note + right + _shortfall(result))
    known = [str(case.parameters["stops"])] if "stops" in case.parameters else []
    if result.formulation == "multibody" and result.status == -1:
        known += _STOPS_OF_MULTIBODY
    told = any(part in result.message for part in known)
    text = f"{note}stopped (status {result.status}): {result.message}; before it {right}"
    return _Answer(worst if told else math.inf, text)


def _shortfall(result: Result) -> str:
    """What the message of a run to the end says beyond it."""
    _, _, more = result.message.partition("; ")
    return f"; {more}" if more else ""


def _compared(case: Case, result: Result, scene: Scene) -> tuple[float, str]:
    """The worst true error over what it may be, and in words how good the answer is."""
    digits = case.parameters.get("digits")
    arithmetic = multiprecision(digits) if digits else LONG
    motion = None
    if scene.start is not None and case.parameters.get("many_turns"):
        angles = result.data["crank_angle"].values
        motion = many_turns(machine_of(scene), scene.start.angle, scene.start.speed, angles)
    if result.status == 1 and case.parameters.get("held"):  # where the oracle does not go
        result = replace(result, data=result.data.isel(time=slice(-1)))
    true, peaks = true_errors(result, scene, motion, arithmetic)
    scale = scales(peaks)
    shares = dict.fromkeys(true, 0.0)
    for name, error in true.items():
        stated = float(result.data[name].attrs["error_estimate"])
        allowed = _TOO_SMALL * stated + _FLOOR * scale[name]
        share = error / allowed if error else 0.0
        shares[name] = share if math.isfinite(share) else math.inf
    worst = max(shares, key=lambda name: shares[name])
    stated = float(result.data[worst].attrs["error_estimate"])
    numbers = f"{worst} {true[worst]:.1e}, stated {stated:.1e} {VARIABLES[worst].units}"
    if shares[worst] > 1.0:
        return shares[worst], f"WRONG: {numbers}"
    coarse, name = coarsest(result, peaks)
    known = coarse <= case.parameters.get("only_to", {}).get(result.formulation, _USUAL)
    text = f"{graded(coarse, name)}: {numbers}{_by_floor(result, true)}"
    return shares[worst] if known else math.inf, text


def _by_floor(result: Result, true: dict[str, float]) -> str:
    """What is right only by the floor, the furthest beyond twice its stated error."""
    allowed = {n: _TOO_SMALL * float(result.data[n].attrs["error_estimate"]) for n in true}
    beyond = {n: true[n] / allowed[n] if allowed[n] else math.inf for n in true if true[n] > 0.0}
    name = max(beyond, key=lambda n: beyond[n], default="")
    if not name or beyond[name] <= 1.0:
        return ""
    numbers = f"{true[name]:.1e}, stated {0.5 * allowed[name]:.1e} {VARIABLES[name].units}"
    return f"; by the {_FLOOR:.0e} of the peak allowed for rounding {name} {numbers}"


def coarsest(result: Result, peaks: dict[str, float]) -> tuple[float, str]:
    """The largest stated error over its variable's own peak, and that variable's name.

    Of the crank angle it is taken per radian turned; what is zero but for rounding does not count,
    and nothing does where nothing moved.
    """
    turned = float(np.ptp(result.data["crank_angle"].values))
    if turned == 0.0:
        return 0.0, "crank_angle"
    peaks = peaks | {"crank_angle": turned}
    ignored = negligible(peaks, {name: VARIABLES[name].units for name in peaks})
    shares = {
        name: float(result.data[name].attrs["error_estimate"]) / peak
        for name, peak in peaks.items()
        if name not in ignored
    }
    name = max(shares, key=lambda name: shares[name])
    return shares[name], name


def graded(coarse: float, name: str) -> str:
    """How good an answer is that states an error of this share of the peak of a variable."""
    if coarse <= _USUAL:
        return "right"
    if coarse < 1.0:
        return f"right, but only to {100.0 * coarse:.2g} % of the peak ({name})"
    if math.isfinite(coarse):
        return f"no answer, the stated error is {coarse:.2g} times the peak ({name})"
    return f"error unknown ({name})"


def _outcome(case: Case, answers: dict[str, _Answer]) -> Outcome:
    worst = max(answers, key=lambda name: answers[name].error)
    served = any(not answer.text.startswith("refused") for answer in answers.values())
    texts = [answers[name].text if name in answers else "" for name in _FORMULATIONS]
    cells = [text.replace("|", r"\|") for text in texts]
    row = f"| {case.claim} |" + "".join(f" {cell} |" for cell in cells)
    error = answers[worst].error
    if not served and case.check == "hard.every_formulation":
        error = math.inf
    return Outcome(error, f"{worst} {answers[worst].text}", table=(*_HEAD, row))
