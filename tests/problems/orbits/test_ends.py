"""Ends of families of orbits against systems where they are known."""

from math import pi

import numpy as np
import pytest
from scipy.special import beta

from contin import api
from contin.continuation.sample import Stop
from contin.model.model import Model
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.ends import ends


def test_family_that_ends_on_a_fold_of_equilibria():
    """theta' = a - cos theta on the unit circle: period 2 pi / sqrt(a^2 - 1), saddle-node at a = 1, x = 1, y = 0."""
    model = Model(
        "circle", states={"x": 0, "y": 1}, parameters={"a": 2}, definitions={"s": "x^2 + y^2", "turn": "a - x"},
        equations={"x": "(1 - s)*x - turn*y", "y": "turn*x + (1 - s)*y"},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model, {"x": 0.0, "y": 1.0}), "a", (0.5, 3.0))
    a, period = family.columns["a"][1:], family.columns["period"][1:]  # the label of the first row stands at the fold
    np.testing.assert_allclose(period, 2.0 * pi / np.sqrt(a**2 - 1.0), rtol=1e-6)
    assert abs(family.columns["a"][0] - 1.0) <= family.points[0].error
    end = family.ends[0]
    assert end.reason == "homoclinic"
    assert end.data["at"]["a"] == pytest.approx(1.0, abs=1e-9)
    assert end.data["saddle"] == pytest.approx({"x": 1.0, "y": 0.0}, abs=1e-6)
    assert [p.type for p in family.points] == ["HOM"]


def test_rotations_end_at_one_saddle_whatever_sheet_of_the_angle_it_is_on():
    """Damped pendulum with torque: the rotations end at I = 4 g / pi + O(g^2) (Melnikov)."""
    model = Model(
        "pendulum", states={"phi": {"value": 0, "period": "2*pi"}, "w": 3}, parameters={"I": 0.5, "g": 0.1},
        equations={"phi": "w", "w": "I - sin(phi) - g*w"},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model, {"phi": 0.0, "w": 4.0}), "I", (0.0, 0.6))
    end = family.ends[0]
    assert end.reason == "homoclinic"
    assert end.data["at"]["I"] == pytest.approx(4.0 * 0.1 / pi, rel=0.01)
    assert end.data["saddle"]["w"] == pytest.approx(0.0, abs=1e-9)


def test_rotations_are_marched_many_rows_at_a_time_however_far_their_angle_turns(monkeypatch):
    """An angle's size is that of its period: that a rotation goes beyond it is no reason to return after every row."""
    model = Model(
        "pendulum", states={"phi": {"value": 0, "period": "2*pi"}, "w": 3}, parameters={"I": 0.5, "g": 0.1},
        equations={"phi": "w", "w": "I - sin(phi) - g*w"},
    )  # fmt: skip
    march, rows = OrbitProblem.march, []

    def counted(*arguments, **options):
        chunk = march(*arguments, **options)
        rows.append(len(chunk) - 1)
        return chunk

    monkeypatch.setattr(OrbitProblem, "march", counted)
    start = api.periodic_orbit(model, {"phi": 0.0, "w": 4.0})
    family = api.continuation(start, "I", (0.3, 0.6))
    work = family.columns["I"] * 2.0 * pi  # of the torque in a turn; that of friction is g times the integral of w^2
    k = family.start_row
    orbit = family.orbit(k)
    friction = 0.1 * np.trapezoid(orbit.columns["w"] ** 2, orbit.t)
    assert friction == pytest.approx(work[k], rel=1e-3)
    assert sum(rows) >= 5 * len(rows), rows


@pytest.mark.parametrize(("nearness", "reason"), [(3e-8, "homoclinic"), (1e-5, "corrector")])
def test_a_corrector_that_fails_beside_a_homoclinic_orbit_names_it(monkeypatch, nearness, reason):
    """The damped pendulum again, its approach not recognised until the corrector fails, near the end or too early."""
    model = Model(
        "pendulum", states={"phi": {"value": 0, "period": "2*pi"}, "w": 3}, parameters={"I": 0.5, "g": 0.1},
        equations={"phi": "w", "w": "I - sin(phi) - g*w"},
    )  # fmt: skip
    start = api.periodic_orbit(model, {"phi": 0.0, "w": 4.0})
    known = api.continuation(start, "I", (0.0, 0.6), direction="down").ends[0].data["at"]["I"]
    march, recognise = OrbitProblem.march, ends.diverged

    def failing(*arguments, **options):
        chunk = march(*arguments, **options)
        near = np.flatnonzero(chunk.z[:, -1] < known + 0.6 * nearness)
        return chunk.cut(int(near[0]) + 1, Stop.CORRECTOR, chunk.next_step) if near.size else chunk

    monkeypatch.setattr(OrbitProblem, "march", failing)
    monkeypatch.setattr(ends, "diverged", lambda *a, failed=False: recognise(*a, failed=True) if failed else None)
    end = api.continuation(start, "I", (0.0, 0.6), direction="down").ends[0]
    assert end.reason == reason
    if reason == "homoclinic":
        assert abs(end.data["at"]["I"] - known) <= end.data["error"] < 1e-7


