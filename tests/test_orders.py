"""Orders of torque and frame force: against closed forms that mpmath integrates."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from crankmbs import Layout, Motion, Run, engine_orders, load_scene, orders, simulate
from crankmbs.mechanics.harmonics import closed_orders
from crankmbs.scene.forces import ConstantForce, Damper
from crankmbs.scene.parts import Friction
from validation.case import CASES

BANKED = load_scene(CASES.parent / "scenes" / "banked_crank.toml")
FOUR = load_scene("yi_diesel_free")
SPEED = 250.0


def driven(scene, **changes):
    run = Run(until="1 cycle", every="1 deg")
    return replace(scene, start=None, torque=(), motion=Motion(speed=SPEED), run=run, **changes)


def integrated(scene, order):
    """frame_force_x, frame_force_y and torque of one order by mpmath, amplitude exp(i phase)."""
    crank, rod, piston = scene.crank, scene.rod, scene.piston
    r, l, a, e = crank.radius, rod.length, rod.center_of_mass, piston.offset

    def beta(phi):
        return mpmath.asin((r * mpmath.sin(phi) - e) / l)

    def x(phi):
        return r * mpmath.cos(phi) + l * mpmath.cos(beta(phi))

    def rod_place(phi):
        return r * mpmath.expj(phi) + a * mpmath.expj(-beta(phi))

    def inertia(phi):
        turned = rod.moment_of_inertia * mpmath.diff(beta, phi) ** 2
        swung = rod.mass * abs(mpmath.diff(rod_place, phi)) ** 2
        return piston.mass * mpmath.diff(x, phi) ** 2 + swung + turned

    def wave(function):
        """By parts: derivatives become powers of i order, which leaves smooth integrands."""
        values = mpmath.quad(
            lambda phi: function(phi) * mpmath.expj(-order * phi),
            mpmath.linspace(0, 2 * mpmath.pi, 5),
        )
        return complex(values / mpmath.pi)

    along = order**2 * (piston.mass * wave(x) + rod.mass * wave(lambda p: rod_place(p).real))
    across = order**2 * rod.mass * wave(lambda p: rod_place(p).imag)
    torque = -0.5j * order * wave(inertia)
    total = np.zeros(3, dtype=complex)
    for cylinder in scene.cylinders:
        turn = np.exp(1j * order * cylinder.phase)
        c, s = math.cos(cylinder.bank), math.sin(cylinder.bank)
        total += turn * np.array([c * along - s * across, s * along + c * across, torque])
    if order == 1:
        total[:2] += crank.mass * crank.center_of_mass * np.array([1.0, -1.0j])
    return total


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "order"),
    [*((BANKED, order) for order in (1, 2, 3, 6)), (FOUR, 2), (FOUR, 4)],
    ids=lambda one: "banked" if one is BANKED else "four" if one is FOUR else str(one),
)
def test_closed_forms_are_those_of_a_quadrature(scene, order):
    closed = closed_orders(scene)
    found = [getattr(closed, n)[order - 1] for n in ("frame_force_x", "frame_force_y", "torque")]
    scale = [np.abs(closed.frame_force_x).max()] * 2 + [np.abs(closed.torque).max()]
    assert (np.abs(found - integrated(scene, order)) < 1e-12 * np.array(scale)).all()


def test_a_rod_near_its_fold_has_no_closed_form():
    rod = replace(BANKED.rod, length=BANKED.crank.radius + BANKED.piston.offset + 1e-4)
    assert closed_orders(replace(BANKED, rod=rod)) is None
    rows = engine_orders(simulate(driven(replace(BANKED, rod=rod)))).rows
    assert all(row.closed is None for row in rows)


@pytest.mark.parametrize("speed", [SPEED, -SPEED])
@pytest.mark.parametrize("every", ["1 deg", "7 deg", "0.3 ms"])
def test_orders_at_constant_speed_are_the_closed_forms(speed, every):
    scene = driven(BANKED, gravity=BANKED.gravity)
    run = Run(until="2 cycles", every=every)
    scene = replace(scene, motion=Motion(speed=speed, angle=0.3), run=run)
    found = engine_orders(simulate(scene))
    assert found.speed.value == pytest.approx(speed, rel=1e-12)
    for row in found.rows[1:]:
        wave = row.orders.amplitude * np.exp(1j * row.orders.phase)
        apart = np.abs(wave - row.closed).max()
        assert apart < 1e-10 * np.abs(row.closed).max()
        assert apart <= 2.0 * row.orders.error


def test_friction_and_forces_on_the_pistons_are_no_inertia():
    forces = (ConstantForce(force=700.0), Damper(coefficient=30.0))
    friction = Friction(ring_force=200.0, viscous=20.0)
    found = engine_orders(simulate(driven(BANKED, friction=friction, force=forces)))
    row = found.rows[1]
    assert row.quantity == "inertia torque"
    wave = row.orders.amplitude * np.exp(1j * row.orders.phase)
    assert np.abs(wave - row.closed).max() < 1e-9 * np.abs(row.closed).max()


def test_two_strokes_have_whole_orders():
    found = engine_orders(simulate(driven(load_scene("compressor"))))
    row = found.rows[2]
    assert row.orders.order.tolist() == list(range(1, 13))
    wave = row.orders.amplitude * np.exp(1j * row.orders.phase)
    assert np.abs(wave - row.closed).max() < 1e-10 * np.abs(row.closed).max()


@pytest.mark.slow
def test_errors_of_a_free_crank_cover_coarser_samples():
    """The same motion sampled and solved ten times as finely."""
    scene = replace(BANKED, run=Run(until="2 cycles", every="1 deg", rtol=1e-6))
    coarse = simulate(scene)
    fine = simulate(replace(scene, run=Run(until="2 cycles", every="0.1 deg", rtol=1e-12)))
    for name in ("crank_torque", "frame_force_x", "frame_moment", "gas_force"):
        one, other = orders(coarse, name), orders(fine, name)
        waves = [o.amplitude * np.exp(1j * o.phase) for o in (one, other)]
        apart = max(np.abs(waves[0] - waves[1]).max(), np.abs(one.mean - other.mean).max())
        assert apart <= 2.0 * (one.error + other.error), name
        assert one.error < 1e-4 * np.abs(other.amplitude).max(), name


def test_they_do_not_depend_on_the_samples():
    wide, fine = (
        orders(simulate(replace(BANKED, run=Run(until="1 cycle", every=every))), "crank_torque")
        for every in ("200 deg", "1 deg")
    )
    assert np.max(np.abs(wide.amplitude - fine.amplitude)) <= wide.error + fine.error
    assert wide.error < 1e-6 * np.max(wide.amplitude)


def test_a_sum_that_cancels_errs_by_what_its_terms_round():
    three = load_scene("propeller").with_(
        run__until="settled", layout=Layout(firing_order=(1, 2, 3))
    )
    across = orders(simulate(three), "frame_force_y")
    assert 0.0 < across.amplitude.max() <= across.error < 1e-8
