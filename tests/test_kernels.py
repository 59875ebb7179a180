"""The compiled loops of sweeps: when they are loaded, and their cache."""

import importlib
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from crankmbs.numerics.kernels import kernel


def fresh(code: str) -> str:
    """What a process of its own prints."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_numba_is_loaded_only_where_loops_run() -> None:
    fresh(
        "import sys, crankmbs\n"
        "for name in ('yi_diesel', 'run_up'):\n"
        "    crankmbs.simulate(crankmbs.load_scene(name))\n"
        "crankmbs.Stepper(crankmbs.load_scene('torque_driven')).advance(1e-3)\n"
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
