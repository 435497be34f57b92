"""The parts of a model, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from contin.model.expression import Expression
from contin.model.parts import (
    Averaging,
    Condition,
    Constraints,
    Event,
    Expectation,
    Forcing,
    Functional,
    Interval,
    Limit,
    Parameter,
    Start,
    State,
    Symmetry,
    Total,
    VanishingMass,
)
from contin.model.scope import Function


@dataclass(frozen=True, init=False, repr=False)
class ModelParts:
    """What `Model` consists of; see there."""

    name: str
    states: tuple[State, ...]
    parameters: tuple[Parameter, ...]
    equations: tuple[Expression, ...]
    kind: Literal["flow", "map", "bvp", "algebraic"] = "flow"
    title: str | None = None
    source: str | None = None
    description: str | None = None
    functions: Mapping[str, Function] = field(default_factory=dict)
    definitions: Mapping[str, Expression] = field(default_factory=dict)
    observables: Mapping[str, Expression] = field(default_factory=dict)
    labels: Mapping[str, str] = field(default_factory=dict)
    symmetries: tuple[Symmetry, ...] = ()
    rotation: Mapping[str, Expression] = field(default_factory=dict)
    starts: tuple[Start, ...] = ()
    averaging: Averaging | None = None
    forcing: Forcing | None = None
    limits: tuple[Limit, ...] = ()
    events: tuple[Event, ...] = ()  # jumps of the states, for simulations
    interval: Interval | None = None
    conditions: tuple[Condition, ...] = ()
    functionals: Mapping[str, Functional] = field(default_factory=dict)
    mass: Mapping[str, Mapping[str, Expression]] = field(default_factory=dict)
    constraints: Constraints | None = None
    vanishing: tuple[VanishingMass, ...] = ()  # set by the same pass
    expect: tuple[Expectation, ...] = ()
    conserved: bool = True  # branches are followed at fixed conserved totals (`contin.symbolic.passes.conserved`)
    totals: tuple[Total, ...] = ()  # the pass has done so

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the states in the order of the vector u."""
        return tuple(s.name for s in self.states)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters in the order of the vector p."""
        return tuple(p.name for p in self.parameters)

    @property
    def starting_names(self) -> tuple[str, ...]:
        """States that a start may give: those of the vector u, and those that conserved totals eliminated."""
        return (*self.state_names, *(t.state.name for t in self.totals))

    @property
    def equation_map(self) -> dict[str, Expression]:
        """State name -> right-hand side."""
        return dict(zip(self.state_names, self.equations, strict=True))
