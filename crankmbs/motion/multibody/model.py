"""The system of a scene in exudyn, to be run from any start, and what a run of it recorded."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

import numpy as np

from crankmbs.motion.multibody.loads import Load
from crankmbs.motion.multibody.parts import Assembly, exu
from crankmbs.motion.multibody.start import SPECTRAL_RADIUS, Start
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Model", "Record"]

_SHIFT = 2e-4  # m or rad
_WEIGHTS = (1.0 / 3.0, -2.0, 8.0 / 3.0)  # of h, h/2 and h/4: without terms in h and h^2
_FAR = 1e9  # rad: no run turns farther
# relative, of Newton's method: where forces are small beside what they cancel the first may lie
# below what some processors round; 1e-8 leaves errors that no halving shows, and passes near folds
_TOLERANCES = (1e-10, 1e-9)


class Record(NamedTuple):
    """What exudyn knows at the steps of a run: m steps, n cylinders, global axes.

    time : shape (m,) [s]
    position, velocity, acceleration : shape (m, 3 + 5 n), coordinates as in `Start`
    bearing : shape (m, 2); crank_pin, piston_pin : shape (m, n, 2); side : shape (m, n) [N]
    drive : shape (m,) [N m], the torque that keeps a prescribed speed
    complete : whether the solver went through
    iterations : of Newton's method
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    bearing: Array
    crank_pin: Array
    piston_pin: Array
    side: Array
    drive: Array
    complete: bool
    iterations: int

    def rows(self) -> dict[str, Array]:
        """What was recorded step by step, by name."""
        return dict(zip(self._fields[:-2], self[:-2], strict=True))


