"""`python -m validation.speed SCENE`: every formulation beside other tools and a limit in C."""

import argparse
import sys
from pathlib import Path

from crankmbs.cli.work_precision import measure_scene
from crankmbs.errors import CrankmbsError
from crankmbs.scene.scene import Scene
from crankmbs.work_precision.contender import Contender
from crankmbs.work_precision.reference import Reference
from validation.speed.kernel import kernels_of
from validation.speed.peers import peers_of


def main(arguments: list[str] | None = None) -> int:
    """Print and write what `crankmbs work-precision` does, with the others beside.

    Returns
    -------
    0; 2 for bad input; 3 where the scene stops before its end
    """
    parser = argparse.ArgumentParser(prog="python -m validation.speed", description=__doc__)
    parser.add_argument("scene", help="a scene file, or the name of a shipped scene")
    parser.add_argument("--out", type=Path, help="folder of the results; default results/NAME")
    asked = parser.parse_args(arguments)
    try:
        return 0 if measure_scene(asked.scene, out=asked.out, beside=_beside) else 3
    except CrankmbsError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def _beside(scene: Scene, reference: Reference) -> tuple[list[Contender], list[str]]:
    contenders, absent = peers_of(scene, reference)
    return [*kernels_of(scene, reference), *contenders], absent


if __name__ == "__main__":
    sys.exit(main())
