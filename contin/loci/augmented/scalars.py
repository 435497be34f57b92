"""Scalars that curves of equilibria and fixed points hold at zero: degeneracies, conditions, an unfolding."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Rejected
from contin.continuation.sample import Sample
from contin.loci.augmented.elimination import Scalars
from contin.loci.codim2.functions import function_of
from contin.loci.codim2.matrices import eigenvalues
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.model.model import Model
from contin.model.relations import Relation
from contin.problems.quantities import Quantities


@dataclass(frozen=True)
class Degeneracy:
    """What makes a point of `type` on the curve's base, of codimension one, one of codimension two."""

    type: str
    locus: LocusProblem

    @property
    def text(self) -> str:
        return f"{self.locus.locus} with the condition of {self.type}"

    def near(self, problem: object, z: Array, scale: Array) -> Scalars:
        sample = Sample(z, np.zeros(z.size), np.zeros(0), 0, eigenvalues(self.locus, z))
        found = function_of(self.locus, self.type, sample)
        if isinstance(found, Rejected):
            return lambda at: np.full(1, np.nan)
        return lambda at: np.array([found(at)])


@dataclass(frozen=True)
class Unfolding:
    """Branch points that nothing forces have no unfolding: a parameter more takes its place."""

    locus: LocusProblem
    text: str = "branch points"

    def near(self, problem: object, z: Array, scale: Array) -> Scalars:
        place = -1 - len(self.locus.curve.places)
        return lambda at: at[[place]] / scale[place]


@dataclass(frozen=True)
class Conditions:
    """The user's equations in states, observables and parameters."""

    model: Model
    relations: tuple[Relation, ...]
    locus: LocusProblem
    _formulas: dict[str, Quantities] = field(default_factory=dict)

    @property
    def text(self) -> str:
        return ", ".join(r.text for r in self.relations)

    def near(self, problem: object, z: Array, scale: Array) -> Scalars:
        if not self._formulas:
            self._formulas["own"] = Quantities(self.model, tuple(r.residual for r in self.relations))
        formulas, curve = self._formulas["own"], self.locus.curve
        return lambda at: formulas.at(at[: curve.n], curve.full_parameters(at))[0]
