"""A sweep is resumed with functions in Python only where they are the same ones."""

import importlib.util
import os
import subprocess
import sys
import threading
from dataclasses import replace
from functools import cached_property, lru_cache, wraps
from pathlib import Path

import numpy as np
import pytest
from numba import njit
from scipy.interpolate import CubicSpline

from crankmbs import InputError, Load, load_scene, sweep
from crankmbs.sweep.fingerprint import fingerprint
from crankmbs.sweep.plan import plan_of
from crankmbs.sweep.run import fill

pytestmark = pytest.mark.slow

MODULE = """
import math
from functools import cached_property, partial

SHARE = {share}
KINDS = {{"start", "stop", "idle"}}

class Brake:
    size = 1e-3

    def __init__(self, offset):
        self.offset = offset

    def __call__(self, t, theta, omega):
        return -self.size * self.force({factor} * omega)

    def force(self, speed):
        return self.offset + speed

    @cached_property
    def twice(self):
        return {factor}

def half(x):
    {comment}
    return {factor} * x

def load(t, theta, omega):
    sign = 1.0 if "start" in KINDS and "idle" not in {{"run", "stop", "start"}} else -1.0
    return -half(omega) + sign * SHARE * math.sin(theta)

def made(size):
    def inner(t, theta, omega, scale=SHARE):
        return -size * scale * omega
    return inner

def later(t, theta, omega):
    return max(load(t, theta, omega), *[later(t - 1.0, theta, omega) for _ in range(int(t > 0.0))])

brake = Brake(0.5)
closed = made({factor})
whole = partial(Brake(0.5).force)
"""
PLAIN = {"share": "0.0", "factor": "1e-3", "comment": "# halves"}
ROOT = Path(__file__).parent.parent
SCENE = load_scene("coasting").with_(run__until="0.01 s")
VARY = {"start.speed": [50.0 + k for k in range(8)]}


@pytest.fixture
def module(tmp_path):
    """Makes a module of one's own, with these numbers in it."""

    def made(**words):
        file = tmp_path / f"mine{len([*tmp_path.iterdir()])}.py"
        file.write_text(MODULE.format(**(PLAIN | words)))
        spec = importlib.util.spec_from_file_location("mine", file)
        found = importlib.util.module_from_spec(spec)
        sys.modules["mine"] = found
        spec.loader.exec_module(found)
        return found

    yield made
    sys.modules.pop("mine", None)


NAMES = ["load", "later", "closed", "brake", "whole"]


@pytest.mark.parametrize("name", NAMES)
def test_a_function_read_again_is_the_same(module, name):
    first = fingerprint(getattr(module(), name))
    assert fingerprint(getattr(module(comment="# after a word"), name)) == first


@pytest.mark.parametrize("name", NAMES)
def test_a_function_with_another_number_anywhere_is_another(module, name):
    first = fingerprint(getattr(module(), name))
    assert fingerprint(getattr(module(factor="2e-3"), name)) != first


@pytest.mark.parametrize("name", ["load", "closed", "later"])
def test_globals_and_defaults_are_looked_at(module, name):
    first = fingerprint(getattr(module(), name))
    assert fingerprint(getattr(module(share="0.1"), name)) != first


def test_what_wraps_a_function_is_identified_by_it():
    def made(size):
        class Part:
            @cached_property
            def cached(self):
                return size

            @property
            def computed(self):
                return size

            @staticmethod
            def still(x):
                return size * x

        def plain(x):
            return size * x

        @wraps(plain)
        def wrapped(x):
            return plain(x) + size

        return [Part(), Part.still, lru_cache(plain), wrapped, Part.cached, Part.computed]

    one, same, other = made(1.0), made(1.0), made(2.0)
    assert [*map(fingerprint, one)] == [*map(fingerprint, same)]
    assert all(fingerprint(a) != fingerprint(b) for a, b in zip(one, other, strict=True))
    assert all(map(fingerprint, one))


