"""The compiled loops against plain Python, to rounding; when they are loaded, and their cache."""

import dataclasses
import importlib
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crankmbs import (
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
from crankmbs.motion.minimal import stepper
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
    for module in (stepper,)
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
