"""Numbers of an orbit as columns of its family: amplitude, norm, frequency, and formulas in integrals and extrema.

    amplitude   half the range of the first state, (max - min)/2
    norm        root mean square of all states over one period, sqrt(mean(x^2 + y^2 + ...)), in the states' own units
    frequency   orbits in a unit of time, 1/period

A name that the model uses itself keeps the model's meaning. Formulas are those of `contin.model.relations`:
`integral(x^2)` over one period in model time, `mean(x^2)` divided by it, `max(x) - min(y)`; columns on request.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.problems.orbits.measured.functionals import OrbitConditions
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.systems.protocol import System

STANDARD: Final = ("amplitude", "norm", "frequency")


@dataclass(frozen=True, eq=False)
class Measures:
    """Formulas as they were written, and as numbers of an orbit."""

    texts: tuple[str, ...]
    numbers: OrbitConditions

    def columns(self, profiles: Sequence[Profile], parameters: Callable[[int], Array]) -> dict[str, Array]:
        """Of orbits in rows; `parameters(row)` are all of them (p_size,), as at the time 0."""
        if not self.texts:
            return {}
        found = np.full((len(profiles), len(self.texts)), np.nan)
        for row, profile in enumerate(profiles):
            if np.all(np.isfinite(profile.u)):
                found[row] = self.numbers.values(profile, parameters(row))
        return {text: found[:, k] for k, text in enumerate(self.texts)}


def standard_names(system: System) -> tuple[str, ...]:
    """Those of the standard columns that a family has: not those which the model uses itself."""
    states = tuple(system.state_names)
    taken = {*states, *system.parameter_names, *system.observable_names}
    return tuple(name for name in STANDARD if name not in taken and (states or name == "frequency"))


def standard_columns(system: System, columns: dict[str, Array], norms: Callable[[], Array]) -> dict[str, Array]:
    """The standard columns, from those that a family has and the norms of its rows."""
    found: dict[str, Array] = {}
    for name in standard_names(system):
        if name == "amplitude":
            first = system.state_names[0]
            found[name] = 0.5 * (columns[f"{first}.max"] - columns[f"{first}.min"])
        elif name == "norm":
            found[name] = norms()
        else:
            with np.errstate(divide="ignore", invalid="ignore"):
                found[name] = 1.0 / columns["period"]
    return found
