"""What a normal form needs to know of the equations: multilinear derivatives at one point, and nothing else."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import combinations_with_replacement, product
from typing import Final, Literal, Protocol, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from contin.abi import Vector
from contin.offers import offers

Real: TypeAlias = NDArray[np.float64]
Complex: TypeAlias = NDArray[np.complex128]
Kind: TypeAlias = Literal["flow", "map"]

FEW: Final = 5  # states and parameters up to which all derivatives of one order are computed at once, ...
TENSORS: Final = (2, 3)  # ... and the orders
SIGNS: Final = np.array([1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0])
SPREAD: Final = 4.0  # of the error of a form by differences, over the largest change by other ones
SINGLE: Final = 4  # forms of real directions that are evaluated one by one


class Jet(Protocol):
    """Derivatives of F(u, p) at (u0, p0): u' = F(u, p) for a flow, u -> F(u, p) for a map.

    `form(d1, ..., dk)` is D^k F(u0, p0)[d1, ..., dk], linear in each direction and independent of their order. A
    direction has length n + parameters (states first, then the active parameters) and may be complex. `A` is F_u.
    """

    @property
    def n(self) -> int: ...

    @property
    def parameters(self) -> int: ...

    @property
    def kind(self) -> Kind: ...

    @property
    def A(self) -> Real: ...

    @property
    def scale(self) -> Real | None:
        """Typical sizes of the states, (n,), all positive, where they are known: null vectors are computed in them."""

    @property
    def second_sizes(self) -> Real:
        """|D^2 F_i(u0, p0)[e_j, e_k]| in the states, (n, n, n)."""

    def form(self, *directions: Vector) -> Vector: ...


class Weighed(Protocol):
    """A jet of M u' = F(u, p)."""

    @property
    def mass(self) -> Real | None:
        """M (n, n), singular or not; None: the identity."""


def mass_of(jet: Jet) -> Real | None:
    """M of a jet that has one; None: the identity."""
    return cast(Weighed, jet).mass if offers(type(jet), "mass") else None


class Disturbed:
    """A jet whose derivatives are off by errors; a subclass gives `A` and `form`, all else is that of `jet`."""

    jet: Jet

    @property
    def n(self) -> int:
        return self.jet.n

    @property
    def parameters(self) -> int:
        return self.jet.parameters

    @property
    def kind(self) -> Kind:
        return self.jet.kind

    @property
    def mass(self) -> Real | None:
        return mass_of(self.jet)

    @property
    def scale(self) -> Real | None:
        return self.jet.scale

    @property
    def second_sizes(self) -> Real:
        return self.jet.second_sizes


