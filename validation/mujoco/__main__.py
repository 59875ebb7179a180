"""`python -m validation.mujoco [CLAIM ...]`: compute anew what MuJoCo gives for the scenes of the
claims that are held against it, and keep it; without a name of all of them, which takes an hour."""

import sys

from validation.case import load_cases
from validation.checks.mujoco import scenes_of
from validation.mujoco.motion import stored_motion
from validation.mujoco.stored import read_stored, write_stored


def main(names: list[str]) -> None:
    """Print one line a scene; what cannot be computed is left out."""
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


if __name__ == "__main__":
    main(sys.argv[1:])
