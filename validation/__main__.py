"""`python -m validation [NAME ... | --quick | --long [N]]`: judge claims; exit status 1 unless all
hold."""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial

from validation.about import commit, environment
from validation.case import Case, load_cases
from validation.judge import SEEN, Verdict, judge, seen
from validation.many import run_many
from validation.report import write_pages
from validation.results import read_rows, row_of, stale, write_rows


def main(arguments: list[str] | None = None) -> int:
    """Print one line a claim; but for --quick and --long, try its shifted parameter, too, keep what
    is measured and write the pages."""
    cases = load_cases()
    asked = _parser([case.name for case in cases]).parse_args(arguments)
    if asked.long is not None:
        return 0 if run_many(asked.long, asked.first, asked.processes) else 1
    processes = asked.processes or 1
    if asked.quick:
        tried = list(_judged([case for case in cases if case.quick], processes, shift=False))
        return 0 if tried and all(verdict.green for verdict, _ in tried) else 1
    chosen = [case for case in cases if not asked.page and case.name in (asked.name or case.name)]
    return 0 if _written(cases, chosen, processes) else 1


def _parser(names: list[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m validation", description=__doc__)
    parser.add_argument(
        "name", nargs="*", choices=[*names, []], metavar="NAME", help="claims; all without a name"
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help="leave out the claims that take long (under two minutes), and write nothing",
    )
    parser.add_argument("--page", action="store_true", help="none: write the pages anew")
    parser.add_argument(
        "--long",
        nargs="?",
        type=int,
        const=10_000,
        metavar="N",
        help="judge N random scenes instead, 10,000 without a number, and write nothing "
        "(with heyoka, of the extra bench, an hour; without, a day)",
    )
    parser.add_argument(
        "--first", type=int, default=0, metavar="SEED", help="of --long: the seed to begin with"
    )
    parser.add_argument(
        "--processes",
        type=int,
        metavar="P",
        help="how many claims or random scenes at a time; without, one claim, or as many scenes as "
        "there are processors",
    )
    return parser


def _written(cases: Sequence[Case], chosen: Sequence[Case], processes: int) -> bool:
    """Judge claims, keep the rows of all others, and write the pages where none is missing;
    whether all hold."""
    names = {case.name for case in cases}
    rows = {name: row for name, row in read_rows().items() if name in names}
    at, made_with, day = commit(), environment(), f"{datetime.now(UTC):%Y-%m-%d}"
    for verdict, seconds in _judged(chosen, processes, shift=True):
        row = row_of(verdict, seconds=seconds, date=day, commit=at, environment=made_with)
        rows[row.name] = row
        write_rows(rows)
    if left := stale(cases, rows):
        print(f"to be judged, their inputs changed or they are new: {' '.join(left)}")
        return False
    print(f"written: {write_pages(cases, rows)}")
    return all(rows[name].green for name in names)


def _judged(cases: Sequence[Case], processes: int, *, shift: bool) -> Iterator[tuple[Verdict, int]]:
    """Verdicts as they come, each with its seconds; printed, one line a claim.

    shift : whether the shifted parameter is tried, too, which is not counted in the seconds
    """
    begin, count, red = time.perf_counter(), 0, 0
    for verdict, seconds in _timed_all(cases, processes, shift=shift):
        count, red = count + 1, red + (not verdict.green)
        print(
            f"{verdict.word:12} {verdict.case.name:40} {verdict.outcome.error:9.2e} of "
            f"{verdict.case.tolerance:7.1e}  {verdict.outcome.detail}",
            f"; {verdict.mutant}" if verdict.mutant not in ("", SEEN) else "",
            sep="",
            flush=True,
        )
        yield verdict, seconds
    print(f"{count} claims, {red} red, {time.perf_counter() - begin:.0f} s")


def _timed_all(
    cases: Sequence[Case], processes: int, *, shift: bool
) -> Iterator[tuple[Verdict, int]]:
    timed = partial(_timed, shift=shift)
    if processes == 1:
        yield from map(timed, cases)
        return
    took = {name: row.seconds for name, row in read_rows().items()}
    longest_first = sorted(cases, key=lambda case: took.get(case.name, 0), reverse=True)
    with ProcessPoolExecutor(processes) as pool:
        for future in as_completed([pool.submit(timed, case) for case in longest_first]):
            yield future.result()


def _timed(case: Case, *, shift: bool) -> tuple[Verdict, int]:
    begin = time.perf_counter()
    verdict = judge(case)
    seconds = round(time.perf_counter() - begin)
    return (replace(verdict, mutant=seen(case)) if shift else verdict), seconds


if __name__ == "__main__":
    sys.exit(main())