@dataclass(frozen=True, eq=False)
class DerivativeJet:
    """A jet from a function that gives derivatives along real directions.

    `derivative((d1, ..., dk))` returns D^k F[d1, ..., dk] for real d of length n + parameters. Complex directions are
    expanded by multilinearity; equal and conjugate directions share their evaluations (F5[q, q, q, q*, q*] takes 6
    real ones, not 32), and every multiset of directions is evaluated once in the jet's life. Of few states and
    parameters all derivatives of second and third order are evaluated, at unit vectors, where complex directions or
    many come up: forms are sums of them (35 for each equation at most).
    """

    A: Real
    derivative: Callable[[tuple[Real, ...]], Real]
    parameters: int = 0
    kind: Kind = "flow"
    scale: Real | None = None
    several: Callable[[Sequence[tuple[Real, ...]]], Sequence[Real]] | None = None  # the same for several tuples
    mass: Real | None = None
    otherwise: tuple[DerivativeJet, ...] = ()  # with other differences, which tell errors; () of exact derivatives
    rounded: Callable[[], Sequence[DerivativeJet]] | None = None  # otherwise, where a system knows how; see `rounding`
    _known: dict[tuple[bytes, ...], Real] = field(default_factory=dict, repr=False)
    _tensors: dict[int, Real | None] = field(default_factory=dict, repr=False)
    _asked: dict[int, int] = field(default_factory=dict, repr=False)

    @cached_property
    def n(self) -> int:
        return len(self.A)

    def form(self, *directions: Vector) -> Vector:
        order = len(directions)
        known_terms = self._tensors.get(order)
        if known_terms is not None:
            return contracted(known_terms, directions)
        is_complex = "c" in [d.dtype.kind for d in directions]
        if order in self._tensors or (order in TENSORS and self._has_tensors and self._are_many(order, is_complex)):
            tensor = self._tensor(order)
            if tensor is not None:
                return contracted(tensor, directions)
        if is_complex:
            return expand_complex(self._evaluate, directions, self.n)
        key = tuple(sorted([d.tobytes() for d in directions]))
        known = self._known.get(key)
        if known is None:
            known = self._known[key] = np.array(self.derivative(directions), dtype=float)
        return known

    @property
    def _has_tensors(self) -> bool:
        return self.several is not None and self.n + self.parameters <= FEW

    def _are_many(self, order: int, is_complex: bool) -> bool:
        """Whether the forms of an order that are asked for are worth all its derivatives."""
        self._asked[order] = self._asked.get(order, 0) + 1
        return is_complex or self._asked[order] > SINGLE

    def _tensor(self, order: int) -> Real | None:
        """All derivatives of an order, ((n + parameters)^order, n); None where some are not finite.

        These may belong to a parameter that does not move, and are no part of what is asked for.
        """
        if order not in self._tensors:
            assert self.several is not None
            wanted, places = _units(self.n + self.parameters, order)
            values = np.array(self.several(wanted), dtype=float)
            self._tensors[order] = values[places] if np.isfinite(values).all() else None
        return self._tensors[order]

    def prepare(self, *orders: int) -> None:
        """Evaluate all derivatives of these orders now: many forms of them are to come."""
        for order in orders:
            if order in TENSORS and self._has_tensors:
                self._tensor(order)

    def terms(self, order: int) -> Real | None:
        """The derivatives of an order that its forms are sums of, (width^order, n); None where they are not."""
        return self._tensors.get(order)

    @cached_property
    def second_sizes(self) -> Real:
        n, eye = self.n, np.eye(self.n + self.parameters)
        terms = self._tensors.get(2)
        if terms is not None:
            return np.abs(terms.reshape(len(eye), len(eye), n)[:n, :n]).transpose(2, 1, 0).copy()
        places = [(j, k) for j in range(n) for k in range(j + 1)]
        sizes = np.empty((n, n, n))
        for (j, k), value in zip(places, self._evaluate([(eye[j], eye[k]) for j, k in places]), strict=True):
            sizes[:, j, k] = sizes[:, k, j] = np.abs(value)
        return sizes

    def _evaluate(self, wanted: Sequence[tuple[Real, ...]]) -> list[Real]:
        keys = [tuple(sorted(d.tobytes() for d in directions)) for directions in wanted]
        missing = {key: directions for key, directions in zip(keys, wanted, strict=True) if key not in self._known}
        if self.several is not None and len(missing) > 1:
            self._known.update(zip(missing, self.several(list(missing.values())), strict=True))
        else:
            for key, directions in missing.items():
                self._known[key] = np.array(self.derivative(directions), dtype=float)
        return [self._known[key] for key in keys]


@lru_cache(maxsize=64)
def _units(width: int, order: int) -> tuple[tuple[tuple[Real, ...], ...], NDArray[np.intp]]:
    """Every multiset of so many unit vectors, and where each tuple of them, last one first, stands among these."""
    eye = np.eye(width)
    chosen = list(combinations_with_replacement(range(width), order))
    place = {key: row for row, key in enumerate(chosen)}
    rows = [place[tuple(sorted(key))] for key in product(range(width), repeat=order)]
    return tuple(tuple(eye[k] for k in key) for key in chosen), np.array(rows)


def otherwise(jet: Jet) -> tuple[Jet, ...]:
    """The jet with other differences, which tell errors of its forms; () where these are exact to rounding."""
    return jet.otherwise if isinstance(jet, DerivativeJet) else ()


def uncertain(jet: Jet, *directions: Vector) -> Real:
    """By how much a form is off that differences give, (n,); zero where derivatives are exact to rounding."""
    found = np.zeros(jet.n)
    for other in otherwise(jet):
        found = np.maximum(found, SPREAD * np.abs(jet.form(*directions) - other.form(*directions)))
    return found


def size_of_terms(jet: Jet, *directions: Vector) -> Real:
    """How large the terms of a form are, (n,): the root of the sum of their squares, as that of their errors.

    Where it is not a sum over single derivatives: the modulus of the form in directions with other signs. It may vanish
    in its own because terms of the formulas cancel.
    """
    tensor = jet.terms(len(directions)) if isinstance(jet, DerivativeJet) else None
    if tensor is not None:
        squares = contracted(tensor * tensor, tuple(np.square(np.abs(d)) for d in directions))
        return np.asarray(np.sqrt(squares.real), dtype=float)
    signs = np.resize(SIGNS, jet.n + jet.parameters)
    return np.abs(jet.form(*(d * signs for d in directions)))


