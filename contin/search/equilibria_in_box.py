"""All equilibria in a box at fixed parameters, as far as Newton from many starts and deflation find them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import NO_FUNCTION, Address, Array
from contin.continuation.told import Told
from contin.errors import ContinError, InputError
from contin.kernels.deflation import search
from contin.machine import elementary
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.equilibria.special_points import eigenvalues_of
from contin.search.equilibrium_from_guess import Equilibrium, converge

if TYPE_CHECKING:
    from contin.systems.protocol import System

SINGULAR = 1e-8  # ratio of singular values below which a solution is not isolated
SAME = 1e-6  # solutions closer than this part of the box are one
EFFORT = 3e6  # bounds the number of starts: a start costs about n^3 + 60 multiplications an iteration
ROUNDS = 12  # of deflated Newton from all starts
QUIET_ROUNDS = 2  # ... without anything new, after which the search ends


@dataclass(frozen=True, eq=False, repr=False)
class FoundEquilibrium(Told):
    """One equilibrium of a `find_equilibria`: it starts a continuation like any other.

    image_of : index in the list of the equilibrium of which a declared symmetry (`symmetry`) makes this one, or None.
    isolated : False where the Jacobian is singular (a fold, a branch point, or a point of a continuum).
    """

    equilibrium: Equilibrium
    eigenvalues: NDArray[np.complex128]
    unstable: int
    image_of: int | None = None
    symmetry: str | None = None
    isolated: bool = True

    @property
    def u(self) -> Array:
        return self.equilibrium.u

    @property
    def stable(self) -> bool:
        return self.unstable == 0

    def __str__(self) -> str:
        kind = "stable" if self.stable else f"{self.unstable} unstable"
        image = "" if self.image_of is None else f", {self.symmetry} of number {self.image_of}"
        return f"{self.equilibrium} ({kind}{image})"


@dataclass(frozen=True, eq=False)
class Box:
    """Bounds of the states; lengths are measured in its widths. Angles have their period, whatever their bounds."""

    lower: Array
    upper: Array
    periods: Array

    @property
    def widths(self) -> Array:
        return self.upper - self.lower

    def wrapped(self, u: Array) -> Array:
        """Angles brought into their bounds."""
        moved = u.copy()
        for j in np.flatnonzero(self.periods):
            moved[j] = self.lower[j] + (u[j] - self.lower[j]) % self.periods[j]
        return moved

    def holds(self, u: Array) -> bool:
        slack = SAME * self.widths
        return bool(np.all((u >= self.lower - slack) & (u <= self.upper + slack)))

    def distance(self, a: Array, b: Array) -> float:
        gap = a - b
        angles = np.flatnonzero(self.periods)
        gap[angles] -= self.periods[angles] * np.round(gap[angles] / self.periods[angles])
        return float(np.max(np.abs(gap) / self.widths))

    def starts(self, count: int) -> Array:
        """Points that fill the box evenly (an additive recurrence with the generalised golden ratio), (count, n)."""
        n = len(self.lower)
        ratio = 2.0
        for _ in range(30):
            ratio = elementary.pow(1.0 + ratio, 1.0 / (n + 1))
        steps = elementary.pow(ratio, -np.arange(1.0, n + 1.0))
        fractions = (0.5 + np.outer(np.arange(1, count + 1), steps)) % 1.0
        return np.asarray(self.lower + fractions * self.widths)


def make_box(names: Sequence[str], given: Mapping[str, Sequence[float]] | Sequence[float], periods: Array) -> Box:
    """A box from {state: (lo, hi)}, or (lo, hi) for all states; angles that are not given get their whole period."""
    n = len(names)
    lower, upper = np.full(n, np.nan), np.full(n, np.nan)
    angles = periods > 0.0
    lower[angles], upper[angles] = -0.5 * periods[angles], 0.5 * periods[angles]
    if isinstance(given, Mapping):
        unknown = sorted(set(given) - set(names))
        if unknown:
            raise InputError(f"box: no state {', '.join(unknown)}; there are {', '.join(names)}")
        for name, bounds in given.items():
            lower[names.index(name)], upper[names.index(name)] = (float(x) for x in bounds)
    else:
        lo, hi = (float(x) for x in given)
        lower[~angles], upper[~angles] = lo, hi
    missing = [name for name, low in zip(names, lower, strict=True) if not np.isfinite(low)]
    if missing:
        raise InputError(f"box: say between which values to look for {', '.join(missing)}, e.g. {missing[0]}: (-2, 2)")
    for name, low, high in zip(names, lower, upper, strict=True):
        if not low < high:
            raise InputError(f"box: {name} needs bounds lo < hi; got ({low:g}, {high:g})")
    return Box(lower, upper, periods)


def find(system: System, box: Box, p: Array, starts: int | None = None) -> list[FoundEquilibrium]:
    """Isolated solutions in the box, in ascending order of the states; of a continuum, one point."""
    n = system.n
    most = 1000 if system.jacobian_address != NO_FUNCTION else 40  # a call of a Python function takes 100 times as long
    count = starts or int(np.clip(EFFORT / (60 * (n**3 + 60)), 24, most))
    guesses = box.starts(count)
    known: list[tuple[Array, bool]] = []

    def add(u: Array) -> bool:
        u = box.wrapped(u)
        if not np.all(np.isfinite(u)) or not box.holds(u) or any(box.distance(u, v) < SAME for v, _ in known):
            return False
        isolated = _is_isolated(system, box, u, p)
        if not isolated and any(not kept for _, kept in known):
            return False
        known.append((u, isolated))
        return True

    with _address_of(system) as address:
        quiet = 0
        for turn in range(ROUNDS):
            new = False
            deflated = np.array([u for u, _ in known]).reshape(-1, n)
            for u in _search(system, address, guesses, p, box, deflated):
                if add(u):
                    new = True
                    for image in _images(system, u, p):
                        add(image)
            quiet = 0 if new else quiet + 1
            if quiet >= QUIET_ROUNDS or (turn > 0 and not known):
                break
    return _linked(system, box, p, known)


def _search(system: System, address: Address, guesses: Array, p: Array, box: Box, known: Array) -> Array:
    """Where Newton converged to, (k, n)."""
    out, status = np.empty_like(guesses), np.zeros(len(guesses), np.bool_)
    centre = 0.5 * (box.lower + box.upper)
    table = known if len(known) else np.zeros((1, system.n))
    is_map = system.kind == "map"
    search(address, is_map, guesses, p.copy(), centre, box.widths, box.periods, table, len(known), out, status)
    return out[status]


def _is_isolated(system: System, box: Box, u: Array, p: Array) -> bool:
    """False where the Jacobian, in units of the box, is singular."""
    matrix = system.jacobian(u, p)[1][:, : system.n] - (np.eye(system.n) if system.kind == "map" else 0.0)
    singular = np.linalg.svd(matrix * box.widths / box.widths[:, None], compute_uv=False)
    return bool(singular[-1] > SINGULAR * singular[0])


def _images(system: System, u: Array, p: Array) -> Iterator[Array]:
    for symmetry in system.model.symmetries:
        yield system.symmetry(symmetry.name, u[None, :], p)[0]


def _linked(system: System, box: Box, p: Array, known: Sequence[tuple[Array, bool]]) -> list[FoundEquilibrium]:
    """Polished, sorted, with unstable counts, and mirror images pointing at the first of their kind."""
    solved: list[tuple[Equilibrium, bool]] = []
    for u, isolated in sorted(known, key=lambda item: tuple(np.round(item[0] / box.widths, 6))):
        try:
            exact = converge(system, u, p, box.periods)
        except ContinError:  # Newton stalled there with deflation: no equilibrium
            continue
        if not any(box.distance(exact.u, other.u) < SAME for other, _ in solved) and box.holds(box.wrapped(exact.u)):
            solved.append((exact, isolated))
    found: list[FoundEquilibrium] = []
    problem = EquilibriumProblem(system, np.array(p), 0, box.periods)
    for k, (exact, isolated) in enumerate(solved):
        values = eigenvalues_of(problem, np.append(exact.u, p[:1]))
        size = float(np.abs(values).max(initial=1e-300))
        outside = np.abs(values) > 1.0 + 1e-12 if problem.is_map else values.real > 1e-12 * size
        link = _link(system, box, p, found, exact.u)
        found.append(FoundEquilibrium(exact, values, int(outside.sum()), *link, isolated))
        assert len(found) == k + 1
    return found


def _link(
    system: System, box: Box, p: Array, earlier: Sequence[FoundEquilibrium], u: Array
) -> tuple[int | None, str | None]:
    for index, other in enumerate(earlier):
        if other.image_of is None:
            for symmetry in system.model.symmetries:
                image = system.symmetry(symmetry.name, other.u[None, :], p)[0]
                if box.distance(image, u) < SAME:
                    return index, symmetry.name
    return None, None


class _address_of:
    """The Jacobian's address; for a user's function, that of a callback which lives inside the `with` block."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.error: BaseException | None = None
        self._keep: Callable[..., object] | None = None

    def __enter__(self) -> Address:
        if self.system.jacobian_address != NO_FUNCTION:
            return int(self.system.jacobian_address)
        import ctypes

        n, m = self.system.n, self.system.m
        vector = ctypes.POINTER(ctypes.c_double)

        def call(u: object, p: object, f: object, jacobian: object) -> None:
            out_f = np.ctypeslib.as_array(f, (n,))
            out_j = np.ctypeslib.as_array(jacobian, (n, n + m))
            try:
                states = np.ctypeslib.as_array(u, (n,)).copy()
                others = np.ctypeslib.as_array(p, (m,)).copy() if m else np.empty(0)
                out_f[:], out_j[:] = self.system.jacobian(states, others)
            except BaseException as error:  # noqa: BLE001  (carried over the machine code, raised again below)
                self.error = error
                out_f[:] = np.nan

        self._keep = ctypes.CFUNCTYPE(None, vector, vector, vector, vector)(call)
        return int(ctypes.cast(self._keep, ctypes.c_void_p).value or 0)

    def __exit__(self, *details: object) -> None:
        if self.error is not None:
            raise self.error
