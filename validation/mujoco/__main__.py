"""`python -m validation.mujoco [CLAIM ...]`: compute anew what MuJoCo gives for the scenes of the
claims that are held against it, and keep it; without a name of all of them, which takes an hour."""

import argparse
import sys

from validation.case import load_cases
from validation.checks.mujoco import scenes_of
from validation.mujoco.motion import stored_motion
from validation.mujoco.stored import read_stored, write_stored


def main(arguments: list[str] | None = None) -> int:
    """Print one line a scene; what cannot be computed is left out."""
    parser = argparse.ArgumentParser(prog="python -m validation.mujoco", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="CLAIM", help="all without a name")
    names = parser.parse_args(arguments).names
    stored = read_stored()
    for case in load_cases():
        if not case.check.startswith("mujoco.") or (names and case.name not in names):
            continue
        for name, scene in scenes_of(case):
            stored.pop(name, None)
            try:
                stored[name] = stored_motion(scene, int(case.parameters["samples"]))
            except ArithmeticError as error:
                print(f"{name}: left out, {error}", flush=True)
            else:
                print(name, flush=True)
            write_stored(stored)
    return 0


if __name__ == "__main__":
    sys.exit(main())
