"""Solutions of boundary-value problems, their folds and their branch points: unknowns, borders, sizes.

z = (u at the nodes, 1, mesh, [unfolding of branch points], parameters, the last one first).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.bvp.boundary_problem import BoundaryProblem
from contin.loci.augmented import boundary_degeneracies as degeneracies
from contin.loci.augmented.meshed import Chosen, MeshedBase
from contin.loci.augmented.on_mesh_in_parameters import OnMeshInParameters
from contin.loci.augmented.singular import Borders, null_vectors
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.model.model import Model


@dataclass(frozen=True, eq=False)
class SingularSolutions(MeshedBase[BoundaryProblem]):
    """`type` is LP or BP.

    kind : of branch points, as of the first one (transcritical along the whole curve, or pitchforks).
    usual : sizes (n,) of the solutions on the branch that the curve was found from, where there is one.
    """

    type: str = ""
    kind: str = ""
    usual: Array = field(default_factory=lambda: np.zeros(0))

    has_stability = False

    @property
    def model(self) -> Model:
        return self.problem.two.model

    def based(self, base: Array) -> BoundaryProblem:
        return replace(self.problem, base=base)

    def where(self, z: Array) -> NDArray[np.intp]:
        """Places in z of (u, [unfolding], parameters)."""
        nodes = self.profile(z).u.size
        return np.concatenate([np.arange(nodes), np.arange(z.size - self.behind, z.size)])

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.problem.two.parameters[place] for place in self.places)

    def settled(self, z: Array, scale: Array) -> Self:
        mesh = self.profile(z).h
        own = self._fitting(z, mesh, np.ones(z.size)) if self.type else None
        return replace(self, chosen=Chosen(mesh, own, np.zeros(0)))

    def unfolding(self, z: Array) -> list[int]:
        """Its place among (u, [unfolding], parameters)."""
        return [self.profile(z).u.size] if self.extra else []

    def borders_at(self, z: Array, scale: Array) -> Borders:
        """Those chosen, where they are of this mesh."""
        mesh = self.profile(z).h
        known = None if self.chosen is None else self.chosen.borders_on(mesh)
        return self._fitting(z, mesh, scale) if known is None else known

    def _fitting(self, z: Array, mesh: Array, scale: Array) -> Borders:
        """Borders that fit at z, with the sense of those chosen before."""
        where = np.delete(self.where(z), self.unfolding(z))
        on_mesh = self.on_mesh(mesh, scale[where])
        here = on_mesh.at(z[where] / scale[where])
        if here is None:
            raise FloatingPointError("the equations are not finite where a curve is to be followed")
        found = null_vectors(here.critical(self.extra == 1), 1 + self.extra)
        old, n = None if self.chosen is None else self.chosen.borders, self.problem.n
        if old is not None and float(_sums(found.left, n) @ _sums(old.left, n)) < 0.0:
            found = Borders(-found.left, found.right)
        return degeneracies.turned(found) if old is not None and self._is_turned(found, old, mesh) else found

    def _is_turned(self, found: Borders, old: Borders, mesh: Array) -> bool:
        """Whether the null function has the other sense than it had on the mesh of the borders chosen before."""
        assert self.chosen is not None
        before = degeneracies.in_states(old.right).reshape(-1, self.problem.n)
        there = Profile(self.problem.points, before, 1.0, self.chosen.mesh, 0.0).on_mesh(mesh).u
        return float(degeneracies.in_states(found.right) @ there.ravel()) < 0.0

    def on_mesh(self, mesh: Array, scale: Array) -> OnMeshInParameters:
        return OnMeshInParameters(self.problem, self.places, mesh, scale)

    def node_sizes(self, z: Array) -> Array:
        """Sizes (nodes n,) of the functions: of the solution, and of those on the branch where the curve began."""
        u = self.profile(z).u
        sizes = np.abs(u).max(axis=0)
        if self.usual.size:
            sizes = np.maximum(sizes, self.usual)
        return np.tile(np.where(sizes > 0.0, sizes, sizes.max() or 1.0), len(u))


def _sums(left: Array, n: int) -> Array:
    """Numbers of a left vector that do not depend on the mesh: sums over it by equation, and the conditions' part."""
    return np.concatenate([left[:-n].reshape(-1, n).sum(axis=0), left[-n:]])
