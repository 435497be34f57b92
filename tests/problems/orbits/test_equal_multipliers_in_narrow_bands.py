"""Equal multipliers that run through the unit circle in narrow bands: Mathieu's equation, twice, beside a forced orbit.

u'' + c u' + (d + q cos t) u + u^3 = 0: at u = 0 the multipliers have the product e^(-2 pi c), and pass 1 and -1 where
their sum, of one integration, is +-(1 + e^(-2 pi c)). Between bands, which are 5e-4 and more wide, they are up to 50.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contin

C, Q = 0.3, 4.0


def trace(d: float) -> float:
    def right(t, y):
        stiffness = d + Q * np.cos(t)
        return [y[1], -C * y[1] - stiffness * y[0], y[3], -C * y[3] - stiffness * y[2]]

    end = solve_ivp(right, (0, 2 * np.pi), [1, 0, 0, 1], method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    return float(end[0] + end[3])


def passage(side: int, low: float, high: float) -> float:
    """Where a multiplier is 1 or -1."""
    return brentq(lambda d: trace(d) - side * (1 + np.exp(-2 * np.pi * C)), low, high, xtol=1e-12)


def model(d: float, further: str = "") -> contin.Model:
    """Two equations; with `further` two more, at that value of d."""
    states, equations = {"w": 0.5}, {"w": "-w + cos(t)"}
    for k, value in enumerate(["d", "d", *([further] * 2 if further else [])]):
        states |= {f"u{k}": {"value": 0.0, "scale": 1.0}, f"v{k}": {"value": 0.0, "scale": 1.0}}
        equations |= {f"u{k}": f"v{k}", f"v{k}": f"-{C}*v{k} - ({value} + {Q}*cos(t))*u{k} - u{k}^3"}
    return contin.Model(
        "bands", states=states, parameters={"d": d}, equations=equations, forcing={"period": "2*pi"}
    )  # fmt: skip


def test_a_band_that_lies_within_one_step_is_a_note():
    low, high = passage(1, -2.6294, -2.6291), passage(-1, -2.6289, -2.6286)
    orbit = contin.periodic_orbit(model(-2.75))
    branch = contin.continuation(orbit, "d", (-2.75, -2.5), settings={"step": 0.05, "min_step": 0.04})
    assert not any(branch.columns["d"][0] < p.values["d"] < branch.columns["d"][-1] for p in branch.points)
    (note,) = (n for n in branch.notes if "pass 1 and -1 within one step" in n)
    row = int(np.searchsorted(branch.columns["d"], low))
    assert branch.columns["d"][row] > high
    assert f"between d = {branch.columns['d'][row - 1]:.10g} and {branch.columns['d'][row]:.10g}" in note
    assert branch.unexplained


@pytest.mark.parametrize("further", ["", "-1.0"])
def test_what_passes_1_is_no_period_doubling(further):
    """Out of a band downwards two multipliers pass zero and then 1; with `further` two others are beyond -1."""
    exact = {"BPC": passage(1, -2.6294, -2.6291), "PD": passage(-1, -2.6289, -2.6286)}
    orbit = contin.periodic_orbit(model(-2.6288, further))
    branch = contin.continuation(orbit, "d", (-2.7, -2.6), settings={"step": 0.05})
    assert [p.type for p in branch.points] == ["BPC", "PD"]
    for point in branch.points:
        assert abs(point.values["d"] - exact[point.type]) <= point.error < 1e-6
        assert point.residual < 1e-2
        side = 1.0 if point.type == "BPC" else -1.0
        assert np.sum(np.abs(np.asarray(point.eigenvalues) - side) < 1e-2) == 2
