"""`python -m validation.mutants.claims NAME ...`: judge claims until one is red."""

import sys

from validation.case import CASES, load_case
from validation.judge import judge


def main(names: list[str]) -> int:
    """Print the first red claim as pytest prints a failed test; exit status 1 if there is one."""
    for name in names:
        verdict = judge(load_case(CASES / f"{name}.toml"))
        if not verdict.green and verdict.word != "skipped":
            print(f"FAILED {name} - {verdict.word}: {verdict.outcome.detail}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
