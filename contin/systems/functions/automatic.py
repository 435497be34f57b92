"""Functions written for JAX, autograd or CasADi: their exact derivatives, of every order that contin asks for.

None of these packages is needed by contin; each is imported by its own function here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from types import ModuleType
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import Array, Vector
from contin.errors import InputError
from contin.systems.functions.function_problem import FunctionProblem

Function = Callable[[Any, Any], Any]
Joined = Callable[[Any], Any]  # z = (u, p) -> F
SPARSE_FROM = 50  # states from which CasADi's Jacobian stays sparse


class Tools(Protocol):
    """What a package of automatic differentiation gives."""

    def jacobian(self, function: Joined) -> Joined:
        """z -> dF/dz, (n, n + m)"""

    def along(self, function: Joined, direction: Vector) -> Joined:
        """z -> DF(z)[direction], which can be differentiated again"""

    def compiled(self, function: Joined) -> Joined:
        """The same, faster"""


class _Jax:
    def __init__(self, jax: ModuleType) -> None:
        self.jax = jax

    def jacobian(self, function: Joined) -> Joined:
        made: Joined = self.jax.jit(self.jax.jacfwd(function))
        return made

    def along(self, function: Joined, direction: Vector) -> Joined:
        return lambda z: self.jax.jvp(function, (z,), (self.jax.numpy.asarray(direction),))[1]

    def compiled(self, function: Joined) -> Joined:
        made: Joined = self.jax.jit(function)
        return made


class _Autograd:
    def __init__(self, autograd: ModuleType) -> None:
        self.autograd = autograd
        self.operators = import_module("autograd.differential_operators")

    def jacobian(self, function: Joined) -> Joined:
        made: Joined = self.autograd.jacobian(function)
        return made

    def along(self, function: Joined, direction: Vector) -> Joined:
        return lambda z: self.operators.make_jvp_reversemode(function)(z)(direction)

    def compiled(self, function: Joined) -> Joined:
        return function


def from_jax(residual: Function, u0: ArrayLike, parameters: Mapping[str, float], **options: Any) -> FunctionProblem:
    """`FunctionProblem` of a function written with `jax.numpy`: Jacobian and higher derivatives by JAX, compiled.

    residual : (u, p) -> (n,).  options : those of `FunctionProblem`.  JAX computes in float32 unless told otherwise:
    `jax.config.update("jax_enable_x64", True)`.
    """
    return _differentiated(_Jax(_package("jax")), residual, u0, parameters, options)


def from_autograd(
    residual: Function, u0: ArrayLike, parameters: Mapping[str, float], **options: Any
) -> FunctionProblem:
    """`FunctionProblem` of a function written with `autograd.numpy`.  residual, options : as of `from_jax`."""
    return _differentiated(_Autograd(_package("autograd")), residual, u0, parameters, options)


def from_casadi(residual: Function, u0: ArrayLike, parameters: Mapping[str, float], **options: Any) -> FunctionProblem:
    """`FunctionProblem` of a function of CasADi's symbols: u is a column SX, p a mapping of SX; sparse Jacobians.

    residual : (u, p) -> SX, or a sequence of them.  options : those of `FunctionProblem`.
    """
    casadi = _package("casadi")
    start = np.array(u0, dtype=float).ravel()
    n, names = start.size, tuple(parameters)
    z = casadi.SX.sym("z", n + len(names))
    given = residual(z[:n], {name: z[n + k] for k, name in enumerate(names)})
    value = given if isinstance(given, casadi.SX) else casadi.vertcat(*given)
    slopes = casadi.jacobian(value, z)
    forms, form, seeds = [], value, []
    for order in range(1, 4):
        seeds.append(casadi.SX.sym(f"d{order}", n + len(names)))
        form = casadi.jtimes(form, z, seeds[-1])
        forms.append(casadi.Function(f"form{order}", [z, *seeds], [casadi.densify(form)]))
    at = casadi.Function("value", [z], [casadi.densify(value)])
    in_states = casadi.Function("in_states", [z], [slopes[:, :n]])
    in_parameters = casadi.Function("in_parameters", [z], [casadi.densify(slopes[:, n:])])

    def place(u: Array, p: Mapping[str, float]) -> Array:
        return np.concatenate([np.asarray(u, dtype=float), [float(p[name]) for name in names]])

    def jacobian(u: Array, p: Mapping[str, float]) -> Any:
        matrix = in_states(place(u, p))
        return np.asarray(matrix) if n < SPARSE_FROM else matrix.sparse().tocsc()

    def derivative(u: Array, p: Mapping[str, float], *directions: Array) -> Array:
        return np.asarray(forms[len(directions) - 1](place(u, p), *directions)).ravel()

    return FunctionProblem(
        lambda u, p: np.asarray(at(place(u, p))).ravel(), start, parameters, jacobian,
        parameter_jacobian=lambda u, p, name: np.asarray(in_parameters(place(u, p)))[:, names.index(name)],
        derivative=derivative, **options,
    )  # fmt: skip


def _package(name: str) -> ModuleType:
    try:
        return import_module(name)
    except ImportError:
        raise InputError(f"from_{name} needs the package {name}: pip install {name} (or contin[{name}])") from None


def _differentiated(
    tools: Tools, residual: Function, u0: ArrayLike, parameters: Mapping[str, float], options: Mapping[str, Any]
) -> FunctionProblem:
    start = np.array(u0, dtype=float).ravel()
    n, names = start.size, tuple(parameters)

    def joined(z: Any) -> Any:
        return residual(z[:n], {name: z[n + k] for k, name in enumerate(names)})

    value, slopes = tools.compiled(joined), tools.jacobian(joined)

    def place(u: Array, p: Mapping[str, float]) -> Array:
        return np.concatenate([np.asarray(u, dtype=float), [float(p[name]) for name in names]])

    def derivative(u: Array, p: Mapping[str, float], *directions: Array) -> Array:
        return np.asarray(_along_all(tools, joined, directions)(place(u, p)))

    return FunctionProblem(
        lambda u, p: np.asarray(value(place(u, p))), start, parameters,
        lambda u, p: np.asarray(slopes(place(u, p)))[:, :n],
        parameter_jacobian=lambda u, p, name: np.asarray(slopes(place(u, p)))[:, n + names.index(name)],
        derivative=derivative, **options,
    )  # fmt: skip


def _along_all(tools: Tools, function: Joined, directions: Sequence[Vector]) -> Joined:
    for direction in directions:
        function = tools.along(function, direction)
    return function
