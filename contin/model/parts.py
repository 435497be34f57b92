"""The parts a model is made of. All are immutable; formulas are expressions in states and parameters only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from contin.model.expression import Expression
from contin.records import Record

TIME: Final = "t"  # the name of time in a forced flow
TAKEN_NAMES: Final = frozenset({TIME, "period", "stable", "unstable", "parameters"})  # columns and keys of results


@dataclass(frozen=True)
class State:
    """A state variable: `value` is the default guess, in the parameters; `period` makes it an angle.

    `minimum` is a value below which the equations have no meaning (an amplitude's 0); `beyond` says what to do there.
    `scale` is its natural size, in which tolerances and lengths are measured; by default it is found at the start.
    """

    name: str
    value: Expression
    unit: str | None = None
    description: str | None = None
    period: Expression | None = None
    minimum: Expression | None = None
    beyond: str | None = None
    scale: Expression | None = None


@dataclass(frozen=True)
class Parameter:
    """A parameter: `value` may use other parameters; `range` is the default range of runs, never a constraint."""

    name: str
    value: Expression
    range: tuple[Expression, Expression] | None = None
    unit: str | None = None
    description: str | None = None
    scale: Expression | None = None


@dataclass(frozen=True)
class Symmetry:
    """A substitution u -> g(u) that maps solutions to solutions; states that `map` does not mention stay."""

    name: str
    map: Mapping[str, Expression]


@dataclass(frozen=True)
class Start:
    """A named starting point: values of some states and of some parameters, in the parameters."""

    name: str
    states: Mapping[str, Expression]
    parameters: Mapping[str, Expression] = field(default_factory=dict)


@dataclass(frozen=True)
class Limit:
    """The equations are an approximation that holds where margin >= 0, a formula in states and parameters.

    `beyond` says what ends there, and what to do.  accuracy : relative error of the equations that the limit lets pass,
    of quadratures; errors of special points count it.
    """

    margin: Expression
    beyond: str
    accuracy: float = 0.0


@dataclass(frozen=True)
class Constraints:
    """The algebraic equations g = 0 of a flow with a singular mass matrix, of index 1 (`symbolic.passes.index_one`).

    equations : states whose equations these are.  residuals : g.  massless : states that have no mass.
    correction : Newton's step (n,) from a state onto g = 0, at fixed values of the others: u - correction.
    determinant : of the derivatives of g by the states that it determines; the index is 1 where it does not vanish.
    rate : at which g decays in the flow.
    """

    equations: tuple[str, ...]
    residuals: tuple[Expression, ...]
    massless: tuple[str, ...]
    correction: tuple[Expression, ...]
    determinant: Expression
    rate: float


@dataclass(frozen=True)
class VanishingMass:
    """What the rates of these states are divided by, a formula in parameters (`symbolic.passes.index_one`)."""

    states: tuple[str, ...]
    determinant: Expression

    def words(self) -> str:
        """What it means that it vanishes, and what to do."""
        first, several = self.states[0], len(self.states) > 1
        return (
            f"the mass of {', '.join(self.states)} vanishes: {'an equation is' if several else 'the equation is'} "
            "algebraic there, and an eigenvalue is infinite. That case is a model of its own, with "
            + (f"a row of zeros in `mass`, such as `mass: {{{first}: 0}}`" if several else f"`mass: {{{first}: 0}}`")
        )


@dataclass(frozen=True)
class Oscillator:
    """The two states of one weakly nonlinear oscillator, of a frequency near `harmonic` times the base frequency."""

    position: str
    velocity: str
    harmonic: int = 1


@dataclass(frozen=True)
class Rotator:
    """A phase that turns with a frequency near `harmonic` times the base frequency."""

    phase: str
    harmonic: int = 1


@dataclass(frozen=True)
class Total:
    """A conserved total of a reduced model: the parameter `name` = sum of coefficient * state over `law`.

    `state` was eliminated: it is an observable. `note` says how the law is known, where it is not exact.
    """

    name: str
    law: Mapping[str, Expression]
    state: State
    note: str = ""


@dataclass(frozen=True)
class Averaging:
    """What the averaging pass needs to know: the small parameter and the oscillators.

    forcing : the frequency of the model's forcing in units of the base frequency.  slow : states whose rates are of
    the order of the small parameter.  slaved : states of a linear, damped system that the oscillators drive.
    """

    small: str
    oscillators: tuple[Oscillator, ...]
    forcing: int = 1
    rotators: tuple[Rotator, ...] = ()
    slow: tuple[str, ...] = ()
    slaved: tuple[str, ...] = ()


@dataclass(frozen=True)
class Forcing:
    """The equations depend on time `t` with this period, an expression in the parameters."""

    period: Expression


@dataclass(frozen=True)
class Event:
    """Where `when` crosses zero along a solution, upwards (direction "up"), downwards or both, states jump.

    `jumps` : state -> its value after the jump, a formula in the values before it.
    """

    when: Expression
    direction: str
    jumps: Mapping[str, Expression]

    def __hash__(self) -> int:
        return hash((self.when, self.direction, *self.jumps.items()))


@dataclass(frozen=True)
class Interval:
    """The independent variable of a boundary-value problem and its two ends, expressions in the parameters."""

    name: str
    start: Expression
    end: Expression


@dataclass(frozen=True)
class Functional:
    """A number made of a function on the interval: `start` or `end` value, `integral`, `mean`, `norm`, `max`, `min`.

    norm(x) = sqrt(mean(x^2)). `inner` is the function, an expression in states, parameters and the independent
    variable.
    """

    kind: str
    inner: Expression


@dataclass(frozen=True)
class Condition:
    """residual = 0: an expression in the parameters and in symbols that are keys of `Model.functionals`."""

    text: str
    residual: Expression


@dataclass(frozen=True)
class Expectation:
    """In the last of `runs` (entries like those of a run file; empty: the first parameter over its range), after the
    passes `transform`, the points of type `label` are exactly those `at`, to relative `tolerance`.

    Each point maps names of columns to values, which are expressions in the parameters.
    """

    label: str
    at: tuple[Mapping[str, Expression], ...]
    tolerance: float = 1e-8
    runs: tuple[Record, ...] = ()
    transform: tuple[Any, ...] = ()
