"""The command ``sweep``: a scene with some of its numbers varied."""

from __future__ import annotations

import math
import shlex
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Exit, Option, echo

from crankmbs.cli.options import SceneName, named_scene
from crankmbs.cli.text import cells, heading, table
from crankmbs.display import with_unit
from crankmbs.errors import CrankmbsError, InputError, shown

if TYPE_CHECKING:
    from crankmbs.scene.scene import Scene
    from crankmbs.sweep.plan import Plan
    from crankmbs.sweep.summary import Bounds, Summary

__all__ = ["answered", "sweep", "varied"]

_ENDED = {
    0: "reached their end",
    1: "ended before their end",
    -1: "broke off",
    2: "cannot be built",
    -2: "ended their worker",
}
_OPTIONS = {"method": "--sample", "n": "--n", "seed": "--seed", "keep": "--keep"}
_OPTIONS |= {"executor": "--workers"}
_RANGE = '"crank.inertia=0.05..0.5 kg m^2:40"'


def sweep(
    scene: SceneName,
    out: Annotated[Path, Option("-o", "--out", metavar="FOLDER", help="Such as sweep.zarr.")],
    vary: Annotated[
        list[str] | None,
        Option(metavar="NAME=VALUES", help=f"Such as {_RANGE}; may be given often."),
    ] = None,
    sample: Annotated[
        str | None, Option(help="sobol or latin: cases spread over the ranges.")
    ] = None,
    n: Annotated[int, Option("--n", help="How many cases a sample has.")] = 1024,
    seed: Annotated[int, Option(help="From which a sample is drawn.")] = 1,
    cases: Annotated[
        Path | None, Option(metavar="FILE", help="A CSV file with a row for each case.")
    ] = None,
    keep: Annotated[str, Option(help="measures, or series: every sample too.")] = "measures",
    strict: Annotated[
        bool, Option("--strict", help="Run nothing if any scene cannot be built.")
    ] = False,
    resume: Annotated[bool, Option("--resume", help="Resume what was interrupted.")] = False,
    workers: Annotated[
        int | None, Option(help="How many compute; default one for each processor.")
    ] = None,
    cluster: Annotated[
        str | None, Option(metavar="ADDRESS", help='A Dask scheduler, such as "tcp://host:8786".')
    ] = None,
) -> None:
    """Run a scene with some of its numbers varied, and store the measures of each case."""
    from crankmbs.sweep.plan import check_possible, plan_of
    from crankmbs.sweep.summary import summary

    path, loaded = named_scene(scene)
    with _as_options():
        over = _cases(vary or [], cases, (sample, n, seed))
        plan = plan_of(loaded, over, keep)
    if workers is not None and cluster is not None:
        raise InputError("--workers and --cluster both say where cases are computed; give one")
    _check_free(out, resume)
    if strict:
        check_possible(plan)
    if plan.series:
        echo(f"series of {plan.cases.count} cases take {_bytes(plan.bytes)} before packing")
    _fill(plan, out, workers, cluster)
    title, result = heading(path.stem, plan.scene.title), summary(out)
    also = f"\n{_also_stored(plan, out)}" if result.bounds else ""
    echo(f"{title}\n\n{_report(plan, result)}{also}\n\nwrote {out}")
    if 0 not in result.ended:
        raise Exit(3)


def answered(name: str, scene: Scene, report: str, *, lacks: bool) -> None:
    """Print a report of cases of a scene, and over what their measures are where that need not be a
    settled motion; end with status 3 where it lacks something."""
    parts = [heading(name, scene.title), report]
    if scene.start is not None and not scene.settles:
        parts.append(
            "each run as the scene has it, measured over the last cycle, settled or not; "
            'until = "settled" in [run] asks for settled motions'
        )
    echo("\n\n".join(parts))
    if lacks:
        raise Exit(3)


def varied(texts: list[str]) -> dict[str, str]:
    """Names and their values, as the option --vary has them.

    Raises
    ------
    InputError : no name, or one twice

    >>> varied(["rod.length=0.14..0.2 m:25"])
    {'rod.length': '0.14..0.2 m:25'}
    """
    ranges: dict[str, str] = {}
    for text in texts:
        name, sign, values = text.partition("=")
        name = name.strip()
        if not sign or not name or not values.strip():
            raise InputError(
                f"--vary: must be a name and its values, as {_RANGE}; {shown(text)} came"
            )
        if name in ranges:
            raise InputError(f"--vary: {name} is varied twice; give it once")
        ranges[name] = values.strip()
    return ranges


def _cases(vary: list[str], cases: Path | None, drawn: tuple[str | None, int, int]) -> object:
    """What the options say is varied."""
    ranges, (method, n, seed) = varied(vary), drawn
    if (cases is None) == (not ranges):
        came = "neither" if cases is None else "both"
        raise InputError(
            f"--vary says what is varied, as {_RANGE}, or --cases a file of cases; {came} came"
        )
    if method is None:
        return ranges or cases
    if cases is not None:
        raise InputError("--sample spreads cases over ranges of --vary; a file has its own")
    from crankmbs.sweep.sample import Sample

    return Sample(ranges, n, method, seed)


