"""`python -m validation.mutants.claims NAME ...`: judge claims until one is red."""

import argparse
import sys

from validation.case import CASES, load_case
from validation.judge import judge


def main(arguments: list[str] | None = None) -> int:
    """Print the first red claim as pytest prints a failed test; exit status 1 if there is one."""
    parser = argparse.ArgumentParser(
        prog="python -m validation.mutants.claims", description=__doc__
    )
    parser.add_argument("names", nargs="+", metavar="NAME", help="claims")
    for name in parser.parse_args(arguments).names:
        verdict = judge(load_case(CASES / f"{name}.toml"))
        if not verdict.green and verdict.word != "skipped":
            print(f"FAILED {name} - {verdict.word}: {verdict.outcome.detail}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
