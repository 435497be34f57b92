"""`FunctionProblem`: a user's Python function in place of a model; every verb that takes a model takes one."""

from __future__ import annotations

from copy import copy
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.machine import elementary
from contin.systems.functions.function_system import FunctionSystem
from contin.systems.functions.given_function import GivenFunction
from contin.systems.functions.in_kernels import FunctionInKernels

if TYPE_CHECKING:
    from contin.systems.functions.function_system import FunctionSystem

DENSE_IN_KERNELS = 1000  # states of which kernels keep a dense Jacobian


class FunctionProblem(GivenFunction):
    """F(u, p) = 0, as a flow u' = F(u, p), or the fixed points of a map u -> F(u, p), given by a Python function.

    residual : (u, p) -> (n,), u (n,) and p a mapping of parameter names to values. Where it takes complex u and p and
        is analytic, derivatives that are not given come from complex steps; otherwise from differences of high order.
    u0 : (n,) guess of a solution at `parameters`, {name: value}.
    jacobian : (u, p) -> dF/du. What it returns decides the method: an (n, n) array (dense); a scipy.sparse matrix (one
        factorisation a Newton step, bordered systems by block elimination); a scipy.sparse.linalg.LinearOperator
        (matrix-free, GMRES; up to n = 5,000 without a preconditioner a matrix is made of products). Without it
        `sparsity`, a matrix whose non-zeros are those of dF/du, makes coloured differences; without both, products
        find where entries are (up to n = 5,000), and from n = 200 on the method is that of a LinearOperator.
    kind : 'flow' or 'map'; decides stability and the types of special points.
    parameter_jacobian : (u, p, name) -> dF/dp_name, (n,).
    derivative : (u, p, d1, ..., dk) -> D^k F[d1, ..., dk], k = 2 and 3; directions (n + m,) in states and parameters.
    record : (u, p) -> {name: number}: columns of branches beside the states (which are columns up to n = 50).
    states : names of the states, default u0, u1, ...
    periods : {state: period} of states that are angles.   ranges : {parameter: (lo, hi)}, defaults of runs.
    symmetries : {name: map of u (n,) to (n,)} that take solutions to solutions.
    rotation : G (n, n), an array or sparse matrix, where F commutes with the rotation u' = G u (on a circle d/dx):
        states that it moves are followed in a frame that turns with them (`turning_frame`), with their rate as a column
        `rotation_rate`. (G, w): the frame turns with the wave w (n,), G G w = -c w; needed beyond 1,000 states that G
        mixes, and for a LinearOperator. Otherwise with the mode that is largest in the start.
    typical : sizes of states that are zero in u0, a number or (n,), for differences. States of large systems are
        measured in proportion to them, and want them where they have units of their own. Default 1.
    source, expect : as in a model file: where the problem comes from, and points that runs must find (numbers only).
    preconditioner : (u, p) -> function of r (n,) that approximates (dF/du)^-1 r: GMRES takes it in place of factors. It
        is made anew where it has become worse. `contin.multigrid` of the Jacobian is one, for diffusions.
    arrays : (from numpy, to numpy), such as (cupy.asarray, cupy.asnumpy): all functions get arrays of that module and
        return them; `jacobian` then returns v -> dF/du v.
    mass : M of M u' = F(u, p), constant: a vector (its diagonal), an array or a scipy.sparse matrix. It may be singular
        (algebraic equations); equilibria, their eigenvalues and normal forms may have an index above 1.
    written, explain : the model that this function was made of, all of whose derivatives are exact and of every order,
        and (u, p) -> why it is not finite there, p (m,); None for a user's function.
    """

    def system(self) -> FunctionSystem:
        """The function with all its derivatives, as problems use it."""
        return FunctionSystem(self)

    @cached_property
    def in_kernels(self) -> FunctionInKernels:
        """The same behind addresses, for kernels: orbits, trajectories."""
        if self.n > DENSE_IN_KERNELS:
            raise InputError(
                f"function {self.name!r} has {self.n} states; orbits and trajectories by compiled steps keep a dense "
                f"Jacobian, for up to {DENSE_IN_KERNELS}. Simulate it with method='BDF' and a sparse Jacobian; orbits "
                "start at Hopf points, or from samples of such a simulation"
            )
        return FunctionInKernels(self.divided())

    def in_frame(self, states: Array) -> Array:
        """Samples (K, n) of an orbit of the equations as they were written, in the problem's own unknowns."""
        return states

    def measured(self) -> FunctionProblem:
        """The function with what is measured until it settles as its record: states (of angles cosine and sine)."""
        measured = copy(self)
        for kept in ("in_kernels", "observables"):
            measured.__dict__.pop(kept, None)
        measured.record, measured.state_names = self._measure, ()
        measured.measured_names = self.state_names
        return measured

    def _measure(self, u: Array, values: Any) -> dict[str, float]:
        found: dict[str, float] = {}
        if not self.state_names:
            found |= {"norm": float(np.sqrt(np.mean(u * u))), "min": float(u.min()), "max": float(u.max())}
        for name, x, period in zip(self.state_names, u.tolist(), self._periods.tolist(), strict=False):
            if period > 0.0:
                turn = 2.0 * np.pi * x / period
                found |= {f"cos_{name}": float(elementary.cos(turn)), f"sin_{name}": float(elementary.sin(turn))}
            else:
                found[name] = x
        recorded = {} if self.record is None else self.record(u, values)
        return found | dict(recorded)


def in_kernels(system: Any) -> Any:
    """A system that has addresses: itself, or a user's function behind callbacks."""
    model: Any = getattr(system, "model", None)
    return model.in_kernels if isinstance(system, FunctionSystem) else system
