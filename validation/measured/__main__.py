"""`python -m validation.measured FILE...`: identify a machine on some cycles of the first record,
predict its other cycles and the other records, and write numbers, figures and a page."""

from __future__ import annotations

import argparse
import json
import sys
import tomllib
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from crankmbs.scene.units import quantity
from crankmbs.storage.files import write_in_one_move
from validation.measured.figures import half_orders_figure, whole_figure
from validation.measured.free_run import Engine, Unknown, free_run
from validation.measured.held import Held, held, wheel_errors
from validation.measured.identify import Identified, identify
from validation.measured.logged import Array, Logged, half_orders, read_logged
from validation.measured.page import page_of

__all__ = ["judged", "main"]

_VALIDATION = Path(__file__).parents[1]
_MACHINE = Path(__file__).with_name("generating_set.toml")
_FREE = "free"
_ELSEWHERE = 0.5e5  # Pa, by which the sensor's zero may be off


def main(arguments: list[str] | None = None) -> int:
    """Write measured.json, MEASURED.md and two figures."""
    parser = argparse.ArgumentParser(prog="python -m validation.measured", description=__doc__)
    parser.add_argument("file", nargs="+", type=Path, help="records, the first one identified on")
    parser.add_argument("--machine", type=Path, default=_MACHINE, help="what is known of it")
    parser.add_argument("--into", type=Path, default=_VALIDATION, help="folder to write to")
    asked = parser.parse_args(arguments)
    machine = tomllib.loads(asked.machine.read_text(encoding="utf-8"))
    numbers, rows = judged(machine, asked.file)
    folder = asked.into
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    text = json.dumps(_rounded(numbers), indent=1) + "\n"
    (folder / "measured.json").write_text(text, encoding="utf-8")
    (folder / "MEASURED.md").write_text(page_of(_rounded(numbers)), encoding="utf-8")
    _draw(numbers, rows, folder / "figures")
    print(f"written: {folder / 'MEASURED.md'}, measured.json, figures/measured_*.png")
    return 0


def judged(
    machine: dict[str, Any], files: list[Path]
) -> tuple[dict[str, Any], dict[str, list[Held]]]:
    """All numbers, and by each delay the rows that the figures draw."""
    records = [read_logged(file, machine["wheel"], machine["sensor"]) for file in files]
    engine = Engine(
        *(quantity(machine[key], "length") for key in ("bore", "stroke", "rod_length")),
        *(quantity(machine[key], "mass") for key in ("piston_mass", "rod_mass")),
    )
    start = Unknown(
        quantity(machine["inertia"], "inertia"),
        float(np.degrees(quantity(machine["dead_centre"], "angle"))),
        0.0,
    )
    count = machine["identified_on"]
    first, pitch = records[0], records[0].rotation.wheel.pitch
    parts = [(first, 0, count), (first, count, first.cycles - count)]
    parts += [(each, 0, each.cycles) for each in records[1:]]
    numbers: dict[str, Any] = {
        "machine": machine,
        "inputs": {file.name: each.digest for file, each in zip(files, records, strict=True)},
        "others": [
            {"name": each.name, **_found(identify(each, engine, start, 0, each.cycles, delay=True))}
            for each in records[1:]
        ],
        "delays": [],
    }
    rows = {}
    for delay in (*machine["delays"], _FREE):
        begun = start._replace(delay=0.0 if delay == _FREE else quantity(delay, "time"))
        found = identify(first, engine, begun, 0, count, delay=delay == _FREE)
        errors = wheel_errors(first, engine, found.unknown, 0, count)
        rows[delay] = [held(each, engine, found, errors, a, n) for each, a, n in parts]
        numbers["delays"].append(
            {
                "delay": delay,
                **_found(found),
                "held": [{"name": row.name, **row.numbers(pitch)} for row in rows[delay]],
            }
        )
        if delay == machine["delays"][0]:
            numbers["unseen"] = _unseen(first, engine, found, count)
    return numbers, rows


def _found(found: Identified) -> dict[str, Any]:
    unknown, interval = found.unknown, found.interval
    names = ("inertia_kg_m2", "dead_centre_deg", "delay_ms")[: len(interval)]
    scale = (1.0, 1.0, 1e3)
    values = (unknown.inertia, unknown.dead_centre, unknown.delay)
    correlation = found.correlation
    return {
        **{
            name: [values[k] * scale[k], float(interval[k]) * scale[k]]
            for k, name in enumerate(names)
        },
        "misfit": found.misfit,
        "correlation": correlation[np.triu_indices(len(interval), 1)].tolist(),
        "condition": float(np.linalg.cond(correlation)),
    }


def _unseen(logged: Logged, engine: Engine, found: Identified, count: int) -> dict[str, float]:
    """By how much [rpm, rms] half orders change with what they are said to be free of."""

    def half(engine: Engine, unknown: Unknown) -> Array:
        return half_orders(free_run(logged, engine, unknown, 0, count).times, logged.edges)

    here = half(engine, found.unknown)
    heavier = engine._replace(piston_mass=2 * engine.piston_mass, rod_mass=2 * engine.rod_mass)
    others = {
        "offset_of_0.5_bar_rpm": half(engine, found.unknown._replace(offset=_ELSEWHERE)),
        "masses_doubled_rpm": half(heavier, found.unknown),
    }
    mean = logged.rotation.mean_speed / 6.0
    return {
        name: float(mean * np.sqrt(np.mean((there - here) ** 2))) for name, there in others.items()
    }


def _rounded(value: Any) -> Any:
    """Six digits: more than any interval here has."""
    if isinstance(value, float):
        return float(f"{value:.6g}")
    if isinstance(value, dict):
        return {key: _rounded(each) for key, each in value.items()}
    return [_rounded(each) for each in value] if isinstance(value, list) else value


def _draw(numbers: dict[str, Any], rows: dict[str, list[Held]], folder: Path) -> None:
    delays = list(rows)
    shown, others = rows[delays[0]], rows[delays[-1]]
    edges = shown[0].measured.shape[1]
    pitch = 360.0 / int(numbers["machine"]["wheel"].split("-")[0])
    places = np.append(np.arange(edges) * pitch, 360.0)
    middles = 0.5 * (places[1:] + places[:-1])
    titles = [
        f"{row.name}, cycles {row.first + 1} to {row.first + row.cycles}, {row.mean:.0f} rpm: "
        + ("identified on" if k == 0 else "predicted")
        for k, row in enumerate(shown)
    ]
    names = f"predicted, delay {delays[0]}", "predicted, delay free"
    figures = {
        "measured_half_orders": half_orders_figure(shown, others, names, middles, titles),
        "measured_speed": whole_figure(shown, middles, titles),
    }
    for name, figure in figures.items():
        save = partial(figure.savefig, format="png", dpi=80)
        write_in_one_move(folder / f"{name}.png", save)


if __name__ == "__main__":
    sys.exit(main())
