"""Curves of special orbits under conditions, of branch points of cycles in three parameters, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.model.model import Model

COARSE = {"intervals": 8, "max_step": 0.3}  # the orbits are circles


def circles(rate, speed, parameters):
    """r' = r rate(w), theta' = speed(w), w = r^2."""
    rate, speed = (text.replace("w", "(x^2 + y^2)") for text in (rate, speed))
    equations = {"x": f"x*({rate}) - y*({speed})", "y": f"x*({speed}) + y*({rate})"}
    return Model("m", states={"x": 1, "y": 0}, parameters=parameters, equations=equations)


def test_folds_of_cycles_of_one_period():
    """r' = r (m + b w - w^2): folds at m = -b^2/4, w = b/2; the period is 2 pi / (om + g w)."""
    model = circles("m + b*w - w^2", "om + g*w", {"m": 0.5, "b": 2, "om": 1, "g": 0.3})
    orbit = contin.periodic_orbit(model, {"x": 1.5, "y": 0}, intervals=8)
    family = contin.continuation(orbit, "m", (-1.5, 0.6), direction="down", settings=COARSE)
    found = contin.continuation(
        family["LPC1"].locus(("m", "b")), ("m", "b"), {"m": (-3, 1), "b": (1.7, 2.3)}, conditions=["period = 5"],
        free=["om"], settings=COARSE,
    )  # fmt: skip
    m, b, om = (found.columns[name] for name in ("m", "b", "om"))
    assert np.allclose(m, -(b**2) / 4, atol=1e-9)
    assert np.allclose(om + 0.3 * b / 2, 2 * np.pi / 5, atol=1e-9)
    assert np.allclose(found.columns["period"], 5.0, atol=1e-10)
    assert np.allclose(found.columns["x.max"], np.sqrt(b / 2), atol=1e-6)
    assert (found.locus, found.parameters, found.free) == ("LPC", ("m", "b"), ("om",))
    assert np.ptp(b) > 0.59


def test_period_doublings_of_forced_orbits_with_one_mean_square():
    """(p, q) = s (cos t, sin t) + R(t/2) (a, c), a' = (m + k) a - .., c' = -c - ..: doubled at m + k = 0."""
    big, small = "(p - s*cos(t))", "(q - s*sin(t))"
    mean, half = "((m + k - 1)/2)", "((m + k + 1)/2)"
    size = f"({big}^2 + {small}^2)"
    equations = {
        "p": f"-s*sin(t) + {mean}*{big} + {half}*(cos(t)*{big} + sin(t)*{small}) - {small}/2 - {big}*{size}",
        "q": f"s*cos(t) + {mean}*{small} + {half}*(sin(t)*{big} - cos(t)*{small}) + {big}/2 - {small}*{size}",
    }
    model = Model(
        "m", states={"p": 1, "q": 0}, parameters={"m": -0.6, "k": 0.1, "s": 1}, equations=equations,
        forcing={"period": "2*pi"},
    )  # fmt: skip
    orbit = contin.periodic_orbit(model, {"p": 1, "q": 0}, intervals=12)
    family = contin.continuation(orbit, "m", (-0.7, 0.3), direction="up", settings={"max_step": 0.3})
    found = contin.continuation(
        family["PD1"].locus(("m", "k")), ("m", "k"), {"m": (-0.3, 0.1), "k": (-1, 1)},
        conditions=["mean(p^2) = m + 1"], free=["s"], settings={"max_step": 0.3},
    )  # fmt: skip
    m, k, s = (found.columns[name] for name in ("m", "k", "s"))
    assert np.allclose(m, -k, atol=1e-6)
    assert np.allclose(s**2 / 2, m + 1, atol=1e-6)
    assert np.ptp(m) > 0.39


def test_branch_points_of_cycles_in_three_parameters():
    """(w - s)(p - w - s) + q - s^2 = 0 for w = r^2: families in p cross at p = 2 s, w = s, q = s^2."""
    model = circles("(w - s)*(p - w - s) + q - s^2", "1 + w", {"p": 1, "q": 0.25, "s": 0.5})
    orbit = contin.periodic_orbit(model, {"x": 1.2, "y": 0}, {"p": 1.9}, intervals=8)
    family = contin.continuation(orbit, "p", (0.7, 2), direction="down", settings=COARSE)
    names = ("p", "q", "s")
    found = contin.continuation(
        family["BPC1"].locus(names), names, {"p": (0.6, 2), "q": (0, 2), "s": (0.4, 0.6)}, settings=COARSE
    )
    s = found.columns["s"]
    assert np.allclose(found.columns["p"], 2 * s, atol=1e-7)
    assert np.allclose(found.columns["q"], s**2, atol=1e-7)
    assert np.allclose(found.columns["x.max"] ** 2, s, atol=1e-6)
    assert np.ptp(s) > 0.19
    assert found.locus == "BPC"


@pytest.mark.seldom
def test_extrema_of_the_period():
    """r' = r (m - w), theta' = 1 + (m - k)^2 + (k - 1)^2: the period is longest at m = k, then at k = 1."""
    model = circles("m - w", "1 + (m - k)^2 + (k - 1)^2", {"m": 0.5, "k": 0.8})
    orbit = contin.periodic_orbit(model, {"x": 0.7, "y": 0}, intervals=16)
    finer = COARSE | {"intervals": 16}
    family = contin.continuation(orbit, "m", (0.5, 1.2), direction="up", settings=finer, extrema=["period"])
    found = contin.continuation(
        family["EX1"].locus(("m", "k")), ("m", "k"), {"m": (0.4, 1.5), "k": (0.75, 1.1)}, extrema=["period"],
        settings=COARSE | {"step": 0.05, "max_step": 0.2},
    )  # fmt: skip
    assert np.allclose(found.columns["m"], found.columns["k"], atol=1e-7)
    assert np.ptp(found.columns["k"]) > 0.34
    assert found.multiplier_kind
    best = found["EX1"]
    assert abs(best.values["k"] - 1.0) < 1e-6
    assert abs(best.values["period"] - 2 * np.pi) < 1e-9
