"""The public names: what is importable from crankmbs is what __all__ says, documented, and imported
when it is used."""

import ast
import importlib
import inspect
import pickle
import subprocess
import sys
import types
from importlib import metadata
from pathlib import Path

import pytest

import crankmbs

ROOMS = {"figures", "lecture"}
HEAVY = {"exudyn", "h5py", "matplotlib", "pandas", "pydantic", "scipy", "xarray", "zarr"}
ALSO_MODULES = ["choose", "compare", "export", "simulate", "sweep"]


def loaded_by(code):
    """The modules that a new interpreter has loaded after some code."""
    code += "\nimport sys; print(*sys.modules)"
    run = [sys.executable, "-c", code]
    return set(subprocess.run(run, check=True, capture_output=True, text=True).stdout.split())


def test_all_is_sorted_and_what_type_checkers_see():
    stub = ast.parse(Path(crankmbs.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    seen = [
        name.name for node in stub.body if isinstance(node, ast.ImportFrom) for name in node.names
    ]
    assert isinstance(stub.body[-1], ast.Assign)
    assert sorted(seen) == crankmbs.__all__ == ast.literal_eval(stub.body[-1].value)


def test_the_version_is_that_of_the_installation():
    assert crankmbs.__version__ == metadata.version("crankmbs")
    with pytest.raises(AttributeError, match="No crankmbs attribute __versions__"):
        getattr(crankmbs, "__versions__")  # noqa: B009


@pytest.mark.parametrize("name", sorted({*crankmbs.__all__} - ROOMS))
def test_a_public_name_has_a_docstring_of_its_own(name):
    assert not isinstance(getattr(crankmbs, name), types.ModuleType)
    assert inspect.getdoc(getattr(crankmbs, name))


def test_a_star_imports_what_is_public():
    names: dict[str, object] = {}
    exec("from crankmbs import *", names)
    assert names.keys() - {"__builtins__"} == set(crankmbs.__all__)


@pytest.mark.slow
@pytest.mark.parametrize("name", ALSO_MODULES)
def test_a_function_is_never_hidden_by_its_module(name):
    code = f"import crankmbs.{name}, crankmbs, types; print(type(crankmbs.{name}).__name__, 'is')"
    assert "function" in loaded_by(code)
    assert isinstance(importlib.import_module(f"crankmbs.{name}"), types.ModuleType)
    assert isinstance(getattr(crankmbs, name), types.FunctionType)


def test_a_public_function_is_pickled_by_its_name():
    assert pickle.loads(pickle.dumps(crankmbs.load_scene)) is crankmbs.load_scene


def test_a_room_is_an_attribute_and_what_is_not_there_is_none():
    assert crankmbs.lecture.sin_beta is importlib.import_module("crankmbs.lecture").sin_beta
    assert ROOMS <= set(crankmbs.__all__) == set(dir(crankmbs))
    for name in ("nothing", "scene.read", "../scene", ""):
        with pytest.raises(AttributeError, match="crankmbs"):
            getattr(crankmbs, name)


def test_importing_crankmbs_imports_nothing_else():
    loaded = loaded_by("import crankmbs")
    assert not loaded & {*HEAVY, "numpy"}
    assert {name for name in loaded if name.startswith("crankmbs")} == {"crankmbs"}


@pytest.mark.slow
def test_a_load_is_known_by_its_kind_whatever_was_imported_first():
    for module in ("scene.torque", "scene.read", "scene.scene", "choose"):
        loaded_by(f"import crankmbs.{module}, crankmbs.scene.read as r; r.load_scene('propeller')")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "not_loaded"),
    [
        ("--help", {*HEAVY - {"pydantic"}, "numpy"}),  # typer itself uses pydantic
        ("scenes", {*HEAVY - {"pydantic"}, "numpy"}),
        ("check propeller", {"exudyn", "h5py", "matplotlib", "pandas", "scipy.stats", "xarray"}),
        ("run propeller --no-figures", {"exudyn", "matplotlib", "scipy.stats", "zarr"}),
    ],
)
def test_a_command_loads_what_it_needs(command, not_loaded, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code = (
        "import contextlib, io, sys; from crankmbs.cli import main\n"
        f"sys.argv = {['crankmbs', *command.split()]}\n"
        "with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit): main()"
    )
    assert not loaded_by(code) & not_loaded