def test_large_orbits_are_not_taken_for_the_hopf_point_whose_parameter_they_pass():
    """A one-cell enzyme model, the demo `plp` of AUTO-07p: two Hopf points, two folds; its values (100 intervals)."""
    model = Model(
        "enzyme", states={"s": 45.56, "a": 177.8}, parameters={"rho": 2.021628},
        definitions={"R": "s*a/(1 + s + s^2/10)"},
        equations={"s": "110 - s - rho*R", "a": "(500 - a)/5 - rho*R"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "rho", (0.5, 20.0))
    assert [line[f"HB{k}"].values["rho"] for k in (1, 2)] == pytest.approx([3.49995, 4.65046], abs=1e-5)
    family = api.continuation(line["HB1"].switch(), "rho", (0.5, 20.0))
    assert [p.type for p in family.points] == ["LPC", "LPC"]
    assert [p.values["rho"] for p in family.points] == pytest.approx([2.7596874555, 5.0078397608], rel=1e-9)
    assert [p.values["period"] for p in family.points] == pytest.approx([10.006393029, 5.6765785963], rel=1e-8)
    assert family.ends[1].reason == "hopf"
    assert family.ends[1].data["at"]["rho"] == pytest.approx(line["HB2"].values["rho"], abs=1e-9)


def test_subharmonic_orbits_turn_round_at_their_branch_points_without_a_fold():
    """x'' + 0.1 x' + x^3 = F cos t: orbits of three forcing periods that break (x, t) -> (-x, t + pi)."""
    model = Model(
        "ueda", states={"x": 3, "y": 4}, parameters={"F": 7.5}, forcing={"period": "2*pi"},
        equations={"x": "y", "y": "-0.1*y - x^3 + F*cos(t)"},
    )  # fmt: skip
    start = api.periodic_orbit(model)
    assert start.period == pytest.approx(6.0 * pi)
    family = api.continuation(start, "F", (0.0, 12.0))
    assert [p.type for p in family.points] == ["BPC", "BPC"]
    low, high = sorted(p.values["F"] for p in family.points)
    assert family.columns["F"].min() >= low - 1e-7
    assert family.columns["F"].max() <= high + 1e-7
    assert {end.reason for end in family.ends} == {"closed"}
    for p in family.points:  # Liouville: the product of the multipliers is exp(-0.1 T)
        assert np.prod(p.eigenvalues).real == pytest.approx(np.exp(-0.6 * pi), rel=1e-7)


def test_a_closed_family_ends_at_its_start_whatever_its_phase_there():
    """r' = r (e - mu^2 - (r^2 - 1)^2) with a rate that depends on mu, and z' = x y - z: an ellipse in mu and r^2 - 1.

    Round it the phases that the steps choose add up to a shift, as z has the same phase at all mu but x and y do not.
    """
    square, growth = "(x^2 + y^2)", "(0.04 - mu^2 - (x^2 + y^2 - 1)^2)"
    model = Model(
        "isola", states={"x": 1.1, "y": 0.0, "z": 0.0}, parameters={"mu": 0.0},
        equations={"x": f"x*{growth} - y*(1 + 0.3*mu)", "y": f"y*{growth} + x*(1 + 0.3*mu)", "z": "x*y - z"},
        observables={"square": square},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model), "mu", (-1.0, 1.0))
    assert [end.reason for end in family.ends] == ["closed", "closed"]
    assert sorted(p.values["mu"] for p in family.points) == pytest.approx([-0.2, 0.2], abs=1e-9)
    mu, s = family.columns["mu"], family.columns["square.max"] - 1.0
    np.testing.assert_allclose(mu**2 + s**2, 0.04, atol=1e-6)
    assert len(family) < 100


def test_a_family_that_shrinks_onto_a_doubly_degenerate_equilibrium_ends_there():
    """x'' = n x' - x^3 - x^2 x': small orbits x = a u(a t), u'' = -u^3, have n = a^2 <u^2 u'^2>/<u'^2>; nothing bounds
    the period, and no Hopf point is at the end. No row beyond the reach of rounding, and no note."""
    system = Model("case", states={"x": 0.5, "y": 0}, parameters={"n": 0.02},
                   equations={"x": "y", "y": "n*y - x^3 - x^2*y"})  # fmt: skip
    orbit = api.periodic_orbit(system, transient=2000.0)
    family = api.continuation(orbit, "n", (-0.02, 0.03))
    (end,) = [e for e in family.ends if e.reason != "bound"]
    assert end.reason == "degenerate"
    amplitude, n = family.columns["x.max"], family.columns["n"]
    assert 1e-6 < amplitude.min() < 1e-5
    small = (amplitude > 1e-3) & (amplitude < 5e-3)
    means = beta(3 / 4, 3 / 2) / beta(1 / 4, 3 / 2)  # u'^2 = (1 - u^4)/2
    np.testing.assert_allclose(n[small] / amplitude[small] ** 2, means, rtol=3e-6)
    assert not family.notes
    assert len(n) < 400
