"""What is written down of a result beside its data: cost, error, and all that a file keeps."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from pydantic import TypeAdapter

from crankmbs.errors import OutputError, shown
from crankmbs.mechanics.variables import VARIABLES, variables_of
from crankmbs.motion.account import Account, Keep
from crankmbs.motion.base import Decay
from crankmbs.motion.motion import Passes
from crankmbs.numerics.arrays import Labelled
from crankmbs.result.account_file import DIMS, account_in, with_account
from crankmbs.result.motion_file import DIMS as MOTION_DIMS
from crankmbs.result.motion_file import passes_in, with_passes
from crankmbs.scene.scene import Scene
from crankmbs.scene.schema import SAVED
from crankmbs.storage.netcdf import read_netcdf, write_netcdf

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Cost", "Error", "read_saved", "write_saved"]

T = TypeVar("T")


@dataclass(frozen=True)
class Cost:
    """wall_time [s], evaluations of the equation of motion, steps."""

    wall_time: float
    evaluations: int
    steps: int


@dataclass(frozen=True)
class Error:
    """Relative global error: asked for, and estimated (the worst variable of the motion)."""

    asked: float
    estimated: float


@dataclass(frozen=True)
class _About:
    """What is saved of a result beside its data."""

    scene: Scene
    formulation: str
    reasons: tuple[str, ...]
    status: Literal[-1, 0, 1]
    message: str
    cost: Cost
    error: Error
    decay: Decay | None = None
    left_out: tuple[int, int] | None = None
    share: float | None = None


def write_saved(
    by_name: Mapping[str, Any],
    variables: Labelled,
    account: Account | None,
    passes: Passes | None,
    file: Path,
) -> None:
    """Write result.nc: the variables, the account of the way and the passes of the motion where
    there are, and the fields of a result by name."""
    about: dict[str, Any] = {field.name: by_name.get(field.name) for field in fields(_About)}
    if passes is not None:
        about["share"] = passes.share
        variables = with_passes(variables, passes)
    if account is not None:
        about["left_out"] = tuple(rows.left_out for rows in account)
        variables = with_account(variables, account)
    text = json.dumps(_ABOUT.dump_python(_About(**about), mode="json"))
    angle = {"coordinates": "crank_angle"}  # by which a reader knows it as one, too
    coordinates = ("time", "crank_angle")
    labelled = {
        name: (dims, values, attrs | angle if "time" in dims and name not in coordinates else attrs)
        for name, (dims, values, attrs) in variables.items()
    }
    write_netcdf(labelled, file, crankmbs=text)


def read_saved(path: str | Path) -> dict[str, Any]:
    """The fields of a saved result, by name: from its folder, or its result.nc.

    Raises
    ------
    OutputError : there is no such result, or the file is none
    """
    if not isinstance(path, str | Path):
        raise OutputError(f"a saved result is named by its folder or file; {shown(path)} came")
    file = Path(path)
    file = file / "result.nc" if file.is_dir() else file
    if not file.is_file():
        raise OutputError(f"{file}: no such result; save writes one, and so does crankmbs run")
    try:
        data = read_netcdf(file, {**_DIMS, **DIMS, **MOTION_DIMS})
        written = json.loads(data.attrs.pop("crankmbs"))
        if isinstance(written, dict) and "scene" in written and "share" not in written:
            raise OutputError(
                f"{file}: was saved by an earlier version, without the motion between its samples; "
                "run its scene again: crankmbs run SCENE"
            )
        about = _ABOUT.validate_python(written, context=SAVED)
        keep: Keep | None = None
        motion: Callable[[], Passes] | None = None
        if about.share is not None:
            passes, data = passes_in(data, about.scene, about.share)
            motion = partial(_itself, passes)
        if about.left_out is not None:
            account, data = account_in(data, about.scene, about.left_out)
            keep = partial(_itself, account)
        _check_labels(data, about.scene)
    except OutputError:
        raise
    except _NO_RESULT:  # HDF5's message names its inner calls
        raise OutputError(
            f"{file}: no readable result of crankmbs; give the result.nc that save wrote"
        ) from None
    derived = {"left_out", "share"}
    by_name = {name: value for name, value in vars(about).items() if name not in derived}
    return {**by_name, "data": data, "keep": keep, "motion": motion}


def _check_labels(data: xr.Dataset, scene: Scene) -> None:
    """Raise ValueError unless the data are of the scene's cylinders, each with unit and error."""
    if data.sizes["cylinder"] != len(scene.cylinders) or data.sizes["time"] == 0:
        raise ValueError("not the samples of this scene")
    for name, about in variables_of(scene).items():
        attrs = data[name].attrs
        if (
            data[name].dims != about.dims
            or attrs["units"] != about.units
            or not isinstance(attrs["error_estimate"], float)
        ):
            raise ValueError(f"{name}: no unit or no error")


def _itself(value: T) -> T:
    return value


_ABOUT = TypeAdapter(_About)
_DIMS = {name: about.dims for name, about in VARIABLES.items()}
_NO_RESULT = (  # what readers raise on a foreign file; RecursionError is a RuntimeError
    *(ArithmeticError, AttributeError, LookupError, OSError),
    *(RuntimeError, TypeError, ValueError),
)
