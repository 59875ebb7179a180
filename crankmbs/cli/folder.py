"""The folder that a command writes its results into."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from crankmbs.errors import OutputError

__all__ = ["results_folder", "writable", "wrote", "wrote_into"]

_OURS = {".png", ".csv", ".nc"}


def writable(folder: Path) -> Path:
    """Try the folder, so that a run is not lost at its end, and leave nothing of the trial."""
    missing = [each for each in (folder, *folder.parents) if not os.path.lexists(each)]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError as error:
        raise OutputError(
            f"{folder}: cannot be written ({error.strerror}); choose another folder with --out"
        ) from None
    finally:
        for each in missing:
            with suppress(OSError):  # not made, or another run writes there by now
                each.rmdir()


def results_folder(scene: Path, out: Path | None) -> Path:
    """The folder that --out names, else results/NAME of the scene; it can be written."""
    return writable(Path("results", scene.stem) if out is None else out)


def wrote_into(folder: Path, names: Sequence[str]) -> str:
    """What a command has written into a folder, which is named unless it is the present one.

    >>> wrote_into(Path("."), ["a.png", "b.png"])
    'wrote a.png, b.png'
    """
    here = "" if folder == Path() else f"{folder}: "
    return f"wrote {here}{', '.join(names)}"


def wrote(folder: Path, names: Sequence[str]) -> str:
    """What a command has written, and the figures and data beside it that it has not: those of
    another run may contradict the new ones."""
    others = {file.name for file in folder.iterdir() if file.suffix in _OURS} - set(names)
    lines = [wrote_into(folder, names)]
    if others:
        lines.append(f"also there, but not of this command: {', '.join(sorted(others))}")
    return "\n".join(lines)
