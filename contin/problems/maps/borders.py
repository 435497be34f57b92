"""Cycles of maps that jump: a branch ends where one of its points meets a surface (a border collision, BE)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.branch import End
from contin.continuation.outcome import Verified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.linalg.newton import by_steps, solution
from contin.linalg.spectrum import in_order
from contin.problems.surfaces.boundary import BESIDE, FARTHEST, NEWTON, THERE, cut_before
from contin.problems.surfaces.jumps import Jump, jumps_of
from contin.problems.surfaces.sides import between, side_of

if TYPE_CHECKING:
    from contin.problems.equilibria.equilibrium import EquilibriumProblem
    from contin.systems.iterate import IteratedSystem


class Cycle(Protocol):
    """What is asked of the problem of cycles, `contin.problems.maps.cycle.CycleProblem`."""

    @property
    def n(self) -> int: ...

    @property
    def period(self) -> int: ...

    @property
    def active(self) -> int: ...

    @property
    def parameters(self) -> tuple[str, ...]: ...

    @property
    def inner(self) -> EquilibriumProblem: ...

    @property
    def system(self) -> IteratedSystem: ...

    def linearise(self, z: Array) -> tuple[Array, Array]: ...

    def probe(
        self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings
    ) -> Sample | None: ...


@dataclass(frozen=True, eq=False)
class Collision:
    """The cycle whose point number `place` lies on a surface, with the formulas of one side there."""

    jump: Jump
    upper: bool
    place: int
    z: Array
    residual: float
    error: float
    distance: float
    eigenvalues: Vector


def cut_at_border(problem: Cycle, chunk: Chunk) -> Chunk:
    """The chunk up to the first step in which a point comes across a surface on which the map jumps."""
    base = problem.system.base
    if not base.n_switches or len(chunk) < 2 or not jumps_of(base):
        return chunk
    heights = []
    for z in chunk.z:
        points, p = _points(problem, z)
        heights.append(np.array([base.switches(x, p) for x in points]).ravel())
    values = np.array(heights)
    changed = np.any((values[:-1] * values[1:] <= 0.0) & (values[:-1] != values[1:]), axis=1)
    for k in np.flatnonzero(changed):
        if crosses(problem, chunk.z[k], chunk.z[k + 1]):
            return cut_before(chunk, int(k))
    return chunk


def foretold(problem: Cycle, origin: Sample, frame: Frame) -> Renewal | None:
    """The end of a branch whose next step would take a point across a surface on which the map jumps; else None."""
    jumps = jumps_of(problem.system.base) if problem.system.base.n_switches else ()
    places = [(jump, j) for jump in jumps for j in range(problem.period)]
    found = [_collision(problem, jump, j, origin, frame) for jump, j in places]
    ahead = [c for c in found if c is not None and _is_reached(problem, c, origin, frame)]
    if not ahead:
        return None
    first = min(ahead, key=lambda c: c.distance)
    name, surface, at = problem.parameters[0], first.jump.surface.text, float(first.z[-1])
    side = f"{surface[:-4]} {'>' if first.upper else '<'} 0"
    form = {"kind": "border collision", "surface": surface, "side": side}
    unstable = int(np.sum(np.abs(first.eigenvalues) > 1.0))
    vectors = {"jump": first.jump.number, "upper": first.upper, "own": False}
    values = first.eigenvalues
    point = Verified("BE", first.z, first.residual, first.error, values, unstable, form, vectors)
    text = (
        f"at {name} = {at:.10g}, point {first.place + 1} of the cycle meets the surface {surface}, where the equations "
        "jump"
    )
    end = End("surface", text, {"surface": surface, "at": {name: at}})
    return Renewal(frame.scale, origin, None, None, end, None, point)


def _points(problem: Cycle, z: Array) -> tuple[Array, Array]:
    """The points (k, n) and the parameters."""
    return z[:-1].reshape(problem.period, problem.n), problem.inner.full_parameters(z)


def crosses(problem: Cycle, a: Array, b: Array) -> bool:
    """True where a point of the cycle comes across a surface on which the map jumps, from one cycle to another."""
    if not problem.system.base.n_switches:
        return False
    (before, p), (after, q) = _points(problem, a), _points(problem, b)
    jumps, k = jumps_of(problem.system.base), problem.period
    return any(
        between(jumps, (before[j], p, before[(j + 1) % k]), (after[j], q, after[(j + 1) % k])) for j in range(k)
    )


def _collision(problem: Cycle, jump: Jump, place: int, origin: Sample, frame: Frame) -> Collision | None:
    """Newton's method on all points of the cycle and h = 0 at one of them, with one side's formulas there."""
    n, k, scale = problem.n, problem.period, frame.scale
    points, p = _points(problem, origin.z)
    row, own = (place + 1) % k, slice(place * n, (place + 1) * n)
    into = slice(row * n, (row + 1) * n)
    slope = jump.height(points[place], p)[1]
    reach = np.linalg.norm(np.append(slope[:n] * scale[own], slope[n + problem.active] * scale[-1]))
    upper = bool(side_of(jump, points[place], p, points[row], FARTHEST * float(reach)))
    side = jump.held(upper, points[place], p)

    def equations(z: Array) -> tuple[Array, Array] | None:
        f, matrix = problem.linearise(z)
        x, p = _points(problem, z)
        value, slopes = side.jacobian(x[place], p)
        f[into] = value - x[row]
        matrix[into, own], matrix[into, -1] = slopes[:, :n], slopes[:, n + problem.active]
        h, slope = jump.height(x[place], p)
        line = np.zeros(len(z))
        line[own], line[-1] = slope[:n], slope[n + problem.active]
        size = float(np.abs(line * scale).max())
        if not size > 0.0:
            return None
        system = np.vstack([matrix * scale / scale[:-1, None], line * scale / size])
        return np.append(f / scale[:-1], h / size), system

    def step(z: Array) -> Array | None:
        found = equations(z)
        return None if found is None else solution(found[1], -found[0])

    found = by_steps(step, origin.z, scale, NEWTON)
    at = None if found is None else equations(found.at)
    if found is None or at is None:
        return None
    x, q = _points(problem, found.at)
    if not jump.is_jump(x[place], q):
        return None
    product = np.eye(n)
    for j in range(k):
        slopes = (side if j == place else problem.system.base).jacobian(x[j], q)[1][:, :n]
        product = slopes @ product
    error = 4.0 * max(found.made, np.finfo(float).eps) * float(scale[-1])
    distance = float(origin.tangent @ ((found.at - origin.z) / scale))
    values = in_order(np.linalg.eigvals(product).astype(complex))
    return Collision(jump, upper, place, found.at, float(np.abs(at[0]).max()), error, distance, values)


def _is_reached(problem: Cycle, met: Collision, origin: Sample, frame: Frame) -> bool:
    """True where the branch is there right up to the surface, and on its own side of it."""
    if not -THERE < met.distance < FARTHEST:
        return False
    n, own = problem.n, slice(met.place * problem.n, (met.place + 1) * problem.n)
    if abs(met.distance) <= THERE:
        x, p = _points(problem, met.z)
        slope = met.jump.height(x[met.place], p)[1]
        along = frame.scale * origin.tangent
        rises = float(slope[:n] @ along[own]) + float(slope[n + problem.active] * along[-1])
        return rises < 0.0 if met.upper else rises > 0.0
    for part in BESIDE:
        guess = origin.z + part * (met.z - origin.z)
        found = problem.probe(origin, part * met.distance, guess, frame, Settings())
        if found is None or float(np.linalg.norm((found.z - guess) / frame.scale)) > met.distance:
            return False
        x, p = _points(problem, found.z)
        if (met.jump.height(x[met.place], p)[0] > 0.0) != met.upper:
            return False
    return True
