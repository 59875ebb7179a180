"""Files that appear together or not at all, also where several runs write into one folder."""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from crankmbs.errors import CrankmbsError, OutputError

if sys.platform != "win32":
    import fcntl

__all__ = ["text_in_one_move", "together", "write_in_one_move"]

_PART = re.compile(r"\.part-[a-z0-9_]{8}(\.\w+)?")
_OWNER = ".owner"  # in a part: who fills it holds its lock, which ends with the process
_LOCK = ".crankmbs-lock"

_filled: set[Path] = set()  # parts that this process fills


@contextmanager
def together(folder: Path) -> Iterator[Path]:
    """A part to write files into: all of them appear in ``folder`` when the block ends well, none
    when it does not.

    Files of one name are replaced. Of two runs that write into one folder at once, those of the
    later one are there. A block for the part of an open one joins it. What a killed run has left
    is removed.

    Raises
    ------
    OutputError : the folder cannot be made or written; neither a file half-written nor a
        new folder is left
    """
    if folder in _filled:
        yield folder
        return
    made = [each for each in (folder, *folder.parents) if not each.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with _alone(folder):
            _remove_abandoned(folder)
            part = Path(tempfile.mkdtemp(dir=folder, prefix=".part-"))
            owner = os.open(part / _OWNER, os.O_CREAT | os.O_RDWR)
            _locked(owner, wait=True)
    except OSError as error:
        _remove_empty(made)
        raise OutputError(
            f"{folder}: cannot be written ({error.strerror}); choose another folder"
        ) from None
    _filled.add(part)
    try:
        yield part
        with _alone(folder):
            _move(part, folder)
    except CrankmbsError:
        raise
    except OSError as error:
        place, why = _where(error, part, folder), error.strerror or error
        raise OutputError(f"{place}: cannot be written ({why}); choose another folder") from None
    finally:
        _filled.remove(part)
        os.close(owner)
        shutil.rmtree(part, ignore_errors=True)
        _remove_empty(made)


def write_in_one_move(target: Path, write: Callable[[Path], None]) -> None:
    """Let ``write`` fill a file of the target's name in a part, then put it in place in one move.

    Raises
    ------
    OutputError : the folder cannot be made or written; nothing half-written is left
    """
    with together(target.parent) as part:
        write(part / target.name)


def text_in_one_move(target: Path, text: str) -> None:
    """Put a file with this text in place, in UTF-8, as `write_in_one_move` does."""
    with together(target.parent) as part:
        (part / target.name).write_text(text, encoding="utf-8")


def _move(part: Path, folder: Path) -> None:
    files = sorted(file for file in part.iterdir() if file.name != _OWNER)
    for file in files:  # before the first is moved
        if (folder / file.name).is_dir():
            raise IsADirectoryError(f"{file.name} is a folder there")
    for file in files:
        file.replace(folder / file.name)


def _remove_empty(folders: Iterable[Path]) -> None:
    """Remove folders, each in the next one, up to one that holds something."""
    with suppress(OSError):
        for each in folders:
            each.rmdir()


def _where(error: OSError, part: Path, folder: Path) -> Path:
    """The file of an error, at its place; the folder where the system names none."""
    file = Path(str(error.filename or part))
    return folder / file.relative_to(part) if file.is_relative_to(part) else file


def _remove_abandoned(folder: Path) -> None:
    """Remove the parts that nobody fills any more."""
    for part in [each for each in folder.iterdir() if _PART.fullmatch(each.name)]:
        with suppress(OSError):  # of another user
            owner = os.open(part / _OWNER if part.is_dir() else part, os.O_CREAT | os.O_RDWR)
            abandoned = _locked(owner, wait=False)
            os.close(owner)
            if abandoned and part.is_dir():
                shutil.rmtree(part)
            elif abandoned:
                part.unlink()


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Keep other runs out of the folder; the file of the lock is there only as long."""
    if sys.platform == "win32":  # no such locks: the moves of two runs may mix
        yield
        return
    file = folder / _LOCK
    while True:
        handle = os.open(file, os.O_CREAT | os.O_RDWR)
        _locked(handle, wait=True)
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(handle), file.stat()):
                break
        os.close(handle)  # who held it before has removed it
    try:
        yield
    finally:
        file.unlink(missing_ok=True)
        os.close(handle)


def _locked(handle: int, *, wait: bool) -> bool:
    """Whether the file's lock is held now: no other process, and no other handle of this one, has
    it; never where the system or the file system knows no locks."""
    if sys.platform == "win32":
        return False
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        return False
    return True
