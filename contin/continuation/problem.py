"""The contract between the engine and what it follows.

A problem is a system F(z) = 0 with one more unknown than equations, z = (state unknowns, varying parameter). The engine
never looks inside: it asks for chunks of the curve, for single points near it, and for the meaning of what changed
between two of them. Lengths and angles are measured in scaled unknowns z / scale.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Final, Protocol, TypeGuard, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.settings import Settings
from contin.records import Record


class Stop(Enum):
    """Why a march returned, in the order of the kernels' codes (`contin.kernels.algebraic`).

    On EVENT, DIP, BOUND, LOOP and CORNER the last row lies beyond what was seen.
    """

    LIMIT = "limit"
    EVENT = "event"
    DIP = "dip"
    BOUND = "bound"
    CORRECTOR = "corrector"
    NOT_FINITE = "not finite"
    RESCALE = "rescale"
    LOOP = "loop"
    CORNER = "corner"


STOPS: Final = tuple(Stop)  # by the code that a kernel returns


WITHOUT_STABILITY: Final = frozenset({"bvp", "algebraic"})  # kinds of solutions that are no states of a flow or map


@dataclass(frozen=True, eq=False)
class Sample:
    """A point of the curve with all that is measured there."""

    z: Array  # (N,) unknowns, the varying parameter last
    tangent: Array  # (N,) unit tangent in scaled unknowns
    tests: Array  # (k,) test functions; a sign change is an event
    unstable: int  # eigenvalues or multipliers on the unstable side
    eigenvalues: NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Chunk:
    """Rows 0 .. m of a march (row 0 repeats where it began) and why it stopped."""

    z: Array
    tangents: Array
    tests: Array
    unstable: NDArray[np.int64]
    eigenvalues: NDArray[np.complex128]
    lengths: Array  # lengths[k]: the step that led to row k
    stop: Stop
    next_step: float
    reference: float  # normalises the determinant-like test; belongs to this chunk's frame
    dipped: int  # which test dipped, where stop is DIP
    evaluations: int
    detail: str = ""  # in words, where the march failed

    def __len__(self) -> int:
        return len(self.z)

    def sample(self, row: int) -> Sample:
        return Sample(self.z[row], self.tangents[row], self.tests[row], int(self.unstable[row]), self.eigenvalues[row])

    def cut(self, rows: int, stop: Stop, next_step: float) -> Chunk:
        """The first rows, as a march that stopped there would have given them."""
        return replace(
            self, z=self.z[:rows], tangents=self.tangents[:rows], tests=self.tests[:rows],
            unstable=self.unstable[:rows], eigenvalues=self.eigenvalues[:rows], lengths=self.lengths[:rows],
            stop=stop, next_step=next_step,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Frame:
    """A metric (`scale`) with the normalisation of the tests that goes with it."""

    scale: Array
    reference: float = 0.0


@dataclass(frozen=True, eq=False)
class Verified:
    """A special point whose defining system was solved to full precision."""

    type: str
    z: Array
    residual: float
    error: float
    eigenvalues: NDArray[np.complex128]
    unstable: int  # critical ones not counted
    normal_form: Record = field(default_factory=dict)
    vectors: Record = field(default_factory=dict)
    also: tuple[str, ...] = ()
    remark: str = ""  # what could not be told about it, such as why its normal form is empty: a note of the branch
    touches: bool = False  # verified although its test need not change sign there: two branches with one tangent
    crowded: bool = False  # other eigenvalues are critical here too: more than this type may happen


@dataclass(frozen=True)
class Rejected:
    """No such point, and why; `suspect` where its defining system should have a solution and has none.

    A jump to another branch would explain that: the step is tried again with half the length.
    """

    reason: str
    suspect: bool = False


@dataclass(frozen=True)
class Nothing:
    """What changed is no event, such as a neutral saddle: nothing to label, and nothing to say."""


NOTHING: Final = Nothing()
Outcome = Verified | Rejected | Nothing


def unverified(type_: str, reason: str) -> Rejected:
    """The defining system of `type_` has no solution there."""
    return Rejected(f"{type_} not verified: {reason}", suspect=True)


class Failure(Enum):
    """Why Newton's method gave no point."""

    NOT_FINITE = "not finite"
    SINGULAR = "singular"
    DIVERGED = "diverged"
    NO_CONTRACTION = "no contraction"
    NO_CONVERGENCE = "no convergence"
    ELSEWHERE = "not the curve that the step set out on"


