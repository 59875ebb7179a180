"""Every example in a docstring runs and prints what it says."""

import doctest
import importlib
import pkgutil
import warnings

import numpy as np
import pytest

import crankmbs
from crankmbs.mechanics.train import crank_train

pytestmark = pytest.mark.slow

# what a reader has at hand: the package's public names, and those an example would import first
AT_HAND = {name: getattr(crankmbs, name) for name in crankmbs.__all__}
AT_HAND |= {"crankmbs": crankmbs, "crank_train": crank_train, "np": np}


def modules():
    """Every module but those that run something when they are imported."""
    yield crankmbs
    for found in pkgutil.walk_packages(crankmbs.__path__, "crankmbs."):
        if not found.name.endswith("__main__"):
            yield importlib.import_module(found.name)


def examples():
    """Every docstring with an example, by the name of what it describes."""
    finder = doctest.DocTestFinder(exclude_empty=True)
    for module in modules():
        for test in finder.find(module, globs={**AT_HAND, **vars(module)}):
            if test.examples:
                yield pytest.param(test, id=test.name)


@pytest.mark.parametrize("test", list(examples()))
def test_an_example_runs_as_it_stands(test, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        runner.run(test, out=said.append)
    assert not said, "".join(said)
