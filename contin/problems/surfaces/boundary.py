"""Boundary equilibria (BE): a branch of equilibria ends where it meets a surface on which the equations jump."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import accumulate
from operator import mul
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.outcome import Verified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.settings import Settings
from contin.linalg.newton import Rules, by_steps, solution
from contin.problems.surfaces.jumps import Jump, jumps_of
from contin.problems.surfaces.sides import between, side_of

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

NEWTON: Final = Rules(settled=1e-14, stalled=1e-10, far=1e3, budget=30)
FARTHEST: Final = 1e-3  # scaled distance ahead at which a surface is looked for
BESIDE: Final = (0.5, 0.9, 0.99)  # parts of it at which the branch must be there, on the same side
TANGENT: Final = 1e-2  # sine of an angle: fields that cross the surface at less than it do not define sliding motion
AHEAD: Final = tuple(accumulate([2.15] * 9, mul, initial=1e-6))  # scaled distances beyond a last row, to 1e-3
NEAR: Final = 1e-4  # a step across a surface is repeated with shorter ones down to this length
SHORTER: Final = 4.0
TOGETHER: Final = 1e-8  # scaled distance of two surfaces that are met at once
THERE: Final = 1e-12  # scaled distance at which a branch begins on a surface
EDGE: Final = 1e-12  # of a weight: the end of the sliding motion
ROUNDED: Final = 1e-9  # of the terms: slopes below this have no sign


@dataclass(frozen=True, eq=False)
class Meeting:
    """The point at which equilibria of one side lie on a surface, in units of the scale `distance` ahead."""

    jump: Jump
    upper: bool
    z: Array
    residual: float
    error: float
    distance: float


def cut_at_surface(problem: AlgebraicEquations, chunk: Chunk) -> Chunk:
    """The chunk up to the first step across a surface on which the equations jump, as one whose corrector failed.

    Of pseudo-equilibria: up to the first where the motion on their surface does not slide.
    """
    if not problem.system.n_switches and problem.sliding is None:
        return chunk
    if len(chunk) < 2:
        return chunk
    for k in _candidates(problem, chunk):
        if separated(problem, chunk.z[k], chunk.z[k + 1]):
            return cut_before(chunk, int(k))
    if problem.sliding is None:
        return chunk
    weights = problem.sliding.weights(problem, chunk.z[1:])
    drive = problem.sliding.drive(problem, chunk.z)
    inside = (weights > EDGE) & (weights < 1.0 - EDGE)  # a row on the end itself would have nothing ahead
    left = np.flatnonzero(~inside | (drive[1:] * _first(drive) < TANGENT))
    return cut_before(chunk, int(left[0])) if left.size else chunk


def cut_before(chunk: Chunk, row: int) -> Chunk:
    """The chunk without the step from this row: to be done again with a shorter one, until it is as short as NEAR."""
    length = float(chunk.lengths[row + 1])
    if length > NEAR:
        return chunk.cut(row + 1, Stop.LIMIT, max(length / SHORTER, 0.5 * NEAR))
    return chunk.cut(row + 1, Stop.CORRECTOR, length)


def separated(problem: AlgebraicEquations, a: Array, b: Array) -> bool:
    """True where a surface on which the equations jump lies between two points."""
    n = problem.n
    p, q = problem.full_parameters(a), problem.full_parameters(b)
    targets = (a[:n], b[:n]) if problem.is_map else (np.zeros(n), np.zeros(n))
    return between(jumps_of(problem.system), (a[:n], p, targets[0]), (b[:n], q, targets[1]))


def slides(problem: AlgebraicEquations, z: Array) -> bool:
    """True for a pseudo-equilibrium on the part of its surface that motion slides on, its edges included."""
    assert problem.sliding is not None
    weight = float(problem.sliding.weights(problem, z[None])[0])
    return -EDGE <= weight <= 1.0 + EDGE


def _first(drive: Array) -> float:
    """The sign at the first row, or at the next one where the branch begins on the limit of the sliding motion."""
    return float(np.sign(drive[0]) or np.sign(drive[1]))


def _candidates(problem: AlgebraicEquations, chunk: Chunk) -> NDArray[np.intp]:
    """Steps in which some switching function changes its sign, or from or to a point on its surface."""
    if not problem.system.n_switches:
        return np.empty(0, np.intp)
    p = np.array([problem.full_parameters(z) for z in chunk.z])
    values = problem.system.switches(np.ascontiguousarray(chunk.z[:, : problem.n]), p)
    return np.flatnonzero(np.any((values[:-1] * values[1:] <= 0.0) & (values[:-1] != values[1:]), axis=1))


def foretold(problem: AlgebraicEquations, origin: Sample, frame: Frame) -> Renewal | None:
    """The end of a branch whose next step would cross a surface of discontinuity; None where there is none ahead."""
    found = [m for m in _meetings(problem, origin, frame) if _is_reached(problem, m, origin, frame)]
    if not found:
        return _tangent_fields(problem, origin, frame)
    first = min(found, key=lambda m: m.distance)
    point = _verified(problem, first)
    together = _met_with(problem, first, frame)
    names = list(dict.fromkeys(jump.surface.text for jump in (first.jump, *together)))
    if together:  # two surfaces at once: what begins there is not known from one of them
        form = dict(point.normal_form) | {"kind": "degenerate", "surface": " and ".join(names)}
        point = replace(point, normal_form=form, vectors=dict(point.vectors) | {"surfaces": len(names)})
    surfaces = f"the surface{'s' if together else ''} {' and '.join(names)}"
    name = problem.parameters[0]
    noun = "fixed point" if problem.is_map else "equilibrium"
    text = f"at {name} = {first.z[-1]:.10g}, the {noun} meets {surfaces}, where the "
    text += "equations jump" if problem.sliding is None else "equations jump, and the motion slides no further"
    data = {"surface": " and ".join(names), "at": {name: float(first.z[-1])}}
    return Renewal(frame.scale, origin, None, None, End("surface", text, data), None, point)


def _tangent_fields(problem: AlgebraicEquations, origin: Sample, frame: Frame) -> Renewal | None:
    """The end of pseudo-equilibria before a place where both fields are tangent to their surface."""
    if problem.sliding is None:
        return None
    for length in AHEAD:
        guess = origin.z + length * frame.scale * origin.tangent
        found = problem.probe(origin, length, guess, frame, Settings())
        if found is None:
            continue  # Newton has no limit there
        drive = problem.sliding.drive(problem, np.stack([origin.z, found.z]))
        if drive[1] * _first(drive) < TANGENT:
            name, surface = problem.parameters[0], problem.sliding.jump.surface.text
            text = (
                f"beyond {name} = {origin.z[-1]:.10g}, the fields on both sides become tangent to the surface "
                f"{surface}: the sliding motion is not defined there"
            )
            data = {"surface": surface, "at": {name: float(origin.z[-1])}}
            return Renewal(frame.scale, origin, None, None, End("surface", text, data))
    return None


def _meetings(problem: AlgebraicEquations, origin: Sample, frame: Frame) -> list[Meeting]:
    n, found = problem.n, []
    p = problem.full_parameters(origin.z)
    target = origin.z[:n] if problem.is_map else np.zeros(n)
    for jump in jumps_of(problem.system):
        side = side_of(jump, origin.z[:n], p, target, FARTHEST * _reach(problem, jump, origin.z, frame.scale))
        found.append(solved_on_surface(problem, jump, bool(side), origin, frame))
    if problem.sliding is not None:
        weight = float(problem.sliding.weights(problem, origin.z[None])[0])
        own = problem.sliding.jump
        found += [solved_on_surface(problem, own, upper, origin, frame) for upper in {weight > 0.5, True, False}]
    return [m for m in found if m is not None and -THERE < m.distance < FARTHEST]


def _reach(problem: AlgebraicEquations, jump: Jump, z: Array, scale: Array) -> float:
    """How much a height changes over the distance 1."""
    n = problem.n
    slope = jump.height(z[:n], problem.full_parameters(z))[1][[*range(n), n + problem.active]]
    return float(np.linalg.norm(slope * scale))


def solved_on_surface(
    problem: AlgebraicEquations, jump: Jump, upper: bool, origin: Sample, frame: Frame, corners: bool = False
) -> Meeting | None:
    """Newton on f = 0, h = 0 with the formulas of one side, in the states and the active parameter.

    corners : also where the equations do not jump.

    Of other surfaces, which may be met as soon, the side of `origin` counts, on whichever Newton's steps are.
    """
    n, scale = problem.n, frame.scale
    side = jump.held(upper, origin.z[:n], problem.full_parameters(origin.z))
    columns = [*range(n), n + problem.active]

    def equations(z: Array) -> tuple[Array, Array] | None:
        p = problem.full_parameters(z)
        f, matrix = side.jacobian(z[:n], p)
        if problem.is_map:
            f, matrix = f - z[:n], matrix - np.eye(n, matrix.shape[1])
        h, slope = jump.height(z[:n], p)
        row = slope[columns] * scale
        size = float(np.abs(row).max())
        if not size > 0.0:
            return None
        system = np.vstack([matrix[:, columns] * scale / scale[:-1, None], row / size])
        return np.append(f / scale[:-1], h / size), system

    def step(z: Array) -> Array | None:
        found = equations(z)
        return None if found is None else solution(found[1], -found[0])

    found = by_steps(step, origin.z, scale, NEWTON)
    at = None if found is None else equations(found.at)
    if found is None or at is None:
        return None
    if not corners and not jump.is_jump(found.at[:n], problem.full_parameters(found.at)):
        return None
    z, right = found.at, at[0]
    error = 4.0 * max(found.made, np.finfo(float).eps) * float(scale[-1])
    distance = float(origin.tangent @ ((z - origin.z) / scale))
    return Meeting(jump, upper, z, float(np.max(np.abs(right))), error, distance)


def _met_with(problem: AlgebraicEquations, first: Meeting, frame: Frame) -> list[Jump]:
    """Other surfaces through the point where the first one is met.

    They are asked there: Newton's method on f = 0 and another surface may step across the first one, by rounding alone.
    """
    n, z = problem.n, first.z
    columns, p = [*range(n), n + problem.active], problem.full_parameters(z)
    found = []
    for jump in jumps_of(problem.system):
        h, slope = jump.height(z[:n], p)
        near = abs(h) <= TOGETHER * float(np.linalg.norm(slope[columns] * frame.scale))
        if jump is not first.jump and near and jump.is_jump(z[:n], p):
            found.append(jump)
    return found


def _is_reached(problem: AlgebraicEquations, meeting: Meeting, origin: Sample, frame: Frame) -> bool:
    """True where the branch is there right up to the surface, and on its own side of it.

    One that begins on the surface, to rounding, has no points before it: it leads across where its height says so.
    """
    n, settings = problem.n, Settings()
    if abs(meeting.distance) <= THERE:
        own = problem.sliding is not None and meeting.jump is problem.sliding.jump
        slope = meeting.jump.height(meeting.z[:n], problem.full_parameters(meeting.z))[1]
        rises = float(slope[[*range(n), n + problem.active]] @ (frame.scale * origin.tangent))
        return not own and (rises < 0.0 if meeting.upper else rises > 0.0)
    for part in BESIDE:
        length = part * meeting.distance
        guess = origin.z + part * (meeting.z - origin.z)
        found = problem.probe(origin, length, guess, frame, settings)
        if found is None or float(np.linalg.norm((found.z - guess) / frame.scale)) > meeting.distance:
            return False
        if problem.sliding is not None and meeting.jump is problem.sliding.jump:
            continue
        h = meeting.jump.height(found.z[:n], problem.full_parameters(found.z))[0]
        if (h > 0.0) != meeting.upper:
            return False
    return True


def _verified(problem: AlgebraicEquations, meeting: Meeting) -> Verified:
    """The point with the eigenvalues of the branch that ends there."""
    n, z, jump = problem.n, meeting.z, meeting.jump
    own = problem.sliding is not None and jump is problem.sliding.jump
    matrix = (problem.system if own else jump.side(meeting.upper)).jacobian(z[:n], problem.full_parameters(z))[1]
    values = np.linalg.eigvals(matrix[:, :n]).astype(complex)
    values = values[np.lexsort((-values.imag, -values.real))]
    side = f"{jump.surface.text[:-4]} {'>' if meeting.upper else '<'} 0"
    form = {"surface": jump.surface.text, "side": side}
    if problem.is_map:
        form = {"kind": "border collision"} | form
        unstable = int(np.sum(np.abs(values) > 1.0))
    else:
        form = {"kind": _kind(problem, meeting)} | form
        unstable = int(np.sum(values.real > 0.0))
    vectors = {"jump": jump.number, "upper": meeting.upper, "own": own}
    return Verified("BE", z, meeting.residual, meeting.error, values, unstable, form, vectors)


def _kind(problem: AlgebraicEquations, meeting: Meeting) -> str:
    """persistence: the pseudo-equilibrium is on the other side of the parameter; nonsmooth fold: on the same one.

    With the side's A = f_u, slope of h along its equilibria: h' = h_p - h_u A^-1 f_p; of the weight along the
    pseudo-equilibria A u' + f_p + w' (f+ - f-) = 0, h_u u' + h_p = 0 (di Bernardo et al. 2008, sec. 5.2).
    """
    n, z, jump = problem.n, meeting.z, meeting.jump
    p = problem.full_parameters(z)
    matrix = jump.side(meeting.upper).jacobian(z[:n], p)[1]
    a, b = matrix[:, :n], matrix[:, n + problem.active]
    _, slope = jump.height(z[:n], p)
    normal, drift = slope[:n], slope[n + problem.active]
    across = jump.upper.value(z[:n], p) - jump.lower.value(z[:n], p)
    try:
        moved = np.linalg.solve(a, -b)
        bordered = np.block([[a, across[:, None]], [normal[None, :], np.zeros((1, 1))]])
        weight = float(np.linalg.solve(bordered, -np.append(b, drift))[-1])
    except np.linalg.LinAlgError:
        return "degenerate"
    height = float(drift + normal @ moved)
    if abs(height) <= ROUNDED * (abs(drift) + float(np.abs(normal) @ np.abs(moved))) or weight == 0.0:
        return "degenerate"
    # equilibria where h has the side's sign; pseudo-equilibria where the weight is inside (0, 1)
    same = (height > 0.0) == (weight < 0.0) if meeting.upper else (height < 0.0) == (weight > 0.0)
    return "nonsmooth fold" if same else "persistence"
