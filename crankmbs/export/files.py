"""The one verb: a scene or a result into the file of another program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from crankmbs.errors import InputError, OutputError, shown
from crankmbs.export.matlab import write_matlab
from crankmbs.result import Result
from crankmbs.scene.edit import edited_files
from crankmbs.scene.scene import Scene
from crankmbs.scene.sentences import did_you_mean
from crankmbs.scene.write import scene_files
from crankmbs.simulate import simulate
from crankmbs.storage.files import text_in_one_move, together, write_in_one_move

__all__ = ["SUFFIXES", "copy_scene", "export", "refused_kind"]

SUFFIXES = {"toml": ".toml", "matlab": ".mat", "exudyn": ".py"}
"""What can be written, and how the file's name ends."""


def export(what: Scene | Result, to: str, file: str | Path) -> tuple[Path, ...]:
    """Write a scene, or a result, for another program.

    Parameters
    ----------
    what : the scene, or a result, whose scene it is; for "matlab" a scene is run first
    to : "toml", the scene as it stands, with its tables as CSV beside it; "matlab", the samples
        with their names, units and errors; "exudyn", a script of the same bodies, joints and loads
        that needs numpy and exudyn alone
    file : its name ends in .toml, .mat or .py

    Returns
    -------
    the files written, the one asked for first

    Raises
    ------
    InputError : none of these, another ending; what a file or a script cannot express
    OutputError : the file cannot be written, or for "toml" one of the files exists already

    >>> [file.name for file in export(load_scene("torque_driven"), "toml", "mine.toml")]
    ['mine.toml']
    """
    if not isinstance(what, Scene | Result):
        raise InputError(f"export takes a Scene or a Result; {shown(what)} came")
    if not isinstance(to, str) or to not in SUFFIXES:
        raise InputError(refused_kind(to))
    target = _ending(Path(file), to)
    scene = what.scene if isinstance(what, Result) else what
    if to == "toml":
        return _toml(scene, target)
    if to == "matlab":
        result = what if isinstance(what, Result) else simulate(what)
        write_in_one_move(target, lambda part: write_matlab(result, part))
    else:
        from crankmbs.export.exudyn import exudyn_script  # exudyn only here

        text_in_one_move(target, exudyn_script(scene, target.stem))
    return (target,)


def refused_kind(to: object) -> str:
    """What is wrong with a kind of file that is none.

    >>> refused_kind("exudin").endswith('did you mean "exudyn"?')
    True
    """
    near = did_you_mean(to, list(SUFFIXES)) if isinstance(to, str) else ""
    return (
        'to: must be "toml" (a copy of the scene), "matlab" (its result) or "exudyn" (a script); '
        f"{shown(to)} came{near}"
    )


def copy_scene(
    path: str | Path,
    file: str | Path,
    values: Mapping[str, str | Sequence[str]] | None = None,
    remark: str = "",
    *,
    start: Mapping[str, str] | None = None,
    torque: str | None = None,
) -> tuple[Path, ...]:
    """Copy a scene file, its units and comments as they are, with its tables; values of its
    parts may be set, or the crank set free.

    Parameters
    ----------
    path : of the scene; file : its name ends in .toml
    values : as `Scene.with_` names them, {"crank__inertia": "0.3 kg m^2"}; remark : the comment
        beside each
    start : key -> value of [start], in place of [motion]; torque : of a constant load, "-23.7 N m"

    Returns
    -------
    the files written, the scene first

    Raises
    ------
    InputError : another ending; a scene that is none with these values
    OutputError : the file cannot be written, or one of the files exists already
    """
    target = _ending(Path(file), "toml")
    files = edited_files(Path(path), target, values or {}, remark, start=start, torque=torque)
    return _new(files, target)


def _ending(target: Path, to: str) -> Path:
    if target.suffix != SUFFIXES[to]:
        raise InputError(
            f'{target}: the name of a file for "{to}" ends in {SUFFIXES[to]}; '
            f"{target.suffix or 'no ending'} came"
        )
    return target


def _toml(scene: Scene, target: Path) -> tuple[Path, ...]:
    files = scene_files(scene, target.stem)
    return _new({name: text.encode() for name, text in files.items()}, target)


def _new(files: Mapping[str, bytes], target: Path) -> tuple[Path, ...]:
    """Write files that are not there yet."""
    there = [target.parent / name for name in files if (target.parent / name).exists()]
    if there:  # it may be the very scene, with its comments
        raise OutputError(f"{there[0]}: exists already and is not overwritten; name another file")
    with together(target.parent) as part:
        for name, content in files.items():
            (part / name).write_bytes(content)
    return tuple(target.parent / name for name in files)
