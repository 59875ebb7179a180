"""A free run against a machine: what is put into a record is identified within its interval."""

import hashlib
import json
import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from engine_log import EngineLog
from records import SENSOR

from validation.measured.__main__ import judged, main
from validation.measured.free_run import Engine, Unknown, free_run
from validation.measured.held import wheel_errors
from validation.measured.identify import identify
from validation.measured.logged import half_orders, orders_of, read_logged
from validation.measured.page import page_of

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
ENGINE = Engine(0.067, 0.055, 0.084, 0.15, 0.15)
START = Unknown(0.02, 30.0, 0.0)
FOLDER = os.environ.get("CRANKMBS_MEASURED")


@pytest.fixture(scope="module")
def logged(tmp_path_factory):
    folder = tmp_path_factory.mktemp("logged")

    @cache
    def make(**options):
        record = EngineLog(**options)
        path = folder / f"{hashlib.md5(repr(options).encode()).hexdigest()}.txt"
        rows = zip(*record.columns, strict=True)
        path.write_text("\n".join(f"{t:.6e}\t{p:.6e}\t{w:.6e}" for t, p, w in rows) + "\n")
        return record, read_logged(path, "60-2", SENSOR)

    make.folder = folder
    return make


def behind_the_first_edge(record):
    return (record.dead_centre - record.errors[0]) % 360.0


@pytest.fixture(scope="module")
def fitted(logged):
    """Inertia, dead centre and delay found from a record, once for each."""
    return cache(lambda **options: identify(logged(**options)[1], ENGINE, START, 0, 6, delay=True))


LATE = {"delay": 8e-4, "dead_centre": 385.0, "noise": 0.02}


@pytest.mark.parametrize(
    "options",
    [
        LATE,
        {"delay": 0.0, "dead_centre": 30.0, "noise": 0.02, "seed": 2, "inertia": 0.025},
    ],
)
def test_inertia_dead_centre_and_delay_are_those_put_in(logged, fitted, options):
    (record, _), found = logged(**options), fitted(**options)
    true = np.array([record.inertia, behind_the_first_edge(record), record.delay])
    unknown = found.unknown
    apart = [unknown.inertia, unknown.dead_centre, unknown.delay] - true
    assert np.all(np.abs(apart) <= found.interval)
    assert np.all(found.interval < [0.05 * record.inertia, 2.0, 2e-4])


def test_a_later_pressure_a_larger_inertia_and_a_later_dead_centre_are_hard_to_tell_apart(
    logged, fitted
):
    (_, found), free = logged(**LATE), fitted(**LATE)
    assert abs(free.correlation[0, 2]) > 0.9
    given = identify(found, ENGINE, START._replace(delay=8e-4), 0, 6, delay=False)
    assert given.interval[0] < 0.5 * free.interval[0]


def test_cycles_that_were_not_used_are_predicted(logged):
    record, found = logged(delay=8e-4, noise=0.02)
    unknown = Unknown(record.inertia, behind_the_first_edge(record), record.delay)
    run = free_run(found, ENGINE, unknown, 3, 4)
    ours, theirs = (half_orders(each, 58) for each in (run.times, found.edge_times(3, 4)))
    swing = np.ptp(theirs.mean(axis=0))
    assert np.abs(ours - theirs).mean(axis=0).max() < 0.1 * swing
    low = np.abs(orders_of((ours - theirs).mean(axis=0), 6.0, 2.5))
    assert low.max() < 0.005 * swing
    assert run.load == pytest.approx(record.load, rel=0.02)


def test_half_orders_are_free_of_the_wheel_and_of_the_masses(logged):
    same = {"noise": 0.0, "jitter": 0.0}
    halves = []
    for options in ({}, {"uneven": 0.3, "gap": (0.0, 0.0)}, {"reciprocating": 0.6}):
        _, found = logged(**same, **options)
        halves.append(orders_of(half_orders(found.edge_times(0, 6), 58), 6.0, 2.5))
    shift = np.exp(-1j * np.radians(0.9) * (0.5 + np.arange(3)))  # of the first edge, their zero
    size = np.abs(halves[0]).max()
    assert np.abs(halves[1] - halves[0]).max() < 0.03 * size
    assert np.abs(halves[1] - halves[0] / shift).max() < 0.03 * size
    assert np.abs(halves[2] - halves[0]).max() < 0.01 * size


def test_the_wheel_s_errors_are_identified(logged):
    record, found = logged(delay=8e-4, noise=0.02)
    unknown = Unknown(record.inertia, behind_the_first_edge(record), record.delay)
    heavy = ENGINE._replace(piston_mass=0.2, rod_mass=0.0)
    errors = wheel_errors(found, heavy, unknown, 0, 6)
    places = np.append(6.0 * np.arange(58) + record.errors, 360.0 + record.errors[0])
    seen = found.edge_angles(0, 1)[:59]
    true = np.log(np.diff(places) / np.diff(seen))
    jitter = record.jitter / 3.3e-4 * np.sqrt(2.0 / 12.0)  # of two edges, over twelve revolutions
    assert np.std(errors - true) < 1.5 * jitter


def test_the_page_is_that_of_the_numbers_beside_it():
    numbers = json.loads((ROOT / "validation" / "measured.json").read_text(encoding="utf-8"))
    assert (ROOT / "validation" / "MEASURED.md").read_text(encoding="utf-8") == page_of(numbers)


def test_another_machine_s_files_are_written_where_asked(tmp_path, logged):
    machine = tmp_path / "machine.toml"
    text = (ROOT / "validation/measured/generating_set.toml").read_text(encoding="utf-8")
    text = text[: text.index("# what the numbers say")].replace("generating set", "engine known")
    text = text.replace('["0 ms", "0.4 ms", "0.8 ms"]', '["0.8 ms"]').replace("= 6 ", "= 3 ")
    machine.write_text(text, encoding="utf-8")
    _, found = logged(delay=8e-4, noise=0.02, cycles=5)
    path = next(logged.folder.glob(f"{found.name}.txt"))
    assert main([str(path), "--machine", str(machine), "--into", str(tmp_path)]) == 0
    page = (tmp_path / "MEASURED.md").read_text(encoding="utf-8")
    assert "engine known" in page
    assert found.digest in page
    assert "torsion," not in page
    figures = sorted(each.name for each in (tmp_path / "figures").iterdir())
    assert figures == ["measured_half_orders.png", "measured_speed.png"]


@pytest.mark.skipif(FOLDER is None, reason="CRANKMBS_MEASURED names no folder with the records")
def test_the_numbers_are_those_of_the_records():
    kept = json.loads((ROOT / "validation" / "measured.json").read_text(encoding="utf-8"))
    files = [Path(FOLDER, name) for name in kept["inputs"]]
    assert [hashlib.sha256(file.read_bytes()).hexdigest() for file in files] == [
        *kept["inputs"].values()
    ]
    found, _ = judged(kept["machine"], files)
    assert_alike(found, kept)


def assert_alike(found, kept):
    if isinstance(kept, dict):
        assert found.keys() == kept.keys()
        for key in kept:
            assert_alike(found[key], kept[key])
    elif isinstance(kept, list):
        assert len(found) == len(kept)
        for pair in zip(found, kept, strict=True):
            assert_alike(*pair)
    elif isinstance(kept, float):
        assert found == pytest.approx(kept, rel=1e-3, abs=1e-3)
    else:
        assert found == kept
