"""The commands ``scenes``, ``new`` and ``check``: which scenes there are, one to start from, and
how one would be run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Argument, echo

from crankmbs.cli.options import SceneName, named_scene
from crankmbs.errors import InputError, OutputError
from crankmbs.scene.shipped import shipped_scenes
from crankmbs.storage.files import text_in_one_move

__all__ = ["check", "new", "scenes"]


def scenes() -> None:
    """List the shipped scenes."""
    import tomllib

    shipped = shipped_scenes()
    width = max(map(len, shipped), default=0)
    for name, path in shipped.items():
        title = tomllib.loads(path.read_text(encoding="utf-8"))["title"]
        echo(f"{name:<{width}}  {title}")


def new(
    name: Annotated[str, Argument(metavar="NAME", help="Name or path of the new scene.")],
) -> None:
    """Write a commented scene to start from."""
    from crankmbs.scene.template import template

    path = Path(name if name.endswith(".toml") else f"{name}.toml")
    if path.name == ".toml":
        raise InputError(f"NAME: a scene needs a name, such as my_engine; {name!r} came")
    if path.exists():
        raise OutputError(f"{path}: exists already and is not overwritten; choose another name")
    text_in_one_move(path, template(path.stem))
    echo(f"wrote {path}; check it with: crankmbs check {path}")


def check(scene: SceneName) -> None:
    """Read a scene and say how it would be run; run nothing."""
    from crankmbs.choose import choose
    from crankmbs.report.machine import describe

    path, loaded = named_scene(scene)
    echo(describe(str(path), loaded, choose(loaded, loaded.run.formulation)))
