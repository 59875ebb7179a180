"""The compiled loops against plain Python, to rounding; when they are loaded, and their cache."""

import dataclasses
import importlib
import math
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crankmbs import (
    Constant,
    Quadratic,
    Result,
    Run,
    Scene,
    SpeedTable,
    Start,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    simulate,
)
from crankmbs.mechanics.torque import branch_of
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.crank_angle import cells, loops, readout
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.motion.crank_angle.solvers import Begin, Cells, solve_affine, solve_newton
from crankmbs.motion.minimal import stepper
from crankmbs.numerics.collocation import gauss
from crankmbs.numerics.kernels import kernel
from crankmbs.scene.torque import Torque

LOADS: dict[str, tuple[Torque, ...]] = {
    "none": (),
    "quadratic": (Quadratic(coefficient=9.5e-5),),
    "viscous": (Viscous(coefficient=0.02),),
    "time": (TimeTable(file=Table((0.0, 0.02, 0.05, 9.0), (0.0, -20.0, 5.0, -5.0))),),
    "speed": (SpeedTable(file=Table((0.0, 200.0, 300.0, 400.0), (0.0, 5.0, -20.0, -30.0))),),
}


def scene_with(loads: tuple[Torque, ...], speed: float, every: str) -> Scene:
    return dataclasses.replace(
        load_scene("propeller"),
        torque=loads,
        start=Start(angle=0.7, speed=speed),
        run=Run(until="4 cycles", every=every, rtol=1e-9),
    )


KERNELS = [
    (module, name)
    for module in (cells, loops, readout, stepper)
    for name, function in vars(module).items()
    if hasattr(function, "py_func")
]


def both_ways(
    scene: Scene, patch: pytest.MonkeyPatch, formulation: str = "crank_angle"
) -> tuple[Result, Result]:
    """The scene run with every loop in plain Python, which looks at its indices, and compiled."""
    with patch.context() as plain:
        for module, name in KERNELS:
            plain.setattr(module, name, getattr(module, name).py_func)
        interpreted = simulate(scene, formulation=formulation)
    return interpreted, simulate(scene, formulation=formulation)


