"""The contract between the engine and what it follows.

A problem is a system F(z) = 0 with one more unknown than equations, z = (state unknowns, varying parameter). The engine
never looks inside: it asks for chunks of the curve, for single points near it, and for the meaning of what changed
between two of them. Lengths and angles are measured in scaled unknowns z / scale.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol, TypeGuard

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.choices import Choices
from contin.continuation.outcome import NOTHING, Corner, Jump, Outcome, Verified
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.continuation.together import Together

WITHOUT_STABILITY: Final = frozenset({"bvp", "algebraic"})  # kinds of solutions that are no states of a flow or map


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
    gauge: object = None  # for the next chunk, where that of the last one does not serve there


@dataclass(frozen=True)
class Floor:
    """Unknown `index` must stay above `lowest`; `singular` where the equations have no value on the floor itself.

    With `together`, which are unknowns, their distance from zero must stay above it: they may change sign one by one.
    """

    index: int
    lowest: float
    text: str  # what to say there
    singular: bool = False
    together: tuple[int, ...] = ()

    def heights(self, rows: NDArray[np.float64], scale: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far rows (K, N) of unknowns are above the floor, (K,), in units of the scale."""
        if self.together:
            taken = list(self.together)
            return np.asarray(np.linalg.norm(rows[:, taken] / scale[taken], axis=1))
        return np.asarray((rows[:, self.index] - self.lowest) / scale[self.index])


class InTwoParameters(Protocol):
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


