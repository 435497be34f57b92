"""Flows with algebraic states: which eigenvalues are theirs, and in which units vectors are normalised.

Such a flow is solved as an ordinary one whose algebraic equations decay at a rate (`symbolic.passes.index_one`). The
eigenvalues (multipliers) of that decay are the infinite ones of the pencil, and are not shown.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.machine import elementary
from contin.model.model import Model
from contin.model.parts import Constraints
from contin.normalforms.jet import DerivativeJet, Real
from contin.records import Record

if TYPE_CHECKING:
    from contin.systems.protocol import System

UNIT: Final = 2.0**48  # of states without mass: their parts of a vector's length are below rounding


def constraints_of(system: System) -> Constraints | None:
    """Of a system made of formulas with algebraic states."""
    model = getattr(system, "model", None)
    return model.constraints if isinstance(model, Model) else None


def massless(system: System) -> NDArray[np.bool_]:
    """(n,) true for the states without mass."""
    known = constraints_of(system)
    if known is None:  # states without names (fields) have mass, too
        return np.zeros(system.n, bool)
    return np.array([name in known.massless for name in system.state_names], bool)


def finite_eigenvalues(system: System, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Without those of the algebraic equations."""
    known = constraints_of(system)
    return values if known is None else _without(values, complex(-known.rate), len(known.equations))


def finite_multipliers(system: System, values: NDArray[np.complex128], period: float) -> NDArray[np.complex128]:
    """Without those of the algebraic equations, over a period."""
    known = constraints_of(system)
    if known is None:
        return values
    return _without(values, complex(elementary.exp(np.array(-known.rate * period))), len(known.equations))


def _without(values: NDArray[np.complex128], target: complex, count: int) -> NDArray[np.complex128]:
    """All but the `count` values nearest to a target, in their order."""
    distance = np.abs(values - target)
    drop = np.argsort(np.where(np.isnan(distance), np.inf, distance), kind="stable")[:count]
    return np.delete(values, drop)


def unit_mass(system: System) -> Real:
    """Units of the states (n,) in which those without mass count nothing in the length of a vector."""
    return np.ones(system.n) if constraints_of(system) is None else np.where(massless(system), UNIT, 1.0)


def with_units(jet: DerivativeJet, units: Real) -> DerivativeJet:
    """The jet in u / units; they are powers of two, so nothing is rounded."""
    if not np.any(units != 1.0):
        return jet

    def derivative(directions: tuple[Real, ...]) -> Real:
        factors = np.append(units, np.ones(jet.parameters))
        return np.asarray(jet.form(*(d * factors for d in directions))) / units

    scale = None if jet.scale is None else jet.scale / units
    others = tuple(with_units(other, units) for other in jet.otherwise)
    matrix = jet.A * units / units[:, None]
    return DerivativeJet(matrix, derivative, jet.parameters, jet.kind, scale, otherwise=others)


def in_own_units(vectors: Record, units: Real) -> Record:
    """Right vectors (q, ...) and left ones (p, ...) of such a jet in the states' own units."""
    if not np.any(units != 1.0):
        return vectors
    return {
        name: np.asarray(v) / units if name.startswith("p") else np.asarray(v) * units for name, v in vectors.items()
    }  # fmt: skip
