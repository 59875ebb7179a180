"""What a film draws on the mechanism: the ring at mean speed, and arrows of forces to scale."""

import dataclasses
import math

import numpy as np
import pytest
from PIL import Image

from crankmbs import Motion, Oscillation, Run, load_scene, simulate
from crankmbs.figures import last_view
from crankmbs.figures.animation import Filming, save_animation
from crankmbs.figures.arrows import Arrows, draw_bar, largest
from crankmbs.figures.frames import frames_of, round_below
from crankmbs.figures.machines import Ring, shown_forces
from crankmbs.figures.outline import mechanism
from crankmbs.figures.style import panels

TWIN = dataclasses.replace(load_scene("v_twin"), run=Run(until="1 cycle"))  # without gravity
RUBBING = dataclasses.replace(load_scene("friction"), gravity=None, run=Run(until="1 cycle"))


def swinging(amplitude):
    """A crank whose speed swings once a turn about 100 rad/s, by little: it leads by
    amplitude / 100 sin(theta), to the first order."""
    speed = Oscillation(mean=100.0, amplitude=amplitude, order=1.0)
    run, motion = Run(until="1 rev"), Motion(speed=speed)
    return dataclasses.replace(load_scene("compressor"), motion=motion, run=run)


@pytest.mark.parametrize(("amplitude", "times"), [(0.1, 500.0), (1.0, 50.0), (90.0, 1.0)])
def test_the_lead_is_magnified_until_it_is_seen(amplitude, times):
    frames = frames_of(simulate(swinging(amplitude)), 20.0)
    assert frames.magnified == times
    if amplitude < 2.0:
        assert frames.leads == pytest.approx(
            0.01 * amplitude * np.sin(frames.angle), abs=1e-4 * amplitude
        )
        shown = np.degrees(np.max(np.abs(frames.leads)) * times)
        assert 10.0 < shown <= 30.0
        assert frames.ring.endswith(f"magnified {times:g} times")
    quarter = len(frames.time) // 4
    assert frames.lead_in_words(quarter).endswith("ahead")
    assert frames.lead_in_words(3 * quarter).endswith("behind")


def test_a_crank_that_turns_evenly_has_no_lead():
    scene = dataclasses.replace(swinging(1.0), motion=Motion(speed=100.0))
    frames = frames_of(simulate(scene), 20.0)
    assert (frames.magnified, frames.ring) == (0.0, "ring: the crank turns evenly")


@pytest.mark.parametrize("value", [1.0, 1.99, 2.0, 4.9, 5.0, 0.03, 7e4])
def test_a_round_number_below_is_below_and_near(value):
    assert value / 2.5 < round_below(value) <= value


def test_the_ring_points_where_the_throw_would_be():
    _, (ax,) = panels(1, 1, 5.0, 5.0)
    ring = Ring(ax, 10.0, np.array([0.5]), np.array([0.2]))
    ring.move(0)
    inner, outer = ring._ticks.get_segments()[0]
    assert outer == pytest.approx([-10.0 * math.sin(0.3), 10.0 * math.cos(0.3)])
    assert math.hypot(*inner) < 0.9 * 10.0  # the pointer is longer than the ticks
    bow = ring._bow.get_xydata()
    assert bow[0] == pytest.approx(outer)
    assert bow[-1] == pytest.approx([-10.0 * math.sin(0.5), 10.0 * math.cos(0.5)])
    assert ring._mark.get_xydata()[0] == pytest.approx(bow[-1])


def forces_of(scene, body, cuts):
    result = simulate(scene)
    frames, view = frames_of(result, 20.0), last_view(result)
    parts = mechanism(scene, frames.angle)
    return frames, view, parts, shown_forces(body, view, frames, parts, cuts)


def at_frames(view, frames, name):
    time = view.values("time") - view.window.begin
    values = view.values(name)
    return np.stack([np.interp(frames.time, time, row) for row in np.atleast_2d(values.T)], -1)


