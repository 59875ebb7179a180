"""The lectures' formulas as a public face: names, docstrings, examples, refusals, broadcasting."""

import doctest
import inspect
import re

import numpy as np
import pytest

from crankmbs import lecture
from crankmbs.errors import InputError

FUNCTIONS = {
    name: getattr(lecture, name)
    for name in lecture.__all__
    if inspect.isfunction(getattr(lecture, name))
}
SERIES_WITH_ROD = [
    name for name, function in FUNCTIONS.items() if "InputError for a rod ratio" in function.__doc__
]
TURNING = [name for name, function in FUNCTIONS.items() if "cannot turn round" in function.__doc__]


def arguments(name, **given):
    """Plausible keyword arguments of one function, some of them given."""
    usual = {
        "crank_angle": 1.0,
        "crank_radius": 0.05,
        "rod_length": 0.2,
        "rod_ratio": 0.25,
        "omega": 100.0,
        "offset": 0.001,
        "net_force": 1e3,
        "rod_force": 1e3,
        "reciprocating_mass": 1.5,
        "piston_area": 5e-3,
        "clearance_volume": 3e-5,
    }
    parameters = inspect.signature(FUNCTIONS[name]).parameters
    return {key: given.get(key, usual[key]) for key in parameters if key in usual}


def test_all_is_sorted_and_complete():
    public = {
        name
        for name, value in vars(lecture).items()
        if not name.startswith("_") and not inspect.ismodule(value)
    }
    assert list(lecture.__all__) == sorted(public)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_docstring_names_source_kind_and_units(name):
    doc = inspect.getdoc(FUNCTIONS[name])
    assert re.search(r"^(Exact|Approximate|A statistical estimate)", doc, re.M)
    assert re.search(r"^Source: .*\bS[012]\b", doc, re.M | re.S)
    takes = re.search(r"^Arguments: (.*?)^Returns: ", doc, re.M | re.S)[1]
    said = dict(
        re.split(r",? ", part, maxsplit=1) for part in re.sub(r"\s+", " ", takes).split("; ")
    )
    assert list(said) == list(inspect.signature(FUNCTIONS[name]).parameters)
    assert all(re.search(r"\[[^]]+\]\.? ?$", text) for text in said.values())
    assert re.search(r"^Returns: .*\[[^]]+\]", doc, re.M | re.S)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_docstring_example_runs(name):
    function = FUNCTIONS[name]
    (example,) = doctest.DocTestFinder(recurse=False).find(
        function, name, globs=dict(function.__globals__)
    )
    assert example.examples
    assert doctest.DocTestRunner().run(example).failed == 0


@pytest.mark.parametrize("ratio", [1.0, 1.5, -0.2, float("nan")])
@pytest.mark.parametrize("name", SERIES_WITH_ROD)
def test_series_refuses_a_rod_no_longer_than_the_crank(name, ratio):
    given = arguments(name, crank_radius=ratio, rod_length=1.0, rod_ratio=ratio)
    with pytest.raises(InputError, match=rf"rod ratio .* below 1, got {ratio:g}; take a rod"):
        FUNCTIONS[name](**given)


def test_every_function_named_series_refuses():
    named = {name for name in FUNCTIONS if name.endswith("_series")}
    assert named <= set(SERIES_WITH_ROD)


@pytest.mark.parametrize("name", TURNING)
def test_a_rod_too_short_to_turn_is_refused(name):
    given = arguments(name, rod_length=0.0505, crank_angle=1.5 * np.pi)
    if "offset" not in given:
        given["rod_length"] = 0.0495
    with pytest.raises(InputError, match=r"rod_length: must .* take a longer rod"):
        FUNCTIONS[name](**given)


def test_an_angle_the_rod_cannot_reach_is_refused_and_others_are_not():
    rod = {"crank_radius": 1.0, "rod_length": 0.9}
    assert lecture.cos_beta(np.array([0.0, 1.0]), **rod).shape == (2,)
    with pytest.raises(InputError, match=r"got 1\.11111; take a longer rod"):
        lecture.cos_beta(np.array([0.0, 0.5 * np.pi]), **rod)


def test_lists_are_refused_and_not_repeated():
    with pytest.raises(TypeError):
        lecture.cos_beta_series([0.0, 1.0], crank_radius=0.05, rod_length=0.2)


@pytest.mark.parametrize(
    "name",
    [name for name in FUNCTIONS if "crank_angle" in inspect.signature(FUNCTIONS[name]).parameters],
)
def test_arrays_broadcast(name):
    angles = np.linspace(0.0, 6.0, 5)
    radii = np.array([[0.04], [0.05], [0.06]])
    table = FUNCTIONS[name](**arguments(name, crank_angle=angles, crank_radius=radii))
    assert table.shape == (3, 5)
    single = FUNCTIONS[name](**arguments(name, crank_angle=angles[3], crank_radius=radii[1, 0]))
    assert table[1, 3] == pytest.approx(single, rel=1e-14)
