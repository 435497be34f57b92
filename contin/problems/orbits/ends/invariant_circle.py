"""Families that end on a fold of equilibria: a saddle-node on an invariant circle.

On the centre manifold of the fold (u*, p*) the flow is x' = b (p - p*) + a x^2, with a = <l, f_uu(q, q)>/2 and b = <l,
f_p>. Where it has no equilibria, an orbit that passes through all of it (a bottleneck) takes the time
C |p - p*|^(-1/2), C = pi / sqrt(|a b|), up to what is spent elsewhere: 2 |p - p*|^(3/2) |dT/dp| tends to C. The fold is
solved for. Families that end at a homoclinic orbit of a saddle beside a fold enter the bottleneck in its middle, and
take half of that time or less, before they pass p*.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.outcome import Verified
from contin.continuation.sample import Frame, Sample
from contin.machine import elementary
from contin.problems.equilibria import defining
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.equilibria.scaled import ScaledSystem
from contin.problems.orbits.ends.distances import extent_of
from contin.problems.orbits.ends.saddle_node import critical_direction, quadratic
from contin.problems.orbits.ends.saddles import equilibria_of, rounded
from contin.problems.orbits.march.slow_passage import dwelling, slowest_points
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits

DWELT = 0.6  # part of the period spent in the bottleneck from which a fold is looked for
REACHED = 1e-4  # distance of the parameter from the fold, relative to its range, at which the family is complete
CONSTANT = (0.85, 1.2)  # 2 |p - p*|^(3/2) |dT/dp| relative to its limit
NEAR = 0.1  # of the orbit's extent: distance of the bottleneck from the fold
SAME = 1e-9  # relative difference of the parameters of folds that are images of each other


@dataclass(frozen=True, eq=False)
class Bottleneck:
    """A fold of equilibria (u, p) that an orbit passes slowly."""

    z: Array
    error: float  # of p
    a: float  # coefficients of the flow along q, |q| = 1 in states relative to their sizes
    b: float

    def constant(self, parameter: float) -> float:
        """C of the time that the passage takes; 0 where there are equilibria at this parameter."""
        clear = self.a * self.b * (parameter - float(self.z[-1])) > 0.0
        return float(np.pi / np.sqrt(abs(self.a * self.b))) if clear else 0.0

    def width(self, parameter: float) -> float:
        """Of the stretch along q that is passed slowly, in states relative to their sizes."""
        return float(np.sqrt(abs(self.b * (parameter - float(self.z[-1])) / self.a)))


def bottlenecks(problem: FamilyOfOrbits, profile: Profile, sizes: Array, width: float) -> list[Bottleneck]:
    """The folds of equilibria in whose neighbourhood the orbit is slow; none if it is slow elsewhere, too."""
    found = []
    for u in slowest_points(problem, profile, sizes):
        fold = bottleneck(equilibria_of(problem), np.append(u, profile.parameter), sizes, width)
        if fold is None or float(np.max(np.abs(fold.z[:-1] - u) / sizes)) > NEAR * extent_of(profile, sizes):
            return []
        found.append(fold)
    return found


def bottleneck(rest: EquilibriumProblem, guess: Array, sizes: Array, width: float) -> Bottleneck | None:
    """The fold of equilibria next to a guess (u, p); None where Newton's method finds none."""
    metric = np.append(np.sqrt(rest.n) * sizes, width)
    solved = defining.fold(ScaledSystem(rest, metric), guess / metric)
    if solved is None or not solved.residual < 1e-8:
        return None
    z = solved.y * metric
    u, p = z[:-1], rest.full_parameters(z)
    jacobian = rest.system.jacobian(u, p)[1]
    left, q = critical_direction(jacobian[:, : rest.n] * sizes / sizes[:, None])
    a = quadratic(rest.system, u, p, sizes, left, q)
    b = float(left @ (jacobian[:, rest.n + rest.active] / sizes))
    return Bottleneck(z, solved.error * width, a, b) if a != 0.0 and b != 0.0 else None


def invariant_circle(
    problem: FamilyOfOrbits, origin: Sample, before: Sample, frame: Frame
) -> tuple[End, Verified] | None:
    """The fold of equilibria that the family has come to, or None."""
    profile, sizes = problem.profile(origin.z), problem.sizes(origin.z, frame.scale)
    if profile.period <= problem.profile(before.z).period or dwelling(problem, profile, sizes) < DWELT:
        return None
    raw = origin.tangent * frame.scale
    width, position = float(frame.scale[-1]), problem.period_place(origin.z)
    folds = bottlenecks(problem, profile, sizes, width)
    if not folds or raw[-1] == 0.0 or any(abs(float(fold.z[-1] - folds[0].z[-1])) > SAME * width for fold in folds):
        return None
    found, doubt = folds[0].z, folds[0].error
    distance = float(found[-1]) - profile.parameter
    constant = sum(fold.constant(profile.parameter) for fold in folds)
    if abs(distance) > REACHED * width or constant == 0.0:
        return None
    slope = abs(float(raw[position] / raw[-1]))
    if not CONSTANT[0] < 2.0 * elementary.pow(abs(distance), 1.5) * slope / constant < CONSTANT[1]:
        return None
    name = problem.parameters[0]
    values = np.linalg.eigvals(equilibria_of(problem).linear_part(found))
    state = dict(zip(problem.system.state_names, rounded(found[:-1], sizes).tolist(), strict=True))
    where = ", ".join(f"{k} = {v:.8g}" for k, v in state.items())
    at, error = float(found[-1]), doubt
    text = (
        f"the period grows without bound (here {profile.period:.6g}): saddle-node on an invariant circle at "
        f"{name} = {at:.12g}, at the fold of equilibria ({where})"
    )
    data = {
        "at": {name: at}, "error": error, "saddle": state, "saddle_quantity": None, "saddle_node": True,
        "eigenvalues": values[np.argsort(-values.real)].astype(complex),
    }  # fmt: skip
    form = {"at": {name: at}, "kind": "saddle-node"}
    z = origin.z.copy()
    z[-1] = at  # the last orbit stands for the connecting one
    point = Verified("HOM", z, abs(distance), error, origin.eigenvalues, origin.unstable, normal_form=form)
    return End("homoclinic", text, data), point
