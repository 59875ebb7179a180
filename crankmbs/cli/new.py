"""The command `new`: a scene to start from."""

from __future__ import annotations

from pathlib import Path

import typer

from crankmbs.errors import InputError, OutputError
from crankmbs.storage.files import text_in_one_move

__all__ = ["new_scene"]


def new_scene(name: str) -> None:
    """Write a commented scene; a file that exists is not overwritten.

    Raises
    ------
    InputError : no name
    OutputError : the file exists, or cannot be written
    """
    from crankmbs.scene.template import template

    path = Path(name if name.endswith(".toml") else f"{name}.toml")
    if path.name == ".toml":
        raise InputError(f"NAME: a scene needs a name, such as my_engine; {name!r} came")
    if path.exists():
        raise OutputError(f"{path}: exists already and is not overwritten; choose another name")
    text_in_one_move(path, template(path.stem))
    typer.echo(f"wrote {path}; check it with: crankmbs check {path}")
