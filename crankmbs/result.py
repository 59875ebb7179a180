"""What a run gives: a labelled dataset with an error for every variable, and how it was reached."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from pydantic import TypeAdapter

from crankmbs.errors import OutputError
from crankmbs.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["VARIABLES", "Cost", "Error", "Result", "Variable", "write_in_one_move"]


class Variable(NamedTuple):
    """Unit and long name of a variable; ``per_cylinder`` ones have the dimension cylinder."""

    units: str
    long_name: str
    per_cylinder: bool = False


VARIABLES = {
    "time": Variable("s", "time"),
    "crank_angle": Variable("rad", "crank angle from the engine's X, unwrapped"),
    "crank_speed": Variable("rad/s", "crank speed"),
    "crank_acceleration": Variable("rad/s^2", "crank acceleration"),
    "external_torque": Variable("N m", "torque on the crank from outside: drive and loads"),
    "main_bearing_force_x": Variable("N", "bearing on crank, engine's X, all cylinders"),
    "main_bearing_force_y": Variable("N", "bearing on crank, engine's Y, all cylinders"),
    "kinetic_energy": Variable("J", "kinetic energy of crank, rods and pistons"),
    "energy_residual": Variable("J", "kinetic energy gained minus work done"),
    "rod_angle": Variable("rad", "rod angle beta from the cylinder axis", True),
    "piston_position": Variable("m", "piston pin, cylinder's X from the crank axis", True),
    "piston_displacement": Variable("m", "piston displacement from its top dead centre", True),
    "piston_velocity": Variable("m/s", "piston velocity towards the crank", True),
    "piston_acceleration": Variable("m/s^2", "piston acceleration towards the crank", True),
    "gas_pressure": Variable("Pa", "pressure difference across the piston", True),
    "gas_force": Variable("N", "gas force on the piston towards the crank", True),
    "side_force": Variable("N", "cylinder wall on piston, cylinder's Y", True),
    "piston_pin_force_x": Variable("N", "rod on piston, cylinder's X", True),
    "piston_pin_force_y": Variable("N", "rod on piston, cylinder's Y", True),
    "crank_pin_force_x": Variable("N", "crank on rod, cylinder's X", True),
    "crank_pin_force_y": Variable("N", "crank on rod, cylinder's Y", True),
    "crank_torque": Variable("N m", "moment of the rod's force on the crank", True),
}


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
    """

    scene: Scene
    data: xr.Dataset
    formulation: str
    reasons: tuple[str, ...]
    status: int
    message: str
    cost: Cost
    error: Error

    def __str__(self) -> str:
        time, angle = self.data["time"].values, self.data["crank_angle"].values
        turned = abs(angle[-1] - angle[0]) / (2.0 * np.pi)
        speed = self.data["crank_speed"].values * 30.0 / np.pi
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
        """Write result.nc (NetCDF) and motion.csv into ``folder``, each replaced in one move.

        Raises
        ------
        OutputError : the folder cannot be made or written
        """
        target = Path(folder)
        write_in_one_move(target / "result.nc", self._write_netcdf)
        write_in_one_move(target / "motion.csv", self._write_csv)
        return target

    @classmethod
    def load(cls, path: str | Path) -> Result:
        """Read a saved result: its folder, or its result.nc.

        Raises
        ------
        OutputError : there is no such result, or the file is none
        """
        import xarray as xr

        file = Path(path)
        file = file / "result.nc" if file.is_dir() else file
        if not file.is_file():
            raise OutputError(f"{file}: no such result; save writes one, and so does crankmbs run")
        try:
            with xr.open_dataset(file, engine="h5netcdf") as opened:
                data = opened.load()
            about = json.loads(data.attrs.pop("crankmbs"))
        except (OSError, KeyError, ValueError):  # HDF5's own words name its inner calls
            raise OutputError(
                f"{file}: no readable result of crankmbs; give the result.nc that save wrote"
            ) from None
        return cls(
            scene=_SCENE.validate_python(about["scene"]),
            data=data,
            formulation=about["formulation"],
            reasons=tuple(about["reasons"]),
            status=about["status"],
            message=about["message"],
            cost=Cost(**about["cost"]),
            error=Error(**about["error"]),
        )

    def _write_netcdf(self, file: Path) -> None:
        about = {
            "scene": _SCENE.dump_python(self.scene, mode="json"),
            "formulation": self.formulation,
            "reasons": self.reasons,
            "status": self.status,
            "message": self.message,
            "cost": asdict(self.cost),
            "error": asdict(self.error),
        }
        data = self.data.assign_attrs(crankmbs=json.dumps(about))
        data.to_netcdf(file, engine="h5netcdf")

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


def write_in_one_move(target: Path, write: Callable[[Path], None]) -> None:
    """Let ``write`` fill a file beside ``target``, then put it in place in one move.

    Raises
    ------
    OutputError : the folder cannot be made or written; nothing half-written is left
    """
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=".part-", suffix=target.suffix)
    except OSError as error:
        raise OutputError(
            f"{target.parent}: cannot be written ({error.strerror}); choose another folder"
        ) from None
    os.close(handle)
    part = Path(name)
    try:
        write(part)
        part.chmod(0o644)
        part.replace(target)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written: {error}") from None
    finally:
        part.unlink(missing_ok=True)


_SCENE = TypeAdapter(Scene)