def test_state_and_arrays_are_looked_at(module):
    found = module()
    assert fingerprint(found.Brake(0.5)) == fingerprint(found.brake)
    assert fingerprint(found.Brake(0.6)) != fingerprint(found.brake)
    assert fingerprint(np.arange(3)) != fingerprint(np.arange(3.0))
    assert fingerprint({1, 2, 3}) == fingerprint({3, 2, 1})
    x = np.linspace(0.0, 1.0, 5)
    assert fingerprint(CubicSpline(x, x)) == fingerprint(CubicSpline(x, x))
    assert fingerprint(CubicSpline(x, x)) != fingerprint(CubicSpline(x, x**2))


def test_a_compiled_function_is_identified_by_its_source(module):
    found = module()
    assert fingerprint(njit(found.half)) == fingerprint(njit(found.half))
    assert fingerprint(njit(found.half)) != fingerprint(njit(found.load))


@pytest.mark.parametrize("name", NAMES)
def test_another_process_finds_the_same_fingerprint(module, name, tmp_path):
    """With another order of sets and strings, and from the bytecode that Python has stored."""
    first = fingerprint(getattr(module(), name))
    (tmp_path / "mine.py").write_text(MODULE.format(**PLAIN))
    program = (
        "import mine; from crankmbs.sweep.fingerprint import fingerprint; "
        f"print(fingerprint(mine.{name}))"
    )
    found = set()
    for seed in ("1", "2"):
        words = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": f"{tmp_path}:{ROOT}"}
        done = subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=True, env=words
        )
        found.add(done.stdout.strip())
    assert found == {first}


def test_what_belongs_to_a_process_has_no_fingerprint():
    lock = threading.Lock()
    assert fingerprint(lambda t: (t, lock)) == ""


# ----------------------------------------------------------------------------------------- resume


def broken_off(out, function, vary=None):
    """A store of which the first block is there."""

    def enough(count):
        if count:
            raise RuntimeError("enough")

    scene = replace(SCENE, torque=(Load(function),))
    with pytest.raises(RuntimeError, match="enough"):
        fill(plan_of(scene, vary or VARY, "measures"), out, 1, enough)


def test_a_sweep_is_resumed_with_the_same_function(module, tmp_path):
    out = tmp_path / "sweep.zarr"
    broken_off(out, module().load)
    again = replace(SCENE, torque=(Load(module(comment="# as it was").load),))
    assert (sweep(again, VARY, out=out, executor=1)["status"] == 0).all()


def test_a_sweep_is_not_resumed_with_a_changed_function(module, tmp_path):
    out = tmp_path / "sweep.zarr"
    broken_off(out, module().load)
    changed = replace(SCENE, torque=(Load(module(factor="2e-3").load),))
    said = "holds a sweep with functions in Python that are others, or cannot be told from others;"
    with pytest.raises(InputError, match=said):
        sweep(changed, VARY, out=out, executor=1)


def test_a_sweep_of_changed_functions_is_one_of_other_cases(module, tmp_path):
    out = tmp_path / "sweep.zarr"
    vary = {"torque.1": [Load(module().load), Load(module().closed)] * 3}
    broken_off(out, module().load, vary)
    scene = replace(SCENE, torque=(Load(module().load),))
    vary["torque.1"][0] = Load(module(factor="2e-3").load)
    with pytest.raises(InputError, match="holds a sweep of other cases; give another folder"):
        sweep(scene, vary, out=out, executor=1)
    vary["torque.1"][0] = Load(module().load)
    found = sweep(scene, vary, out=out, executor=1)
    assert found["torque.1"].values.tolist() == ["load", "inner"] * 3


def test_functions_that_nothing_identifies_run_but_are_not_resumed(tmp_path):
    lock = threading.Lock()

    def held(t, theta, omega):
        with lock:
            return 0.0

    scene = replace(SCENE, torque=(Load(held),))
    broken_off(tmp_path / "s", held)
    with pytest.raises(InputError, match="or cannot be told from others; give another folder"):
        sweep(scene, VARY, out=tmp_path / "s", executor=1)
    assert (sweep(scene, VARY, executor=1)["status"] == 0).all()
