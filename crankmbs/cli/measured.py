"""What ``pressure`` and ``speed`` share: where the table goes, and errors that name options."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from crankmbs.cli.folder import writable
from crankmbs.errors import InputError, OutputError

__all__ = ["as_options", "naming_options", "table_file"]

_NAMES = (
    "columns|angle|reference|unit|each|stroke|firing_tdc|loss_angle|compression_ratio|invert|smooth"
    "|cycles|separator|decimal|skip|scene|wheel|index|sensor|delay"
)
_GIVEN = re.compile(rf'\b({_NAMES})=(True\b|"[^"]*"|\.\.\.|[\w.]+)')
_TABLES = b"# cylinder pressure from ", b"# speed over the crank angle from "  # their first lines
_BARE = re.compile(r"\b(loss_angle|compression_ratio|firing_tdc)\b(?!=)")


def table_file(file: Path, out: Path | None, name: str) -> Path:
    """Where the table of a measured file is written: ``out``, else results/FILE/NAME.

    Raises
    ------
    CrankmbsError : it is the measured file itself, or another file that is no such table; its
        folder cannot be written
    """
    target = Path("results", file.stem, name) if out is None else out
    if target.resolve() == file.resolve():
        raise InputError(f"-o: {target} is the file that is read; choose another name")
    if target.is_file():
        with target.open("rb") as there:
            if not there.readline(64).startswith(_TABLES):  # it may be the very scene
                raise OutputError(
                    f"{target}: exists already, is no table of this command and is not "
                    "overwritten; choose another name"
                )
    writable(target.parent)
    return target


@contextmanager
def naming_options() -> Iterator[None]:
    """Errors for a caller in Python leave in words of the command line."""
    try:
        yield
    except InputError as error:
        raise InputError(as_options(str(error))) from None


def as_options(text: str) -> str:
    """A sentence for a caller in Python, in words of the command line.

    >>> as_options('give loss_angle, or invert=True, or reference="inlet 1 bar"')
    'give --loss-angle, or --invert, or --reference "inlet 1 bar"'
    """
    first = re.match(rf"({_NAMES}): ", text)
    if first:
        text = f"--{first[1].replace('_', '-')}{text[first.end(1) :]}"
    text = _BARE.sub(lambda match: _option(match[1]), text)
    return _GIVEN.sub(lambda match: f"{_option(match[1])} {match[2]}".removesuffix(" True"), text)


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"