@pytest.mark.parametrize("every", ["1 deg", "0.1 ms"])
@pytest.mark.parametrize("speed", [330.0, -330.0])
@pytest.mark.parametrize("loads", LOADS)
def test_plain_and_compiled_loops_agree(
    loads: str, speed: float, every: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain, compiled = both_ways(scene_with(LOADS[loads], speed, every), monkeypatch)
    assert plain.status == compiled.status
    assert plain.message == compiled.message
    for name in ("time", "crank_angle", "crank_speed", "crank_acceleration", "side_force"):
        a, b = np.asarray(plain.data[name]), np.asarray(compiled.data[name])
        assert a.shape == b.shape
        assert np.max(np.abs(a - b)) < 2e-12 * np.max(np.abs(a)), name
    one, other = (r.error.estimated for r in (plain, compiled))
    assert 0.5 < one / other < 2.0 or max(one, other) < 1e-11


@pytest.mark.parametrize("solve", [solve_affine, solve_newton])
def test_clock_and_energy_lose_nothing_over_many_cells(solve: Callable[..., Cells]) -> None:
    """What rounding takes is the same in every pass, and their difference would not show it."""
    grid = grid_of(CrankTrain(load_scene("coasting"), None), gauss(3))
    strip = grid.strip(0.0, 1.0, 4000, math.inf)
    branch = branch_of((Constant(torque=0.1),), 0.0, 1.0, rising=True)
    cells = solve(grid, strip, branch, Begin(1.0, 50.0, 0.1, math.inf, 0.0))
    spent = strip.width * (cells.slowness @ grid.rule.weights)
    assert abs(cells.time[-1] - math.fsum([0.1, *spent])) <= 2.0 * math.ulp(cells.time[-1])
    gained = strip.width * (cells.torque @ grid.rule.weights)
    assert abs(cells.edges[-1] - math.fsum([50.0, *gained])) <= 2.0 * math.ulp(cells.edges[-1])


def test_the_worst_errors_of_cells_passed_again_and_what_is_no_number() -> None:
    most = np.zeros((2, 3))
    cell = np.array([0, 1, 2, 0, 1, 2])
    at_end = np.array([2.0, math.nan, 1.0, 1.0, 3.0, 4.0])
    loops.worst(cell, at_end, 2.0 * at_end[::-1].copy(), most)
    np.testing.assert_array_equal(most, [[2.0, math.nan, 4.0], [8.0, math.nan, 4.0]])


@pytest.mark.parametrize("stages", range(1, 10))
def test_a_cell_is_read_where_it_is_asked_for(stages: int) -> None:
    """Of torque x^(s-1) and slowness 2 x^(s-1) in cells of width 0.5, backwards."""
    rule, x = gauss(stages), np.linspace(0.0, 1.0, 11)
    power = np.tile(rule.nodes ** (stages - 1), (2, 1))
    grown = x**stages / stages
    edges, width = np.array([0.0, 0.5, 1.0]), np.full(2, 0.5)
    energy, time = (
        np.array([9.0, 3.0, 3.0 - 0.5 / stages]),
        np.array([0.0, 5.0, 5.0 + 1.0 / stages]),
    )
    solved = edges, width, energy, time, power, 2.0 * power
    t, kinetic = np.empty((2, 11))
    readout.inside(1, x, -1.0, rule.to_legendre, solved, (t, kinetic))
    np.testing.assert_allclose(t, 5.0 + grown, rtol=1e-15)
    np.testing.assert_allclose(kinetic, 3.0 - 0.5 * grown, rtol=1e-15)
    cell, (place, again, energy_again) = np.empty(11, np.intp), np.empty((3, 11))
    found = cell, place, again, energy_again
    readout.read(0.5 + 0.5 * x, False, -1.0, rule.to_legendre, solved, found)
    np.testing.assert_allclose(again[1:], t[1:], rtol=1e-15)
    np.testing.assert_allclose(energy_again[1:], kinetic[1:], rtol=1e-15)


@pytest.mark.parametrize("loads", LOADS)
def test_steps_over_time_are_the_same_compiled_and_plain(
    loads: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = scene_with(LOADS[loads], -6.0, "30 deg")  # the gas stops it and drives it back
    scene = dataclasses.replace(scene, run=Run(until="0.6 s", every="30 deg", rtol=1e-7))
    plain, compiled = both_ways(scene, monkeypatch, "minimal")
    assert plain.message == compiled.message
    assert plain.cost.steps == compiled.cost.steps
    assert plain.cost.evaluations == compiled.cost.evaluations
    for name in ("time", "crank_angle", "crank_speed", "crank_acceleration", "side_force"):
        a, b = np.asarray(plain.data[name]), np.asarray(compiled.data[name])
        assert a.shape == b.shape
        assert np.max(np.abs(a - b)) < 1e-10 * np.max(np.abs(a)), name


def test_what_is_compiled_names_no_class_of_ours() -> None:
    """numba's cache on disk cannot be read, and every run fails, once such a class has gone."""
    scene = scene_with(LOADS["quadratic"], 300.0, "10 deg")
    for formulation in ("crank_angle", "minimal"):
        assert simulate(scene, formulation=formulation).status == 0
    signatures = {name: getattr(module, name).signatures for module, name in KERNELS}
    assert signatures["travel"]
    assert signatures["affine"]
    assert set(re.findall(r"\b(\w+)\(", str(signatures))) <= {"Array", "Tuple", "UniTuple", "array"}


def fresh(code: str) -> str:
    """What a process of its own prints."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_numba_is_loaded_only_where_loops_run() -> None:
    fresh(
        "import sys, crankmbs\n"
        "crankmbs.simulate(crankmbs.load_scene('yi_diesel'))\n"
        "assert 'numba' not in sys.modules\n"
    )


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_a_result_does_not_depend_on_what_the_process_did_before(formulation: str) -> None:
    """To the last bit of every variable and error."""
    code = (
        "import crankmbs\n"
        "{before}\n"
        "scene = crankmbs.load_scene('torque_driven')\n"
        f"data = crankmbs.simulate(scene, formulation='{formulation}').data\n"
        "for name, variable in data.variables.items():\n"
        "    print(name, variable.values.tobytes().hex(), variable.attrs)\n"
    )
    others = (
        "import numba\n"
        "for name in ('yi_diesel_free', 'coasting', 'compressor'):\n"
        "    crankmbs.simulate(crankmbs.load_scene(name))"
    )
    assert fresh(code.format(before="")) == fresh(code.format(before=others))


def test_kernels_work_where_nothing_can_be_cached() -> None:
    """numba raises when neither the package's folder nor the home folder can be written."""
    code = (
        "from numba.core.caching import FunctionCache\n"
        "def cannot(*args):\n"
        "    raise RuntimeError('cannot cache function: no locator available')\n"
        "FunctionCache.__init__ = cannot\n"
        "from crankmbs import load_scene, simulate\n"
        "assert simulate(load_scene('coasting')).status == 0\n"
    )
    fresh(code)


@pytest.fixture
def doubled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], Any]:
    """A function of a module of its own, as the kernels are compiled, by each call anew."""
    (tmp_path / "one_kernel.py").write_text("def doubled(x):\n    return 2.0 * x\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "one_kernel", raising=False)
    function = importlib.import_module("one_kernel").doubled
    return lambda: kernel(function)


DAMAGES = {
    "truncated": lambda content: content[: len(content) // 2],
    "empty": lambda content: b"",
    "garbage": lambda content: bytes(range(256)) * 8,
}


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_a_damaged_cache_is_compiled_anew(
    doubled: Callable[[], Any], tmp_path: Path, ending: str, damage: str
) -> None:
    assert doubled()(1.5) == 3.0
    (file,) = tmp_path.rglob(f"*.{ending}")
    whole = file.read_bytes()
    file.write_bytes(DAMAGES[damage](whole))
    assert doubled()(1.5) == 3.0
    again = doubled()
    assert again(1.5) == 3.0
    assert sum(again.stats.cache_hits.values()) == 1


def test_a_cache_that_cannot_be_written_is_left(
    doubled: Callable[[], Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile.save", full)
    assert doubled()(1.5) == 3.0