@dataclass(frozen=True, eq=False)
class Corner:
    """Where a branch turns sharply because the equations are not smooth, without a surface that anybody has named."""

    z: Array


@dataclass(frozen=True)
class Jump:
    """Unstable values change by any number, for the equations are not smooth there: no special point, and no riddle."""

    text: str  # why


@dataclass(frozen=True, eq=False)
class Renewal:
    """A new metric (and mesh) and the samples of an arm in it; or why the arm ends here, and its last row."""

    scale: Array
    origin: Sample
    before: Sample | None
    loop: Sample | None
    end: End | None = None
    last: Sample | None = None  # a row to append: where a family of orbits shrinks, the Hopf point
    point: Verified | None = None  # a label for the last row: HOM


@runtime_checkable
class Adaptive(Protocol):
    """A problem whose unknowns change their meaning along a branch (a mesh that follows the solution)."""

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        """Called after every chunk: see whether the branch ends, and adapt metric and mesh."""

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        """True where two points of one type, found perhaps on different meshes, are the same to their errors."""


@runtime_checkable
class Planar(Protocol):
    """A problem with two varying parameters: the second one, an unknown too, has bounds of its own."""

    @property
    def walls(self) -> Sequence[tuple[int, float, float]]:
        """(index in z, lowest, highest value) of every bounded unknown, the last unknown included."""

    @property
    def identifying(self) -> NDArray[np.bool_]:
        """(N,) true for the unknowns that say which point this is; auxiliary vectors, with free sign, do not."""

    @property
    def growing(self) -> NDArray[np.bool_]:
        """(N,) true for the unknowns whose scale may be outgrown."""

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        """Solve with unknown `index` fixed at `value`, to full precision."""

    def remarks(self, z: Array) -> Sequence[str]:
        """What is to be said of the whole curve, whose rows are z."""


@runtime_checkable
class Remarking(Protocol):
    """A problem that has something to say of a whole branch."""

    def remarks(self, z: Array) -> Sequence[str]:
        """Notes on the branch with rows z."""


@runtime_checkable
class Constrained(Protocol):
    """A problem some of whose eigenvalues are of its method of solution, and say nothing of its solutions."""

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Eigenvalues (multipliers) of the solution z without these."""


@dataclass(frozen=True)
class Floor:
    """Unknown `index` must stay above `lowest`; `singular` where the equations have no value on the floor itself."""

    index: int
    lowest: float
    text: str  # what to say there
    singular: bool = False


@runtime_checkable
class Floored(Protocol):
    """A problem whose equations lose their meaning where an unknown falls to a value."""

    @property
    def floors(self) -> Sequence[Floor]:
        """Every such unknown."""


@runtime_checkable
class Limited(Protocol):
    """A problem whose equations may be an approximation."""

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        """The first of the rows z at which they do not hold, and why; None where they hold at all."""


@runtime_checkable
class Guessing(Protocol):
    """A problem whose metric may rest on nothing for some unknowns."""

    def guessed(self, z: Array, bounds: tuple[float, float]) -> Sequence[str]:
        """The columns of unknowns whose scale at the start z is a mere 1."""

    def guess_note(self, columns: Sequence[str]) -> str:
        """What to say of such columns, where they turn out not to stay 0."""


@runtime_checkable
class Touching(Protocol):
    """A problem whose branches may touch: beyond such a point Newton's method does not tell them apart."""

    def beyond(self, point: Verified, frame: Frame, settings: Settings) -> Sample | None:
        """The branch's own continuation beyond a point with `touches`, where it can be told from the other one."""


