"""One run: its data, how it was reached, and what can be asked of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.errors import InputError, shown
from crankmbs.mechanics.variables import COORDINATES, dataset
from crankmbs.motion.account import Account, Keep
from crankmbs.motion.base import Decay
from crankmbs.motion.labels import Table, cycles_table, events_table
from crankmbs.motion.motion import Passes
from crankmbs.numerics.arrays import Array, Labelled
from crankmbs.result.about import Cost, Error, read_saved, write_saved
from crankmbs.result.account_file import write_rows
from crankmbs.result.columns import data_frame, write_csv
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM
from crankmbs.storage.files import together

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from crankmbs.compare import AtAngle
    from crankmbs.measures import Measures

__all__ = ["Cost", "Error", "Result"]


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
    motion : makes the passes of the motion as they were solved, of which `passes` has one copy
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
    motion: Callable[[], Passes] | None = field(default=None, repr=False, compare=False)

    @classmethod
    def unlabelled(cls, variables: Labelled, **fields: Any) -> Result:
        """A result whose ``data`` are labelled when they are first asked for: xarray takes longer
        to be imported than a run.

        fields : all others, by name
        """
        result = cls(data=None, **fields)  # type: ignore[arg-type]
        del result.__dict__["data"]
        result.__dict__["_variables"] = variables
        return result

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> object:
            """The data, where they have not been asked for."""
            variables = self.__dict__.get("_variables")
            if name != "data" or variables is None:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            data = self.__dict__["data"] = dataset(variables, COORDINATES)
            self.__dict__.pop("_variables", None)
            return data

    @property
    def variables(self) -> Labelled:
        """The variables and coordinates of ``data``, by name: dimensions, values, attributes."""
        variables: Labelled | None = self.__dict__.get("_variables")
        if variables is not None:
            return variables
        every = {**self.data.coords, **self.data.data_vars}
        return {
            str(name): (tuple(map(str, variable.dims)), variable.values, variable.attrs)
            for name, variable in every.items()
        }

    def sampled(self, name: str) -> Array:
        """The values of a variable of ``data``, without the labels.

        >>> float(simulate(load_scene("coasting")).sampled("time")[0])
        0.0
        """
        variables = self.__dict__.get("_variables")
        return np.asarray(self.data[name].values if variables is None else variables[name][1])

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
        so.

        Raises
        ------
        InputError : the formulation, or the file it was loaded from, keeps no account

        >>> simulate(load_scene("coasting")).events.sizes["event"]
        0
        """
        return self.event_table.dataset()

    @cached_property
    def event_table(self) -> Table:
        """The `events`, as they are before xarray has them."""
        return events_table(self.scene, self._account.events)

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
        10,000 cycles the last are kept; ``attrs["left_out"]`` says so.

        Raises
        ------
        InputError : the formulation, or the file it was loaded from, keeps no account

        >>> simulate(load_scene("propeller")).cycles.sizes["cycle"]
        19
        """
        return self.cycle_table.dataset()

    @cached_property
    def cycle_table(self) -> Table:
        """The `cycles`, as they are before xarray has them."""
        return cycles_table(self.scene, self._account.cycles)

    @cached_property
    def _account(self) -> Account:
        if self.keep is None:
            raise InputError("nothing was kept of the way of this result; run the scene again")
        return self.keep()

    @cached_property
    def passes(self) -> Passes:
        """The motion as it was solved, and the motions that check it.

        Raises
        ------
        InputError : the formulation keeps no motion
        """
        if self.motion is None:
            raise InputError("nothing was kept of the motion of this result; run the scene again")
        return self.motion()

    def measures(self) -> Measures:
        """What the run amounts to over its last cycle: means, peaks, power, each with its error.

        As `crankmbs.measures.measure`, whose class says what there is.

        >>> simulate(load_scene("propeller")).measures().window.kind
        'last cycle'
        """
        from crankmbs.measures import measure

        return measure(self)

    def at(self, angle: float | str) -> AtAngle:
        """Every quantity where the last cycle passes a crank angle: "60 deg", or a number in rad.

        As `crankmbs.at_angle`, which reads it from the motion as it was solved.

        Raises
        ------
        InputError : no angle; no whole cycle in the run, a reversal that passes the angle twice

        >>> len(simulate(load_scene("yi_diesel")).at("60 deg").readings) > 20
        True
        """
        from crankmbs.compare import at_angle

        return at_angle(self, angle)

    def interp(
        self, time: ArrayLike | None = None, crank_angle: ArrayLike | None = None
    ) -> xr.Dataset:
        """Every variable but the energy residual between the samples: at times [s], or at crank
        angles [rad], unwrapped, each with its error.

        As `crankmbs.measures.interp`: by the polynomials that the motion was solved with, not by
        lines; also of a loaded result, and without running anything again.

        Raises
        ------
        InputError : outside the samples; an angle that is passed twice

        >>> simulate(load_scene("coasting")).interp(time=0.1234).sizes["time"]
        1
        """
        from crankmbs.measures import interp

        return interp(self, time, crank_angle)

    def plot(self, kind: str = "speed", joint: str = "crank_pin") -> Figure:
        """One of the figures that ``crankmbs run`` writes, as matplotlib's: of the last cycle.

        As `crankmbs.figures.plot`.

        Parameters
        ----------
        kind : "speed", "motion" of the pistons, "forces" along and across the cylinders, "polar"
            load, "torque", "orders" of torque and frame force, or "cycles"
        joint : of a "polar" load: "main_bearing", "crank_pin" or "piston_pin"

        Raises
        ------
        InputError : another kind or joint; no orders without a whole cycle

        >>> simulate(load_scene("yi_diesel")).plot("torque").axes[0].get_xlabel()
        'crank angle [deg], last cycle'
        """
        from crankmbs.figures import plot

        return plot(self, kind, joint)

    def to_dataframe(self) -> pd.DataFrame:
        """The samples as a pandas table over the crank angle, all angles in degrees.

        The index is "crank_angle [deg]"; of what each cylinder has there is a column for each, such
        as "side_force 1 [N]". ``attrs["error_estimate"]`` has the error of each by its heading.

        >>> simulate(load_scene("torque_driven")).to_dataframe().columns[:2].tolist()
        ['time [s]', 'crank_speed [deg/s]']
        """
        return data_frame(self.variables)

    def save(self, folder: str | Path) -> Path:
        """Write result.nc (NetCDF), motion.csv and, where there are any, events.csv and cycles.csv
        into ``folder``: all together or none.

        Raises
        ------
        OutputError : the folder cannot be made or written
        """
        target = Path(folder)
        account = None if self.keep is None else self._account
        with together(target) as part:
            readable = self.motion is not None and all(
                f.law.python is None for f in self.scene.force
            )
            passes = self.passes if readable else None
            write_saved(vars(self), self.variables, account, passes, part / "result.nc")
            write_csv(self.variables, part / "motion.csv")
            if self.keep is not None and self.event_table.length:
                write_rows(self.event_table, part / "events.csv")
            if self.keep is not None and self.cycle_table.length:
                write_rows(self.cycle_table, part / "cycles.csv")
        return target

    @classmethod
    def load(cls, path: str | Path) -> Result:
        """Read a saved result: its folder, or its result.nc. No other file is opened.

        Raises
        ------
        OutputError : there is no such result, or the file is none
        """
        return cls(**read_saved(path))

    def __repr__(self) -> str:
        time, turned = self.data["time"].values, self._turned
        return (
            f"<Result of {shown(self.scene.title or 'a scene')}: {self.formulation}, status "
            f"{self.status}, {len(time)} samples to {time[-1]:.6g} s, {turned:.6g} rev, relative "
            f"error {self.error.estimated:.1e}>"
        )

    def _repr_html_(self) -> str:
        from crankmbs.report.html import result_html

        return result_html(self)

    @property
    def _turned(self) -> float:
        """Between first and last sample [rev]."""
        angle = self.data["crank_angle"].values
        return float(abs(angle[-1] - angle[0]) / (2.0 * np.pi))

    def __str__(self) -> str:
        time, turned = self.data["time"].values, self._turned
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
