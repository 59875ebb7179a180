"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

if TYPE_CHECKING:
    from crankmbs.scene.scene import Scene

__all__ = [
    "CostCap",
    "Decimal",
    "Index",
    "NoFigures",
    "Out",
    "OutBesideScene",
    "Rtol",
    "SceneName",
    "Separator",
    "Skip",
    "Until",
    "WrittenScene",
    "named_scene",
]

SceneName = Annotated[
    str, Argument(metavar="SCENE", help="A scene file, or the name of a shipped scene.")
]

CostCap = Annotated[
    float, Option(help="Seconds, as steps, after which multibody and minimal give up.")
]

Rtol = Annotated[float | None, Option(help="Relative global error asked for.")]
Until = Annotated[str | None, Option(help='End: "20 cycles", "10 rev", "0.75 s" or "settled".')]
_RESULTS = "Folder of the results; default results/NAME."
Out = Annotated[Path | None, Option("-o", "--out", metavar="DIR", help=_RESULTS)]
OutBesideScene = Annotated[Path | None, Option("--out", metavar="DIR", help=_RESULTS)]
"""Where -o is the scene with the answer."""
WrittenScene = Annotated[
    Path | None,
    Option(
        "-o", "--write", metavar="FILE", help="Write the scene with the answer in place, .toml."
    ),
]
NoFigures = Annotated[bool, Option("--no-figures", help="Draw no figures.")]

Index = Annotated[
    str | None, Option(help="The column of an encoder's mark; its pulses: --wheel 360.")
]
Separator = Annotated[str | None, Option(help='";", ",", "|", tab or blank; else it is found.')]
Decimal = Annotated[str | None, Option(help='"." or ","; else it is found.')]
Skip = Annotated[int, Option(help="Lines at the beginning to leave out.")]


def named_scene(name: str) -> tuple[Path, Scene]:
    """The file of the scene that the argument SCENE names, and the scene."""
    from crankmbs.scene.read import load_scene, scene_path

    path = scene_path(name)
    return path, load_scene(path)
