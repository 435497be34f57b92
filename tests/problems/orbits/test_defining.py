"""Newton on the defining systems of special orbits: closed forms, null vectors by a second method, effort."""

from unittest import mock

import numpy as np
import pytest

from contin.lowering import compile_system
from contin.model.model import Model
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.linearised import bordered
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.special_orbits import defining
from contin.problems.orbits.special_orbits.held_parameter import HeldCurve

BAND = {  # X' = p X - X^3, Y' = -Y beside the circle r = 1, in axes that turn by half of the angle
    "r": "sqrt(x^2 + y^2)", "R": "r - 1", "co": "x/r", "si": "y/r",
    "cc": "(1 + co)/2", "ss": "(1 - co)/2", "cs": "si/2",
    "g": "p - R^2*cc - 2*R*z*cs - z^2*ss", "dR": "g*(R*cc + z*cs) + z*cs - R*ss - z/2",
    "dz": "g*(R*cs + z*ss) - z*cc + R*cs + R/2",
}  # fmt: skip
CIRCLE = {"x": "(1 - x^2 - y^2)*x - y", "y": "x + (1 - x^2 - y^2)*y"}
CASES = {  # equations, definitions; radius, period, parameter and angle of the special orbit
    "LPC": ({"x": "(p + s - s^2)*x - (1 + s)*y", "y": "(1 + s)*x + (p + s - s^2)*y"}, {"s": "x^2 + y^2"},
            np.sqrt(0.5), 4 * np.pi / 3, -0.25, 0.0),
    "BPC": ({**CIRCLE, "z": f"p*w - w^3 + {CIRCLE['x']}"}, {"w": "z - x"}, 1.0, 2 * np.pi, 0.0, 0.0),
    "PD": ({"x": "dR*co - y", "y": "dR*si + x", "z": "dz"}, BAND, 1.0, 2 * np.pi, 0.0, 0.0),
    "NS": ({**CIRCLE, "u": "p*u - 0.3*v", "v": "0.3*u + p*v"}, {}, 1.0, 2 * np.pi, 0.0, 0.6 * np.pi),
}  # fmt: skip


def special(type_, off):
    """(problem, z, scale) of the special orbit, with everything off by this much."""
    equations, definitions, radius, period, parameter, _ = CASES[type_]
    model = Model(
        "special", states=dict.fromkeys(equations, 0), parameters={"p": 0}, definitions=definitions, equations=equations
    )
    system = compile_system(model)
    n, h = len(equations), np.full(15, 1 / 15)
    angles = 2 * np.pi * Profile(4, np.zeros((61, n)), 1.0, h, 0.0).times
    u = np.zeros((61, n))
    u[:, 0], u[:, 1] = radius * np.cos(angles), radius * np.sin(angles)
    u[:, 2:] += u[:, :1] * (type_ == "BPC") + off
    u *= 1 + off * np.cos(3 * angles)[:, None]
    problem = OrbitProblem(system, np.zeros(system.p_size), 0, np.zeros(n), 4)
    z = Profile(4, u, period * (1 + off), h, parameter + off).vector()
    scale = problem.initial_scale(z, (-1.0, 1.0))
    return problem, z, scale


@pytest.mark.parametrize("type_", CASES)
def test_special_orbit_is_found_from_beside_it(type_):
    """By at most 12 linearisations on two meshes (measured: 10 and 11), and no sparse factors."""
    problem, z, scale = special(type_, 0.01)
    *_, period, parameter, angle = CASES[type_]
    with (
        mock.patch.object(HeldCurve, "step", autospec=True, side_effect=HeldCurve.step) as steps,
        mock.patch.object(bordered.Bordered, "with_borders", side_effect=AssertionError),
    ):
        found = defining.solve_special(problem, type_, z, scale, angle)
    assert steps.call_count <= 12
    assert found.confirmed
    assert abs(found.z[-1] - parameter) <= max(found.error, 1e-13)
    assert found.error < 1e-7
    assert problem.profile(found.z).period == pytest.approx(period, rel=1e-7)
    assert found.theta == pytest.approx(angle, abs=1e-7)
    assert found.residual < 1e-12


@pytest.mark.parametrize("type_", ["LPC", "BPC", "PD"])
def test_null_vectors_are_those_of_the_sparse_matrices(type_):
    problem, z, scale = special(type_, 0.003)
    found = defining.solve_special(problem, type_, z, scale, CASES[type_][-1])
    linear = OrbitLinear(problem, found.z, scale, found.z)
    matrix = {
        "LPC": lambda: linear.jacobian[:, :-1],
        "BPC": lambda: linear.jacobian,
        "PD": lambda: linear.variational(-1.0),
    }[type_]()
    assert found.right.shape == (matrix.shape[1], 2 if type_ == "BPC" else 1)
    assert np.linalg.matrix_rank(found.right) == found.right.shape[1]
    np.testing.assert_allclose(matrix @ found.right, 0.0, atol=1e-9 * np.abs(found.right).max())


def test_no_special_orbit_is_found_where_there_is_none():
    """w' = -(1 + p^2) w beside the circle: its multiplier is below exp(-2 pi) for every p."""
    equations = {**CIRCLE, "z": f"-(1 + p^2)*(z - x) + {CIRCLE['x']}"}
    with mock.patch.dict(CASES, {"BPC": (equations, {}, 1.0, 2 * np.pi, 0.0, 0.0)}):
        problem, z, scale = special("BPC", 0.01)
    assert defining.solve_special(problem, "BPC", z, scale) is None
    assert defining.solve_special(problem, "PD", z, scale) is None


@pytest.mark.parametrize("type_", ["LPC", "PD"])
def test_a_correction_that_fails_gives_no_step_made_of_what_the_one_before_left(type_):
    problem, z, scale = special(type_, 0.003)
    curve = HeldCurve.of(type_, problem)
    metric = curve.join(scale, float(scale[-1]), 1.0)
    x = curve.join(z, float(z[-1]), 0.0)
    assert curve.step(x, metric) is not None
    x[: curve.nodes(x)] = np.nan
    assert curve.step(x, metric) is None
