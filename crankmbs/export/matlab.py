"""A result as a .mat file, for MATLAB and Octave."""

from __future__ import annotations

from pathlib import Path

from crankmbs.result import Result

__all__ = ["write_matlab"]


def write_matlab(result: Result, file: Path) -> None:
    """Write every variable as an array under its name, (time) or (time, cylinder).

    Structures beside them have the same names in them: ``units``, ``long_name``, and
    ``error_estimate``, the largest error of each in its unit; ``about`` says how the run ended.

    Raises
    ------
    OSError : the file cannot be written

    >>> write_matlab(simulate(load_scene("torque_driven")), Path("mine.mat"))
    """
    from scipy.io import savemat

    data = result.data
    names = ["time", "crank_angle", *map(str, data.data_vars)]
    labels = ("units", "long_name", "error_estimate")
    about = {
        "title": result.scene.title,
        "formulation": result.formulation,
        "status": result.status,
        "message": result.message,
        "relative_error_asked": result.error.asked,
        "relative_error_estimated": result.error.estimated,
    }
    savemat(
        file,
        {
            **{name: data[name].values for name in names},
            **{label: {name: data[name].attrs[label] for name in names} for label in labels},
            "about": about,
        },
        long_field_names=True,
        oned_as="column",
    )
