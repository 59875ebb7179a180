"""The command ``export``: a scene or its result for another program."""

from __future__ import annotations

from pathlib import Path

import typer

from crankmbs.cli.progress import progress
from crankmbs.export import copy_scene, export
from crankmbs.export.files import SUFFIXES
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.simulate import simulate

__all__ = ["export_scene"]


def export_scene(name: str, to: str, *, out: Path | None) -> bool:
    """Write a scene for another program; return whether a run that this took reached its end.

    Raises
    ------
    CrankmbsError : a bad scene, what cannot be expressed, or a file that cannot be written
    """
    path = scene_path(name)
    scene = load_scene(path)
    target = out or Path(f"{path.stem}{SUFFIXES.get(to, '')}")
    with progress("exporting"):
        result = simulate(scene) if to == "matlab" else None
        written = copy_scene(path, target) if to == "toml" else export(result or scene, to, target)
    typer.echo(f"wrote {', '.join(map(str, written))}")
    if result is not None and result.status != 0:
        typer.echo(result.message)
        return False
    return True
