"""F_u of a user's function as a `Linear`: given sparse, differenced by colours, or applied without being formed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array, Vector
from contin.errors import InputError, UserFunctionError
from contin.kernels.colouring import colour_columns
from contin.linalg.by_rows import ByRows
from contin.linalg.csc import filled
from contin.linalg.factor import Factoriser
from contin.linalg.linear import DirectLinear, KrylovLinear, Linear
from contin.linalg.multigrid import Multigrid
from contin.linalg.probed import ProbedMatrix, entries
from contin.problems.sparse.old_factors import OldFactors
from contin.systems.functions.complex_steps import COMPLEX_STEP, slope
from contin.systems.functions.function_system import FunctionSystem
from contin.systems.functions.guarded import called, vector
from contin.systems.functions.stencils import differentiated
from contin.systems.functions.trials import try_sparsity

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

AT_ONCE = 100_000  # numbers in the states of one call, of coloured complex steps: what is small is limited by calls
ALWAYS_FACTORED = 20_000  # unknowns up to which SuperLU is quick enough to factor at every Newton step
WORSE = 1.5  # ratio of GMRES iterations to those of a new preconditioner from which the user's is made anew, ...
MORE = 3  # ... and as many beside
WEAK = 0.7  # of an error, left by one application of a preconditioner


@dataclass(eq=False)
class Held:
    """A user's preconditioner, and the GMRES iterations that it took when it was new (0: not known yet).

    rate : what an iteration has left of an error in the worst solve of all points that it served (0: not known yet; at
    a point where it is exact nothing is learnt).
    """

    apply: Callable[[Array], Array]
    iterations: int = 0
    rate: float = 0.0


class JacobianSource:
    """Makes the operator at a point; keeps what all points share (orders of elimination, colours)."""

    def __init__(self, system: FunctionSystem) -> None:
        self.system = system
        self.factoriser = Factoriser()
        self._last: KrylovLinear | None = None
        self.mass = system.model.mass_matrix
        self._by_rows = ByRows()
        self._old = OldFactors(self.factoriser, self.mass)
        self._held: Held | None = None  # the user's preconditioner, ...
        self._probed = ProbedMatrix(system.n)
        self._before: Held | None = None  # ... and the one that it replaced, as long as it is not known to be better
        model = system.model
        if model.jacobian is None and model.sparsity is not None and model.written is None:
            try_sparsity(system, self._coloured)

    def at(self, u: Array, p: Array) -> Linear | None:
        """F_u(u, p); None where it is not finite."""
        if self.system.model.method == "sparse":
            matrix = self.system.attempt("Jacobian", lambda: self.matrix(u, p), None, u, p)
            if matrix is None or not np.all(np.isfinite(matrix.data)):
                return None
            if self.system.model.preconditioner is not None:
                return self._preconditioned(matrix, u, p)
            cheap = self.system.n <= ALWAYS_FACTORED or self.factoriser.is_band_for(matrix)
            return DirectLinear(matrix, self.factoriser, mass=self.mass) if cheap else self._old.at(matrix, u, p)
        return self._matrix_free(u, p)

    def forget(self) -> None:
        """The next operator is factored, whatever the last one was."""
        self._old.forget()

    def _preconditioned(self, matrix: csc_matrix, u: Array, p: Array) -> KrylovLinear | None:
        """Solved by GMRES with the user's preconditioner of an earlier point, as long as it serves well."""
        return self._serving(self._by_rows.product(matrix), matrix, u, p)

    def _serving(
        self, product: Callable[[Array], Array], matrix: csc_matrix | None, u: Array, p: Array
    ) -> KrylovLinear | None:
        """The operator v -> product(v) with the last preconditioner, made anew where that has become worse.

        A new one that is worse still (multigrid next to a fold) is given up for the one that it replaced.
        """
        last, held, before = self._last, self._held, self._before
        if held is not None and last is not None:
            held.rate = max(held.rate, last.rate)
        if held is not None and last is not None and held.iterations == 0:
            held.iterations = last.iterations
            if before is not None and held.iterations > before.iterations:
                held, self._before, last = before, None, None
        kept = last is not None and held is self._held
        if held is None or (last is not None and last.iterations > WORSE * held.iterations + MORE):
            apply = self.system.attempt("preconditioner", lambda: self._preconditioner(u, p), None, u, p)
            self.factoriser.tally.factorisations += 1
            if apply is None:
                return None
            if held is not None and last is not None:
                self._before = Held(held.apply, last.iterations)
            held, kept = Held(apply), False
        self._held = held
        approximate, lost = held.apply, np.full(self.system.n, np.nan)

        def apply_here(r: Array) -> Array:  # where it fails is this point, wherever it was made
            return np.asarray(self.system.attempt("preconditioning", lambda: approximate(r), lost, u, p))

        linear = KrylovLinear(product, apply_here, matrix=matrix, tally=self.factoriser.tally, mass=self.mass)
        if kept and last is not None:
            linear.solved = last.solved
        self._last = linear
        return linear

    def rate(self) -> float | None:
        """What part of an error one application of the user's preconditioner leaves about; None where it is weak.

        Eigenvectors are corrected by it (Davidson's method), whose corrections by a weak one are no measure of errors.
        """
        held, last = self._held, self._last
        if held is None or last is None:
            return None
        rate = max(held.rate, last.rate)
        return rate if 0.0 < rate <= WEAK else None

    def matrix(self, u: Array, p: Array) -> csc_matrix:
        """F_u as a CSC matrix."""
        from scipy.sparse import csc_matrix

        model = self.system.model
        if model.method != "sparse":
            product = self.product(u, p)
            matrix = self._probed.at(product, self.system.sizes_at(u))
            return entries(product, self.system.n) if matrix is None else matrix
        if model.jacobian is None:
            return self._coloured(u, p)
        matrix = called("Jacobian", model.jacobian, u, self.system._named(p))
        if matrix.format != "csc" or matrix.dtype != float:
            matrix = csc_matrix(matrix, dtype=float)
        if matrix.shape != (self.system.n, self.system.n):
            raise UserFunctionError(f"jacobian must return dF/du of shape {(self.system.n,) * 2}; got {matrix.shape}")
        if not matrix.has_canonical_format:
            matrix.sum_duplicates()
        return filled(matrix, matrix.data.copy())  # the function may fill one matrix again and again

    # coloured differences ---------------------------------------------------------------------------------------------

    @cached_property
    def _pattern(self) -> tuple[csc_matrix, Vector, Vector, int]:
        """The pattern in CSC, the column of each entry, the colour of each column, the number of colours."""
        from scipy.sparse import csc_matrix

        pattern = csc_matrix(self.system.model.sparsity, dtype=float)
        n = self.system.n
        if pattern.shape != (n, n):
            raise InputError(f"sparsity must be a matrix of shape ({n}, {n}), like dF/du; got {pattern.shape}")
        pattern.sum_duplicates()
        by_rows = pattern.tocsr()
        colours = np.empty(n, np.int64)
        parts = (pattern.indptr, pattern.indices, by_rows.indptr, by_rows.indices)
        count = colour_columns(*(np.asarray(a, np.int64) for a in parts), colours)
        return pattern, np.repeat(np.arange(n), np.diff(pattern.indptr)), colours, int(count)

    def _coloured(self, u: Array, p: Array) -> csc_matrix:
        pattern, columns, colours, count = self._pattern
        size, value, block = self.system.sizes_at(u), self.system.quickly, max(1, AT_ONCE // self.system.n)
        slopes = np.empty((count, self.system.n))
        circled = p.astype(complex)
        with np.errstate(all="ignore"):
            if self.system.lines.analytic:
                for first in range(0, count, block):
                    chosen = np.arange(first, min(first + block, count))
                    steps = np.where(colours == chosen[:, None], size, 0.0)
                    moved = self.system.quickly_at_rows(u + 1j * COMPLEX_STEP * steps, circled)
                    slopes[chosen] = slope(moved, COMPLEX_STEP)
            else:
                for c in range(count):
                    step = np.where(colours == c, size, 0.0)
                    slopes[c] = differentiated(partial(_ahead, value, u, step, p), 1, 1.0)
        return filled(pattern, slopes[colours[columns], pattern.indices] / size[columns])

    # matrix-free ------------------------------------------------------------------------------------------------------

    def _matrix_free(self, u: Array, p: Array) -> Linear | None:
        product = self.system.attempt("Jacobian", lambda: self.product(u, p), None, u, p)
        if product is None:
            return None
        if self.system.model.preconditioner is not None:
            return self._serving(product, None, u, p)
        matrix = self._probed.at(product, self.system.sizes_at(u))  # GMRES without a preconditioner takes more products
        if matrix is None:
            return KrylovLinear(product, lambda r: r, mass=self.mass)
        if not np.all(np.isfinite(matrix.data)):
            return None
        return DirectLinear(matrix, self.factoriser, mass=self.mass)

    def product(self, u: Array, p: Array) -> Callable[[Array], Array]:
        """v -> F_u v"""
        system, model, n = self.system, self.system.model, self.system.n
        if model.jacobian is None:
            padding = np.zeros(system.m)
            system.watch_steps(u, p)
            return lambda v: system.lines.first(u, p, np.concatenate([v, padding])) if v.any() else np.zeros(n)
        operator = called("Jacobian", model.jacobian, u, system._named(p))

        def apply(v: Array) -> Array:
            return vector("Jacobian's product", called("Jacobian", lambda: operator @ v), n).astype(float)

        return lambda v: np.asarray(system.attempt("product", lambda: apply(v), np.full(n, np.nan), u, p))

    def _preconditioner(self, u: Array, p: Array) -> Callable[[Array], Array]:
        system, model, n = self.system, self.system.model, self.system.n
        assert model.preconditioner is not None
        made = called("preconditioner", model.preconditioner, u, system._named(p))

        def apply(r: Array) -> Array:
            self.factoriser.tally.applied(r)
            found = vector("preconditioner", called("preconditioner", made, r), n)
            return found.astype(float, copy=not isinstance(made, Multigrid))  # others may write into it again

        return apply


def _ahead(value: Callable[[Array, Array], Vector], u: Array, step: Array, p: Array, t: float) -> Array:
    """F(u + t step, p)."""
    return np.asarray(value(u + t * step, p), dtype=float)
