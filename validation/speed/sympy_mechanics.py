"""SymPy mechanics derives Lagrange's equation; SciPy's LSODA integrates it."""

from __future__ import annotations

from functools import partial
from typing import Any

from crankmbs.work_precision.contender import Contender
from crankmbs.work_precision.trace import Trace
from validation.speed.gas import gas_function
from validation.speed.job import Job
from validation.speed.reduced import LADDER, integrated

__all__ = ["sympy_contenders"]


def sympy_contenders(job: Job, reference: Trace) -> tuple[Contender, ...]:
    """One contender; the derivation is not timed."""
    acceleration, gas = _derived(job), gas_function(job.alone)

    def slope(t: float, y: Any) -> tuple[float, float]:
        theta, omega = float(y[0]), float(y[1])
        torque = job.constant - (job.viscous + job.quadratic * abs(omega)) * omega
        return omega, acceleration(theta, omega, gas(theta), torque)

    return (
        Contender(
            name="SymPy mechanics, LSODA",
            knob="rtol",
            settings=LADDER,
            run=partial(integrated, job, slope, "LSODA"),
            reference=reference,
        ),
    )


def _derived(job: Job) -> Any:
    """alpha(theta, omega, gas force, torque), common subexpressions taken out."""
    import sympy as sp
    from sympy.physics import mechanics as me

    q = me.dynamicsymbols("q")
    speed = me.dynamicsymbols("q", 1)
    gas, moment, theta, omega = sp.symbols("gas moment theta omega")
    ground = me.ReferenceFrame("ground")
    crank_frame = ground.orientnew("crank", "Axis", [q, ground.z])
    beta = sp.asin((job.radius * sp.sin(q) - job.offset) / job.rod_length)
    rod_frame = ground.orientnew("rod", "Axis", [-beta, ground.z])
    axis = me.Point("axis")
    axis.set_vel(ground, 0)
    crank_pin = axis.locatenew("crank_pin", job.radius * crank_frame.x)
    points = {
        "crank": axis.locatenew("crank_center", job.crank_center * crank_frame.x),
        "rod": crank_pin.locatenew("rod_center", job.rod_center * rod_frame.x),
        "piston": crank_pin.locatenew("piston_pin", job.rod_length * rod_frame.x),
    }
    for point in points.values():
        point.set_vel(ground, point.pos_from(axis).dt(ground))
    central = job.crank_inertia - job.crank_mass * job.crank_center**2
    crank = me.RigidBody(
        "crank",
        points["crank"],
        crank_frame,
        job.crank_mass,
        (me.inertia(crank_frame, 0, 0, central), points["crank"]),
    )
    rod = me.RigidBody(
        "rod",
        points["rod"],
        rod_frame,
        job.rod_mass,
        (me.inertia(rod_frame, 0, 0, job.rod_inertia), points["rod"]),
    )
    piston = me.Particle("piston", points["piston"], job.piston_mass)
    pull = job.gravity[0] * ground.x + job.gravity[1] * ground.y
    forces = [(body.masscenter, body.mass * pull) for body in (crank, rod)]
    forces += [(points["piston"], piston.mass * pull - gas * ground.x)]
    forces += [(crank_frame, moment * ground.z)]
    method = me.LagrangesMethod(
        me.Lagrangian(ground, crank, rod, piston), [q], forcelist=forces, frame=ground
    )
    method.form_lagranges_equations()
    right = method.forcing_full[1] / method.mass_matrix_full[1, 1]
    plain = right.subs(speed, omega).subs(q, theta)
    return sp.lambdify((theta, omega, gas, moment), plain, modules="math", cse=True)
