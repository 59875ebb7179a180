"""Two runs are compared at the samples that both have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from crankmbs.compare.confirm import differences
from crankmbs.result import Result
from crankmbs.scene.read import load_scene
from crankmbs.scene.run import Run
from crankmbs.simulate import simulate

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", params=["deg", "ms"])
def result(request: pytest.FixtureRequest) -> Result:
    run = Run(until="0.2 s", every=f"1 {request.param}")
    return simulate(replace(load_scene("coasting"), run=run))


def ended(result: Result, n: int, status: int) -> Result:
    """The same, ended between two samples after the first n."""
    data = result.data.isel(time=slice(n + 1)).copy(deep=True)
    for name in ("time", "crank_angle"):
        values = data[name].values.copy()
        values[-1] = 0.3 * values[-2] + 0.7 * values[-1]
        data = data.assign({name: (data[name].dims, values, data[name].attrs)})
    return replace(result, data=data, status=status)


def samples(one: Result, other: Result) -> set[int]:
    rows = differences(one, other)
    assert [row.share for row in rows[1:]] == [0.0] * (len(rows) - 1)
    return {len(row.size) for row in rows}


def test_the_end_of_a_run_that_ends_first_is_no_sample_of_the_other(result: Result) -> None:
    assert samples(ended(result, 20, -1), result) == {20}
    assert samples(result, ended(result, 20, 1)) == {20}


def test_two_whole_runs_are_compared_at_their_ends_too(result: Result) -> None:
    n = result.data.sizes["time"]
    assert samples(result, result) == {n}
    nearby = result.data.copy(deep=True)
    nearby["crank_angle"].values[-1] += 1e-4
    assert samples(result, replace(result, data=nearby)) == {n}


def test_runs_that_reverse_elsewhere_are_compared_up_to_there() -> None:
    run = Run(until="0.2 s", every="1 deg")
    result = simulate(replace(load_scene("coasting"), run=run))
    n = result.data.sizes["time"]
    without = result.data.isel(time=np.delete(np.arange(n), 30))
    assert samples(result, replace(result, data=without)) == {30}