@runtime_checkable
class Unfolding(Protocol):
    """A problem that may be started at a point at which the leading terms of its equations tell no branch."""

    def unfolded(self, z: Array, frame: Frame) -> tuple[Sample, Verified, Mapping[int, Array]] | None:
        """The start with a branch's tangent, its label, and a point on the branch by arm; None where there is none."""


@runtime_checkable
class Terminating(Protocol):
    """A problem whose equations mean something else beyond some of its special points."""

    def end_at(self, point: Verified) -> End | None:
        """The end of a curve that has come to this labelled point, its last row; None where it goes on."""


@runtime_checkable
class Foretelling(Protocol):
    """A problem that may know where a branch was going whose corrector fails."""

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """The end that the branch was near, from its last points; None where there is no sign of one."""


class Problem(Protocol):
    """What a problem offers to the engine; `contin.problems.equilibrium` is the model answer.

    Rules for implementers:

    1.  z = (state unknowns, varying parameter) has N components, F(z) = 0 has N - 1; both vary along a branch only
        where the problem is `Adaptive`.
    2.  Tangents are unit vectors in scaled unknowns z / scale; `Sample.tangent` keeps its sense along an arm.
    3.  Row 0 of a chunk repeats `origin`. On EVENT, DIP, BOUND, LOOP and CORNER the last row lies beyond what was
        seen; on all other stops every row is accepted.
    4.  `march` accepts at most `limit` rows, takes no step below `settings.min_step`, and lasts about 50 ms at most.
    5.  Tests have one meaning and one order along a branch: `watch` gives the index of a type's test. A test that has
        no value is NaN; its sign changes nothing.
    6.  `explain` names types only where one of each explains every change between two samples; else it gives None,
        and the engine looks closer.
    7.  `verify` solves the defining system to full precision. A `Verified` holds to its `error`; what is no such point
        is `Rejected`, with its reason, and `NOTHING` where there is nothing to say.
    8.  Numerical trouble is never raised by `march`, `probe`, `verify` or `at_parameter`: it is a stop, None, or a
        reason.
    9.  A problem is a frozen value: pickles and copies serve as well as it does. What it remembers makes answers
        cheaper, not different.
    10. What is born at a point is not the problem's: `contin.transitions` has a table for it. Optional parts are the
        protocols above (`Adaptive`, `Planar`, `Floored`, ...), asked for with `is_adaptive` and so on.
    """

    @property
    def kind(self) -> str:
        """equilibrium | fixed-point | orbit | bvp | locus"""

    @property
    def locus(self) -> str | None:
        """For curves in two parameters: the type of the points on it."""

    @property
    def parameters(self) -> tuple[str, ...]:
        """The varying one(s), the last unknown first."""

    @property
    def angle_periods(self) -> Array:
        """(N - 1,), 0 for unknowns that are not angles."""

    @property
    def maximum_chunk(self) -> int:
        """Most points a march may accept before it returns, so that a chunk lasts about 50 ms at most."""

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        """Scale of every unknown at the start of a run."""

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        """Unit tangents (scaled) of the branches through z: one at a regular point, more at a branch point."""

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        """Follow the curve along origin.tangent; `before` is the row before origin, `length` away (None at a start)."""

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        """The point with <base.tangent, (z - base.z)/scale> = length, from a guess; None where Newton fails."""

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        """Solve with the varying parameter fixed at `value`, to full precision."""

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        """Types of the simple events that explain all changes between a and b, or None where one of each does not."""

    def watch(self, type_: str) -> int | None:
        """Index of the test function whose zero locates this type; None: by the change of the unstable count."""

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        """Solve the defining system of `type_` from a nearby sample."""

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        """Events that coincide: a and b are indistinguishably close, on either side."""

    def verify_corner(self, a: Sample, b: Sample, frame: Frame) -> Outcome | Jump | None:
        """A point where the equations change formula; None where nothing turns or changes stability there."""

    def cross_corner(
        self, last: Sample, frame: Frame, settings: Settings
    ) -> tuple[Sample, Verified | Corner | None] | None:
        """Where a march failed at a corner of piecewise equations: a point beyond it and the fold on it, if any."""

    def reverses(self, z: Array, tangent: Array, symmetries: Sequence[str]) -> bool:
        """True where one of these symmetries keeps z and turns the (raw) tangent round."""

    def columns(self, z: Array) -> dict[str, Array]:
        """Named columns of rows of unknowns: varying parameter(s), states, observables."""

    def constants(self) -> dict[str, float]:
        """Every model parameter's value (a varying one's is that of the start)."""

    def describe_failure(self, z: Array) -> str:
        """Why Newton may fail at z, in words, with what to try."""


