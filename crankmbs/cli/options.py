"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

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