class Problem(ABC):
    """What a problem offers to the engine; `contin.problems.equilibria.equilibrium` is the model answer.

    Rules for implementers:

    1.  Derive from this class. What is abstract here is asked of everybody; the rest is optional, and what stands here
        is right for a problem that has no such thing.
    2.  z = (state unknowns, varying parameter) has N components, F(z) = 0 has N - 1; both vary along a branch only
        where the problem is `adaptive`. Problems with a `locus` have two varying parameters, and are `InTwoParameters`.
    3.  Tangents are unit vectors in scaled unknowns z / scale; `Sample.tangent` keeps its sense along an arm.
    4.  Row 0 of a chunk repeats `origin`. On EVENT, DIP, BOUND, LOOP and CORNER the last row lies beyond what was
        seen; on all other stops every row is accepted.
    5.  `march` accepts at most `limit` rows, takes no step below `settings.min_step`, and lasts about 50 ms at most.
    6.  Tests have one meaning and one order along a branch: `test_of` gives the index of a type's test. A test that has
        no value is NaN; its sign changes nothing.
    7.  `explain` names types only where one of each explains every change between two samples; else it gives None,
        and the engine looks closer.
    8.  `verify` solves the defining system to full precision. A `Verified` holds to its `error`; what is no such point
        is `Rejected`, with its reason, and `NOTHING` where there is nothing to say.
    9.  Numerical trouble is never raised by `march`, `probe`, `verify` or `at_parameter`: it is a stop, None, or a
        reason.
    10. A problem is a frozen value: pickles and copies serve as well as it does. What it remembers makes answers
        cheaper, not different; what is chosen for a stretch of a branch is the `gauge` of its chunk and frame. What is
        born at a point is not the problem's: `contin.transitions` has a table for it.
    """

    has_shared_places = False  # its rows are functions, whose values `at_shared_places` are compared
    adaptive = False  # its unknowns change their meaning along a branch: a mesh that follows the solution
    may_stand = False  # it knows that its parameter may be constant along a branch, and what ends that then
    multiplied_out = False  # multipliers of orbits are those of one matrix: beside a large one others are rounding
    of_special_orbits = False  # a curve of orbits: the eigenvalues that it measures are multipliers
    parts_touching = False  # it tells branches apart that touch, where Newton's method does not (`beyond`)

    if TYPE_CHECKING:  # fields of one problem, properties of another

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

    @property
    def has_stability(self) -> bool:
        """False for solutions of equations without time."""
        return self.kind not in WITHOUT_STABILITY

    @property
    def free_names(self) -> tuple[str, ...]:
        """Parameters that are solved for beside the varying ones, so that conditions hold."""
        return ()

    def free_sizes(self, z: Array, bounds: tuple[float, float]) -> Array:
        """What changes of those count by, at z; 0 where nothing is known."""
        return np.zeros(len(self.free_names))

    def effort(self) -> Mapping[str, int]:
        """What is counted beside evaluations, since the problem was made: factorisations of large systems, e.g."""
        return {}

    # -- the curve ----------------------------------------------------------------------------------------------------

    @abstractmethod
    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        """Scale of every unknown at the start of a run."""

    @abstractmethod
    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        """Unit tangents (scaled) of the branches through z: one at a regular point, more at a branch point."""

    @abstractmethod
    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        """Follow the curve along origin.tangent; `before` is the row before origin, `length` away (None at a start)."""

    @abstractmethod
    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        """The point with <base.tangent, (z - base.z)/scale> = length, from a guess; None where Newton fails."""

    def probes(
        self, base: Sample, lengths: Array, guesses: Array, frame: Frame, settings: Settings
    ) -> Sequence[Sample | None]:
        """`probe` at lengths (k,) from guesses (k, N), which may be overwritten; faster than one by one, perhaps."""
        pairs = zip(lengths.tolist(), guesses, strict=True)
        return [self.probe(base, length, guess, frame, settings) for length, guess in pairs]

    def points_between(
        self, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float], fractions: Sequence[float],
        frame: Frame, settings: Settings,
    ) -> Sequence[Sample | None] | None:  # fmt: skip
        """Points at fractions of the way between two samples of these lengths from base, in one call of a kernel.

        None: there is none; `probe` serves, from guesses that `contin.continuation.curve` makes.
        """
        return None

    def tests_between(
        self, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float], fractions: Sequence[float],
        frame: Frame, settings: Settings,
    ) -> tuple[Array, Sequence[int]] | None:  # fmt: skip
        """Tests (m, k) and unstable counts of `points_between`, -1 where there is no point; None as there."""
        return None

    def refined(self, sample: Sample, frame: Frame) -> tuple[Problem, Sample, Frame] | None:
        """A sample solved for on a finer mesh (more accurately), on the hyperplane normal to its tangent.

        With the problem and the metric of its unknowns; None where nothing is discretised, or it is not found there.
        """
        return None

    def asked_alone(self, values: Array) -> Array | None:
        """(K, k) lengths of what is asked by itself whether tangents explain its steps, of values (K, N) in scaled
        unknowns; the parameter last. None: only the whole is asked.

        Here each unknown; where these are values on a mesh, some of which may change fast anywhere, none.
        """
        return None if self.adaptive else np.abs(values)

    def at_shared_places(self, z: Array, values: Array) -> Array:
        """Of branches of functions: values (like z, on its mesh) at places that all rows share, (places, functions)."""
        raise NotImplementedError(f"{type(self).__name__} has no functions that are compared on different meshes")

    def sizes(self, z: Array, scale: Array) -> Array:
        """Of branches of functions: their sizes (n,) in a metric that belongs to z."""
        raise NotImplementedError(f"{type(self).__name__} has no functions with sizes")

    def rows_at_shared_places(self, z: Array, values: Array) -> Array:
        """The same of rows z (K, N) and values like them, (K, places, functions)."""
        return np.array([self.at_shared_places(*row) for row in zip(z, values, strict=True)])

    def apart_at_shared_places(self, one: Array, other: Array) -> Array:
        """one - other at places that all rows share, (places, functions), of unknowns on one mesh."""
        return self.at_shared_places(one, one - other)

    def of_one_mesh(self, one: Array, other: Array) -> bool:
        """Whether two rows are functions on the same mesh."""
        return True

    def on_mesh_of(self, z: Array, other: Array) -> Array:
        """The functions z, interpolated, on the mesh of another row."""
        return z

    def mesh_error(self, z: Array, sizes: Array) -> float:
        """The estimated error of a solution by its mesh, relative to sizes of its functions; 0 where there is none."""
        return 0.0

    @abstractmethod
    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        """Solve with the varying parameter fixed at `value`, to full precision."""

    # -- special points -----------------------------------------------------------------------------------------------

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        """Types of the simple events that explain all changes between a and b, or None where one of each does not."""
        return ()

    def test_of(self, type_: str) -> int | None:
        """Index of the test function whose zero locates this type; None: by the change of the unstable count."""
        return None

    def measured_beside(self, type_: str, sample: Sample, frame: Frame) -> Sample:
        """A sample next to a located point of this type, with tests that a march leaves out and that change there."""
        return sample

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        """Solve the defining system of `type_` from a nearby sample."""
        return NOTHING

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        """Events that coincide: a and b are indistinguishably close, on either side."""
        return ()

    def together(self, a: Sample, b: Sample) -> Iterable[Together]:
        """Multipliers that are equal to rounding and may pass together, where that is all that changes from a to b."""
        return ()

    def verify_corner(self, a: Sample, b: Sample, frame: Frame) -> Outcome | Jump | None:
        """A point where the equations change formula; None where nothing turns or changes stability there."""
        return None

    def cross_corner(
        self, last: Sample, frame: Frame, settings: Settings
    ) -> tuple[Sample, Verified | Corner | Jump | None] | None:
        """Where a march failed at a corner of piecewise equations: a point beyond it and the fold on it, if any.

        A jump where the parameter goes on and the number of unstable values does not.
        """
        return None

    def is_lost(self, test: int, z: Array, scale: Array) -> bool:
        """True where a test may be zero at z for all that the rounding of what it is made of lets see."""
        return False

    def beyond(self, point: Verified, frame: Frame, settings: Settings) -> Sample | None:
        """The branch's own continuation beyond a point with `touches`, where it can be told from the other one."""
        return None

    def unfolded(self, z: Array, frame: Frame) -> tuple[Sample, Verified, Mapping[int, Array]] | None:
        """At a start at which the leading terms of the equations tell no branch: that start with a branch's tangent,
        its label, and a point on the branch by arm; None where there is none."""
        return None

    def alone(self, z: Array, tangent: Array, scale: Array) -> tuple[Problem, Array, Array, Array]:
        """A solution as one without conditions, from which other branches leave: problem, z, raw tangent, metric."""
        return self, z, tangent, scale

    # -- ends ---------------------------------------------------------------------------------------------------------

    @property
    def floors(self) -> Sequence[Floor]:
        """Unknowns that must stay above a value, below which the equations lose their meaning."""
        return ()

    @property
    def is_smooth(self) -> bool:
        """True where the equations are known to have no corners."""
        return False

    @property
    def has_reach(self) -> bool:
        """False where `left_reach` can find nothing, for equations that are exact and never singular."""
        return True

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        """The first of the rows z at which the equations, an approximation, do not hold, and why."""
        return None

    def past_half(self, z: Array) -> int | None:
        """The first of the rows z, on curves of cycles, before which cycles of half the period were passed."""
        return None

    def end_at(self, point: Verified) -> End | None:
        """The end of a curve that has come to this labelled point, its last row; None where it goes on."""
        return None

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """The end that a branch was near whose corrector fails, from its last points; None where there is no sign."""
        return None

    @property
    def formulas(self) -> object:
        """The model of formulas that is solved; None of users' functions."""
        return None

    def choices(self, z: Array) -> Choices:
        """Functions of the parameters alone that choose formulas, at rows z (K, N)."""
        return Choices.none(len(z))

    def separated(self, a: Array, b: Array) -> bool:
        """True where the equations jump somewhere between a and b: no branch leads across."""
        return False

    def reverses(self, z: Array, tangent: Array, scale: Array, symmetries: Sequence[str]) -> bool:
        """True where one of these symmetries keeps z and turns the (raw) tangent round, in the metric of `scale`."""
        return False

    # -- unknowns that change along a branch, or have a phase ---------------------------------------------------------

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        """Of `adaptive` problems, after every chunk: see whether the branch ends, and adapt metric and mesh."""
        return Renewal(frame.scale, origin, before, loop)

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        """Of `adaptive` ones: two points of one type, found perhaps on different meshes, are one to their errors."""
        raise NotImplementedError(f"{type(self).__name__} is adaptive: it must tell which of its points are one")

    def in_phase(self, start: Sample, near: Array, scale: Array) -> Sample:
        """The start, shifted in time to be as close to `near` as it can be."""
        return start

    def apart(self, start: Array, near: Array, scale: Array) -> float:
        """A distance (scaled) that no shift in time brings the two closer than; cheap beside `in_phase`."""
        return 0.0

    # -- words and columns --------------------------------------------------------------------------------------------

    def orbit_at(self, z: Array) -> object | None:
        """The orbit that a point of a curve in two parameters stands for (its `profile`); None of what has none."""
        return None

    def column(self, name: str, z: Array) -> Array:
        """One of the columns; without the others where these cost more."""
        return self.columns(z)[name]

    def column_names(self) -> Sequence[str]:
        """Names of columns, as far as they are known without a solution: `columns` may have others on top."""
        return self.parameters

    @abstractmethod
    def columns(self, z: Array) -> dict[str, Array]:
        """Named columns of rows of unknowns: varying parameter(s), states, observables."""

    @abstractmethod
    def constants(self) -> dict[str, float]:
        """Every model parameter's value (a varying one's is that of the start)."""

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        """How far a parameter varies where nobody says so, at the present values; None: it must be said."""
        return None

    @abstractmethod
    def describe_failure(self, z: Array) -> str:
        """Why Newton may fail at z, in words, with what to try."""

    def explain_columns(self, z: Array) -> str | None:
        """The first observable that is not finite at z, and why."""
        return None

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Eigenvalues (multipliers) of the solution z, without those that are of its method of solution alone."""
        return values

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """Notes on the whole branch with rows z, whose eigenvalues (rows, k) are as the march gave them.

        Of a curve in two parameters: that eigenvalues are critical all along it, so that their changes are rounding.
        """
        return ()

    def shortcomings(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """Notes on what could not be computed, or not accurately, along such a branch."""
        return ()

    def recounted(
        self, z: Array, unstable: NDArray[np.int64], eigenvalues: NDArray[np.complex128]
    ) -> NDArray[np.int64]:
        """`unstable` of all rows z without what is critical all along the branch, which one row alone cannot tell."""
        return unstable

    def guessed(self, z: Array, bounds: tuple[float, float]) -> Sequence[str]:
        """The columns of unknowns whose scale at the start z is a mere 1, for want of anything to take it from."""
        return ()

    def guess_note(self, columns: Sequence[str]) -> str:
        """What to say of such columns, where they turn out not to stay 0."""
        return ""


def in_two_parameters(problem: object) -> TypeGuard[InTwoParameters]:
    """True for problems in two varying parameters."""
    return isinstance(problem, Problem) and problem.locus is not None
