"""Continuous symmetries of the plainest kind: directions v with f(x + s v, p) = f(x, p) for all x, p and s.

They are right null vectors of the Jacobian everywhere, as conserved quantities are left ones (a map: of DF - 1). Phases
that enter by their differences alone are the common case. Equilibria then come in lines, and where the phases run, the
states that seem to rest are relative equilibria. They are named, not divided out: that takes new coordinates.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import ContinError
from contin.model.expression import add, mul, number, sub, substitute, symbol
from contin.model.model import Model
from contin.model.parts import TIME
from contin.symbolic.calculus.derivatives import sparse_jacobian
from contin.symbolic.calculus.echelon import echelon, fractions
from contin.symbolic.calculus.monomials import Monomials
from contin.symbolic.calculus.sampling import sample
from contin.symbolic.passes.conserved_laws import rates_of

LARGEST: Final = 60  # states
POINTS: Final = 8
NOTHING: Final = 1e-9
SHIFT: Final = "shift along the symmetry"  # no name of a model can be this


def translations(model: object) -> tuple[dict[str, Fraction], ...]:
    """A basis of these directions, {state: component} without zeros, each proved by multiplying out."""
    if not isinstance(model, Model) or model.kind not in ("flow", "map") or not 0 < len(model.states) <= LARGEST:
        return ()
    found = []
    for row in _candidates(model):
        direction = {n: c for n, c in zip(model.state_names, row, strict=True) if c}
        if direction and _holds(model, direction):
            found.append(direction)
    return tuple(found)


def translation_notes(model: object) -> list[str]:
    """What is said of them where no isolated equilibrium is found."""
    found = []
    for direction in translations(model):
        parts = ", ".join(n if c == 1 else f"{c}*{n}" for n, c in direction.items())
        moved = "are shifted together" if len(direction) > 1 else "is shifted"
        advice = " Differences of these states as new ones (transform: coordinates) divide it out"
        found.append(
            f"the equations do not change when {parts} {moved}: solutions come in lines along this symmetry, or move "
            f"along it.{advice if len(direction) > 1 else ''}"
        )
    return found


def _candidates(model: Model) -> list[list[Fraction]]:
    """Echelon form of the common null space of the Jacobians at random points, in simple fractions."""
    names = list(model.state_names)
    chance = np.random.default_rng(3)
    try:
        u, p = model.start_point()
    except ContinError:  # sizes are not known then
        u, p = np.ones(len(names)), np.ones(len(model.parameters))
    size = np.where(u != 0.0, u, float(np.abs(u).max(initial=0.0)) or 1.0)
    env: dict[str, Array] = {n: s * chance.uniform(0.3, 2.0, POINTS) for n, s in zip(names, size, strict=True)}
    env |= {n: (v or 1.0) * chance.uniform(0.5, 1.5, POINTS) for n, v in zip(model.parameter_names, p, strict=True)}
    env[TIME] = chance.uniform(0.0, 10.0, POINTS)
    entries = sparse_jacobian(rates_of(model), names)
    table = np.zeros((POINTS, len(names), len(names)))
    for (i, j), values in zip(entries, sample(entries.values(), env), strict=True):
        table[:, i, j] = values
    rows = table[np.isfinite(table).all(axis=(1, 2))].reshape(-1, len(names))
    largest = np.abs(rows).max(axis=1, initial=0.0)
    rows = rows[largest > 0.0] / largest[largest > 0.0, None]
    if not len(rows):
        return []
    _, singular, right = np.linalg.svd(rows, full_matrices=True)
    space = right[int(np.sum(singular > NOTHING * singular[0])) :]
    return fractions(echelon(space, relative=False), 1000)


def _holds(model: Model, direction: dict[str, Fraction]) -> bool:
    rates = rates_of(model)
    moved = {symbol(n): add(symbol(n), mul(number(c), symbol(SHIFT))) for n, c in direction.items()}
    there = substitute(rates, moved)
    return not any(Monomials().expand([sub(b, a) for a, b in zip(rates, there, strict=True)]))
