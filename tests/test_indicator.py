"""The indicator diagram against mpmath, against closed-form work, and against S1's polytropes."""

import dataclasses
import math

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.interpolate import PPoly

from crankmbs import Crank, Gas, Indicator, Motion, Piston, Rod, Run, Scene, Start, simulate
from crankmbs.mechanics.geometry import close_loop, dead_centres
from crankmbs.mechanics.indicator import INDICATOR_RTOL, indicator_pieces
from crankmbs.mechanics.pressure import PeriodicPressure, pressures_of
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.free.passes import run as run_free
from validation.adapter import diagram_of
from validation.oracles.indicator import absolute_pressure

mp.dps = 30

AT = 98066.5  # kgf/cm2 in Pa
BORE = 0.08525
S1 = Indicator(
    compression_ratio=20.0,
    n_compression=1.32,
    n_expansion=1.18,
    intake_pressure=0.9001 * AT,
    exhaust_pressure=1.133 * AT,
    peak_pressure=65.7187 * AT,
    pre_expansion=1.351791,
)
PETROL = Indicator(
    compression_ratio=9.0,
    n_compression=1.3,
    n_expansion=1.25,
    intake_pressure=0.9e5,
    exhaust_pressure=1.1e5,
    peak_pressure=50e5,
)
# radius, rod_length, offset
ENGINE = (0.046, 0.046 / 0.3, 0.0282 * 0.046)
CENTRAL = (0.05, 0.25, 0.0)
BENT = (0.1, 0.3, -0.06)
HARDLY_LONGER = (0.046, 0.0461, 0.0)
FOLDING = (0.05, 0.05, 0.0)
CASES = [
    pytest.param(S1, ENGINE, 4, id="S1"),
    pytest.param(PETROL, CENTRAL, 4, id="petrol"),
    pytest.param(S1, BENT, 2, id="two-stroke, offset"),
    pytest.param(PETROL, BENT, 4, id="constant volume, offset"),
    pytest.param(PETROL, HARDLY_LONGER, 4, id="rod hardly longer than the crank"),
    pytest.param(PETROL, FOLDING, 4, id="rod as long as the crank"),
    pytest.param(dataclasses.replace(S1, pre_expansion=19.9), ENGINE, 4, id="late combustion"),
    pytest.param(
        dataclasses.replace(S1, pre_expansion=1 + 1e-12), ENGINE, 4, id="short combustion"
    ),
]


def pieces(scene):
    """The diagram of a machine of like cylinders."""
    return indicator_pieces(scene.gas, scene.running_gear[0].shape)


def scene(indicator, shape, stroke):
    radius, length, offset = shape
    return Scene(
        crank=Crank(radius=radius, inertia=1.0),
        rod=Rod(length=length),
        piston=Piston(mass=1.0, bore=BORE, offset=offset),
        gas=Gas(indicator=indicator, ambient=AT, stroke=stroke),
        start=Start(angle=0.0, speed=1.0),
        run=Run(until="1 s"),
    )


def diagram(indicator, shape, stroke):
    """The pieces with absolute pressure, to be evaluated inside them."""
    knots, coefficients = pieces(scene(indicator, shape, stroke))
    absolute = coefficients + np.array([[0.0], [0.0], [0.0], [AT]])
    return PPoly(absolute, knots)


def oracle(angle, indicator, shape, stroke):
    """Absolute pressure in mpmath, from the circle about the crank pin alone."""
    r, l, e = map(mpf, shape)

    def pin(phi):
        return r * mp.cos(phi) + mp.sqrt(abs(l**2 - (r * mp.sin(phi) - e) ** 2))

    highest = mp.sqrt((l + r) ** 2 - e**2)
    lowest = mp.sqrt((l - r) ** 2 - e**2)
    ratio = mpf(indicator.compression_ratio)
    volume = 1 + (ratio - 1) * (highest - pin(mpf(angle))) / (highest - lowest)
    top, bottom = dead_centres(*shape)
    stage = (angle - top) % (stroke * math.pi)
    if stage < bottom - top:
        if stroke == 4:
            return mpf(indicator.intake_pressure)
        stage += 2.0 * math.pi
    if stage < 2.0 * math.pi:
        return indicator.intake_pressure * (ratio / volume) ** mpf(indicator.n_compression)
    if stage >= 2.0 * math.pi + bottom - top:
        return mpf(indicator.exhaust_pressure)
    spread = min(mpf(indicator.pre_expansion) / volume, mpf(1))
    return indicator.peak_pressure * spread ** mpf(indicator.n_expansion)


def worst(pieces, indicator, shape, stroke):
    """Largest relative deviation at three angles inside every fifth piece."""
    worst_of_all = 0.0
    for left, right in list(zip(pieces.x, pieces.x[1:], strict=False))[::5]:
        for part in (0.003, 0.5, 0.893):
            angle = left + part * (right - left)
            exact = oracle(angle, indicator, shape, stroke)
            worst_of_all = max(worst_of_all, abs(float(pieces(angle) / exact) - 1.0))
    return worst_of_all


