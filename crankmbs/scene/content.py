"""The bytes of a file that a user names: one that is there, has an end, and is not too large."""

from __future__ import annotations

import stat
from pathlib import Path

from crankmbs.errors import InputError, shown

__all__ = ["content_of"]

_MOST = 32_000_000  # bytes: a million rows
_ENDLESS = (stat.S_ISCHR, stat.S_ISBLK, stat.S_ISFIFO, stat.S_ISSOCK)


def content_of(path: Path, most: int = _MOST, base: str = "the scene file") -> bytes:
    """The bytes of a file that has an end, not farther away than ``most`` bytes.

    base : what its path is relative to, for the sentence

    Raises
    ------
    InputError : missing, unreadable, endless or too large; the file and the way out

    >>> content_of(Path("no.csv"))
    Traceback (most recent call last):
    crankmbs.errors.InputError: file no.csv is missing; paths are relative to the scene file
    """
    try:
        return _content(path, most)
    except FileNotFoundError:
        raise InputError(f"file {path} is missing; paths are relative to {base}") from None
    except OSError as error:
        raise InputError(f"file {path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{shown(str(path))} is no file name") from None


def _content(path: Path, most: int) -> bytes:
    if any(kind(path.stat().st_mode) for kind in _ENDLESS):  # to open a pipe waits for its writer
        raise InputError(
            f"file {path} is a device, a pipe or a socket, which may have no end; save the table "
            "as a CSV file"
        )
    with path.open("rb") as stream:
        content = stream.read(most + 1)
    if len(content) > most:
        raise InputError(
            f"file {path} is larger than {most / 1e6:g} MB, the most of a table; leave out the "
            "columns and rows that are not needed"
        )
    return content
