"""Checks of a user's function before it is used: double precision, and a Jacobian that is its derivative."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.errors import UserFunctionError

if TYPE_CHECKING:
    from contin.systems.functions.given_function import GivenFunction

BESIDE: Final = (
    0.01  # distance from the start (relative) of the points that are tried: what vanishes there hides nothing
)
STEP: Final = 1e-3  # of differences, relative; a second one with half of it measures their error
WRONG: Final = 1e-3  # relative difference beyond which a derivative is wrong
DIRECTIONS: Final = 2
SEARCHED: Final = 200  # states among which the wrong entry is searched for


def real(what: str, array: Vector) -> Array:
    """Numbers in double precision; UserFunctionError for complex ones."""
    if array.dtype.kind == "c":
        if np.any(array.imag != 0.0):
            worst = int(np.argmax(np.abs(array.imag.ravel())))
            raise UserFunctionError(
                f"the {what} returned the complex number {array.ravel()[worst]:.6g} for real arguments (a root or "
                "logarithm of a negative number?)"
            )
        array = array.real
    return np.array(array, dtype=float)


class Tried(Protocol):
    """What trials ask of a function with its derivatives."""

    model: GivenFunction
    n: int
    m: int
    parameter_names: tuple[str, ...]

    def raw(self, u: Vector, p: Vector) -> Vector:
        """What the function returns, (n,)."""

    def jacobian_product(self, u: Array, p: Array, v: Array) -> Array:
        """dF/du v."""

    def parameter_slope(self, u: Array, p: Array, k: int) -> Array:
        """dF/dp of one parameter."""


def try_function(system: Tried, u0: Array, p0: Array) -> None:
    """UserFunctionError where the function, or a derivative that is given, cannot be what continuation needs."""
    sizes = np.concatenate(
        [np.where(u0 != 0.0, np.abs(u0), system.model.typical), np.where(p0 != 0.0, np.abs(p0), 1.0)]
    )
    generator = np.random.default_rng(17)
    for _ in range(DIRECTIONS):
        shift = BESIDE * sizes * generator.uniform(-1.0, 1.0, sizes.size)
        direction = sizes * generator.uniform(-1.0, 1.0, sizes.size)
        u, p = u0 + shift[: system.n], p0 + shift[system.n :]
        value = _value(system, u, p)
        if value is None:
            continue  # defined nearer to the start only
        _in_double_precision(value)
        _try_jacobian(system, u, p, direction)
        _try_parameters(system, u, p, direction)


def _value(system: Tried, u: Array, p: Array) -> Vector | None:
    """F as the function gives it; None where it fails, or is not real and finite."""
    try:
        value = system.raw(u, p)
    except UserFunctionError:  # told where the function is called at the start itself
        return None
    return value if np.all(np.isfinite(value)) and not np.any(np.imag(value)) else None


def _in_double_precision(value: Vector) -> None:
    floats = value.dtype in (np.float32, np.float16, np.complex64)
    numbers = np.real(value).astype(float)
    with np.errstate(over="ignore"):
        rounded = np.any(numbers != np.rint(numbers)) and np.all(numbers == numbers.astype(np.float32).astype(float))
    if floats or rounded:
        raise UserFunctionError(
            "the residual computes in float32, with 7 digits; continuation needs float64 (numpy: dtype=float; "
            'JAX: jax.config.update("jax_enable_x64", True); torch: dtype=torch.float64)'
        )


def _difference(system: Tried, u: Array, p: Array, v: Array) -> tuple[Array, Array]:
    """D F[v] by central differences, and the estimate of its error; NaN where F is not real and finite.

    Two differences may err alike by rounding, as where a small term stands beside large ones: that is counted too.
    """
    n, slopes, size = system.n, [], 0.0
    for h in (STEP, 0.5 * STEP):
        ahead, behind = (_value(system, u + s * h * v[:n], p + s * h * v[n:]) for s in (1.0, -1.0))
        if ahead is None or behind is None:
            return np.full(n, np.nan), np.full(n, np.nan)
        slopes.append((np.real(ahead).astype(float) - np.real(behind).astype(float)) / (2.0 * h))
        size = max(size, float(np.abs(ahead).max(initial=0.0)), float(np.abs(behind).max(initial=0.0)))
    rounding = float(np.finfo(float).eps) * size / STEP
    return (4.0 * slopes[1] - slopes[0]) / 3.0, np.abs(slopes[1] - slopes[0]) + rounding


def differs(given: Array, found: Array, error: Array) -> NDArray[np.bool_]:
    """Components in which a derivative is not the one found by differences, beyond the error of these."""
    size = float(np.max(np.abs(found), initial=0.0))
    return np.asarray(
        np.abs(given - found) > WRONG * np.maximum(np.abs(given), np.abs(found)) + 20.0 * error + 1e-6 * size
    )


def _try_jacobian(system: Tried, u: Array, p: Array, direction: Array) -> None:
    if system.model.jacobian is None:
        return
    v = np.append(direction[: system.n], np.zeros(system.m))
    given = system.jacobian_product(u, p, v[: system.n])
    found, error = _difference(system, u, p, v)
    bad = differs(given, found, error)
    if not np.any(bad) or not np.all(np.isfinite(found)):
        return
    row = int(np.flatnonzero(bad)[np.argmax(np.abs(given - found)[bad])])
    raise UserFunctionError(
        "the jacobian is not the derivative of the residual: "
        + (next(_wrong_entries(system, u, p, row), None) or f"row {row} times a vector is {given[row]:.6g}, and "
           f"differences of the residual give {found[row]:.6g}")
        + ". Correct it, or leave `jacobian` out"
    )  # fmt: skip


def _wrong_entries(system: Tried, u: Array, p: Array, row: int) -> Iterator[str]:
    if system.n > SEARCHED:
        return
    for column in range(system.n):
        v = np.zeros(system.n + system.m)
        v[column] = max(abs(u[column]), 1e-3)
        given = system.jacobian_product(u, p, v[: system.n])
        found, error = _difference(system, u, p, v)
        if differs(given, found, error)[row]:
            yield (
                f"dF[{row}]/du[{column}] is {given[row] / v[column]:.6g}, and differences of the residual give "
                f"{found[row] / v[column]:.6g}"
            )


def try_sparsity(system: Tried, matrix: Callable[[Array, Array], Any]) -> None:
    """UserFunctionError where differences by the colours of a given pattern are not those in a random direction.

    matrix : (u, p) -> dF/du in the pattern. What the pattern leaves out is missing there, or counted elsewhere.
    """
    u0, p0 = system.model.start_point()
    sizes = np.where(u0 != 0.0, np.abs(u0), system.model.typical)
    generator = np.random.default_rng(23)
    for _ in range(DIRECTIONS):
        u = u0 + BESIDE * sizes * generator.uniform(-1.0, 1.0, sizes.size)
        v = np.append(sizes * generator.uniform(-1.0, 1.0, sizes.size), np.zeros(system.m))
        if _value(system, u, p0) is None:
            continue
        jacobian = matrix(u, p0)
        given = np.asarray(jacobian @ v[: system.n], dtype=float)
        found, error = _difference(system, u, p0, v)
        bad = differs(given, found, error)
        if not np.any(bad) or not np.all(np.isfinite(found)):
            continue
        row = int(np.flatnonzero(bad)[np.argmax(np.abs(given - found)[bad])])
        where = next(_left_out(system, jacobian, u, p0), None) or f"F[{row}] depends on states that its row leaves out"
        raise UserFunctionError(
            f"`sparsity` is not the pattern of dF/du: {where}. Add what is missing (entries that are zero do no harm), "
            "or give `jacobian`"
        )


def _left_out(system: Tried, jacobian: Any, u: Array, p: Array) -> Iterator[str]:
    """Entries that are not zero and not in the pattern, in words."""
    if system.n > SEARCHED:
        return
    pattern = jacobian.copy()
    pattern.data[:] = 1.0
    for column in range(system.n):
        v = np.zeros(system.n + system.m)
        v[column] = max(abs(u[column]), 1e-3)
        found, error = _difference(system, u, p, v)
        inside = pattern[:, [column]].toarray().ravel() != 0.0
        for row in np.flatnonzero(~inside & differs(np.zeros(system.n), found, error)):
            yield f"F[{row}] depends on u[{column}], and entry ({row}, {column}) is not in it"


def _try_parameters(system: Tried, u: Array, p: Array, direction: Array) -> None:
    if system.model.parameter_jacobian is None:
        return
    for k, name in enumerate(system.parameter_names):
        v = np.zeros(system.n + system.m)
        v[system.n + k] = direction[system.n + k]
        given = v[system.n + k] * system.parameter_slope(u, p, k)
        found, error = _difference(system, u, p, v)
        bad = differs(given, found, error)
        if np.any(bad) and np.all(np.isfinite(found)):
            row = int(np.flatnonzero(bad)[0])
            raise UserFunctionError(
                f"the parameter Jacobian is not the derivative of the residual: dF[{row}]/d{name} is "
                f"{given[row] / v[system.n + k]:.6g}, and differences give {found[row] / v[system.n + k]:.6g}"
            )


def not_analytic(
    system: Tried, u: Array, p: Array, first: Callable[[Array, Array, Array], Array]
) -> str | None:
    """Where complex steps give another derivative here than differences do: which; None where they agree."""
    z = np.concatenate([u, p])
    v = np.maximum(np.abs(z), 1e-3) * np.random.default_rng(19).uniform(-1.0, 1.0, z.size)
    given = first(u, p, v)
    found, error = _difference(system, u, p, v)
    bad = differs(given, found, error)
    if not np.any(bad) or not np.all(np.isfinite(found)):
        return None
    row = int(np.flatnonzero(bad)[0])
    return (
        f"the residual takes complex arguments, but is not analytic everywhere: the slope of component {row} is "
        f"{given[row]:.6g} by a complex step and {found[row]:.6g} by differences (np.real, abs or a comparison "
        "inside?). Differences are used from here on; give `jacobian` for more digits"
    )
