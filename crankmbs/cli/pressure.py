"""The command ``pressure``: a measured file in, a table, figures and sentences out."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import typer

from crankmbs.cli.folder import writable
from crankmbs.cli.progress import progress
from crankmbs.errors import InputError
from crankmbs.indicated import Indicated, read_pressure
from crankmbs.indicated.write import gas_lines
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.storage.files import together

__all__ = ["measured_pressure"]

_NAMES = (
    "columns|reference|unit|each|stroke|firing_tdc|loss_angle|compression_ratio|invert|smooth"
    "|cycles|separator|decimal|skip|scene"
)
_GIVEN = re.compile(rf'\b({_NAMES})=(True\b|"[^"]*"|\.\.\.|[\w.]+)')
_BARE = re.compile(r"\b(loss_angle|compression_ratio|firing_tdc)\b(?!=)")


def measured_pressure(
    file: Path, scene: str | None, given: Mapping[str, Any], *, out: Path | None, figures: bool
) -> None:
    """Read a file, write its table and figures, print what was found and done.

    given : the options of `read_pressure`; out : the table; None: results/NAME/pressure.csv

    Raises
    ------
    CrankmbsError : what cannot be read, or is left open, in words of the command line
    """
    target = Path("results", file.stem, "pressure.csv") if out is None else out
    if target.resolve() == file.resolve():
        raise InputError(f"-o: {target} is the file that is read; choose another name")
    machine = None if scene is None else load_scene(scene_path(scene))
    folder = writable(target.parent)
    try:
        with progress("reading"):
            found = read_pressure(file, machine, **given)
        with together(folder) as part:
            found.save(part / target.name)
            names = [target.name]
            if figures:
                names += _draw(found, part, target.stem)
    except InputError as error:
        raise InputError(_as_options(str(error))) from None
    lines = [_as_options(sentence) for sentence in found.sentences]
    lines += ["", f"wrote {folder}: {', '.join(names)}", "as [gas] of a scene:"]
    lines += [f"  {line}" for line in gas_lines(found, target.name)]
    typer.echo("\n".join(lines))


def _draw(found: Indicated, folder: Path, stem: str) -> list[str]:
    from crankmbs.figures import save_indicated_figures  # matplotlib only here

    return [file.name for file in save_indicated_figures(found, folder, stem)]


def _as_options(text: str) -> str:
    """A sentence for a caller in Python, in words of the command line.

    >>> _as_options('give loss_angle, or invert=True, or reference="inlet 1 bar"')
    'give --loss-angle, or --invert, or --reference "inlet 1 bar"'
    """
    first = re.match(rf"({_NAMES}): ", text)
    if first:
        text = f"--{first[1].replace('_', '-')}{text[first.end(1) :]}"
    text = _BARE.sub(lambda match: _option(match[1]), text)
    return _GIVEN.sub(lambda match: f"{_option(match[1])} {match[2]}".removesuffix(" True"), text)


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"
