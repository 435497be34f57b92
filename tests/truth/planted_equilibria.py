"""Planted equilibria: products of known curves in random coordinates, so that every special point is known exactly.

One equation g(x, p) = 0 is a product of graphs x = c(p); the branch followed is one factor. The other states are
slaved, y_k' = -r_k (y_k - a_k x), and all are mixed by a random matrix of given condition, so that nothing is sparse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

import contin
from tests.truth.ledger import Expected

RANGE = (-0.53, 0.61)


@dataclass(frozen=True)
class Planted:
    """A model, the start on the branch that is followed, and the labels on that branch."""

    name: str
    equations: dict[str, str]
    start: dict[str, float]
    expected: Sequence[Expected]
    range: tuple[float, float] = RANGE
    constants: dict[str, float] = field(default_factory=dict)
    at: float = RANGE[0]  # where the branch starts
    kind: str = "flow"

    def follow(self, **settings: object):
        model = contin.Model(
            "planted", kind=self.kind, states=self.start, parameters={"p": self.at, **self.constants},
            equations=self.equations,
        )  # fmt: skip
        at = {"p": self.at, **self.constants}
        start = contin.equilibrium(model, self.start, at)
        return contin.continuation(start, "p", self.range, settings=settings or None)


def mixed(
    generator: np.random.Generator, equation: str, start: float, condition: float, size: int, rate: float = 1.0
) -> tuple[dict[str, str], dict[str, float]]:
    """x' = equation(x, p), slaves y_k' = -r_k (y_k - a_k x), in coordinates u = M (x, y) with cond M = condition."""
    left, _ = np.linalg.qr(generator.normal(size=(size, size)))
    right, _ = np.linalg.qr(generator.normal(size=(size, size)))
    matrix = left @ np.diag(np.geomspace(1.0, 1.0 / condition, size)) @ right
    inverse = np.linalg.inv(matrix)
    names = [f"u{k}" for k in range(size)]
    inner = [" + ".join(f"({c!r})*{n}" for c, n in zip(map(float, row), names, strict=True)) for row in inverse]
    slopes = [float(v) for v in generator.uniform(-1.0, 1.0, size)]
    rates = [float(v) for v in rate * generator.uniform(1.0, 3.0, size)]
    fields = [equation.replace("X", f"({inner[0]})")]
    fields += [f"-({rates[k]!r})*(({inner[k]}) - ({slopes[k]!r})*({inner[0]}))" for k in range(1, size)]
    equations = {
        names[i]: " + ".join(f"({float(matrix[i, k])!r})*({fields[k]})" for k in range(size)) for i in range(size)
    }
    at = matrix @ np.append(start, [slopes[k] * start for k in range(1, size)])
    return equations, dict(zip(names, map(float, at), strict=True))


def crossings(generator: np.random.Generator, spacing: float, count: int, size: int, condition: float) -> Planted:
    """x (x - a prod(p - r_k)): on x = 0 the other branch crosses at `count` values a `spacing` apart."""
    first = float(generator.uniform(-0.3, 0.3))
    places = [first + spacing * k for k in range(count)]
    product = "*".join(f"(p - ({r!r}))" for r in places)
    equations, start = mixed(generator, f"(-X*(X - 5*{product}))", 0.0, condition, size)
    name = f"{count} crossings {spacing:.0e} apart, n = {size}, condition {condition:.0e}"
    return Planted(name, equations, start, [Expected("BP", r) for r in places])


def hopf_points(generator: np.random.Generator, spacing: float, count: int) -> Planted:
    """(x, y)' = (g(p) +- i) (x, y) - cubic, g = 5 prod(p - r_k)."""
    first = float(generator.uniform(-0.3, 0.3))
    places = [first + spacing * k for k in range(count)]
    growth = "5*" + "*".join(f"(p - ({r!r}))" for r in places)
    omega = float(generator.uniform(0.5, 2.0))
    equations = {
        "x": f"{growth}*x - ({omega})*y - x*(x^2 + y^2)", "y": f"{growth}*y + ({omega})*x - y*(x^2 + y^2)",
    }  # fmt: skip
    expected = [Expected("HB", r) for r in places]
    return Planted(f"{count} Hopf points {spacing:.0e} apart", equations, {"x": 0.0, "y": 0.0}, expected)


def tangency(generator: np.random.Generator, order: int, size: int, condition: float) -> Planted:
    """x (x - a q^m), q = p - r: two branches with contact of order m at q = 0."""
    r, a = float(generator.uniform(-0.2, 0.2)), float(generator.choice([-1.0, 1.0]) * generator.uniform(0.5, 2.0))
    q = f"(p - ({r!r}))"
    equations, start = mixed(generator, f"(-X*(X - ({a!r})*{q}^{order}))", 0.0, condition, size)

    def further(point) -> str:
        kind, contact = point.normal_form.get("kind"), point.normal_form.get("contact")
        return "" if kind == "tangency" and contact in (order, None) else f"{kind} with contact {contact}"

    name = f"tangency of order {order}, n = {size}, condition {condition:.0e}"
    return Planted(name, equations, start, [Expected("BP", r, further)])


def imperfect(generator: np.random.Generator, gap: float, size: int) -> Planted:
    """(x - s)^2 - (p - r)^2 = gap^2: two sheets that do not meet; nothing happens on x > s."""
    r, s = (float(v) for v in generator.uniform(-0.2, 0.2, 2))
    start = float(s + np.hypot(RANGE[0] - r, gap))
    equations, at = mixed(generator, f"(-((X - ({s!r}))^2 - (p - ({r!r}))^2 - {gap!r}^2))", start, 1.0, size)
    return Planted(f"imperfect crossing, gap {gap:.0e}, n = {size}", equations, at, [])


def folds(generator: np.random.Generator, spacing: float, size: int, condition: float) -> Planted:
    """p = r + x^4/4 - e^2 x^2/2: three folds at x = 0, +-e."""
    r, top = float(generator.uniform(-0.4, -0.2)), RANGE[1]
    e2 = spacing**2
    x0 = -np.sqrt(e2 + np.sqrt(e2 * e2 + 4.0 * (top - r)))
    equations, at = mixed(generator, f"(-(p - ({r!r}) - X^4/4 + {e2!r}*X^2/2))", float(x0), condition, size)
    places = [r - e2 * e2 / 4.0, r, r - e2 * e2 / 4.0]
    name = f"three folds {spacing:.0e} apart, n = {size}, condition {condition:.0e}"
    return Planted(name, equations, at, [Expected("LP", q) for q in places], at=top)
