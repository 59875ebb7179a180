"""`python -m validation.mutants`: break the mechanics, one law at a time; one guard must turn red.

Exit status 1 where a mutant survives that is not explained.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from datetime import date
from pathlib import Path
from queue import SimpleQueue

from validation.about import commit
from validation.case import load_cases
from validation.mutants.page import summary, write_page
from validation.mutants.plan import Guards, Mutant, load_mutants, wide_guards
from validation.mutants.results import NO_END, PAGE, RESULTS, Row, read_rows, untried, write_rows
from validation.mutants.scratch import Red, Scratch

_LIMIT = 300.0  # s for the guards of one mutant; unbroken they take a tenth of it or so
_WIDE_LIMIT = 1800.0  # s for all others


def main(arguments: list[str] | None = None) -> int:
    """Try the mutants asked for, keep the results of all others, and write the page."""
    mutants, rows = load_mutants(), read_rows(RESULTS)
    asked = _parser(mutants).parse_args(arguments)
    rows = {mutant.name: rows[mutant.name] for mutant in mutants if mutant.name in rows}
    left = untried(mutants, rows)
    for row in _tried([m for m in mutants if _is_asked(m, asked, left)], asked.processes):
        rows[row.name] = row
        write_rows((rows[m.name] for m in mutants if m.name in rows), RESULTS)
        print(f"{row.verdict:9} {row.seconds:4} s  {row.name:40} {row.by}", flush=True)
    if left := untried(mutants, rows):
        print(f"{len(left)} mutants have no result as they are; --missing tries them")
        return 1
    print("\n".join(summary(mutants, rows)))
    print(f"written: {write_page(mutants, rows, PAGE)}")
    return 0 if all(rows[m.name].dead or m.equivalent for m in mutants) else 1


def _parser(mutants: list[Mutant]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m validation.mutants", description=__doc__)
    parser.add_argument(
        "--only",
        nargs="+",
        metavar="NAME",
        choices=[mutant.name for mutant in mutants],
        help="these mutants",
    )
    parser.add_argument(
        "--room",
        nargs="+",
        choices=sorted({mutant.room for mutant in mutants}),
        help="those of these TOML files",
    )
    parser.add_argument(
        "--missing",
        action="store_true",
        help="those without a result as they are, of the above or of all",
    )
    parser.add_argument("--page", action="store_true", help="none: write the page anew")
    parser.add_argument("--processes", type=int, default=1, metavar="P", help="how many at a time")
    return parser


def _is_asked(mutant: Mutant, asked: argparse.Namespace, left: list[str]) -> bool:
    if asked.page or (asked.missing and mutant.name not in left):
        return False
    chosen = [mutant.name in (asked.only or ()), mutant.room in (asked.room or ())]
    return any(chosen) or (asked.only is None and asked.room is None)


def _tried(mutants: list[Mutant], processes: int) -> Iterator[Row]:
    """Every mutant in a copy that no other one is in at the time."""
    if not mutants:
        return
    wide = wide_guards(load_mutants(), [case.name for case in load_cases() if case.quick])
    at, today = commit(), date.today().isoformat()
    with (
        tempfile.TemporaryDirectory(prefix="mutants_") as folder,
        ThreadPoolExecutor(processes) as pool,
    ):
        free: SimpleQueue[Scratch] = SimpleQueue()
        for k in range(processes):
            copy = Path(folder) / str(k)
            copy.mkdir()
            free.put(Scratch(copy))
        _check_unbroken(free, [mutant.guards for mutant in mutants])

        def tried(mutant: Mutant) -> Row:
            scratch, begin = free.get(), time.perf_counter()
            try:
                red = _red(scratch, mutant, wide)
            finally:
                free.put(scratch)
            seconds = round(time.perf_counter() - begin)
            if red is None:
                return Row(mutant.name, "survived", "", seconds, today, at, mutant.digest)
            verdict = "killed" if red.ended else NO_END
            return Row(mutant.name, verdict, red.guard, seconds, today, at, mutant.digest)

        futures = [pool.submit(tried, mutant) for mutant in mutants]
        try:
            for future in as_completed(futures):
                yield future.result()
        finally:
            pool.shutdown(cancel_futures=True)


def _red(scratch: Scratch, mutant: Mutant, wide: Guards) -> Red | None:
    """What turns red with a mutant: of its own guards, or else of all, if it is not equivalent."""
    with scratch.mutated(mutant):
        red = scratch.first_red(mutant.guards, _LIMIT)
        if red is not None or mutant.equivalent:
            return red
        others = wide.without(mutant.guards)
        red = scratch.first_red(Guards(tests=others.tests), _WIDE_LIMIT)
        red = red or scratch.first_red(Guards(claims=others.claims), _WIDE_LIMIT)
    if red is not None and red.ended and scratch.first_red(others.only(red.guard)) is not None:
        raise SystemExit(f"without any mutant {red.guard} is red: mend that first")
    return red


def _check_unbroken(free: SimpleQueue[Scratch], guards: list[Guards]) -> None:
    """Without a mutant every guard is green, or its red says nothing.

    Raises
    ------
    SystemExit : one is red
    """
    tests = dict.fromkeys(test for own in guards for test in own.tests)
    claims = dict.fromkeys(claim for own in guards for claim in own.claims)
    scratch = free.get()
    red = scratch.first_red(Guards(tuple(tests), tuple(claims)))
    free.put(scratch)
    if red is not None:
        raise SystemExit(f"without any mutant {red.guard} is red: mend that first")


if __name__ == "__main__":
    sys.exit(main())
