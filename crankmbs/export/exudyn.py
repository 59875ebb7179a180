"""The multibody model of a scene as a script, which needs numpy and exudyn alone."""

from __future__ import annotations

import inspect
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from crankmbs.digits import error_digits
from crankmbs.errors import InputError
from crankmbs.mechanics.geometry import top_position
from crankmbs.mechanics.knots import repeat
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.motion.multibody.beside import initial
from crankmbs.motion.multibody.forces import Forces
from crankmbs.motion.multibody.generalized_alpha import settings_of
from crankmbs.motion.multibody.mechanism import (
    Body,
    Guide,
    Hinge,
    Mechanism,
    add_body,
    build,
    marker,
    mechanism_of,
)
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import NEAR, Cycle
from crankmbs.scene.force import PistonForce
from crankmbs.scene.forces import ConstantForce, Damper, ForceAngleTable, Spring
from crankmbs.scene.loads import Constant, Quadratic, Viscous
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["exudyn_script"]

_BODY = Environment(
    loader=FileSystemLoader(Path(__file__).parent),
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
).get_template("exudyn_body.txt")
_IMPORTS = """from __future__ import annotations

from typing import Any, Callable, NamedTuple

import exudyn as exu
import exudyn.itemInterface as eii
import numpy as np

SPECTRAL_RADIUS = 0.9
"""
_STEPS_PER_TURN = 1000  # of the fastest speed
_FEWEST_STEPS = 4
_MOST_ROWS = 100_000  # that are held against the motion
_STATED = {  # variable -> its words in the head of the script; a prescribed motion errs in forces
    "crank_angle": "crank angle [rad]",
    "crank_speed": "crank speed [rad/s]",
    "main_bearing_force_x": "main bearing force, x [N]",
    "main_bearing_force_y": "main bearing force, y [N]",
    "crank_pin_force_x": "crank pin force, x [N]",
    "crank_pin_force_y": "crank pin force, y [N]",
    "side_force": "side force [N]",
}

_JUMPS = (
    "# Forces jump at some crank angles, and the steps pass over the jumps: half the step may",
    "# leave more than a quarter of these errors. A row nearer to a jump than the crank angle errs",
    "# may have the forces of its other side.",
)


def exudyn_script(scene: Scene, stem: str) -> str:
    """A script that builds the bodies, joints and loads of a scene and runs them in exudyn.

    Mechanism, system and settings are those of `crankmbs.motion.multibody`, quoted. It runs at 1000
    steps a turn, not extrapolated, over jumps of the forces as over all else; how far that is from
    the motion, as the run of the scene has it, it says in its head. Run, it writes STEM_exudyn.csv.

    Raises
    ------
    InputError : fuel, friction, torques by tables, forces over the travel or over time, windows,
        functions, a speed that changes, a settled motion, a crank that nothing moves; says which

    >>> "def run():" in exudyn_script(load_scene("torque_driven"), "mine")
    True
    """
    refused = _refused(scene)
    if refused:
        raise InputError(f"a script for exudyn cannot express {refused}")
    train = crank_train(scene)
    result = simulate(scene)
    if result.status != 0:
        raise InputError(
            f"a script for exudyn cannot express this scene: {result.message}; give a "
            "run that reaches its end"
        )
    end = float(result.sampled("time")[-1])
    fastest = float(np.max(np.abs(result.sampled("crank_speed"))))
    steps = max(math.ceil(end * fastest / (2.0 * math.pi) * _STEPS_PER_TURN), _FEWEST_STEPS)
    text = _text(train, stem, end, steps)
    jumps = Forces(train).jumps if scene.start else np.empty(0)  # prescribed angles do not err
    errors = _errors(train, _run(text), jumps)
    return _head(scene, end / steps, errors, jumps=len(jumps) > 0) + text


def _text(train: CrankTrain, stem: str, end: float, steps: int) -> str:
    """All of a script but its head."""
    over_angle = _over_angle(train)
    springs = any(map(any, _springs(train.scene)))
    parameters = _parameters(train, stem, end, steps, springs=springs, angles=bool(over_angle))
    sources: list[Any] = [Body, Hinge, Guide, Mechanism, marker, add_body, build, settings_of]
    quoted = [inspect.getsource(each) for each in sources]
    quoted[-1] = quoted[-1].replace("settings_of", "settings", 1)
    main = 'if __name__ == "__main__":\n    main()\n'
    body = _BODY.render(
        prescribed=train.scene.motion is not None,
        loads=bool(train.scene.torque),
        springs=springs,
        angles=bool(over_angle),
    )
    bisection = "from bisect import bisect_right\n" if over_angle else ""
    imports = _IMPORTS.replace("from typing", f"{bisection}from typing")
    return "\n\n".join([imports, *quoted, f"{parameters}{over_angle}\n", body, main])