class Model:
    """The system of a scene. Set its loads, then run it.

    gas : per cylinder the force [N] of gas and rings over the crank angle [rad]; empty without both
    torque : torque [N m] on a free crank over time [s], crank angle [rad] and speed [rad/s]
    angle : crank angle [rad] of a prescribed motion over the number of the step
    stiff : whether Newton's method shall know how the loads change; 2.7 times as slow
    begun : where the last `run` started, and its step [s]
    """

    def __init__(self, scene: Scene, reference: Start, *, gas: bool, free: bool) -> None:
        self.gas: Sequence[Callable[[float], float]] = ()
        self.torque: Load = lambda time, theta, omega: 0.0
        self.angle: Callable[[int], float] = lambda step: 0.0
        self.stiff = False
        self.begun: tuple[Start, float] | None = None
        self._settings = _settings()
        self._container = exu.SystemContainer()
        self._system = self._container.AddSystem()
        self._reference = reference.position
        self._zero = float(reference.position[2])
        self._begin, self._step = 0.0, 1.0  # solver time counts from the first step
        assembly = Assembly(self._system, scene, reference.position)
        self._sensors = assembly.sensors
        if not free:
            assembly.drive(lambda time: self.angle(round(time / self._step)) - self._zero)
        elif scene.torque:
            assembly.load(
                lambda time: self.torque(
                    self._begin + time, self._zero + self._q.item(2), self._v.item(2)
                )
            )
        for k in range(len(scene.cylinders) if gas else 0):
            assembly.push(k, self._gas_force(k))
        if scene.friction is not None and scene.friction.viscous > 0.0:
            for k, cylinder in enumerate(scene.cylinders):
                assembly.push(k, self._viscous_force(k, cylinder.bank, scene.friction.viscous))
        self._system.Assemble()
        data = self._system.systemData
        self._q, self._v = (  # exudyn's own memory: always the current state
            data.GetODE2Coordinates(copy=False),
            data.GetODE2Coordinates_t(copy=False),
        )

    def close(self) -> None:
        """Let go of what exudyn holds: it and this model refer to each other."""
        self._system.Reset()

    def run(
        self,
        start: Start,
        begin: float,
        step: float,
        steps: int,
        proceed: Callable[[float, float], bool] | None = None,
        lead: int = 0,
    ) -> Record:
        """Solve from ``start`` at time ``begin`` [s].

        proceed(crank angle, speed) : asked before every step but the first ``lead``; False ends it.
            None leaves out two of some thirty microseconds a step
        """
        self.begun = start, step
        self._set(start, begin, step)
        self._system.SetPreStepUserFunction(0)
        if proceed is not None:
            asked = (lead - 0.5) * step

            def ask(_: object, time: float) -> bool:
                return time < asked or proceed(self._zero + self._q.item(2), self._v.item(2))

            self._system.SetPreStepUserFunction(ask)
        return self._solve(self._over(step, steps))

    def crank(self, start: Start, begin: float, step: float, steps: int) -> tuple[Array, Array]:
        """The crank alone, from ``start`` at time ``begin`` [s].

        Returns
        -------
        its angle [rad], speed [rad/s] and acceleration [rad/s2], shape (m, 3), m = steps + 1 unless
        the solver fails; the last position of all bodies, as in `Start`
        """
        self._set(start, begin, step)
        self._system.SetPreStepUserFunction(0)
        self._integrate(self._over(step, steps))
        rows = [self._stored(name, 1)[0] for name in ("position", "velocity", "acceleration")]
        seen = np.stack([values[:, 2] for values in rows], axis=1)
        seen[:, 0] += self._zero
        return seen, self._q + self._reference

    def consistent(self, start: Start, time: float) -> Record:
        """One row: accelerations and forces of a free start, without a step; to ten digits.

        exudyn differentiates the constraints by a difference to one side. Rows f with a shift of
        d, d/2, d/4 have errors of order d and d^2, which f(d)/3 - 2 f(d/2) + 8 f(d/4)/3 has not.
        """
        self._set(start, time, 1e-9)
        self._system.SetPreStepUserFunction(0)
        rows = [self._solve(_initial(_SHIFT * part)) for part in (1.0, 0.5, 0.25)]
        exact: dict[str, Any] = {
            name: sum(weight * row.rows()[name] for weight, row in zip(_WEIGHTS, rows, strict=True))
            for name in ("acceleration", "bearing", "crank_pin", "piston_pin", "side", "drive")
        }
        return rows[-1]._replace(**exact, complete=all(row.complete for row in rows))

    def _gas_force(self, k: int) -> Callable[[], float]:
        return lambda: self.gas[k](self._zero + self._q.item(2))

    def _viscous_force(self, k: int, bank: float, viscous: float) -> Callable[[], float]:
        """Against the piston's own velocity, towards the crank [N]."""
        x, along, across = 6 + 5 * k, viscous * math.cos(bank), viscous * math.sin(bank)
        return lambda: along * self._v.item(x) + across * self._v.item(x + 1)

    def _set(self, start: Start, begin: float, step: float) -> None:
        self._begin, self._step = begin, step
        data, initial = self._system.systemData, exu.ConfigurationType.Initial
        data.SetODE2Coordinates(start.position - self._reference, initial)
        data.SetODE2Coordinates_t(start.velocity, initial)
        data.SetODE2Coordinates_tt(start.acceleration, initial)

    def _over(self, step: float, steps: int) -> Any:
        """Settings for so many steps."""
        _span(self._settings, step, steps)
        return self._settings

    def _integrate(self, settings: Any) -> bool:
        """Whether the solver goes through, if need be with a tolerance above what is rounded."""
        settings.timeIntegration.computeLoadsJacobian = 2 if self.stiff else 0
        with _quiet():
            for tolerance in _TOLERANCES:
                settings.timeIntegration.newton.relativeTolerance = tolerance
                with suppress(RuntimeError, ValueError):  # Newton fails, or a matrix is singular
                    if self._system.SolveDynamic(settings):
                        return True
        return False

    def _solve(self, settings: Any) -> Record:
        complete = self._integrate(settings)
        bodies = {name: self._stored(name) for name in ("position", "velocity", "acceleration")}
        joints = {name: self._stored(name) for name in ("bearing", "crank_pin", "piston_pin")}
        m = len(bodies["position"][0])
        position, velocity, acceleration = (np.hstack(parts) for parts in bodies.values())
        bearing, crank_pin, piston_pin = (-np.stack(p, axis=1)[..., :2] for p in joints.values())
        return Record(
            time=self._begin + self._step * np.arange(m, dtype=np.float64),
            position=position + self._reference,
            velocity=velocity,
            acceleration=acceleration,
            bearing=bearing[:, 0],
            crank_pin=crank_pin,
            piston_pin=piston_pin,
            side=-np.hstack(self._stored("side")),
            drive=-self._stored("drive")[0][:, 0] if "drive" in self._sensors else np.zeros(m),
            complete=complete,
            iterations=int(self._system.sys["dynamicSolver"].it.newtonStepsCount),
        )

    def _stored(self, name: str, most: int | None = None) -> list[Array]:
        """Per sensor (of the first ones) the recorded values, shape (m, its components)."""
        return [self._system.GetSensorStoredData(s)[:, 1:] for s in self._sensors[name][:most]]


def _initial(shift: float) -> Any:
    """Settings for the initial accelerations alone, with a shift [m] or [rad] to differentiate."""
    settings = _settings()
    _span(settings, 1e-9, 1)
    settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = True
    difference = settings.timeIntegration.newton.numericalDifferentiation
    difference.relativeEpsilon = shift / _FAR  # of this or of the coordinate, if that is larger
    difference.minimumCoordinateSize = _FAR
    return settings


def _span(settings: Any, step: float, steps: int) -> None:
    settings.timeIntegration.endTime = steps * step
    settings.timeIntegration.numberOfSteps = steps
    settings.solution.sensors.writePeriod = 0.5 * step  # every step, whatever the rounding


def _settings() -> Any:
    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.adaptiveStep = False  # it may succeed with nonsense near a singular position
    integration.verboseMode = 0
    integration.generalizedAlpha.spectralRadius = SPECTRAL_RADIUS
    integration.generalizedAlpha.computeInitialAccelerations = False
    integration.generalizedAlpha.resetAccelerations = False
    integration.newton.useModifiedNewton = True
    integration.newton.modifiedNewtonJacUpdatePerStep = True  # a third less time than full Newton
    integration.newton.absoluteTolerance = 1e-12
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EXUdense
    return settings


@contextmanager
def _quiet() -> Iterator[None]:
    before = exu.config.printToConsole
    exu.config.printToConsole = False
    try:
        yield
    finally:
        exu.config.printToConsole = before
