"""From whatever may start a branch to a seed, its bounds, and the user values on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Protocol, TypeAlias, runtime_checkable

from contin.abi import Array
from contin.api.fixed_totals import varying
from contin.api.starts import equilibrium
from contin.continuation.branch import LocusStart
from contin.continuation.location.extrema import Extremum
from contin.continuation.location.user_value import Target
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.model.advice import closest, place_of_parameter
from contin.model.model import Model
from contin.systems.functions.function_problem import FunctionProblem

Range: TypeAlias = tuple[float, float] | Sequence[float] | Mapping[str, Sequence[float]]


@runtime_checkable
class Start(Protocol):
    """A solution, or a guess of one, at fixed parameters: an equilibrium, an orbit, functions on an interval."""

    @property
    def system(self) -> Any:
        """Whose `parameter_names` may vary."""

    def seed(self, parameter: str) -> Seed:
        """Where a continuation with this parameter free starts."""


@runtime_checkable
class WithEquilibrium(Protocol):
    """What a search of a box found."""

    @property
    def equilibrium(self) -> Start:
        """The solution."""


@runtime_checkable
class FoundByItself(Protocol):
    """A start that says how it was found."""

    @property
    def words(self) -> str: ...


@runtime_checkable
class StartOfCurve(Protocol):
    """What starts a curve in two parameters: an orbit that connects two saddles."""

    @property
    def saddles(self) -> Array:
        """(2, n)"""

    def locus(self, parameters: tuple[str, str]) -> Any:
        """The curve's seed."""


def placed(start: Any, parameter: str | Sequence[str], range: Range | None) -> tuple[Seed, tuple[float, float]]:
    """What can start a continuation, as a seed within its bounds: those of the (first) parameter are returned too."""
    names = (parameter,) if isinstance(parameter, str) else tuple(parameter)
    if len(names) == 1:
        seed = as_seed(start, names[0])
        return seed, bounds_of(seed.problem, names[0], range)
    if isinstance(start, LocusStart):
        start = start.point.locus(names)
    elif isinstance(start, StartOfCurve):
        start = start.locus((names[0], names[1]))  # of connections, which have two
    seed = start[0] if isinstance(start, list) and start else start
    if not isinstance(seed, Seed) or tuple(seed.problem.parameters) != names:
        raise InputError(
            f"a curve in {', '.join(names)} starts from a labelled point: pass point.locus() and these names"
        )
    if range is not None and not isinstance(range, Mapping):
        each = ", ".join(f"{name!r}: (lo, hi)" for name in names)
        raise InputError(f"several parameters need a range each: {{{each}}}")
    bounds = [bounds_of(seed.problem, name, range) for name in names]
    return replace(seed, problem=seed.problem.within(*bounds)), bounds[0]  # type: ignore[attr-defined]


def as_seed(start: object, parameter: str) -> Seed:
    """What can start a continuation, as a seed with `parameter` free."""
    if isinstance(start, list) and start and all(isinstance(s, Seed) for s in start):
        return as_seed(start[0], parameter)
    if isinstance(start, FunctionProblem | Model):
        start = equilibrium(start)
    if not isinstance(start, Seed) and isinstance(start, WithEquilibrium):
        start = start.equilibrium
    if isinstance(start, Seed):
        if start.problem.parameters[0] != parameter:
            raise InputError(
                f"this start varies {start.problem.parameters[0]}; switch with parameter={parameter!r} instead"
            )
        return start
    if isinstance(start, Start):
        place_of_parameter(parameter, varying(start.system.parameter_names))
        return start.seed(parameter)
    if isinstance(start, LocusStart | StartOfCurve):
        raise InputError("point.locus() starts a curve in two parameters: give both, such as ('a', 'b')")
    raise InputError(f"a continuation starts from an equilibrium or a switched point; got {type(start).__name__}")


def bounds_of(problem: Any, parameter: str, given: Range | None) -> tuple[float, float]:
    """(lo, hi) from a pair, a mapping {parameter: pair}, or the model's own range."""
    if isinstance(given, Mapping):
        given = given.get(parameter)
    if given is None:
        given = problem.default_range(parameter)
    if given is None:
        raise InputError(f"range: say how far {parameter} may vary, e.g. range: [0, 1]; the model gives none")
    lo, hi = (float(x) for x in given)
    return lo, hi


def targets_of(seed: Seed, values: Mapping[str, Sequence[float]] | None) -> list[Target]:
    """User values as targets; every name must be a column of the branch."""
    _check_columns(seed, "values", list(values or {}))
    return [Target(column, float(v)) for column, wanted in (values or {}).items() for v in wanted]


def extrema_of(seed: Seed, columns: Sequence[str]) -> list[Extremum]:
    """Columns to be labelled where they turn; each must be a column of the branch."""
    _check_columns(seed, "extrema", columns)
    return [Extremum(column) for column in columns]


def _check_columns(seed: Seed, key: str, columns: Sequence[str]) -> None:
    """InputError for a name that is no column of the branch."""
    if not columns:
        return
    known = set(seed.problem.column_names())
    if any(column not in known for column in columns):
        known |= set(seed.problem.columns(seed.z[None]))
    for column in columns:
        if column not in known:
            raise InputError(f"{key}: unknown column {column!r}: {_advice(column, known)}")


def _advice(column: str, known: set[str]) -> str:
    return closest(column, known) or f"known: {', '.join(sorted(known))}"