def _run(text: str) -> dict[str, Array]:
    """The columns that a script gives."""
    names: dict[str, Any] = {"__name__": "script"}
    exec(compile(text, "script", "exec"), names)  # what was written here, nothing of others
    columns: dict[str, Array] = names["run"]()
    return columns


def _errors(train: CrankTrain, columns: dict[str, Array], jumps: Array) -> dict[str, float]:
    """By variable what the rows of a script err by at most: their largest difference from the run
    of the scene, and its error; of rows that lie on the same side of all jumps [rad] in both."""
    time, *_ = columns.values()
    every = math.ceil(len(time) / _MOST_ROWS)
    step = float(time[-1]) / len(time)
    result = simulate(train.scene.with_(run__every=f"{every * step!r} s"))
    count = min(len(time) // every, len(result.sampled("time")) - 1) - 1  # not that at the end

    def both(heading: str) -> tuple[Array, Array]:
        name, _, number = heading.split(" [")[0].partition(" ")
        values = result.sampled(name)[1 : count + 1]
        return columns[heading][every - 1 :: every][:count], (
            values[:, int(number) - 1] if number else values
        )

    passed, true = both("crank_angle [rad]")
    around = repeat(jumps, train.period, true.min() - 1.0, true.max() + 1.0)
    sides = (np.searchsorted(around, angle + NEAR) for angle in (passed, true))
    same = np.equal(*sides)
    errors: dict[str, float] = {}
    for heading in list(columns)[1:]:
        name = heading.split(" [")[0].split(" ")[0]
        ours, true = both(heading)
        difference = float(np.max(np.abs(ours - true)[same], initial=0.0))
        error = difference + result.data[name].attrs["error_estimate"]
        errors[name] = max(errors.get(name, 0.0), error)
    return errors


def _refused(scene: Scene) -> str:
    """What in a scene a script does not express, and the way out."""
    if scene.settles:
        return 'until = "settled", which is solved for and not run to; give an end such as "2 rev"'
    if scene.fuel is not None:
        return "[fuel], whose shares are decided on the way; remove [fuel]"
    if scene.friction is not None:
        return "[friction], which jumps where a piston turns; remove [friction]"
    if scene.motion is not None and not isinstance(scene.motion.speed, float):
        return "a prescribed speed that changes; give one constant speed, or free the crank"
    return _refused_load(scene)


def _refused_load(scene: Scene) -> str:
    """Which torque or force on a piston it does not express, and the way out."""
    for number, load in enumerate(scene.torque, start=1):
        if not isinstance(load, Constant | Viscous | Quadratic):
            kind = "a function of Python" if load.parts.function else f'kind = "{load.kind}"'
            return (
                f"torque[{number}], {kind}; give constant, viscous or quadratic loads, which are "
                "smooth"
            )
    for number, force in enumerate(scene.force, start=1):
        if not isinstance(force, ConstantForce | Spring | Damper | ForceAngleTable):
            kind = "a function of Python" if force.law.python else f'kind = "{force.kind}"'
            return (
                f"force[{number}], {kind}; give springs, dampers, constants or a table over the "
                "angle, which are smooth"
            )
    for name, loads in (("torque", scene.torque), ("force", scene.force)):
        for number, torque in enumerate(loads, start=1):
            if torque.has_window:
                return f"the window of {name}[{number}]; leave out when it sets in and ends"
    return ""


def _head(scene: Scene, step: float, errors: dict[str, float], *, jumps: bool) -> str:
    stated = _STATED if scene.motion is None else dict(list(_STATED.items())[2:])
    title = " ".join(scene.title.split()) or "a scene"
    lines = [
        f"# {title.encode('ascii', 'replace').decode()}",
        "#",
        "# A slider-crank mechanism of rigid bodies in exudyn, written by crankmbs.",
        "# Planar: X along the cylinder from the crank axis to the head, Y is X turned by +90",
        "# degrees. Units are SI. It needs numpy and exudyn.",
        "#",
        f"# At this step ({step:.6g} s) it differs from the motion by at most",
        *(f"#     {error_digits(errors[name]):<10} {words}" for name, words in stated.items()),
        *(_JUMPS if jumps else ()),
        "",
    ]
    return "\n".join(lines)


def _parameters(
    train: CrankTrain, stem: str, end: float, steps: int, *, springs: bool, angles: bool
) -> str:
    """What the functions below take, and nothing that none of them does."""
    scene, step = train.scene, end / steps
    values: list[tuple[str, object, str]] = []
    if angles:
        phases = [c.phase for c in scene.cylinders]
        values += [
            ("PHASES", phases, "rad, cycle angles at crank angle 0"),
            ("NEAR", NEAR, "rad: angles nearer than this are one"),
        ]
    if springs:
        tops = [top_position(*gear.shape) for gear in scene.running_gear]
        values += [
            ("TOPS", tops, "m, of the pistons"),
            ("SPRINGS", _springs(scene), "of each piston: N at the top dead centre, N/m, N s/m"),
        ]
    if scene.torque:
        values += [
            ("TORQUE_CONSTANT", _sum(scene, Constant, "torque"), "N m, on the free crank"),
            ("TORQUE_VISCOUS", 0.0 - _sum(scene, Viscous, "coefficient"), "N m s"),
            ("TORQUE_QUADRATIC", 0.0 - _sum(scene, Quadratic, "coefficient"), "N m s^2"),
        ]
    if scene.motion is not None:
        values += [
            ("PRESCRIBED_SPEED", scene.motion.speed, "rad/s"),
            ("START_ANGLE", scene.motion.angle, "rad"),
        ]
    values += [
        ("OUTPUT", f"{stem}_exudyn.csv", "not the name of a table that the scene reads"),
        ("STEP", step, "s"),
        ("STEPS", steps, "to the end"),
    ]
    lines = [f"{name} = {value!r}  # {about}" for name, value, about in values]
    arrays = dict(zip(("POSITION", "VELOCITY", "ACCELERATION"), initial(train, step), strict=True))
    return "\n".join(
        [
            f"MECHANISM = {_mechanism(mechanism_of(scene))}",
            *lines,
            "# x, y [m], angle [rad] of the crank, then of each rod and x, y of its piston: values",
            "# for this step from which the joint forces do not ring.",
            *(_array(f"START_{name}", each) for name, each in arrays.items()),
        ]
    )


def _mechanism(mechanism: Mechanism) -> str:
    rows = ["Mechanism(", f"    gravity={mechanism.gravity!r},"]
    for name, parts in list(mechanism._asdict().items())[1:]:
        rows += [f"    {name}=(", *(f"        {part!r}," for part in parts), "    ),"]
    return "\n".join([*rows, ")"])


def _sum(scene: Scene, kind: type, name: str) -> float:
    return math.fsum(getattr(load, name) for load in scene.torque if isinstance(load, kind))


def _array(name: str, values: Array) -> str:
    return f"{name} = np.array([\n{_rows(values.tolist())}])"


def _rows(values: Sequence[float], across: int = 3) -> str:
    rows = (values[k : k + across] for k in range(0, len(values), across))
    return "".join(f"    {', '.join(map(repr, row))},\n" for row in rows)


def _on(scene: Scene, k: int) -> list[PistonForce]:
    """The forces on the piston of the cylinder k."""
    return [force for force in scene.force if force.cylinder in (None, k + 1)]


def _springs(scene: Scene) -> list[tuple[float, float, float]]:
    """Of each piston the sum of constants [N], springs [N/m] and dampers [N s/m]: the force at rest
    at its top dead centre, what it loses there over the displacement, and with the velocity."""
    rows = []
    for k in range(len(scene.cylinders)):
        laws = [force.law for force in _on(scene, k)]
        lines = [law.forward.pieces[0] for law in laws if law.forward is not None]
        constant, slope = (math.fsum(line[power] for line in lines) for power in (0, 1))
        rows.append((constant, 0.0 - slope, math.fsum(law.viscous for law in laws)))
    return rows


def _over_angle(train: CrankTrain) -> str:
    """The forces over the cycle angle, of gas and tables: each different one once, and which act on
    each piston; nothing where there are none."""
    scene = train.scene
    of_each: list[list[tuple[Cycle, float]]] = []
    for k, gear in enumerate(scene.running_gear):
        gas = [(each, gear.piston.gas_area or 0.0) for each in (train.pressure or ())[k : k + 1]]
        tables = [force.law.over_angle for force in _on(scene, k)]
        of_each.append([*gas, *((each, 1.0) for each in tables if each is not None)])
    different = list(dict.fromkeys(each for forces in of_each for each in forces))
    if not different:
        return ""
    lines = [
        "# What gas and tables put on a piston [N] over its cycle angle [rad]: from each start a",
        "# cubic, by descending power of the angle from there.",
    ]
    for number, (force, area) in enumerate(different, start=1):
        knots = force.knots
        cubics = (area * force.coefficients).T
        lines += [
            f"PIECES_{number} = {{",
            f'    "first": {float(knots[0]) - NEAR!r},',
            f'    "period": {float(knots[-1] - knots[0])!r},',
            '    "starts": [',
            _rows((knots[:-1] - knots[0]).tolist(), 4).rstrip(),
            "    ],",
            '    "cubics": [',
            *(f"    ({', '.join(map(repr, row))})," for row in cubics.tolist()),
            "    ],",
            "}",
        ]
    names = [[f"PIECES_{different.index(force) + 1}" for force in forces] for forces in of_each]
    rows = (f"[{', '.join(row)}]" for row in names)
    return "\n".join(["", *lines, f"OVER_ANGLE = [{', '.join(rows)}]"])