def _fill(plan: Plan, out: Path, workers: int | None, cluster: str | None) -> None:
    """Compute the cases here or on the cluster, with a bar and a way to resume."""
    from crankmbs.sweep.cluster import cluster_executor
    from crankmbs.sweep.run import fill

    with ExitStack() as stack:
        executor = stack.enter_context(cluster_executor(cluster)) if cluster else workers
        report = stack.enter_context(_progress(plan.cases.count))
        stack.enter_context(_as_options())
        stack.enter_context(_resumable(out))
        fill(plan, out, executor, report)


def _check_free(out: Path, resume: bool) -> None:
    from crankmbs.sweep.store import unfinished

    if resume and not out.exists():
        raise InputError(f"--resume: there is no {out} to resume; leave it out")
    if not resume and unfinished(out):
        raise InputError(
            f"{out}: exists already; give --resume for a sweep that was interrupted, "
            "or another folder with -o"
        )


@contextmanager
def _as_options() -> Iterator[None]:
    """Sentences that begin with an argument of Python begin with the option."""
    try:
        yield
    except InputError as error:
        word, _, rest = str(error).partition(" ")
        option = _OPTIONS.get(word.rstrip(":"))
        raise InputError(f"{option}: {rest}" if option else str(error)) from None


@contextmanager
def _resumable(out: Path) -> Iterator[None]:
    """Say after an interrupt how to resume."""
    try:
        yield
    except KeyboardInterrupt:
        from crankmbs.sweep.store import unfinished

        if unfinished(out):
            name = shlex.quote(str(out))
            echo(f"{name} has all finished blocks; --resume computes the others", err=True)
        raise


@contextmanager
def _progress(count: int) -> Iterator[Callable[[int], None]]:
    """How many cases are there, how many a second, and the time left, on a terminal's stderr."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        ProgressColumn,
        Task,
        TextColumn,
        TimeRemainingColumn,
    )
    from rich.text import Text

    class Rate(ProgressColumn):
        """Cases a second."""

        def render(self, task: Task) -> Text:
            return Text(f"{task.speed:.3g}/s" if task.speed else "")

    columns = (TextColumn("cases"), BarColumn(), MofNCompleteColumn(), Rate())
    console = Console(stderr=True)
    with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
        task = bar.add_task("", total=count)
        yield lambda more: bar.advance(task, more)


def _report(plan: Plan, summary: Summary) -> str:
    lines = [f"{plan.cases.count} cases over {', '.join(plan.cases.varied)}"]
    if 0 not in summary.ended:
        lines.append("none reached its end")
    for status, (count, message) in sorted(summary.ended.items(), key=lambda item: item[0] != 0):
        first = "" if status == 0 else f"; the first: {message}"
        lines.append(f"{count} {_ENDED[status]}{first}")
    lines += _warnings(plan)
    if summary.bounds:
        headings = ["over all cases", "least", "largest", "num. error at most"]
        lines += ["", table(headings, [_bounds(bounds) for bounds in summary.bounds])]
    return "\n".join(lines)


_EACH = {"cylinder": "cylinder", "journal": "bearing", "lecture": "lecture formula"}


def _also_stored(plan: Plan, out: Path) -> str:
    """What the store has of each of several, and how to see it."""
    from crankmbs.sweep.columns import columns_of

    dims = {dim for column in columns_of(plan.scene).values() for dim in column.dims}
    *most, last = (name for dim, name in _EACH.items() if dim in dims)
    each = f"{', '.join(most)} and {last}" if most else last
    return (
        f"also stored, of each {each}; to see it: crankmbs plot "
        f'{shlex.quote(str(out))} --show "crank pin peak"; an unknown name lists all'
    )


def _warnings(plan: Plan) -> list[str]:
    """What is not plausible of the first and the last case, and is of the scene itself."""
    from crankmbs.measures.plausible import warnings
    from crankmbs.sweep.scenes import scene_of

    known = {text.partition(":")[0] for text in warnings(plan.scene)}
    lines: dict[str, None] = {}
    for end in (slice(1), slice(-1, None)):
        (values,) = plan.cases.values([end] * len(plan.cases.shape))
        with suppress(CrankmbsError):  # what cannot be built is counted
            texts = warnings(scene_of(plan.scene, plan.cases.names, values))
            lines |= dict.fromkeys(t for t in texts if t.partition(":")[0] not in known)
    return [f"warning: {text}" for text in lines]


def _bounds(bounds: Bounds) -> list[str]:
    least, largest = (
        cells((x, bounds.error), bounds.units) for x in (bounds.least, bounds.largest)
    )
    return [with_unit(bounds.long_name, bounds.units), least[0], *largest]


def _bytes(size: float) -> str:
    units = ("B", "kB", "MB", "GB", "TB")
    power = min(int(math.log10(size) // 3), len(units) - 1)
    return f"{size / 1000.0**power:.3g} {units[power]}"
