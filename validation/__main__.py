"""`python -m validation [--quick | --long [N]]`: judge claims; exit status 1 unless all hold."""

import argparse
import sys
import time

from validation.case import load_cases
from validation.judge import Verdict, judge
from validation.many import run_many
from validation.report import write_report


def main(arguments: list[str] | None = None) -> int:
    """Print one line a claim. A full run also writes REPORT.md and the figures."""
    parser = argparse.ArgumentParser(prog="python -m validation", description=__doc__)
    parser.add_argument(
        "--quick",
        action="store_true",
        help="leave out the claims that take long (under two minutes), and write nothing",
    )
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
        "--processes", type=int, metavar="P", help="of --long: how many scenes at a time"
    )
    asked = parser.parse_args(arguments)
    if asked.long is not None:
        return 0 if run_many(asked.long, asked.first, asked.processes) else 1
    quick = asked.quick
    verdicts: list[Verdict] = []
    begin = time.perf_counter()
    for case in load_cases():
        if case.quick or not quick:
            verdict = judge(case)
            verdicts.append(verdict)
            print(
                f"{verdict.word:12} {case.name:40} {verdict.outcome.error:9.2e} of "
                f"{case.tolerance:7.1e}  {verdict.outcome.detail}",
                flush=True,
            )
    red = sum(not verdict.green for verdict in verdicts)
    print(f"{len(verdicts)} claims, {red} red, {time.perf_counter() - begin:.0f} s")
    if not quick:
        print(f"written: {write_report(verdicts)}")
    return 1 if red or not verdicts else 0


if __name__ == "__main__":
    sys.exit(main())
