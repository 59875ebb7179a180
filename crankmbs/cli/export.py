"""The command ``export``: a scene or its result for another program."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Exit, Option, echo

from crankmbs.cli.options import SceneName, named_scene
from crankmbs.cli.progress import progress
from crankmbs.errors import InputError

__all__ = ["export"]


def export(
    scene: SceneName,
    to: Annotated[
        str, Option(help="toml: a copy of the scene; matlab: its result; exudyn: a script.")
    ],
    out: Annotated[
        Path | None,
        Option("--out", "-o", metavar="FILE", help="Default NAME.toml, NAME.mat or NAME.py."),
    ] = None,
) -> None:
    """Copy a scene as it is, write its result for MATLAB, or its bodies as a script for exudyn."""
    from crankmbs.export import copy_scene
    from crankmbs.export import export as exported
    from crankmbs.export.files import SUFFIXES, refused_kind
    from crankmbs.simulate import simulate

    if to not in SUFFIXES:
        raise InputError(f"--{refused_kind(to)}")
    path, loaded = named_scene(scene)
    target = out or Path(f"{path.stem}{SUFFIXES[to]}")
    with progress("exporting"):
        result = simulate(loaded) if to == "matlab" else None
        copied = to == "toml"
        written = copy_scene(path, target) if copied else exported(result or loaded, to, target)
    echo(f"wrote {', '.join(map(str, written))}")
    if result is not None and result.status != 0:
        echo(result.message)
        raise Exit(3)
