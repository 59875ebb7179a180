"""The command ``plot``: measures of a sweep, drawn over what was varied."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

from typer import Argument, Option, echo

from crankmbs.cli.folder import writable, wrote
from crankmbs.errors import InputError
from crankmbs.storage.files import together

__all__ = ["plot"]


def plot(
    sweep: Annotated[Path, Argument(metavar="SWEEP", help="The folder that sweep wrote.")],
    show: Annotated[
        list[str] | None,
        Option(help='Such as "peak crank pin force" or "side thrust by Grega"; often.'),
    ] = None,
    limit: Annotated[
        str | None, Option(help='Of what is shown, "1 %" or "20 kN": a line is drawn there.')
    ] = None,
    over: Annotated[
        str | None,
        Option(
            metavar="MEASURE",
            help='Such as "fluctuation": it is the axis in place of what was varied last.',
        ),
    ] = None,
    out: Annotated[
        Path | None,
        Option("-o", "--out", help="Folder of the figures, or one PNG file; default results/NAME."),
    ] = None,
) -> None:
    """Draw measures of a sweep over what was varied: curves, contours or small multiples."""
    from crankmbs.sweep.store import load_sweep

    data, names = load_sweep(sweep), show or ["fluctuation"]
    out = Path("results", sweep.stem) if out is None else out
    file = out.name if out.suffix == ".png" else None
    if file and len(names) > 1:
        raise InputError(f"--out {out}: is one file, and {len(names)} figures come; give a folder")
    folder = writable(out.parent if file else out)
    from crankmbs.figures import sweep_figure  # matplotlib only here

    drawn = {}
    for words in names:
        try:
            name = file or f"{re.sub(r'[^a-z0-9.]+', '_', words, flags=re.I).strip('_')}.png"
            drawn[name] = sweep_figure(data, words, limit, over)
        except InputError as error:
            text = str(error).replace("limit: ", "--limit: ", 1)
            at = "--" if text.startswith("over: ") else f"--show {words}: "
            raise InputError(f"{at}{text}") from None
    with together(folder) as part:
        for name, figure in drawn.items():
            figure.savefig(part / name, format="png")
    echo(f"wrote {out}" if file else wrote(folder, [*drawn]))
