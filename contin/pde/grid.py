"""The product of one or two axes: coordinates, sides, integrals and derivatives of functions on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, identity, kron

from contin.abi import Array
from contin.pde.axes import Axis


@dataclass(frozen=True)
class Side:
    """One end of an axis that is no circle: end 0 or 1."""

    axis: int
    end: int


@dataclass(frozen=True)
class Grid:
    """Nodes are numbered with the last axis fastest."""

    axes: tuple[Axis, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Nodes on each axis."""
        return tuple(axis.points for axis in self.axes)

    @property
    def size(self) -> int:
        """Number of nodes."""
        return int(np.prod(self.shape))

    @cached_property
    def coordinates(self) -> dict[str, Array]:
        """Each coordinate at all nodes, (size,)."""
        meshes = np.meshgrid(*(axis.nodes for axis in self.axes), indexing="ij")
        return {axis.name: mesh.ravel() for axis, mesh in zip(self.axes, meshes, strict=True)}

    @cached_property
    def weights(self) -> Array:
        """Weights (size,) of integrals over the domain."""
        return np.asarray(reduce(_kron, [axis.weights for axis in self.axes]))

    @cached_property
    def sides(self) -> dict[str, Side]:
        """x.start, x.end, ... of the axes that are no circles."""
        return {
            f"{axis.name}.{word}": Side(k, end)
            for k, axis in enumerate(self.axes)
            if not axis.periodic
            for end, word in enumerate(("start", "end"))
        }

    def nodes_of(self, side: Side) -> NDArray[np.intp]:
        """Numbers of the nodes of a side, ascending."""
        numbers = np.arange(self.size).reshape(self.shape)
        return np.asarray(np.take(numbers, -side.end, axis=side.axis)).ravel()

    def along(self, axis: int, matrix: csr_matrix) -> csr_matrix:
        """A matrix that acts on one axis, on the whole grid."""
        factors = [identity(a.points, format="csr") for a in self.axes]
        factors[axis] = matrix
        return csr_matrix(reduce(lambda a, b: kron(a, b, format="csr"), factors))

    def interpolation(self, at: Sequence[float]) -> Array:
        """Weights (size,) that give the value at a point."""
        return np.asarray(reduce(_kron, [a.interpolation(x) for a, x in zip(self.axes, at, strict=True)]))


def _kron(a: Array, b: Array) -> Array:
    return np.asarray(np.kron(a, b), dtype=float)
