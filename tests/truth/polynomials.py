"""Random polynomial systems whose solutions and folds are counted independently, by elimination.

n = 1: x' = g(x, p); n = 2: x' = g(x, p) + x y/4 + y/8 and y' = a x^2 + b p x - 2 y, from which y is eliminated. With
rational coefficients all real roots in x at a value of p, and all roots in p of the discriminant, where two of them may
meet, are isolated exactly (sympy's `real_roots`).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import sympy

RANGE = (-1.0, 1.0)


@dataclass(frozen=True)
class Polynomial:
    """Equations with coefficients that are exact in binary; the solutions' x at p are the roots of one polynomial."""

    equations: dict[str, str]
    eliminant: sympy.Expr  # in x and p
    second: sympy.Expr  # y of a solution, in x and p

    def within(self, roots: np.ndarray, p: float, size: float) -> np.ndarray:
        """Those of the x at p that belong to solutions in the box |x|, |y| <= size, clear of its edge."""
        y = np.broadcast_to(sympy.lambdify(sympy.symbols("x p"), self.second)(roots, p), roots.shape)
        return np.asarray(roots[np.maximum(np.abs(roots), np.abs(y)) < 0.99 * size])

    def roots(self, p: float) -> np.ndarray:
        """The real x at p, ascending."""
        x, q = sympy.symbols("x p")
        exact = sympy.Poly(self.eliminant.subs(q, sympy.Rational(p)), x)
        return np.array(sorted(float(r) for r in sympy.real_roots(exact)))

    def singular(self) -> list[float]:
        """The p in the range, ends included, at which the eliminant has a repeated root or loses degree."""
        x, q = sympy.symbols("x p")
        discriminant = sympy.Poly(sympy.discriminant(self.eliminant, x), q)
        return [float(r) for r in sympy.real_roots(discriminant) if abs(float(r)) <= RANGE[1] * (1.0 + 1e-12)]


def _coefficient(generator: np.random.Generator) -> Fraction:
    return Fraction(int(generator.integers(-16, 17)), 8)


def random_polynomial(generator: np.random.Generator, n: int, degree: int) -> Polynomial:
    """n = 1 or 2 equations; the leading coefficient is fixed, so that no root goes to infinity within the range."""
    x, y, p = sympy.symbols("x y p")
    powers = [(i, j) for i in range(degree) for j in range(2) if i + j <= degree]
    g = sum(
        (sympy.Rational(c.numerator, c.denominator) * x**i * p**j
         for i, j in powers for c in [_coefficient(generator)]), sympy.Integer(0),
    ) - x**degree  # fmt: skip
    if n == 1:
        return Polynomial({"x": _text(g)}, g, sympy.Integer(0))
    a, b = (sympy.Rational(c.numerator, c.denominator) for c in (_coefficient(generator), _coefficient(generator)))
    second = a * x**2 + b * p * x - 2 * y
    first = g + sympy.Rational(1, 4) * y * x + sympy.Rational(1, 8) * y
    of_x = (a * x**2 + b * p * x) / 2
    return Polynomial({"x": _text(first), "y": _text(second)}, sympy.expand(first.subs(y, of_x)), of_x)


def _text(expression: sympy.Expr) -> str:
    return str(sympy.expand(expression)).replace("**", "^")
