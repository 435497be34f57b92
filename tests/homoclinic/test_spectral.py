"""Belyakov points, neutral divergence and three leading eigenvalues where the loop and its saddle are known exactly.

The plane has the loop x^2 (1 - x) = y^2 for mu = 0 and every a, b, with eigenvalues a +- b at the saddle (Sandstede's
system); z and w are a linear block with eigenvalues -c +- sqrt(q), which the loop does not enter.
"""

import numpy as np
import pytest

import contin

T = np.linspace(-30, 30, 4001)


def system(sense: int) -> contin.Model:
    f = {
        "x": "a*x + b*y - a*x^2 + mu*x*(2 - 3*x)",
        "y": "b*x + a*y - 1.5*b*x^2 - 1.5*a*x*y - 2*mu*y",
        "z": "-c*z + w",
        "w": "q*z - c*w",
    }
    return contin.Model(
        "block", states={"x": 0, "y": 0, "z": 0, "w": 0}, parameters={"mu": 0, "c": 0.3, "q": -1, "a": -0.5, "b": 1},
        equations={name: f"{sense}*({text})" for name, text in f.items()},
    )  # fmt: skip


def loop(sense: int):
    """x = 1 - tanh^2(t/2) (b = 1; a turns the orbit's own clock into t)."""
    s = np.linspace(-14, 14, 3000)  # x = sech^2(s/2), y = x tanh: dx/dt = a x (1 - x) + b y
    x = 1 / np.cosh(s / 2) ** 2
    y = -x * np.tanh(s / 2)
    rate = -0.5 * x * (1 - x) + y  # dx/dt
    slope = -x * np.tanh(s / 2)  # dx/ds
    inside = np.abs(slope) > 1e-9
    clock = np.interp(s, s[inside], (rate / np.where(inside, slope, 1.0))[inside])  # ds/dt
    t = np.concatenate([[0], np.cumsum(0.5 * (1 / clock[1:] + 1 / clock[:-1]) * np.diff(s))])
    u = np.column_stack([x, y, 0 * x, 0 * x])
    return (t, u) if sense > 0 else (t, u[::-1])


@pytest.mark.parametrize(
    ("sense", "second", "bounds", "fixed", "expected"),
    [
        (1, "c", (0.2, 2.0), {}, {"NDS": 0.25, "NSF": 0.5, "TLS": 1.5}),
        pytest.param(-1, "c", (0.2, 2.0), {}, {"NDU": 0.25, "NSF": 0.5, "TLU": 1.5}, marks=pytest.mark.long),
        (1, "q", (-0.3, 0.05), {"c": 0.3, "q": -0.2}, {"DRS": 0.0}),
        (-1, "q", (-0.3, 0.05), {"c": 0.3, "q": -0.2}, {"DRU": 0.0}),
    ],
)
@pytest.mark.seldom
def test_points_stand_where_the_eigenvalues_say(sense, second, bounds, fixed, expected):
    model, p = system(sense), {"c": 0.3, **fixed}
    start = contin.connection(model, {"x": 0}, parameters=p, samples=loop(sense), truncation=1e-4)
    box, settings = {"mu": (-0.5, 0.5), second: bounds}, {"step": 0.3, "max_step": 2.0}
    branch = contin.continuation(start, ("mu", second), box, settings=settings)
    found = {point.type: point.values[second] for point in branch.points}
    assert found.keys() == expected.keys()
    for code, value in expected.items():
        assert found[code] == pytest.approx(value, abs=1e-6)
    assert np.abs(branch.columns["mu"]).max() < 1e-7
