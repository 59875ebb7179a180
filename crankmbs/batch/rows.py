"""What settled scenes amount to, by the names under which a sweep keeps it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.solve import Group, solved_together
from crankmbs.compare import LECTURES, QUANTITIES
from crankmbs.measures.names import names_of
from crankmbs.mechanics.peaks import negligible
from crankmbs.motion.ending import Ending
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Rows", "rows_of"]


class Rows(NamedTuple):
    """Of some of the scenes asked for.

    which : shape (n,), their numbers; columns : name -> shape (n, ...); messages : how each ends
    """

    which: NDArray[np.intp]
    columns: dict[str, Array]
    messages: tuple[str, ...]


def rows_of(scenes: Sequence[Scene | None]) -> list[Rows]:
    """The columns of those scenes that are solved together (`crankmbs.batch.solve`): names, units
    and meaning are those of a sweep, what it has of one scene alone agrees within the errors.

    >>> scene = load_scene("propeller").with_(run__until="settled")
    >>> (rows,) = rows_of([scene])
    >>> rows.columns["fluctuation"].round(6).tolist()
    [0.137409]
    """
    return [_rows(group) for group in solved_together(scenes)]


def _rows(group: Group) -> Rows:
    of, error, scene = group.numbers, group.errors, group.machine.scene
    columns = {"relative_error": of["relative"], "energy_closure": of["closure"]}
    for name in names_of(scene):
        if name in of:
            columns |= {name: of[name], f"{name}_error": error[name]}
    columns |= {name: of[name] for name in of if name.endswith("_peak_angle")}
    return Rows(group.which, columns | _of_lectures(group), _messages(group))


def _messages(group: Group) -> tuple[str, ...]:
    """How each ends."""
    if not group.machine.scene.settles:
        return (Ending.COMPLETE.said(0.0)[1],) * len(group.which)
    factors = (1.0 + group.numbers["growth"]) ** group.machine.shares
    return tuple(
        f"settled: a disturbance decays to {100.0 * factor:.4g} % per period" for factor in factors
    )


def _of_lectures(group: Group) -> dict[str, Array]:
    """Largest deviations over the peaks; of what is zero but for rounding no number."""
    shape = len(group.which), len(QUANTITIES), 1 + len(LECTURES)
    value, error = (of["lectures"].reshape(shape) for of in (group.numbers, group.errors))
    peak, deviation = value[:, :, 0], value[:, :, 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = deviation / peak[:, :, None]
        apart = (error[:, :, 1:] + share * error[:, :, :1]) / peak[:, :, None]
    units = {name: about.units for name, about in QUANTITIES.items()}
    for k, sizes in enumerate(np.fmax.reduce(value, axis=2).tolist()):  # no lecture is larger
        nothing = negligible(dict(zip(QUANTITIES, sizes, strict=True)), units)
        share[k, [name in nothing for name in QUANTITIES]] = np.nan
    share[~np.isfinite(apart)] = np.nan
    apart[np.isnan(share)] = np.nan
    return {
        "lecture_deviation": np.swapaxes(share, 1, 2),
        "lecture_deviation_error": np.swapaxes(apart, 1, 2),
    }
