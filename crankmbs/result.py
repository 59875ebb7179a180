"""What a run gives: a labelled dataset with an error for every variable, and how it was reached."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import TypeAdapter

from crankmbs.errors import InputError, OutputError, shown
from crankmbs.kept import DIMS, account_in, with_account, write_rows
from crankmbs.mechanics.variables import VARIABLES, variables_of
from crankmbs.motion.account import Account, Keep
from crankmbs.motion.base import Decay
from crankmbs.motion.labels import cycles_dataset, events_dataset
from crankmbs.scene.scene import Scene
from crankmbs.scene.schema import SAVED
from crankmbs.scene.units import RPM
from crankmbs.storage.files import together
from crankmbs.storage.netcdf import read_netcdf, write_netcdf

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "Cost",
    "Error",
    "Result",
]


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
class Result:
    """One run.

    data : Dataset over time (coordinate crank_angle) and cylinder; every variable carries
        ``units``, ``long_name`` and ``error_estimate``, an estimate of its largest error in its
        unit: at least half the true one in 99.96 % of 19,516 runs of random scenes
    formulation, reasons : which served the scene, and why
    status : 0 reached the end; 1 a physical end before it; -1 a numerical one
    message : the sentence that goes with the status
    decay : of a settled motion: the largest factor by which a disturbance changes in a period
    keep : makes the account of what happened on the way, of which `events` tells
    """

    scene: Scene
    data: xr.Dataset
    formulation: str
    reasons: tuple[str, ...]
    status: int
    message: str
    cost: Cost
    error: Error
    decay: Decay | None = None
    keep: Keep | None = field(default=None, repr=False, compare=False)

    @cached_property
    def events(self) -> xr.Dataset:
        """What happened on the way, in its order: a Dataset over ``event``.

        time [s], crank_angle [rad], crank_speed [rad/s] : where the solver located it
        kind : "fuel", a cylinder decides its share of the combustion; "load on", "load off", the
            window of a load opens or closes; "rest", "start", "reversal" of the crank
        cylinder, load : the number of whose it is, else 0; share : that is decided, else NaN
        text : the same in words

        Of time, angle, speed and share ``error_estimate`` states the largest error over all: what
        two runs of different order differ by, infinite where there was one alone. Events that one
        of them has not, near the end of the run, are left out. So are all decisions on the fuel
        where they are more than 10,000, and other events beyond as many; ``attrs["left_out"]`` says
        so. They are located by following the motion again, when they are first asked for.

        Raises
        ------
        InputError : the formulation, or the file it was loaded from, keeps no account

        >>> simulate(load_scene("coasting")).events.sizes["event"]
        0
        """
        return events_dataset(self.scene, self._account.events)

    @cached_property
    def cycles(self) -> xr.Dataset:
        """The whole cycles of the engine: a Dataset over ``cycle``, which counts them from 1.

        A cycle begins where the crank passes the angle of its start, or one whole periods from it,
        and ends one period on; one in which it turns back is none. Over ``cycle``, ``cylinder`` and
        ``load``, where the scene has them:

        time [s], crank_angle [rad] : at its beginning; duration [s]
        mean_speed, least_speed, largest_speed [rad/s] : over time; of the motion, not of samples
        kinetic_energy_gained [J] : the sum of all works; that of gravity is zero over a cycle
        gas_work [J], imep [Pa] : of each cylinder
        fuel : share of the combustion of the firing whose dead centre the cycle holds
        load_work, drive_work [J] : of each load; of what gives a prescribed speed

        Each ``error_estimate`` is the largest error over all: what two runs of different order
        differ by, looked at in different places, infinite where there was one alone. Of more than
        10,000 cycles the last are kept; ``attrs["left_out"]`` says so. They are found by following
        the motion again, when they are first asked for.

        Raises
        ------
        InputError : the formulation, or the file it was loaded from, keeps no account

        >>> simulate(load_scene("propeller")).cycles.sizes["cycle"]
        19
        """
        return cycles_dataset(self.scene, self._account.cycles)

    @cached_property
    def _account(self) -> Account:
        if self.keep is None:
            raise InputError("nothing was kept of the way of this result; run the scene again")
        return self.keep()

    def __str__(self) -> str:
        time, angle = self.data["time"].values, self.data["crank_angle"].values
        turned = abs(angle[-1] - angle[0]) / (2.0 * np.pi)
        speed = self.data["crank_speed"].values / RPM
        whole = self.scene.run.every is not None  # else only the last cycle is kept
        length = (
            f"{time[-1]:.6g} s, {turned:.6g} rev"
            if whole
            else f"last {turned:.6g} rev of {time[-1]:.6g} s"
        )
        return "\n".join(
            [
                f"{self.scene.title or 'scene'}: {self.formulation}, status {self.status}",
                f"  {self.message}",
                f"  {length}, {speed.min():.6g} to {speed.max():.6g} rpm",
                f"  relative error {self.error.estimated:.1e} (asked {self.error.asked:.0e}), "
                f"{self.cost.wall_time:.3g} s, {self.cost.evaluations} evaluations",
            ]
        )

    def save(self, folder: str | Path) -> Path:
        """Write result.nc (NetCDF), motion.csv and, where there are any, events.csv and cycles.csv
        into ``folder``: all together or none.

        Raises
        ------
        OutputError : the folder cannot be made or written
        """
        target = Path(folder)
        with together(target) as part:
            self._write_netcdf(part / "result.nc")
            self._write_csv(part / "motion.csv")
            if self.keep is not None and self.events.sizes["event"]:
                write_rows(self.events, part / "events.csv")
            if self.keep is not None and self.cycles.sizes["cycle"]:
                write_rows(self.cycles, part / "cycles.csv")
        return target

    @classmethod
    def load(cls, path: str | Path) -> Result:
        """Read a saved result: its folder, or its result.nc. No other file is opened.

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
            data = read_netcdf(file, {**_DIMS, **DIMS})
            about = _ABOUT.validate_python(json.loads(data.attrs.pop("crankmbs")), context=SAVED)
            keep: Keep | None = None
            if about.left_out is not None:
                account, data = account_in(data, about.scene, about.left_out)
                keep = partial(_itself, account)
            _check_labels(data, about.scene)
        except _NO_RESULT:  # HDF5's own words name its inner calls
            raise OutputError(
                f"{file}: no readable result of crankmbs; give the result.nc that save wrote"
            ) from None
        given = {name: value for name, value in vars(about).items() if name != "left_out"}
        return cls(data=data, keep=keep, **given)

    def _write_netcdf(self, file: Path) -> None:
        about: dict[str, Any] = {one.name: getattr(self, one.name, None) for one in fields(_About)}
        data = self.data
        if self.keep is not None:
            about["left_out"] = tuple(rows.left_out for rows in self._account)
            data = with_account(data, self._account)
        text = json.dumps(_ABOUT.dump_python(_About(**about), mode="json"))
        write_netcdf(data.assign_attrs(crankmbs=text), file)

    def _write_csv(self, file: Path) -> None:
        names, columns = ["time [s]", "crank_angle [rad]"], []
        columns += [self.data["time"].values, self.data["crank_angle"].values]
        for name, array in self.data.data_vars.items():
            unit = array.attrs["units"]
            if "cylinder" in array.dims:
                for k, number in enumerate(self.data["cylinder"].values):
                    names.append(f"{name} {number} [{unit}]")
                    columns.append(array.values[:, k])
            else:
                names.append(f"{name} [{unit}]")
                columns.append(array.values)
        table = np.column_stack(columns)
        np.savetxt(file, table, fmt="%.12g", delimiter=",", header=",".join(names), comments="")


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


def _itself(account: Account) -> Account:
    return account


_ABOUT = TypeAdapter(_About)
_DIMS = {name: about.dims for name, about in VARIABLES.items()}
_NO_RESULT = (  # what readers raise on a foreign file; RecursionError is a RuntimeError
    *(ArithmeticError, AttributeError, LookupError, OSError),
    *(RuntimeError, TypeError, ValueError),
)
