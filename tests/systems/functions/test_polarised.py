"""Forms of analytic functions along complex directions: closed forms, and how many values they take."""

import numpy as np
import pytest

import contin
from contin.systems.functions.derivatives import Lines
from contin.systems.functions.known_lines import Line

A = np.array([[0.7, -1.1, 0.4, 0.3], [1.3, 0.2, -0.6, 0.9], [0.2, 0.5, 1.0, -0.4]])
U, P = np.array([0.4, -1.3, 0.8]), np.array([0.7])


def exponentials(u, p):
    return np.exp(A @ np.append(u, p))


def exact(*directions):
    """D^k exp(a z) = (a d1) ... (a dk) exp(a z)."""
    return np.prod([A @ d for d in directions], axis=0) * exponentials(U, P)


@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_complex_forms_have_their_closed_form(order):
    random = np.random.default_rng(order)
    x, y, r = (random.normal(size=4) + 1j * random.normal(size=4) for _ in range(3))
    lines = Lines(exponentials, np.ones(4), True)
    chosen = [(x,) * order, (x, x.conj(), *(x,) * (order - 2)), (x, 1e3 * y, *(r,) * (order - 2)), (x, y.real, x, x, y)]
    for directions in chosen:
        directions = directions[:order]
        expected = exact(*directions)
        np.testing.assert_allclose(lines.form(U, P, directions), expected, rtol=1e-9 * 20 ** (order - 3), atol=1e-9)


@pytest.mark.parametrize("factor", [1, -1, 1j, -1j])
def test_lines_with_the_same_derivatives_are_one(factor):
    lines = Lines(exponentials, np.ones(4), True)
    for v in (np.array([0.3, -0.2, 0.0, 0.5]), np.array([0.1 - 0.4j, 0.3, 0.2j, 0.0])):
        for w in (factor * v, factor * np.conj(v)):
            np.testing.assert_allclose(lines.pure(U, P, w, 3), exact(w, w, w), rtol=1e-10)
    assert len({Line.along(s * np.array([0.2 + 0.1j, -1.0])).v.tobytes() for s in (1, -1)}) == 1


def test_how_many_values_the_forms_of_a_hopf_point_take():
    """B(q, q), B(q, q*), C(q, q, q*) share three lines, 34 values (they took 117 values)."""
    count = 0

    def residual(u, p):
        nonlocal count
        count += 1
        return exponentials(u, [p["p"]])

    system = contin.FunctionProblem(residual, U, {"p": 0.7}).system()
    q = np.array([0.5, 0.3 - 0.4j, 0.2j, 0.0])
    assert system.lines.analytic
    count = 0
    found = [system.derivative(U, P, *d) for d in ((q, q), (q, q.conj()), (q, q, q.conj()))]
    assert count == 34
    for value, directions in zip(found, ((q, q), (q, q.conj()), (q, q, q.conj())), strict=True):
        np.testing.assert_allclose(value, exact(*directions), rtol=1e-10, atol=1e-11)


def test_a_small_imaginary_part_keeps_its_digits():
    """Next to a Bogdanov-Takens point it is divided by the frequency: it was rounding of the real one."""
    system = contin.FunctionProblem(lambda u, p: exponentials(u, [p["p"]]), U, {"p": 0.7}).system()
    a, b = np.array([0.5, 0.3, 0.2, 0.0]), np.array([0.1, -0.3, 0.7, 0.0])
    for small in (1e-3, 1e-12, 1e-150):
        found = system.derivative(U, P, a + 1j * small * b, a)
        np.testing.assert_allclose(found.imag / small, exact(a, b), rtol=1e-9, atol=1e-10)
