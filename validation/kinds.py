"""Kinds of evidence: what a claim is held against, and what that shares with crankmbs."""

from __future__ import annotations

from dataclasses import dataclass

from validation.case import Case

__all__ = ["KINDS", "Kind", "kind_of"]


@dataclass(frozen=True)
class Kind:
    """title : in the report; shares : what the other side has in common with crankmbs; checks : the
    modules of `validation.checks`, or single functions of them, that give it."""

    title: str
    shares: str
    checks: str


KINDS = (
    Kind(
        "Published numbers",
        "Nothing: a book, a paper or the output of another program, by the method of the source "
        "where that is truncated or rounded on the way.",
        "printed s1_tables s1_figures polytropes.expansion design s2.special_angles "
        "s2.brix_correction steam.by_series",
    ),
    Kind(
        "Formulas of the lectures",
        "Nothing: the formula as printed, exact or with its truncation error computed apart.",
        "answers budget curves perturbation polytropes.brauer turning_points two_mass "
        "s2.mean_speed",
    ),
    Kind(
        "Oracles: the numbers",
        "Nothing but the scene: other equations and other methods, mostly in 25 to 40 digits or "
        "80-bit floats, that never import crankmbs.",
        "computed changing.governed changing.mean_pressures double.every_variable "
        "double.mean_pressures "
        "frame.by_momentum indicator steam.in_full "
        "journals.beams measured settled.fluctuation settled.long_run settled.set_free",
    ),
    Kind(
        "Oracles: the stated errors",
        "Nothing but the scene: a run is right where its true error, taken from the oracles, is at "
        "most twice the one that it states.",
        "honest hard.every_formulation means long_runs settled.stated_errors "
        "changing.stated_scene drawn.stated_scene",
    ),
    Kind(
        "Random scenes",
        "Nothing but the scene, drawn from a seed: stated errors against the oracles.",
        "changing.stated_scenes double.stated_scenes drawn.stated_scenes friction.random_errors "
        "periods pushed stepped",
    ),
    Kind(
        "Another formulation that shares no mechanics",
        "The laws of gas and loads: exudyn integrates rigid bodies and joints, and is held against "
        "the oracles or the closed form.",
        "multibody multibody_order frame.by_bodies friction.confirmed",
    ),
    Kind(
        "Another program's rigid bodies",
        "Nothing but the scene: MuJoCo's mass matrix, bias forces, Jacobians and joint forces, "
        "under laws of gas and loads by the oracles. Its numbers are stored.",
        "mujoco",
    ),
    Kind(
        "Identities and rules",
        "No second computation: a law that any right result obeys, a closed form, or input that "
        "has to be refused.",
        "energy firing friction.closes friction.mean_pressure journals.of_runs sums turning weight "
        "frame.closed_form_orders frame.one_cylinder_balanced hard.refused",
    ),
    Kind(
        "The same program in another way",
        "All code: it shows that the ways agree, not that they are right.",
        "swept",
    ),
)


def kind_of(case: Case) -> Kind:
    """The kind of a claim, by its check.

    Raises
    ------
    ValueError : its check stands in none, or in two
    """
    names = {case.check, case.check.partition(".")[0]}
    found = [kind for kind in KINDS if names & set(kind.checks.split())]
    if len(found) != 1:
        raise ValueError(f"{case.name}: {case.check} is of {len(found)} kinds of evidence, not one")
    return found[0]
