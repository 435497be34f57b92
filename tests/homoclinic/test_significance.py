"""Tests of flips that are zero all along a curve, and those of weak couplings, which only are small."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import contin
from contin.homoclinic.significance import slope_beside
from contin.model.model import Model

A, B = 0.2, 1.4


def loop(rows=200):
    """Times and points of x^2 (1 - x) = y^2: x = 1 - s^2, y = x s, with the time in closed form."""
    s = np.linspace(0.99999, -0.99999, 2001)
    times = np.log(1 - s) / (A + B) - np.log(1 + s) / (B - A) + 2 * A / (B * B - A * A) * np.log(B + A * s)
    even = np.linspace(times[0], times[-1], rows)
    s = np.interp(even, times, s)
    x = 1 - s * s
    return even - even[0], x, x * s


def plane(more=("", "")):
    x = "a*x + b*y - a*x^2 + m*x*(2 - 3*x)"
    return {"x": x + more[0], "y": "b*x + a*y - 1.5*b*x^2 - 1.5*a*x*y - 2*m*y" + more[1]}


def curve_of(model, samples, k):
    rest = dict.fromkeys(model.state_names, 0)
    start = contin.connecting_orbit(model, rest, samples=samples)
    return contin.continuation(start, ("m", "k"), {"m": (-0.1, 0.1), "k": k})


@pytest.mark.seldom
def test_a_flip_is_where_quadrature_says_however_weak_the_coupling_is():
    """Integral of exp(-0.5 t) psi . (x + k y, x^2) = 0 at k = 6.02105263157895 (mpmath, 30 digits)."""
    fields = plane((" + w*z*(x + k*y)", " + w*z*x^2")) | {"z": "-0.5*z"}
    parameters = {"a": A, "b": B, "m": 0, "k": 6.0, "w": 1e-5}
    model = Model("weak", states={"x": 0.6, "y": 0, "z": 0}, parameters=parameters, equations=fields)
    times, x, y = loop()
    found = curve_of(model, (times, np.stack([x, y, 0 * x], axis=1)), (5.99, 6.05))
    assert [p.type for p in found.points] == ["IFS"]
    assert abs(found["IFS1"].values["k"] - 6.02105263157895) <= found["IFS1"].error < 1e-3
    assert found.notes == ()


@pytest.mark.seldom
def test_a_state_that_the_plane_drives_makes_no_inclination_flips_and_no_notes():
    """z acts on nothing, in coordinates that hide it (v = z + x): the adjoint solution has no part in it."""
    fields = plane()
    fields |= {"v": f"({fields['x']}) - 0.5*(v - x) + x - k*x^2"}
    model = Model(
        "driven", states={"x": 0.6, "y": 0, "v": 0}, parameters={"a": A, "b": B, "m": 0, "k": 0.2}, equations=fields
    )
    times, x, y = loop()
    z = np.zeros_like(x)
    for j in range(1, len(x)):  # z' = -z/2 + x - k x^2 by the trapezium rule
        h, f = times[j] - times[j - 1], x - 0.2 * x * x
        z[j] = (z[j - 1] * (1 - h / 4) + h / 2 * (f[j] + f[j - 1])) / (1 + h / 4)
    found = curve_of(model, (times, np.stack([x, y, z + x], axis=1)), (0.1, 0.3))
    assert found.points == ()
    assert found.notes == ()


def probing(values, finer):
    """A curve on which tests have given values: `values`(s), on a finer mesh `finer`(s)."""

    def problem(test):
        probe = lambda near, s, z, frame, settings: SimpleNamespace(tests=np.array([test(s)]))  # noqa: E731
        return SimpleNamespace(probe=probe, refined=lambda near, frame: (problem(finer), near, frame))

    return problem(values)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("values", "finer", "slope"),
    [
        (lambda s: 1e-9 * s, lambda s: 1.01e-9 * s, 1e-9),  # a weak coupling
        (lambda s: 1e-9 * s, lambda s: -1.01e-9 * s, 1e-9),  # an adjoint solution in the other sense
        (lambda s: 1e-9 * s, lambda s: -1e-11 * s, 0.0),  # the mesh
        (lambda s: 1e-9 * np.sin(1e5 * s), lambda s: 1e-9 * np.sin(1e5 * s), 0.0),  # rounding
        (lambda s: 1e-5 * s * s - 1e-12, lambda s: 1e-5 * s * s, 0.0),  # what Newton's method left
        (lambda s: s, lambda s: s, 1.0),
    ],
)
def test_the_slope_of_a_test_is_zero_where_its_values_are_errors(values, finer, slope):
    here = SimpleNamespace(z=np.zeros(1), tangent=np.ones(1))
    frame = SimpleNamespace(scale=np.ones(1))
    assert slope_beside(probing(values, finer), here, frame, 0) == pytest.approx(slope, rel=1e-9, abs=0)
