"""End values much smaller than the function elsewhere are right in their own size, or said not to be."""

import mpmath
import numpy as np
import pytest

import contin

TROESCH = {
    "name": "troesch", "kind": "bvp", "time": {"name": "t", "from": 0, "to": 1}, "states": {"u": 0, "v": 1},
    "parameters": {"mu": 1.0}, "equations": {"u": "v", "v": "mu*sinh(mu*u)"},
    "conditions": ["u(start) = 0", "u(end) = 1"], "starts": {"line": {"u": "t", "v": "1"}},
}  # fmt: skip


def slope_at_start(mu: float) -> float:
    """u'(0) of Troesch's problem: u'^2 = 2 (cosh(mu u) - 1) + u'(0)^2, and the time from 0 to 1 is 1."""
    with mpmath.workdps(30):

        def late(log):
            s = mpmath.exp(log)
            places = [0, s / mu, 5 * s / mu, 1e-6, 1e-4, 1e-2, 0.1, 0.3, 1]
            return mpmath.quad(lambda u: 1 / mpmath.sqrt(4 * mpmath.sinh(mu * u / 2) ** 2 + s * s), places) - 1

        guess = mpmath.log(8) - mu
        return float(mpmath.exp(mpmath.findroot(late, (guess, guess + 0.1), tol=1e-20)))


@pytest.fixture(scope="module")
def troesch():
    start = contin.boundary_problem(contin.load(TROESCH), "line")
    return contin.continuation(start, "mu", (1.0, 20.0), values={"mu": [10.0], "v.start": [1e-6]})


def test_the_slope_at_the_start_of_troesch_is_right_in_its_own_size(troesch):
    assert troesch.notes == ()
    for row in (len(troesch) - 1, troesch["UZ1"].index):  # mu = 20: 1.648773182e-8, beside u'(1) = 22026
        mu, slope = troesch.columns["mu"][row], troesch.columns["v.start"][row]
        assert slope == pytest.approx(slope_at_start(mu), rel=1e-9)


@pytest.mark.seldom
def test_a_user_value_at_a_small_end_holds_to_its_error(troesch):
    point = troesch["UZ2"]
    mu, step = point.values["mu"], 1e-4
    rate = np.log(slope_at_start(mu + step) / slope_at_start(mu - step)) / (2 * step)
    assert abs(np.log(1e-6 / slope_at_start(mu)) / rate) <= point.error < 1e-8


def test_a_mesh_that_is_too_coarse_for_an_end_says_so():
    start = contin.boundary_problem(contin.load(TROESCH), "line")
    branch = contin.continuation(start, "mu", (1.0, 20.0), settings={"intervals": 20})
    (note,) = branch.notes
    assert "than elsewhere it is known to about" in note


def test_an_exponential_tail_is_known_in_its_own_size():
    """u'' = k^2 u, u(0) = 1, u'(1) = -k u(1): u = exp(-k t)."""
    parts = {
        "name": "tail", "kind": "bvp", "time": {"name": "t", "from": 0, "to": 1}, "states": {"u": 1, "v": -1},
        "parameters": {"k": 1.0}, "equations": {"u": "v", "v": "k^2*u"},
        "conditions": ["u(start) = 1", "v(end) = -k*u(end)"],
    }  # fmt: skip
    branch = contin.continuation(contin.boundary_problem(contin.load(parts)), "k", (1.0, 25.0))
    k = branch.columns["k"]
    np.testing.assert_allclose(branch.columns["u.end"] * np.exp(k), 1.0, rtol=1e-6)
    np.testing.assert_allclose(branch.columns["v.end"] * np.exp(k) / k, -1.0, rtol=1e-6)
