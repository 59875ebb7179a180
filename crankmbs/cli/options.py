"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["CostCap", "NoFigures", "Out", "Rtol", "SceneName", "Until", "WrittenScene"]


SceneName = Annotated[
    str, typer.Argument(metavar="SCENE", help="A scene file, or the name of a shipped scene.")
]

CostCap = Annotated[
    float, typer.Option(help="Seconds, as steps, after which multibody and minimal give up.")
]

Rtol = Annotated[float | None, typer.Option(help="Relative global error asked for.")]
Until = Annotated[
    str | None, typer.Option(help='End: "20 cycles", "10 rev", "0.75 s" or "settled".')
]
Out = Annotated[Path | None, typer.Option(help="Folder of the results; default results/NAME.")]
WrittenScene = Annotated[
    Path | None,
    typer.Option(
        "-o", "--write", metavar="FILE", help="Write the scene with the answer in place, .toml."
    ),
]
NoFigures = Annotated[bool, typer.Option("--no-figures", help="Draw no figures.")]