def along_units(jet: Jet, *directions: Vector) -> Vector:
    """The form with these directions and each unit vector in one place more, (n + parameters, n)."""
    terms = jet.terms(len(directions) + 1) if isinstance(jet, DerivativeJet) else None
    width = jet.n + jet.parameters
    if terms is not None:
        return contracted(terms, directions).reshape(width, jet.n)
    return np.array([jet.form(*directions, unit) for unit in np.eye(width)])


def combined(jet: Jet, *rows: Real) -> Real:
    """The forms at every choice of one real direction from each set, (a, width), (b, width), ...: (a, b, ..., n)."""
    terms = jet.terms(len(rows)) if isinstance(jet, DerivativeJet) else None
    width, shape = jet.n + jet.parameters, tuple(map(len, rows))
    if terms is None:
        known: dict[tuple[bytes, ...], Vector] = {}  # in whatever order directions stand
        places = [tuple(sorted(d.tobytes() for d in chosen)) for chosen in product(*rows)]
        for place, chosen in zip(places, product(*rows), strict=True):
            if place not in known:
                known[place] = jet.form(*chosen)
        return np.array([known[place] for place in places]).reshape(*shape, jet.n)
    found = terms
    for axis, directions in enumerate(rows):
        found = directions @ found.reshape(*shape[:axis], width, -1)
    return found.reshape(*shape, jet.n)


def contracted(tensor: Real, directions: tuple[Vector, ...]) -> Vector:
    """The multilinear form with these derivatives (width^order, n) at so many directions (width,)."""
    result: Vector = tensor
    for direction in directions:
        result = direction.dot(result.reshape(len(direction), -1))
    return result


def expand_complex(
    evaluate: Callable[[Sequence[tuple[Real, ...]]], Sequence[Real]], directions: tuple[Vector, ...], n: int
) -> Vector:
    """D^k F[d1, ..., dk] for complex directions from evaluations at real ones, all of them together.

    Each direction a + ib is written in real basis vectors (a, b up to sign, zeros dropped), the product is expanded,
    and terms with the same multiset of basis vectors are collected before anything is evaluated.
    """
    basis: dict[bytes, Real] = {}
    split: dict[bytes, list[tuple[bytes, complex]]] = {}  # of every direction, each of which may occur several times
    terms: dict[tuple[bytes, ...], complex] = {(): 1.0}
    for direction in directions:
        whole = direction.tobytes()
        if whole not in split:
            split[whole] = _real_parts(direction, basis)
        grown: dict[tuple[bytes, ...], complex] = {}
        for key, factor in split[whole]:
            for known, coefficient in terms.items():
                keys = tuple(sorted((*known, key)))
                grown[keys] = grown.get(keys, 0.0) + coefficient * factor
        terms = grown
    terms = {keys: coefficient for keys, coefficient in terms.items() if coefficient != 0.0}
    total = np.zeros(n, dtype=complex)
    values = evaluate([tuple(basis[key] for key in keys) for keys in terms])
    for coefficient, value in zip(terms.values(), values, strict=True):
        total += coefficient * value
    return total if any(d.dtype.kind == "c" for d in directions) else total.real


def _real_parts(direction: Vector, basis: dict[bytes, Real]) -> list[tuple[bytes, complex]]:
    """Keys of real basis vectors, which are entered into `basis`, and their factors; the direction is the sum."""
    parts = []
    for part, factor in ((direction.real, 1.0 + 0.0j), (direction.imag, 1.0j)):
        lead = next((x for x in part.tolist() if x != 0.0), 0.0)
        if lead == 0.0:
            continue
        sign = 1.0 if lead > 0.0 else -1.0
        vector = sign * part + 0.0  # + 0.0 turns -0.0 into 0.0: one key a vector
        key = vector.tobytes()
        basis[key] = vector
        parts.append((key, factor * sign))
    return parts


def lift(state: Vector, parameters: int, active: int | None = None) -> Vector:
    """The direction (state, e_active) of length n + parameters; without `active`, no parameter moves."""
    direction = np.zeros(len(state) + parameters, dtype=state.dtype)
    direction[: len(state)] = state
    if active is not None:
        direction[len(state) + active] = 1.0
    return direction
