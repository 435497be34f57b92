"""Inclination and orbit flips of Sandstede's model: published places, and the adjoint equation integrated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contin
from contin import api
from contin.homoclinic.equations import ConnectionCurve
from contin.homoclinic.flips import component, ends_of_orbit
from contin.homoclinic.solved_connection import solved_connection
from contin.homoclinic.subspaces import Leading
from contin.model.model import Model
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.layout import Profile, node_times

PARAMETERS = {"a": 0.25, "b": 1, "c": -2, "alpha": 0.5, "beta": 1, "mu": 0, "m": 1e-4}


def sandstede(sign=1, **values):
    """(3.9) of Sandstede, J. Dynam. Differential Equations 9 (1997) 269, the demo `san` of AUTO-07p; m is its mu~.

    Saddle 0 with eigenvalues a + b, a - b, c for mu = m = 0; there x^2 (1 - x) = y^2, z = 0 is a homoclinic orbit.
    """
    fields = {
        "x": "a*x + b*y - a*x^2 + (m - alpha*z)*x*(2 - 3*x)",
        "y": "b*x + a*y - 1.5*b*x^2 - 1.5*a*x*y - (m - alpha*z)*2*y",
        "z": "c*z + mu*x + alpha*beta*(x^2*(1 - x) - y^2)",
    }
    return Model(
        "sandstede", states={"x": 0.6, "y": 0, "z": 0}, parameters=PARAMETERS | values,
        equations={name: f"{sign}*({f})" for name, f in fields.items()},
    )  # fmt: skip


def leading_part(alpha, half=9.0):
    """Of the adjoint solution that decays in both senses, the part that decays like exp(0.75 t) as t -> -infinity.

    phi' = -A(t)^T phi along the planar loop: the solution that ends in the left unstable eigenvector is met at t = 0 by
    the two that begin in the left stable ones. (All are normal to u' there: two vectors span them.)
    """
    a, b, c = 0.25, 1.0, -2.0
    unstable, strong, weak = a + b, c, a - b

    def loop(s, u):
        x, y = u
        return [a * x + b * y - a * x**2, b * x + a * y - 1.5 * b * x**2 - 1.5 * a * x * y]

    def matrix(x, y):
        return np.array([
            [a - 2 * a * x, b, -alpha * x * (2 - 3 * x)],
            [b - 3 * b * x - 1.5 * a * y, a - 1.5 * a * x, 2 * alpha * y],
            [alpha * (2 * x - 3 * x**2), -2 * alpha * y, c],
        ])  # fmt: skip

    accurate = {"rtol": 1e-12, "atol": 1e-14, "dense_output": True, "method": "DOP853"}
    ahead = solve_ivp(loop, (0, half), [1.0, 0.0], **accurate).sol
    back = solve_ivp(loop, (0, -half), [1.0, 0.0], **accurate).sol

    def adjoint(s, phi):
        return -matrix(*(ahead if s > 0 else back)(s)).T @ phi

    values, left = np.linalg.eig(matrix(0, 0).T)
    start = np.real(left[:, int(np.argmin(abs(values - unstable)))])
    middle = solve_ivp(adjoint, (half, 0), start, **accurate).y[:, -1]
    weakly, strongly = (np.real(left[:, int(np.argmin(abs(values - v)))]) for v in (weak, strong))
    ends = [solve_ivp(adjoint, (-half, 0), w, **accurate).y[:, -1] for w in (weakly, strongly)]
    ends = [w / np.linalg.norm(w) for w in ends]
    parts, residual, *_ = np.linalg.lstsq(np.column_stack(ends), middle, rcond=None)
    assert float(residual[0]) < 1e-10 * float(middle @ middle)
    return float(parts[0])


@pytest.fixture(scope="module")
def loops():
    start = contin.connecting_orbit(sandstede(), {"x": 0, "y": 0, "z": 0})
    return contin.continuation(start, ("m", "alpha"), {"m": (-0.5, 0.5), "alpha": (0.4, 2)})


@pytest.mark.seldom
def test_the_inclination_flip_of_sandstedes_model_is_where_auto_finds_it(loops):
    """AUTO-07p, demo `san`, run 3, label 7: alpha = 1.230857."""
    np.testing.assert_allclose(loops.columns["m"], 0, atol=1e-10)
    assert [p.type for p in loops.points] == ["IFS", "IFS"]
    assert loops["IFS1"].values["alpha"] == pytest.approx(1.230857, abs=1e-6)
    assert loops["IFS1"].error < 1e-8


def test_inclination_flips_are_where_the_adjoint_solution_loses_its_leading_part(loops):
    assert len(loops.points) == 2
    for p in loops.points:
        alpha = p.values["alpha"]
        below, above = leading_part(alpha - 1e-5), leading_part(alpha + 1e-5)
        zero = alpha - 1e-5 + 2e-5 * below / (below - above)
        assert zero == pytest.approx(alpha, abs=1e-7)


@pytest.mark.seldom
def test_orbit_flip_where_the_loop_is_planar():
    """AUTO-07p, demo `san`, run 11: with beta = 0, a = 1/2, b = 3 the loop flips at mu = m = 0, leading rate -2."""
    model = sandstede(a=0.5, b=3, alpha=1, beta=0, mu=0.25, m=0.06)
    start = contin.connecting_orbit(model, {"x": 0, "y": 0, "z": 0})
    loops = contin.continuation(start, ("m", "mu"), {"m": (-0.5, 0.5), "mu": (-0.2, 0.3)})
    assert [p.type for p in loops.points] == ["OFS"]
    assert loops["OFS1"].values["mu"] == pytest.approx(0, abs=1e-9)
    assert loops["OFS1"].values["m"] == pytest.approx(0, abs=1e-9)
    assert loops["OFS1"].error < 1e-8


@pytest.mark.seldom
def test_in_reversed_time_the_flip_is_on_the_unstable_side():
    plane = ("m", "alpha")
    (forwards,) = contin.connecting_orbit(sandstede(), {"x": 0, "y": 0, "z": 0}).locus(plane)
    curve = forwards.problem.curve
    profile = curve.profile(forwards.z)
    system = api.compiled(sandstede(-1))
    orbits = OrbitProblem(system, curve.full_parameters(forwards.z), curve.first, np.zeros(3), 4)
    reversed_curve = ConnectionCurve(orbits, curve.second, 1, curve.unstable_count, curve.stable_count)
    arc = replace(profile, u=profile.u[::-1].copy(), h=profile.h[::-1].copy())
    seed = solved_connection(reversed_curve, arc, curve.equilibria(forwards.z), 0.5, None)
    loops = contin.continuation(seed, plane, {"m": (-0.5, 0.5), "alpha": (0.4, 1.5)})
    assert [p.type for p in loops.points] == ["IFU"]
    assert loops["IFU1"].values["alpha"] == pytest.approx(1.230857, abs=1e-6)


@pytest.mark.fast
@pytest.mark.parametrize("length", [4.0, 9.0, 25.0])
def test_the_test_of_a_flip_does_not_depend_on_where_the_orbit_is_cut(length):
    """x = (c e^-|t|, e^-3|t|), largest at t = 0: the test is c / sqrt(1 + c^2) (the cosine is 1 but for 1e-18)."""
    c, h = 1e-3, np.full(20, 0.05)
    times = length * (2.0 * node_times(h, 4) - 1.0)
    decay = np.exp(-np.abs(times))
    profile = Profile(4, np.stack([c * decay, decay * decay * decay], axis=1), 2 * length, h, 0.0)
    _, home = ends_of_orbit(profile, (np.zeros(2), np.zeros(2)), np.ones(2))
    slow = Leading(-1.0 + 0j, np.array([1.0, 0.0]), np.array([1.0, 0.0]))
    assert component({}, "OFS", slow, slow.left, home) == pytest.approx(c / np.sqrt(1 + c * c), rel=1e-12)


def test_which_of_two_loops_is_the_larger_one_by_rounding_does_not_matter():
    h = np.full(80, 1.0 / 80)
    times = 40.0 * node_times(h, 4)

    def ends(share):
        u = np.exp(-np.abs(times - 12.0)) + share * np.exp(-np.abs(times - 28.0))
        profile = Profile(4, u[:, None], 40.0, h, 0.0)
        return ends_of_orbit(profile, (np.zeros(1), np.zeros(1)), np.ones(1))

    for one, other in zip(ends(1.0 - 1e-9), ends(1.0 + 1e-9), strict=True):
        assert one.time == pytest.approx(other.time, rel=1e-12)
        assert one.vector * np.exp(one.time) == pytest.approx(1.0, rel=1e-2)  # the loop's own