@runtime_checkable
class Probing(Protocol):
    """A problem that finds several points near one faster than each by itself."""

    def probes(
        self, base: Sample, lengths: Array, guesses: Array, frame: Frame, settings: Settings
    ) -> Sequence[Sample | None]:
        """`Problem.probe` at lengths (k,) from guesses (k, N), which may be overwritten."""


@runtime_checkable
class Recording(Protocol):
    """A problem that can say why a column has no value at a point."""

    def explain_columns(self, z: Array) -> str | None:
        """The first observable that is not finite at z, and why."""


@runtime_checkable
class Phased(Protocol):
    """A problem whose solutions may be shifted in time: a branch may come back to its start with another phase."""

    def in_phase(self, start: Sample, near: Array, scale: Array) -> Sample:
        """The start, shifted to be as close to `near` as it can be."""

    def apart(self, start: Array, near: Array, scale: Array) -> float:
        """A distance (scaled) that no shift brings the two closer than; cheap beside `in_phase`."""


_offered: dict[tuple[type, type], bool] = {}


def _offers(problem: object, protocol: type) -> bool:
    """isinstance for protocols, asked once a class: the standard check goes through every attribute each time."""
    key = (type(problem), protocol)
    if key not in _offered:
        _offered[key] = isinstance(problem, protocol)
    return _offered[key]


def is_adaptive(problem: object) -> TypeGuard[Adaptive]:
    """True for problems that renew their unknowns along a branch."""
    return _offers(problem, Adaptive)


def is_probing(problem: object) -> TypeGuard[Probing]:
    """True for problems that find several points at once."""
    return _offers(problem, Probing)


def is_planar(problem: object) -> TypeGuard[Planar]:
    """True for problems in two varying parameters."""
    return _offers(problem, Planar)


def is_floored(problem: object) -> TypeGuard[Floored]:
    """True for problems with floors under unknowns."""
    return _offers(problem, Floored)


def is_constrained(problem: object) -> TypeGuard[Constrained]:
    """True for problems that tell eigenvalues of their own from those of solutions."""
    return _offers(problem, Constrained)


def is_limited(problem: object) -> TypeGuard[Limited]:
    """True for problems that know how far their equations hold."""
    return _offers(problem, Limited)


def is_guessing(problem: object) -> TypeGuard[Guessing]:
    """True for problems that know where their metric is a guess."""
    return _offers(problem, Guessing)


def is_touching(problem: object) -> TypeGuard[Touching]:
    """True for problems that tell branches apart that touch."""
    return _offers(problem, Touching)


def is_unfolding(problem: object) -> TypeGuard[Unfolding]:
    """True for problems that find the branches at a start that is a degenerate point."""
    return _offers(problem, Unfolding)


def is_phased(problem: object) -> TypeGuard[Phased]:
    """True for problems whose solutions have a phase."""
    return _offers(problem, Phased)


def is_recording(problem: object) -> TypeGuard[Recording]:
    """True for problems that explain missing observables."""
    return _offers(problem, Recording)


def is_foretelling(problem: object) -> TypeGuard[Foretelling]:
    """True for problems that may know where a branch was going whose corrector fails."""
    return _offers(problem, Foretelling)


def is_remarking(problem: object) -> TypeGuard[Remarking]:
    """True for problems that speak of whole branches."""
    return _offers(problem, Remarking)


def is_terminating(problem: object) -> TypeGuard[Terminating]:
    """True for problems whose curves end at some of their special points."""
    return _offers(problem, Terminating)
