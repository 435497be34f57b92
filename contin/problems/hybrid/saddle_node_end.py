"""Where a family ends because its period grows without bound: an orbit with jumps that comes to a fold of equilibria.

A spiking neuron at its rheobase: beside the fold at p* the orbit takes the time C |p - p*|^(-1/2), and as much as
before elsewhere (`contin.problems.orbits.ends.invariant_circle`). The fold is solved for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.machine import elementary
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.hybrid.sampling import arc_samples
from contin.problems.orbits.ends.invariant_circle import CONSTANT, bottleneck
from contin.problems.orbits.ends.saddles import rounded
from contin.problems.scales import parameter_width
from contin.problems.two_parameters import UNBOUNDED

if TYPE_CHECKING:
    from contin.problems.hybrid.cycle_of_events import CycleOfEvents

DWELT: Final = 0.6  # part of the period that is spent beside the fold
NEAR: Final = 0.2  # of the states' sizes: the orbit comes so close to it


def saddle_node_end(problem: CycleOfEvents, z: Array, before: Array) -> End | None:
    """The end at p*, with the fold; None where the last two orbits do not approach one."""
    passages = problem.passage(z), problem.passage(before)
    if problem.flow.forced or passages[0] is None or passages[1] is None:
        return None
    p, name, sizes = problem.inner.full_parameters(z), problem.parameters[0], problem.map.sizes
    states = np.vstack([arc_samples(problem, z, flown) for flown in passages[0].flown])
    speeds = np.abs(np.array([problem.flow.system.value(u, p) for u in states]) / sizes).max(axis=1)
    slowest = states[int(np.argmin(speeds))]
    rest = EquilibriumProblem(problem.flow.system, p, problem.inner.active)
    declared = problem.flow.given.parameter_range(name)
    width = parameter_width(problem.flow.given, name, float(z[-1]), declared or UNBOUNDED)
    fold = bottleneck(rest, np.append(slowest, z[-1]), sizes, width)
    if fold is None or float(np.max(np.abs(fold.z[:-1] - slowest) / sizes)) > NEAR:
        return None
    at, constant = float(fold.z[-1]), fold.constant(float(z[-1]))
    here, there = (float(elementary.pow(abs(q - at), -0.5)) for q in (float(z[-1]), float(before[-1])))
    longer = passages[0].period - passages[1].period
    if constant * here < DWELT * passages[0].period or not here > there:
        return None
    if not CONSTANT[0] < longer / (constant * (here - there)) < CONSTANT[1]:
        return None
    values = np.linalg.eigvals(rest.linear_part(fold.z))
    place = dict(zip(problem.system.state_names, rounded(fold.z[:-1], sizes).tolist(), strict=True))
    words = ", ".join(f"{k} = {v:.8g}" for k, v in place.items())
    data = {
        "at": {name: at}, "error": fold.error, "saddle": place, "saddle_quantity": None, "saddle_node": True,
        "eigenvalues": [[float(v.real), float(v.imag)] for v in values[np.argsort(-values.real)]],
    }  # fmt: skip
    text = (
        f"the period grows without bound (here {passages[0].period:.6g}): the orbit with jumps comes to the fold of "
        f"equilibria at {name} = {at:.12g} ({words})"
    )
    return End("homoclinic", text, data)
