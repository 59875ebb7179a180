"""Fixtures of several test files, and which tests of slow files run by default."""

import gc

import pytest
from browser import started
from guards import COLLECTED, quick_guards
from lesson_visit import kept, lesson, written  # noqa: F401
from page_engine import Engine
from scene_texts import GAS
from v8 import running

from crankmbs.errors import SceneError
from crankmbs.scene.read import parse_scene


def pytest_collection():
    """What is collected stays to the end: looking for what of it can go takes seconds."""
    gc.disable()


def pytest_collection_finish():
    gc.freeze()
    gc.enable()


# what it starts for all of its tests is started once where one process runs them all: those at the
# end are shared out, those at the beginning are not
FIRST = "test_sweep_workers.py"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    """What kills a mutant runs by default; what is collected is known before -m leaves some out."""
    items.sort(key=lambda item: item.path.name != FIRST)
    config.stash[COLLECTED] = {item.nodeid for item in items}
    guards = quick_guards()
    for item in items:
        if item.nodeid in guards:
            item.add_marker("always")


@pytest.fixture
def read(tmp_path):
    """Parse a scene that lies beside a few tables; the folder is cut out of a message."""
    (tmp_path / "gas.csv").write_text(GAS)

    def parse(text):
        try:
            return parse_scene(text, tmp_path / "scene.toml")
        except SceneError as error:
            raise SceneError(str(error).replace(f"{tmp_path}/", "")) from None

    return parse


@pytest.fixture(scope="session")
def browser():
    """A browser for all visits of one process, each of them in a context of its own."""
    with started() as opened:
        yield opened


@pytest.fixture(scope="module")
def v8():
    """What computes in a browser, without one."""
    with running() as opened:
        yield opened


@pytest.fixture(scope="module")
def engine(v8):
    """The page's engine."""
    return Engine(v8)
