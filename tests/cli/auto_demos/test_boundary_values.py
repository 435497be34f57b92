"""Demos of AUTO-07p with boundary values, conditions and manifolds, beside integration."""

from math import cos, exp, pi, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tests.cli.auto_demos.results import branches_of


def test_an_eigenvalue_under_a_condition():
    """u = a sin(k (1 - t)), k = pi p1, with u(0) = p2 and integral(u^2) = a^2 (1/2 - sin(2 k)/(4 k)) = 1/2."""
    columns = branches_of("lin")["eigenvalue"]["columns"]
    assert len(columns["p1"]) > 10
    for p1, p2 in zip(columns["p1"], columns["p2"], strict=True):
        k = pi * p1
        assert p2 == pytest.approx(abs(sin(k)) / sqrt(1 - sin(2 * k) / (2 * k)), abs=1e-6)


def test_a_problem_that_depends_on_the_place_ends_where_its_trajectory_does():
    columns = branches_of("non")["line"]["columns"]
    for row in (len(columns["p1"]) // 2, -1):
        p1 = columns["p1"][row]
        start = [0.0, columns["u2.start"][row]]
        end = solve_ivp(
            lambda x, u, p1=p1: [u[1], -p1 * exp(x**3 * u[0])], (0, 1), start, "DOP853", rtol=1e-11, atol=1e-12
        )
        assert end.y[:, -1] == pytest.approx([0.0, columns["u2.end"][row]], abs=1e-7)


UNSTABLE = {  # rates, radius of the circle and of the sphere
    "um2": (lambda u: [0.1 * u[0] - u[1] ** 3, u[1] + u[0] ** 3], 0.1, 0.6),
    "um3": (lambda u: [0.01 * u[0] - u[1] ** 3 + u[2] ** 3, u[1] + u[0] ** 3, u[0] ** 2 - u[2]], 0.03, 1.0),
}


@pytest.mark.parametrize("name", UNSTABLE)
@pytest.mark.seldom
def test_orbits_of_an_unstable_manifold_reach_the_sphere_when_they_do_by_integration(name):
    """um2, um3: `free: [T]` takes the place of the radius, which was solved for in the runs before."""
    rates, small, large = UNSTABLE[name]
    branches = branches_of(name)
    assert branches["slower"]["free"] == branches["round"]["free"] == ["T"]
    columns, angles = branches["round"]["columns"], [0.3, 1.0, 2.0, 2.9]
    assert {"T", "theta"} <= set(columns)
    for angle in angles:
        row = int(np.argmin(np.abs(np.array(columns["theta"]) - angle)))
        theta, time = columns["theta"][row], columns["T"][row]
        start = [small * cos(theta), small * sin(theta), 0.0][: len(rates([0.1, 0.1, 0.1]))]
        path = solve_ivp(lambda t, u: rates(u), (0, time), start, "DOP853", rtol=1e-12, atol=1e-14)
        assert np.linalg.norm(path.y[:, -1]) == pytest.approx(large, abs=1e-6)


@pytest.mark.seldom
def test_the_stable_manifold_of_lorenz_equations_leads_to_the_origin():
    """man: points of its orbits, integrated forwards, come near the origin."""
    columns = branches_of("man")["ws"]["columns"]
    points = np.array([columns[name] for name in ("x", "y", "z")])
    points = points[:, :: points.shape[1] // 12]

    def lorenz(_, flat):  # all points at once
        x, y, z = flat.reshape(points.shape)
        return np.concatenate([10 * (y - x), 28 * x - y - x * z, x * y - 8 / 3 * z])

    path = solve_ivp(lorenz, (0, 4), points.ravel(), "DOP853", rtol=1e-11, atol=1e-12, max_step=0.01)
    distances = np.linalg.norm(path.y.reshape(*points.shape, -1), axis=0)
    assert np.all(distances.min(axis=1) < 0.05 * distances[:, 0])
    passed = path.t[distances.argmin(axis=1)]
    off = distances.min(axis=1) * np.exp(-11.8277234511634 * passed)  # the unstable eigenvalue, (sqrt(1201) - 11)/2
    assert np.all(off < 1e-9 * distances[:, 0])


@pytest.mark.long
def test_the_optimum_of_three_parameters_is_stationary_by_shooting():
    """obv: the manual names three extrema in one parameter; in three, the cost's gradient vanishes."""
    branches = branches_of("obv")
    assert sum(point["type"] == "EX" for point in branches["one"]["points"]) == 3
    (best,) = [point["values"] for point in branches["three"]["points"] if point["type"] == "EX"]

    def cost(l1, l2, l3):
        rates = lambda t, y: [y[1], -l1 * exp(y[0] + l2 * y[0] ** 2 + l3 * y[0] ** 4), (y[0] - 1) ** 2]  # noqa: E731
        shot = lambda v: solve_ivp(rates, (0, 1), [0, v, 0], "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]  # noqa: E731
        slope = brentq(lambda v: shot(v)[0], 0.97 * best["v.start"], 1.03 * best["v.start"], xtol=1e-13)
        return shot(slope)[2] + (l1 * l1 + l2 * l2 + l3 * l3) / 10

    place = np.array([best["l1"], best["l2"], best["l3"]])
    assert cost(*place) == pytest.approx(best["cost"], abs=1e-10)
    for step in 1e-3 * np.eye(3):
        assert abs(cost(*(place + step)) - cost(*(place - step))) / 2e-3 < 1e-6
