"""Bratu's problem: steady combustion in a slab, by Chebyshev collocation."""

import numpy as np

from contin import FunctionProblem

POINTS = 24  # spectral: the fold is then right to rounding


def second_derivative(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Inner Chebyshev points of (0, 1) and d^2/dx^2 on them for functions that vanish at both ends.

    Trefethen, Spectral Methods in MATLAB, ch. 6 and 7.
    """
    k = np.arange(count + 1)
    x = np.cos(np.pi * k / count)
    weights = np.where((k == 0) | (k == count), 2.0, 1.0) * (-1.0) ** k
    gap = x[:, None] - x[None, :] + np.eye(count + 1)
    first = weights[:, None] / weights[None, :] / gap
    first -= np.diag(first.sum(axis=1))
    return (1 + x[1:-1]) / 2, 4.0 * (first @ first)[1:-1, 1:-1]  # the slab has half the length of [-1, 1]


def model() -> FunctionProblem:
    """u'' + p exp(u) = 0 on (0, 1), u = 0 at both ends; the solutions fold at p = 3.51383."""
    _, laplace = second_derivative(POINTS)
    middle = (POINTS - 1) // 2

    def residual(u, p):
        return laplace @ u + p["p"] * np.exp(u)

    def jacobian(u, p):
        return laplace + np.diag(p["p"] * np.exp(u))

    # u = 2 log(cosh(s)/cosh(s (1 - 2 x))), p = 8 (s/cosh s)^2: the fold is where s tanh s = 1
    s = 1.0
    for _ in range(60):
        s = 1.0 / np.tanh(s)
    return FunctionProblem(
        residual,
        np.zeros(POINTS - 1),
        {"p": 0.0},
        jacobian,
        ranges={"p": (0.0, 4.0)},
        record=lambda u, p: {"middle": u[middle], "norm": float(np.sqrt(np.mean(u**2)))},
        name="bratu",
        title="Bratu's problem in one dimension, by Chebyshev collocation",
        source="G. Bratu, Bull. Soc. Math. France 42 (1914) 113; J. Liouville, J. Math. Pures Appl. 18 (1853) 71",
        expect=[
            {
                "label": "LP",
                "at": {"p": 8 * (s / np.cosh(s)) ** 2, "middle": 2 * np.log(np.cosh(s))},
                "run": {"parameter": "p", "range": [0, 4], "settings": {"steps": 60}},
            }
        ],
    )
