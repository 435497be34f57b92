"""Closed averages of quotients of polynomials at small amplitudes, against the trapezoidal rule."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

import contin
from contin.lowering import compile_system
from contin.model.evaluate import evaluate
from contin.model.parser import parse
from contin.symbolic.calculus.remove_singularities import remove_singularities

FORCES = {  # whose denominators have complex roots: partial fractions cancel to several orders where r is small
    "x^2*y/(1 + x^4)": lambda x, y: x * x * y / (1 + x**4),
    "x^4*y/(1 + x^6)": lambda x, y: x**4 * y / (1 + x**6),
    "y^5/(1 + 2*y^2 + 3*y^4)": lambda x, y: y**5 / (1 + 2 * y * y + 3 * y**4),
    "y^3/(2 - y^2 + y^4)": lambda x, y: y**3 / (2 - y * y + y**4),
    "y/(1 + x^2 + x^4)": lambda x, y: y / (1 + x * x + x**4),
    "x^6*y/(1 + x^8)": lambda x, y: x**6 * y / (1 + x**8),
}


@pytest.mark.parametrize("force", FORCES)
@pytest.mark.seldom
def test_averages_keep_their_digits_where_the_amplitude_is_small(force):
    model = contin.load({
        "contin": 1, "name": "one", "states": {"x": 1.0, "y": 0}, "parameters": {"alpha": 0.0, "eps": 0.01},
        "equations": {"x": "y", "y": f"-x + eps*(-alpha*y + {force})"},
        "averaging": {"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
    })  # fmt: skip
    system = compile_system(contin.average(model, form="polar"))
    phases = 2 * np.pi * np.arange(128) / 128
    cos, sin = np.cos(phases), np.sin(phases)

    def average(r):
        return -float(np.mean(FORCES[force](r * cos, -r * sin) * sin))

    for r in 0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9:
        value, slopes = system.jacobian(np.array([r]), np.array([0.0, 0.01]))
        assert value[0] == pytest.approx(average(r), abs=2e-15 * r, rel=0)  # moves alpha by a rounding error
        difference = (average(1.001 * r) - average(0.999 * r)) / (0.002 * r)
        assert slopes[0, 0] == pytest.approx(difference, rel=1e-4, abs=1e-12)


ROOTS = {
    "sqrt(sqrt(r^4 + 1) - 1)": lambda m, r, a: m.sqrt(m.sqrt(r**4 + 1) - 1),
    "sqrt(3*sqrt(4 + a*r^2) - 6)": lambda m, r, a: m.sqrt(3 * m.sqrt(4 + a * r * r) - 6),
    "sqrt(sqrt(1 + a*r^3) - 1)": lambda m, r, a: m.sqrt(m.sqrt(1 + a * r**3) - 1),
}


@pytest.mark.fast
@pytest.mark.parametrize("text", ROOTS)
def test_roots_of_differences_of_roots_lose_no_digits(text):
    (regular,) = remove_singularities([parse(text, ["r", "a"])])
    exact = mpmath.mp.clone()
    exact.dps = 60
    for r in 1.0, 1e-2, 1e-5, 1e-9:
        reference = float(ROOTS[text](exact, exact.mpf(r), exact.mpf(2)))
        assert evaluate(regular, {"r": r, "a": 2.0}) == pytest.approx(reference, rel=1e-14)