@pytest.mark.parametrize(("indicator", "shape", "stroke"), CASES)
def test_pieces_follow_the_exact_polytropes(indicator, shape, stroke):
    pieces = diagram(indicator, shape, stroke)
    assert worst(pieces, indicator, shape, stroke) < INDICATOR_RTOL


@pytest.mark.parametrize(
    "name", ["n_compression", "n_expansion", "intake_pressure", "peak_pressure"]
)
def test_a_shifted_parameter_is_noticed(name):
    shifted = dataclasses.replace(S1, **{name: getattr(S1, name) * (1.0 + 1e-8)})
    assert worst(diagram(S1, ENGINE, 4), shifted, ENGINE, 4) > INDICATOR_RTOL


@pytest.mark.parametrize(("indicator", "shape", "stroke"), CASES)
def test_pieces_cover_one_period_and_are_not_too_many(indicator, shape, stroke):
    knots, coefficients = pieces(scene(indicator, shape, stroke))
    assert knots[-1] - knots[0] == pytest.approx(stroke * math.pi, rel=1e-15)
    assert np.diff(knots).min() > 1e-9
    assert coefficients.shape == (4, len(knots) - 1)
    assert coefficients.shape[1] < 700


@pytest.mark.parametrize(("indicator", "shape", "stroke"), CASES)
def test_the_pressure_jumps_at_dead_centres_only(indicator, shape, stroke):
    pieces = diagram(indicator, shape, stroke)
    width = np.diff(pieces.x)
    end = np.array([np.polyval(c, w) for c, w in zip(pieces.c.T, width, strict=True)])
    jump = np.abs(np.roll(pieces.c[3], -1) / end - 1.0)
    top, bottom = dead_centres(*shape)
    jumps = np.unique(np.round(np.mod(pieces.x[1:][jump > 3.0 * INDICATOR_RTOL], 2 * math.pi), 9))
    expected = np.round(np.mod([top, bottom], 2.0 * math.pi), 9)
    assert set(jumps) == set(expected)


@pytest.mark.parametrize(("indicator", "shape", "stroke"), CASES)
def test_work_of_a_cycle_is_that_of_the_polytropes(indicator, shape, stroke):
    """The integral of p dV over the pieces; a polytrope's is (p1 V1 - p2 V2) / (n - 1)."""
    pieces = diagram(indicator, shape, stroke)
    node, weight = np.polynomial.legendre.leggauss(8)
    left, width = pieces.x[:-1, None], np.diff(pieces.x)[:, None]
    angle = left + 0.5 * width * (node + 1.0)
    top, bottom = dead_centres(*shape)
    stroke_length = close_loop(top, *shape).x - close_loop(bottom, *shape).x
    dv = -close_loop(angle, *shape).x_1 * (indicator.compression_ratio - 1.0) / stroke_length
    found = float(np.sum(pieces(angle) * dv * weight * 0.5 * width))

    ratio, rho = indicator.compression_ratio, indicator.pre_expansion
    low, peak = indicator.intake_pressure, indicator.peak_pressure
    n, m = indicator.n_compression, indicator.n_expansion
    work = low * ratio * (1.0 - ratio ** (n - 1.0)) / (n - 1.0)
    work += peak * (rho - 1.0) + peak * rho * (1.0 - (rho / ratio) ** (m - 1.0)) / (m - 1.0)
    if stroke == 4:
        work += (ratio - 1.0) * (low - indicator.exhaust_pressure)
    assert found == pytest.approx(work, rel=2e-9)


def test_quarter_turns_are_knots_so_that_cylinders_share_them():
    knots, _ = pieces(scene(S1, ENGINE, 4))
    quarters = np.arange(3, 6) * 0.5 * math.pi
    assert np.abs(knots[:, None] - quarters).min(axis=0).max() < 1e-14


# S1, its Table 6 and indicator diagram recomputed from its truncated displacement: degrees, V / V_c
# and the polytropes' pressure [kgf/cm2]
S1_POLYTROPES = [
    (210, 19.1237, 0.95494),
    (240, 16.3884, 1.17075),
    (270, 12.0054, 1.76553),
    (300, 6.88835, 3.67568),
    (330, 2.66919, 12.8478),
    (390, 2.58882, 30.5282),
    (420, 6.74915, 9.85482),
    (450, 11.8446, 5.07466),
    (480, 16.2491, 3.49448),
    (510, 19.0433, 2.89779),
    (540, 20.0, 2.73493),
]


