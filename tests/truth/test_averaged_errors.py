"""Labels of averaged models without a closed form lie within their stated errors: quadratures have errors, too.

The averages are known: <exp(-k x^2) sin^2> by Bessel functions I, <cos(k x) sin^2> = J1(k r)/(k r), whose folds are the
zeros of J2. The places are computed by mpmath in 30 digits.
"""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

import contin
from contin.model.model import Model


def slow(force: str, parameters: dict[str, float], form: str) -> Model:
    model = Model(
        "oscillator", states={"x": 1.2, "y": 0}, parameters={"eps": 0.01, **parameters},
        equations={"x": "y", "y": f"-x + eps*({force})"},
        averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
    )  # fmt: skip
    return contin.average(model, form=form, reach=25.0)


def folds(model: Model, form: str, a: float, bounds: tuple[float, float], r: float, **settings) -> list:
    start = {"r": r} if form == "polar" else {"u1": r, "v1": 0.0}
    start = contin.equilibrium(model, start=start, parameters={"a": a})
    line = contin.continuation(start, "a", bounds, settings=settings)
    return [point for point in line.points if point.type == "LP"]


@pytest.mark.parametrize(("form", "k"), [("polar", 1.0), ("cartesian", 0.37)])
@pytest.mark.seldom
def test_folds_of_a_gaussian_damping_are_where_bessel_functions_say(form, k):
    """a r = 2 r <exp(-k x^2) sin^2> + 3/4 c r^3: the fold is the minimum of a over r."""
    c = 1e-4
    model = slow(f"a*y - y*exp(-{k}*x^2) - {c}*y^3", {"a": 0.6}, form)
    with mp.workdps(30):
        parameter = lambda r: (  # noqa: E731
            mp.exp(-k * r * r / 2) * (mp.besseli(0, k * r * r / 2) + mp.besseli(1, k * r * r / 2))
            + mpf(3) / 4 * mpf(c) * r * r
        )
        at = mp.findroot(lambda r: mp.diff(parameter, r), mpf(15))
        exact = parameter(at)
    start = 8.0
    (point,) = folds(model, form, float(parameter(start)), (0.01, 1.0), start, stop_at=("LP",))
    assert abs(mpf(point.values["a"]) - exact) <= point.error
    assert point.error < 1e-9


def test_folds_of_a_cosine_are_at_zeros_of_a_bessel_function():
    """a = 2 J1(s)/s, s = 1.3 r: d/ds (J1/s) = -J2/s."""
    model = slow("a*y - y*cos(1.3*x)", {"a": 0.6}, "polar")
    start = 1.0
    found = folds(model, "polar", float(2 * mpmath.besselj(1, 1.3 * start) / (1.3 * start)), (-1.0, 0.99), start)
    assert len(found) >= 3
    for point in found:
        with mp.workdps(30):
            s = mp.findroot(lambda s: mp.besselj(2, s), mpf(1.3) * mpf(point.values["r"]))
            exact = 2 * mp.besselj(1, s) / s
        assert abs(mpf(point.values["a"]) - exact) <= point.error, float(mpf(point.values["a"]) - exact)
        assert point.error < 1e-9
    assert np.all(np.diff([abs(point.values["a"]) for point in found]) != 0.0)


@pytest.mark.parametrize("method", ["collocation", pytest.param("shooting", marks=pytest.mark.long)])
@pytest.mark.seldom
def test_folds_of_averaged_orbits_are_at_zeros_of_a_bessel_function(method):
    """Detuned, the same averages are orbits: circles whose folds are those of r' above."""
    model = slow("a*y - y*cos(1.3*x) - d*x", {"a": 0.9, "d": 1.0}, "cartesian")
    line = contin.continuation(contin.equilibrium(model, start={"u1": 0, "v1": 0}), "a", (0.8, 1.1))
    family = contin.continuation(line["HB1"].switch(), "a", (-0.5, 1.1), settings={"method": method, "steps": 120})
    assert family.points
    for point in family.points:
        assert point.type == "LPC"
        with mp.workdps(30):
            s = mp.findroot(lambda s: mp.besselj(2, s), mpf(1.3) * mpf(point.orbit.columns["u1"].max()))
            exact = 2 * mp.besselj(1, s) / s
        assert abs(mpf(point.values["a"]) - exact) <= point.error
        assert 1e-12 < point.error < 1e-9, "the quadrature's part"


@pytest.mark.long  # every day: the folds above
@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_cusps_of_averaged_orbits_are_at_zeros_of_a_bessel_function(method):
    """a = 2 J1(s)/s + 3/4 c r^2, s = 1.3 r: by s^2 it is -J2/s^2 + 3 c/(4 1.3^2), and once more J3/(2 s^3)."""
    model = slow("a*y - y*cos(1.3*x) - c*y^3 - d*x", {"a": 0.9, "c": 0, "d": 1.0}, "cartesian")
    settings = {"method": method}
    line = contin.continuation(contin.equilibrium(model, start={"u1": 0, "v1": 0}), "a", (0.8, 1.1))
    family = contin.continuation(line["HB1"].switch(), "a", (-0.5, 1.1), settings={**settings, "stop_at": ("LPC",)})
    bounds = {"a": (-0.5, 0.5), "c": (-0.03, 0.001)}
    curve = contin.continuation(family["LPC1"].locus(), ("a", "c"), bounds, settings=settings)
    assert {point.type for point in curve.points} == {"CPC"}
    for point in curve.points:
        with mp.workdps(30):
            s = mp.findroot(lambda s: mp.besselj(3, s), 1.3 * point.orbit.columns["u1"].max())
            c = 4 * mpf(1.3) ** 2 / 3 * mp.besselj(2, s) / s**2
            exact = 2 * mp.besselj(1, s) / s + mpf(3) / 4 * c * (s / mpf(1.3)) ** 2
        assert abs(mpf(point.values["a"]) - exact) <= point.error
        assert abs(mpf(point.values["c"]) - c) <= point.error
        assert 1e-12 < point.error < 1e-7, "the quadrature's part"
