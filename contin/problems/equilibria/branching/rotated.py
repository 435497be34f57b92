"""Branch points of states that a declared rotation keeps, with eigenvectors that it turns.

With every solution all its rotated copies branch off there: the reduced equations have circles of solutions, in which
nothing is to be looked for (`contin.transitions.equivariant_branches` finds the branch in the frame that turns).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.lowering.system import CompiledSystem
from contin.model.model import Model
from contin.symbolic.passes.corotating import corotating, frame_generator

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

KEPT: Final = 1e-9  # of the sizes: a state that the rotation moves by less is kept by it
TURNED: Final = 1e-6  # of the rotation's size: eigenvectors that it moves by less are kept by it


@dataclass(frozen=True, eq=False)
class TurningKernel:
    """The model, the matrix G (n, n) of its rotation, and the kernel of F_u in scaled states, basis (n, k)."""

    model: Model
    generator: Array
    basis: Array


def turning_kernel(problem: AlgebraicEquations, z: Array, sizes: Array, kernel: int) -> TurningKernel | None:
    """None where no rotation is declared, the state is moved by it, or a part of the kernel is not."""
    system = problem.system
    model = system.written if isinstance(system, CompiledSystem) else None
    if kernel < 2 or not isinstance(model, Model) or not model.rotation or problem.is_map:
        return None
    values = dict(zip(model.parameter_names, problem.full_parameters(z).tolist(), strict=True))
    generator = frame_generator(corotating(model), values)
    assert generator is not None
    if float(np.max(np.abs(generator @ z[:-1]) / sizes)) > KEPT:
        return None
    _, _, right = np.linalg.svd(problem.linear_part(z) * sizes[None, :] / sizes[:, None])
    basis = right[-kernel:].T
    turn = basis.T @ (generator * sizes[None, :] / sizes[:, None]) @ basis
    if np.linalg.matrix_rank(turn, tol=TURNED * float(np.abs(generator).max())) < kernel:
        return None
    return TurningKernel(model, generator, basis)
