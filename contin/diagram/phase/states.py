"""Which equilibria and periodic orbits there are at one point of a phase diagram, and how stable they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch, SpecialPoint
from contin.diagram.identity import wrapped
from contin.diagram.orbits import copies, known_orbit
from contin.diagram.phase.cycles import distinct_images, is_one, is_shorter
from contin.diagram.sizes import sizes_among
from contin.problems.maps.cycle import CycleProblem
from contin.problems.symmetry import apply_symmetry, every_symmetry

if TYPE_CHECKING:
    from contin.problems.equilibria.equilibrium import EquilibriumProblem

SAME: Final = 1e-6
SMALL: Final = 1e-3  # of a state's size: below this a difference is compared with that, not with the state
MARKED: Final = 1e-9  # of the range: a parameter has the value that was asked for


@dataclass(frozen=True, eq=False)
class State:
    """An equilibrium or a periodic orbit: its values and its number of unstable eigenvalues (multipliers).

    `values` : of the states and observables; of an orbit the period and the smallest and largest ones.
    `vector` : the states of an equilibrium.  `orbit` : the problem and unknowns of a periodic orbit, else None.
    `steps` : the period of a cycle of a map.
    `copies` counts it together with its images under the declared symmetries.
    """

    values: Mapping[str, float]
    unstable: int
    vector: Array
    copies: int = 1
    orbit: tuple[Any, Array] | None = None
    steps: int = 1

    @property
    def is_orbit(self) -> bool:
        """True for periodic orbits, and for cycles of maps of more than one step."""
        return self.orbit is not None or self.steps > 1


def states_on(branches: Sequence[Branch], value: float, width: float) -> tuple[State, ...]:
    """The states of branches marked at this value of their parameter (images left out), each once up to symmetries.

    `width` : of the parameter's range, to which the accuracy of its value is relative.
    """
    states: list[State] = []
    seen: list[Array] = []
    sizes: Array | None = None
    for branch in branches:
        if branch.image_of is not None:
            continue
        if branch.kind == "orbit":
            states += _orbits_on(branch, value, width, [s.orbit for s in states if s.orbit is not None])
            continue
        problem = branch.problem
        names = [*problem.system.state_names, *problem.system.observable_names]
        for p in branch.points:
            if not _is_at(p, branch, value, width):
                continue
            if isinstance(problem, CycleProblem):
                if not is_shorter(problem, p.z) and not any(is_one(problem, p.z, s.vector) for s in states):
                    values = {n: p.values[n] for n in [*names, "period"]}
                    count = distinct_images(problem, p.z)
                    states.append(State(values, int(p.values["unstable"]), p.z[:-1], count, None, problem.period))
                continue
            if sizes is None:
                sizes = _sizes_at(branches, problem, value, width)
            if any(_equal(v, p.z[:-1], problem.angle_periods, sizes) for v in seen):
                continue
            images = images_of(problem, p.z, sizes)
            seen.extend(images)
            count = max(sum(_is_meant(problem, image) for image in images), 1)
            states.append(State({n: p.values[n] for n in names}, int(p.values["unstable"]), p.z[:-1], count))
    return tuple(states)


def _sizes_at(branches: Sequence[Branch], problem: EquilibriumProblem, value: float, width: float) -> Array:
    """Of the states of all equilibria that are marked at this value."""
    kinds = ("equilibrium", "fixed-point")
    points = [
        p.z[:-1].reshape(-1, problem.system.n)
        for b in branches if b.kind in kinds and b.image_of is None
        for p in b.points if _is_at(p, b, value, width)
    ]  # fmt: skip
    return sizes_among(problem, points, value)


def points_of(state: State) -> Array:
    """Of an equilibrium, a cycle or an orbit, (k, n)."""
    if state.orbit is not None:
        problem, z = state.orbit
        return np.asarray(problem.profile(z).u)
    return state.vector.reshape(state.steps, -1)


def _is_at(point: SpecialPoint, branch: Branch, value: float, width: float) -> bool:
    return point.type == "UZ" and abs(point.values[branch.parameters[0]] - value) <= MARKED * width


def _orbits_on(branch: Branch, value: float, width: float, known: Sequence[tuple[object, Array]]) -> list[State]:
    """The orbits marked by user values on a family, without those that are known."""
    problem = branch.problem
    names = [name for name in problem.column_names() if name != branch.parameters[0]]
    found: list[State] = []
    for p in branch.points:
        if not _is_at(p, branch, value, width) or known_orbit(problem, p.z, known) is not None:
            continue
        values = {name: p.values[name] for name in names}
        found.append(State(values, int(p.values["unstable"]), p.z[:0], copies(problem, p.z), (problem, p.z)))
    return found


def _is_meant(problem: EquilibriumProblem, u: Array) -> bool:
    """False below a state's lowest value: an amplitude r < 0 is the amplitude -r half a turn on, no second state."""
    return all(u[floor.index] >= floor.lowest for floor in problem.floors if not floor.together)


def images_of(problem: EquilibriumProblem, z: Array, sizes: Array) -> list[Array]:
    """The state and its distinct images under the declared symmetries; sizes (n,) of the states."""
    found = [np.asarray(z[:-1])]
    for name in every_symmetry(problem):
        image = apply_symmetry(problem, name, z)[0][:-1]
        if not any(_equal(known, image, problem.angle_periods, sizes) for known in found):
            found.append(image)
    return found


def _equal(a: Array, b: Array, periods: Array, sizes: Array) -> bool:
    size = np.maximum(np.maximum(np.abs(a), np.abs(b)), SMALL * sizes)
    return bool(np.all(np.abs(wrapped(a - b, np.asarray(periods)[: len(a)])) <= SAME * size))