@pytest.mark.parametrize("scene", [TWIN, RUBBING])
def test_the_arrows_on_a_piston_add_up_to_its_mass_times_its_acceleration(scene):
    count = len(scene.cylinders)
    frames, view, _, forces = forces_of(scene, "piston", [list(range(count))])
    outwards = -at_frames(view, frames, "piston_acceleration")
    for k in range(count):
        total = sum(each.force for each in forces if each.cylinder == k)
        bank = scene.cylinders[k].bank
        along = np.array([math.cos(bank), math.sin(bank)])
        expected = scene.piston.mass * outwards[:, k, None] * along
        assert total == pytest.approx(expected, abs=1e-6 * largest(forces))


def test_the_arrows_on_a_crank_add_up_to_its_mass_times_its_acceleration():
    frames, view, _, forces = forces_of(TWIN, "crank", [[0, 1]])
    theta = at_frames(view, frames, "crank_angle")[:, 0]
    omega = at_frames(view, frames, "crank_speed")[:, 0]
    alpha = at_frames(view, frames, "crank_acceleration")[:, 0]
    turn = (1j * alpha - omega**2) * np.exp(1j * theta)
    expected = TWIN.crank.mass * TWIN.crank.center_of_mass * turn
    total = sum(each.force[:, 0] + 1j * each.force[:, 1] for each in forces)
    assert total == pytest.approx(expected, abs=2e-3 * largest(forces))  # linear between samples


def test_what_pushes_ends_on_the_crown_and_the_rest_begins_where_it_acts():
    _, _, parts, forces = forces_of(TWIN, "piston", [[0, 1]])
    gas = next(each for each in forces if each.name == "gas on piston")
    pushed = int(np.argmax(np.hypot(*gas.force.T)))
    _, (ax,) = panels(1, 1, 5.0, 5.0)
    arrows = Arrows(ax, forces, 36.0, largest(forces))
    arrows.move(pushed)
    tails = arrows._quiver.get_offsets()
    vectors = np.stack([arrows._quiver.U, arrows._quiver.V], axis=-1)
    number = forces.index(gas)
    crown = parts.piston[pushed, gas.cylinder, 1:3].mean(axis=0)
    tip = tails[number] + vectors[number]
    assert tip == pytest.approx([-1e3 * crown[1], 1e3 * crown[0]])
    wall = next(k for k, each in enumerate(forces) if each.name == "wall on piston")
    pin = parts.piston_pin[pushed, forces[wall].cylinder]
    assert tails[wall] == pytest.approx([-1e3 * pin[1], 1e3 * pin[0]])


def test_the_bar_and_the_arrows_have_one_scale():
    _, _, _, forces = forces_of(TWIN, "rod", [[0, 1]])
    newtons = largest(forces)
    _, (ax,) = panels(1, 1, 5.0, 5.0)
    ax.set_xlim(-100.0, 100.0)
    arrows = Arrows(ax, forces, 36.0, newtons)
    draw_bar(ax, 36.0, newtons)
    bar = float(np.ptp(ax.lines[-1].get_xdata()))
    (text,) = [each.get_text() for each in ax.texts]
    assert text.endswith(" kN")
    per_newton = bar / (1e3 * float(text.removesuffix(" kN")))
    for vector, force in zip(arrows._arrows, forces, strict=True):
        assert np.hypot(*vector.T) == pytest.approx(per_newton * np.hypot(*force.force.T))


def test_bearings_are_drawn_only_where_all_cylinders_are():
    scene = dataclasses.replace(load_scene("yi_diesel_free"), run=Run(until="1 cycle"))
    for cuts, bearings in (([[0], [1], [2], [3]], 0), ([[1]], 0)):
        *_, forces = forces_of(scene, "crank", cuts)
        assert sum(each.cylinder is None for each in forces) == bearings
        assert [each.cylinder for each in forces] == [k for cut in cuts for k in cut]


@pytest.mark.slow
def test_a_film_with_forces_shows_their_colours(tmp_path):
    filming = Filming(length=0.5, forces="piston")
    file = save_animation(simulate(RUBBING), tmp_path / "rub.gif", filming)
    with Image.open(file) as film:
        film.seek(film.n_frames // 2)
        pixels = np.asarray(film.convert("RGB"), dtype=int)[:, :260]
    for colour in ((184, 84, 0), (0, 104, 165)):  # gas and pin
        assert (np.abs(pixels - colour).sum(axis=-1) < 60).sum() > 30
