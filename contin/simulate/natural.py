"""Natural sizes of states and time at a start: the one source of absolute numbers, covariant under a change of units.

A tolerance, a push, a box, a distance is so many natural sizes. If a state is measured in other units its size changes
by the same factor, and the computation is the same. A state's size is, in this order: the model's `scale`; an angle's
period / (2 pi); its value at the start, or the largest one in the model's own starts; how far its equation moves it in
the natural time; the length over which the equations bend; what the coupling to the others makes of their sizes
(Osborne's balancing, to first and second order). Where none of these says anything it is 1: see `Metric.guessed`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.errors import ContinError
from contin.linalg.balancing import balancing_scales
from contin.machine import elementary
from contin.model.kept import kept_with
from contin.model.model import Model
from contin.simulate.beyond_slopes import lengths_beyond_slopes
from contin.simulate.named import name_of_state
from contin.systems.iterate import sizes_along

if TYPE_CHECKING:
    from contin.systems.protocol import System


REMEMBERED: Final = 256  # values of the parameters
ROUNDING: Final = 1e-12  # of its usual size: a state this small is a zero with rounding errors
SMALLER: Final = 1e-2  # absolute tolerances, in natural sizes, beside relative ones
IN_A_STEP: Final = 100.0  # roundings of the terms of an equation in the natural time
COUPLED_UP_TO: Final = 500  # states of a function, up to which tolerances ask for its eigenvalues
BENDS_UP_TO: Final = 50  # states: second and third derivatives are taken for so many
SWEEPS: Final = 10  # of balancing
BENDING: Final = 1e3  # ratio of a state's size to the length over which its equations bend, or its inverse, at most
NUDGE: Final = 1e-13  # relative change of states and parameters ...
CHANCE: Final = 0.01  # ... at which a number that changes by this part of itself is one of rounding errors
TINY: Final = float(np.finfo(float).tiny)


@dataclass(frozen=True, eq=False)
class Metric:
    """Natural sizes of the states (n,) and of time, all positive; names of the states whose size is a mere 1."""

    states: Array
    time: float
    guessed: tuple[str, ...] = ()

    def tolerances(self, relative: float) -> Array:
        """Absolute tolerances (n,): these parts of the natural sizes."""
        return relative * self.states


def natural_metric(system: System, u: Array, p: Array, seen: Array | None = None) -> Metric:
    """The metric at a start (u, p) of a compiled model, or of a Python function.

    seen : (n,) the largest moduli of the states where they are known, in place of those in the model's starts.
    """
    n = int(system.n)
    full = np.append(p, 0.0) if system.is_forced else np.asarray(p, dtype=float)
    declared, usual = sizes_of(system.model, tuple(float(v) for v in p))
    usual = usual if seen is None else np.where(seen > 0.0, seen, usual)
    f, jacobian = (np.nan_to_num(part, posinf=0.0, neginf=0.0) for part in system.jacobian(u, full))
    matrix = jacobian[:, :n]
    if system.kind == "map":
        f, matrix = f - u, matrix - np.eye(n)
    rate = float(np.abs(np.linalg.eigvals(matrix)).max())
    reached = sizes_along(system, u, full)
    size = np.where(declared > 0.0, declared, np.maximum(beyond_rounding(reached, usual), usual))
    terms = np.abs(jacobian) @ np.abs(np.concatenate([reached, full]))  # what cancels in f, to first order
    moved = np.where(np.abs(f) > ROUNDING * terms, np.abs(f), 0.0) / (rate if rate > 0.0 else np.inf)
    size = np.where(size > 0.0, size, moved)
    found, guessed = filled(size, np.abs(matrix))
    if guessed.any() and n <= BENDS_UP_TO:
        second, third = pure_derivatives(system, u, full)
        lengths = growth_lengths(np.abs(matrix), second, third)
        known = np.where(size > 0.0, size, lengths)
        said = np.where(guessed, size == 0.0, (usual > 0.0) & (size > ROUNDING * size.max()))
        known = np.where(guessed, known, size)
        found, guessed = filled(known, np.abs(matrix), second, lengths, said)
        if guessed.any():
            further = lengths_beyond_slopes(system, u, full, np.abs(matrix), np.where(guessed, lengths, found))
            known = np.where(guessed & (size == 0.0), further, known)
            found, guessed = filled(known, np.abs(matrix), second, lengths, said)
    size = found
    time = 1.0 / rate if rate > 0.0 else 0.0
    if system.kind == "map":
        time = 1.0
    elif not time > 0.0 and f.any():
        time = float(np.min(size[f != 0.0] / np.abs(f[f != 0.0])))
    named = tuple(name_of_state(system, int(k)) for k in np.flatnonzero(guessed))
    return Metric(size, time if time > 0.0 else 1.0, named)


def absolute_tolerances(
    system: System, u: Array, p: Array, relative: float, given: float | Array | None = None
) -> Array:
    """Absolute tolerances of the states (n,): as given, for one or all, or these parts of their natural sizes."""
    if given is not None:
        return np.full(int(system.n), given, dtype=float)
    if int(system.n) > COUPLED_UP_TO and not isinstance(system.model, Model):
        usual = sizes_of(system.model, tuple(float(v) for v in p))[1]
        return np.asarray(relative * np.maximum(usual, np.abs(u)))
    return natural_metric(system, np.asarray(u, dtype=float), np.asarray(p, dtype=float)).tolerances(relative)


def above_rounding(system: System, allowed: Array, u: Array, p: Array) -> Array:
    """Absolute tolerances (n,) of the states, none below the rounding errors of the equations at (u, p).

    What cancels in f_i, |f_u| |u| + |f_p| |p|, leaves a rounding error of some eps of it, which moves u_i by so much in
    the natural time: no step is short enough for a smaller tolerance (a state that is zero, as on an invariant plane,
    where the solution leaves a start near an equilibrium and its terms become large).
    """
    if len(u) > COUPLED_UP_TO:
        return allowed
    jacobian = np.nan_to_num(system.jacobian(u, p)[1], posinf=0.0, neginf=0.0)
    rate = float(np.abs(np.linalg.eigvals(jacobian[:, : len(u)])).max())  # in any units
    if not rate > 0.0:
        return allowed
    terms = np.abs(jacobian) @ np.abs(np.concatenate([u, p]))
    return np.asarray(np.maximum(allowed, IN_A_STEP * np.finfo(float).eps * terms / rate))


def with_variations(
    allowed: Array, relative: float, variations: Array | None, parameters: Array | None = None
) -> Array:
    """Absolute tolerances of (u, v_1, .., v_k): those of v_j as many times as large as it begins, in natural sizes.

    allowed : of u, these (`relative`) parts of the natural sizes.  A sensitivity begins at 0: its tolerance is that of
    the states, divided by its parameter's value in `parameters` (k,).
    """
    allowed = np.maximum(np.asarray(allowed, dtype=float), TINY)  # of an orbit at rest in the origin: 0
    if variations is None:
        return allowed
    factors = relative * (np.abs(np.asarray(variations, dtype=float)) / allowed[:, None]).max(axis=0)
    if not factors.all():
        q = np.zeros(len(factors)) if parameters is None else np.abs(parameters)
        begun = 1.0 / np.where(q > 0.0, q, 1.0)
        factors = np.where(factors == 0.0, begun, factors)
    return np.concatenate([allowed, np.outer(factors, allowed).ravel()])


def sizes_of(model: Any, p: tuple[float, ...]) -> tuple[Array, Array]:
    """(declared, usual) sizes (n,) of a model's states, 0 where there are none.

    declared : `scale`, or an angle's period / (2 pi).  usual : the largest moduli in the model's default and named
    starts, at these values of the parameters.
    """
    known: dict[tuple[float, ...], tuple[Array, Array]] = kept_with(model, "natural sizes", dict)
    if p not in known:
        if len(known) >= REMEMBERED:
            known.clear()
        known[p] = _sizes_of(model, p)
    return known[p]


def _sizes_of(model: Any, p: tuple[float, ...]) -> tuple[Array, Array]:
    if not isinstance(model, Model):  # a Python function
        return model.declared_sizes, np.where(model.u0 != 0.0, np.abs(model.u0), model.typical)
    values = dict(zip(model.parameter_names, p, strict=True))
    periods = model.periods(values) / (2.0 * np.pi)
    declared = np.where(periods > 0.0, periods, model.scales(values))
    usual = np.zeros(len(model.states))
    for start in (None, *(s.name for s in model.starts)):
        try:
            usual = np.maximum(usual, np.abs(model.start_point(start, values)[0]))
        except ContinError:  # a start that does not exist for these parameters
            continue
    return declared, usual


def beyond_rounding(u: Array, usual: Array) -> Array:
    """|u|, and 0 where that is a rounding error beside the usual sizes."""
    size = np.abs(u)
    return np.asarray(np.where(size > ROUNDING * usual, size, 0.0))


def pure_derivatives(system: System, u: Array, p: Array) -> tuple[Array, Array]:
    """|d^2 F_k / d u_i^2| and |d^3 F_k / d u_i^3|, (n, n) each; p (p_size,). Those of rounding errors are 0.

    What changes by a part of itself where states and parameters change by some hundred roundings is one of those: terms
    that cancel, by symmetry or by chance. (A zero that is exact, or comes of an exponent that is moved, says nothing.)
    """
    n, z = int(system.n), np.concatenate([u, p])
    directions = np.tile(np.eye(n, len(z)), (3, 1))
    signs = np.where(np.arange(len(z)) % 2 == 0, 1.0, -1.0)
    nudges = np.array([np.zeros(len(z)), NUDGE * signs, np.full(len(z), NUDGE)])
    places = np.repeat(z * (1.0 + nudges), n, axis=0)
    orders = [system.derivatives(places[:, :n], places[:, n:], *order * [directions]) for order in (2, 3)]
    size = np.nan_to_num(np.abs(np.array(orders)).reshape(2, 3, n, n).swapaxes(2, 3), posinf=0.0)
    here = size[:, 0].copy()
    for there in (size[:, 1], size[:, 2]):
        here[(np.abs(there - here) > CHANCE * here) & (there > 0.0)] = 0.0
    return here[0], here[1]


def growth_lengths(slopes: Array, second: Array, third: Array) -> Array:
    """Where the terms of second or third order in a state alone are as large as those of first order, (n,).

    slopes : (n, n), |d F_k / d u_i|, or how large that becomes over the parameter's range. 0 where nothing says so.
    """
    slopes = without_rounding(slopes)  # of z' = -x^2 the one at x = 1e-33 is 2e-33, as long as that is not x's unit
    with np.errstate(divide="ignore", invalid="ignore"):
        lengths = np.stack([2.0 * slopes / second, np.sqrt(6.0 * slopes / third)])
    lengths = np.where(np.isfinite(lengths) & (lengths > 0.0), lengths, np.inf)
    shortest = lengths.min(axis=(0, 1))
    return np.asarray(np.where(np.isfinite(shortest), shortest, 0.0))


def filled(
    scale: Array,
    coupling: Array,
    second: Array | None = None,
    lengths: Array | None = None,
    said: NDArray[np.bool_] | None = None,
) -> tuple[Array, NDArray[np.bool_]]:
    """Unknown (zero) sizes (n,) so that coupling (n, n) to and from the others is alike; and which are a mere 1.

    second : |d^2 F_k / d u_i^2|, (n, n): what drives a state to which nothing couples to first order.
    lengths : (n,), over which the equations bend in each state; a size as large as that is no rounding error.
    said : (n,), true where a size is the model's own word, which is one in units of 1e-12 of the others, too.
    """
    n = scale.size
    known = scale > ROUNDING * scale.max(initial=0.0)  # below that, the coupling decides whether it is rounding
    if lengths is not None:
        known |= np.isfinite(lengths) & (scale > lengths / BENDING) & (scale < lengths * BENDING)
    if said is not None:
        known |= said & (scale > 0.0)
    result = np.where(known, scale, 1.0)
    found = known.copy()
    unknown = np.flatnonzero(~known)
    if not known.any() or not unknown.size:
        return result, ~found
    coupling = without_rounding(coupling)
    for _ in range(SWEEPS):
        before = result.copy(), found.copy()
        for i in unknown:
            others = (np.arange(n) != i) & found
            incoming = float(coupling[i, others] @ result[others])
            outgoing = float(coupling[others, i] @ (1.0 / result[others]))
            if incoming == 0.0 and second is not None:
                incoming = float(0.5 * second[i, others] @ elementary.square(result[others]))
            if incoming > 0.0 and outgoing > 0.0:
                result[i] = np.sqrt(incoming / outgoing)
            elif incoming > 0.0 and coupling[i, i] > 0.0:  # only driven: as large as the others make it
                result[i] = incoming / coupling[i, i]
            else:
                continue
            found[i] = True
        if np.array_equal(result, before[0]) and np.array_equal(found, before[1]):  # as all further sweeps would
            break
    # small in its units, and no rounding; of a state to which nothing couples nobody knows: 2e-17 is mostly a zero
    own = ~known & found & (scale > ROUNDING * result)
    return np.where(own, scale, result), ~(found | own)


def without_rounding(coupling: Array) -> Array:
    """Moduli of a matrix (n, n), 0 where they are rounding errors beside the others once it is balanced.

    In units of 1e-9 and 1e9 of two states one entry is 1e-36 of the other, and yet no rounding error.
    """
    if not np.any((coupling > 0.0) & (coupling <= ROUNDING * coupling.max())):
        return coupling
    d = balancing_scales(coupling)
    balanced = coupling / d[:, None] * d
    return np.asarray(np.where(balanced > ROUNDING * balanced.max(), coupling, 0.0))


def guessed_note(names: Sequence[str]) -> str:
    """What to say of states whose size is a mere 1."""
    listed = ", ".join(names)
    several = len(names) > 1
    return (
        f"nothing says how large {listed} {'are' if several else 'is'} (0 at the start, and in every start of the "
        f"model): taken as 1; declare it, {names[0]}: {{value: 0, scale: ...}}"
    )
