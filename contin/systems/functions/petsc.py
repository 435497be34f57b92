"""Functions written for PETSc: vectors and matrices are spread over the processes of an MPI program.

petsc4py and mpi4py are not needed by contin, and imported here only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.systems.functions.processes import Distributed, Values

# petsc4py has no types; vectors, matrices and solvers by what they are
Vec = Any
Mat = Any
Residual = Callable[[Vec, Values, Vec], None]
Jacobian = Callable[[Vec, Values, Mat], None]
Record = Callable[[Vec, Values], Values]
PREFIX: Final = "contin_"  # of the options that the user gives to the linear solver


def from_petsc(
    residual: Residual, u0: Vec, parameters: Values, jacobian: Jacobian, matrix: Mat, *,
    record: Record | None = None, prefix: str = PREFIX, **options: Any,
) -> Distributed:  # fmt: skip
    """A system whose states, residual and Jacobian are PETSc's, on all processes of the communicator of u0.

    residual : (u, p, f), fills the Vec f with F(u, p).  jacobian : (u, p, J), fills and assembles the Mat J with dF/du;
    `matrix` is a Mat of that pattern.  record : (u, p) -> {name: number}.  All are called on all processes at the same
    time. The preconditioner is the KSP of the options with `prefix` (`-contin_ksp_type`, `-contin_pc_type`, ...); LU
    factors (of MUMPS on several processes) by default.  options : those of `FunctionProblem`. Components stand in
    PETSc's order.

    `from_petsc(...).run(work)` returns work(problem) of process 0, where `problem` is a matrix-free `FunctionProblem`.
    """
    petsc = _petsc()
    comm = u0.getComm().tompi4py()
    parts = PetscParts(petsc, residual, jacobian, record, u0, matrix, prefix)
    return Distributed(comm, parts, parts.gathered(u0), parameters, record is not None, **options)


@dataclass
class Kept:
    """sign * dF/du, and its solver once it is needed."""

    sign: float
    matrix: Mat
    solver: Any = None


class PetscParts:
    """What each process does with its parts of vectors and matrices; see `Parts`."""

    def __init__(
        self, petsc: Any, residual: Residual, jacobian: Jacobian, record: Record | None, u0: Vec, matrix: Mat,
        prefix: str,
    ) -> None:  # fmt: skip
        self.petsc, self.prefix, self.matrix = petsc, prefix, matrix
        self.functions = residual, jacobian, record
        self.u, self.f, self.x = u0.duplicate(), u0.duplicate(), u0.duplicate()
        self.first = u0.getComm().getRank() == 0
        self.scatter, self.whole = petsc.Scatter.toZero(u0)
        self.kept: dict[int, Kept] = {}

    def gathered(self, vec: Vec) -> Array | None:
        """All of a vector on process 0."""
        self.scatter.scatter(vec, self.whole, mode=self.petsc.ScatterMode.FORWARD)
        return np.array(self.whole.getArray()) if self.first else None

    def spread(self, values: Array | None, vec: Vec) -> Vec:
        """The parts of a vector of process 0 on all of them."""
        if values is not None:
            self.whole.getArray()[:] = values
        self.scatter.scatter(self.whole, vec, mode=self.petsc.ScatterMode.REVERSE)
        return vec

    def residual(self, u: Array | None, p: Values) -> Array | None:
        self.functions[0](self.spread(u, self.u), p, self.f)
        return self.gathered(self.f)

    def record(self, u: Array | None, p: Values) -> Values:
        record = self.functions[2]
        self.spread(u, self.u)
        return {} if record is None else dict(record(self.u, p))

    def linearise(self, u: Array | None, p: Values, key: int) -> None:
        made = self.matrix.duplicate(copy=True)
        self.functions[1](self.spread(u, self.u), p, made)
        trace = made.getDiagonal().sum()
        sign = -1.0 if trace < 0.0 else 1.0  # multigrid wants positive definite matrices, and flows have negative ones
        made.scale(sign)
        self.kept[key] = Kept(sign, made)

    def multiply(self, v: Array | None, key: int) -> Array | None:
        kept = self.kept[key]
        kept.matrix.mult(self.spread(v, self.x), self.f)
        self.f.scale(kept.sign)
        return self.gathered(self.f)

    def solve(self, r: Array | None, key: int) -> Array | None:
        kept = self.kept[key]
        kept.solver = kept.solver or self._solver(kept.matrix)
        kept.solver.solve(self.spread(r, self.f), self.x)
        self.x.scale(kept.sign)
        return self.gathered(self.x)

    def release(self, nothing: None, keys: list[int]) -> None:
        for key in keys:
            kept = self.kept.pop(key)
            kept.matrix.destroy()
            if kept.solver is not None:
                kept.solver.destroy()

    def _solver(self, matrix: Mat) -> Any:
        solver = self.petsc.KSP().create(matrix.getComm())
        solver.setOperators(matrix)
        solver.setType("preonly")
        preconditioner = solver.getPC()
        preconditioner.setType("lu")
        if matrix.getComm().getSize() > 1:
            preconditioner.setFactorSolverType("mumps")
        solver.setOptionsPrefix(self.prefix)
        solver.setFromOptions()
        return solver


def _petsc() -> Any:
    try:
        petsc = import_module("petsc4py.PETSc")
        import_module("mpi4py.MPI")
    except ImportError:
        raise InputError(
            "from_petsc needs petsc4py and mpi4py: pip install petsc petsc4py mpi4py, conda install petsc4py mpi4py, "
            "or Debian's python3-petsc4py and python3-mpi4py"
        ) from None
    if petsc.ScalarType is not np.float64:
        raise InputError(f"from_petsc needs PETSc with real numbers in double precision; this has {petsc.ScalarType}")
    return petsc