@pytest.mark.parametrize(("degrees", "volume", "pressure"), S1_POLYTROPES)
def test_s1_polytropes_but_for_its_truncated_volume(degrees, volume, pressure):
    """S1's truncated displacement is the whole difference: up to 0.3 % of the volume."""
    start, exponent = (
        (0.9001 * 20.0**1.32, 1.32) if degrees < 360 else (65.7187 * 1.351791**1.18, 1.18)
    )
    assert start / volume**exponent == pytest.approx(pressure, rel=2e-5)
    found = float(diagram(S1, ENGINE, 4)(math.radians(degrees))) / AT
    assert found == pytest.approx(pressure, rel=4.5e-3)


def test_s1_ends_of_the_strokes():
    pieces = diagram(S1, ENGINE, 4)
    top, bottom = dead_centres(*ENGINE)
    fired = 2.0 * math.pi + top
    assert float(pieces(bottom)) / AT == pytest.approx(0.9001, rel=1e-12)
    assert float(pieces(fired - 1e-12)) / AT == pytest.approx(0.9001 * 20.0**1.32, rel=1e-9)
    assert float(pieces(fired)) / AT == pytest.approx(65.7187, rel=1e-12)
    assert float(pieces(2.0 * math.pi + bottom)) / AT == pytest.approx(1.133, rel=1e-12)


def random_engine(seed):
    """An engine with a random diagram, four-stroke or two-stroke, its crank free."""
    rng = np.random.default_rng(seed)
    ratio, intake = rng.uniform(5.0, 20.0), rng.uniform(0.5e5, 2e5)
    indicator = Indicator(
        compression_ratio=ratio,
        n_compression=rng.uniform(1.2, 1.4),
        n_expansion=rng.uniform(1.15, 1.35),
        intake_pressure=intake,
        exhaust_pressure=1.1 * intake,
        peak_pressure=intake * ratio**1.4 * rng.uniform(1.0, 2.0),
        pre_expansion=rng.uniform(1.0, 1.8),
    )
    radius = rng.uniform(0.03, 0.08)
    length, offset = radius * rng.uniform(2.5, 5.0), radius * rng.uniform(-0.2, 0.2)
    return Scene(
        crank=Crank(radius=radius, inertia=0.1),
        rod=Rod(length=length, mass=0.5, center_of_mass=0.3 * length, inertia="two-mass"),
        piston=Piston(mass=0.5, bore=2.0 * radius, offset=offset),
        gas=Gas(indicator=indicator, ambient=1e5, stroke=4 if seed % 2 else 2),
        start=Start(angle=0.3, speed=300.0),
        run=Run(until="2 cycles", every="3.7 deg"),
    )


def exact_gauge(engine, angle):
    """Gauge pressure [Pa] of the polytropes themselves."""
    return np.asarray(
        absolute_pressure(diagram_of(engine), angle) - engine.gas.ambient, dtype=float
    )


def as_it_is(engine, pieces):
    """The pressure of the polytropes: a cubic through four of its values in each twelfth of a
    piece."""
    starts, widths = pieces.knots[:-1], np.diff(pieces.knots)
    knots = np.append((starts[:, None] + widths[:, None] * np.arange(12) / 12.0), pieces.knots[-1])
    width, places = np.diff(knots), 0.5 - 0.5 * np.cos(np.pi * (np.arange(4) + 0.5) / 4.0)
    values = exact_gauge(engine, (knots[:-1, None] + width[:, None] * places).ravel())
    cubics = np.linalg.solve(np.vander(places, 4), values.reshape(-1, 4).T)
    return PeriodicPressure(knots, cubics / width ** np.arange(3, -1, -1)[:, None])


@pytest.mark.parametrize("seed", range(12))
def test_a_driven_engine_states_what_the_pieces_miss_of_the_polytropes(seed):
    free = random_engine(seed)
    driven = dataclasses.replace(free, start=None, motion=Motion(speed=300.0, angle=0.3))
    data = simulate(driven).data
    exact = exact_gauge(driven, data["crank_angle"].values)
    missed = np.abs(data["gas_pressure"].values[:, 0] - exact)
    stated = data["gas_pressure"].attrs["error_estimate"]
    assert missed.max() <= 2.0 * stated <= 1e-8 * exact.max()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_a_free_engine_states_what_the_pieces_miss_of_the_polytropes(seed):
    """The same engine under the polytropes themselves, but for a ten-thousandth of what the pieces
    miss."""
    engine = random_engine(seed)
    pressure = as_it_is(engine, pressures_of(engine)[0])
    exact = run_free(CrankTrain(engine, (pressure,)), 1e-11, 10.0, by_angle=True)
    data = simulate(engine, rtol=1e-11).data
    names = ("time", "crank_speed", "main_bearing_force_x", "side_force", "crank_torque")
    apart = {n: np.abs(data[n].values - exact.variables[n]).max() for n in names}
    stated = {n: data[n].attrs["error_estimate"] + exact.errors[n] for n in names}
    assert max(apart[n] / stated[n] for n in names) <= 2.0
    assert stated["crank_speed"] < 1e-8 * 300.0
