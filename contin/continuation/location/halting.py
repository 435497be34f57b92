"""Labelled points at which an arm ends: where it meets its own image, where its curve ends, where the run stops."""

from __future__ import annotations

from collections.abc import Sequence

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.location.found import Found
from contin.continuation.outcome import Verified
from contin.continuation.problem import Problem

HALF_PERIOD = "half a period"  # the symmetry of doubled orbits, see `contin.problems.orbits.symmetric.symmetry`

Halt = tuple[Found, End]


def mirror(problem: Problem, found: Sequence[Found], scale: Array, symmetries: Sequence[str]) -> Halt | None:
    """The branch point at which a branch meets its own mirror image, or orbits those of half the period.

    symmetries : those that the branch broke at its birth.
    """
    for f in found:
        if f.point.type not in ("BP", "BPC"):
            continue
        where, data = _where(problem, f), {"at": float(f.point.z[-1])}
        if halves(problem, f, scale):
            text = f"came together with orbits of half the period, at their period doubling {where}"
            data |= {"halved": True}
        elif symmetries and _reverses(problem, f, scale, symmetries):
            text = f"met its own mirror image at the branch point {where}"
        else:
            continue
        return f, End("joined", text, data)
    return None


def halves(problem: Problem, f: Found, scale: Array) -> bool:
    """True where orbits, or cycles of maps, meet those of half the period."""
    return f.point.type in ("BP", "BPC") and _reverses(problem, f, scale, (HALF_PERIOD,))


def halt(problem: Problem, found: Sequence[Found], scale: Array, stop_at: Sequence[str]) -> Halt | None:
    """The first point of a type at which the run is asked to stop.

    So do a DP from which on a curve of folds is its own mirror image, and points that the problem's curves end at.
    """
    for f in found:
        end = _end_at(problem, f, scale, stop_at)
        if end is not None:
            return f, end
    return None


def _end_at(problem: Problem, f: Found, scale: Array, stop_at: Sequence[str]) -> End | None:
    where = _where(problem, f)
    if f.point.type == "DP" and _reverses(problem, f, scale, ()):
        text = f"met its own mirror image on the curve of branch points at {where}"
        return End("joined", text, {"at": float(f.point.z[-1])})
    if f.point.type == "TZ" and problem.locus == "BP":
        return End("joined", f"three eigenvalues vanish at {where}: curves of several types meet there")
    return asked_to_stop(problem, f.point) if f.point.type in stop_at else problem.end_at(f.point)


def asked_to_stop(problem: Problem, point: Verified) -> End:
    """The end at a point of a type at which the run is asked to stop."""
    where = f"{problem.parameters[0]} = {point.z[-1]:.10g}"
    return End(point.type.lower(), f"{point.type} at {where}, where the run was asked to stop")


def _reverses(problem: Problem, f: Found, scale: Array, symmetries: Sequence[str]) -> bool:
    return problem.reverses(f.point.z, f.sample.tangent * scale, scale, symmetries)


def _where(problem: Problem, f: Found) -> str:
    return f"{problem.parameters[0]} = {f.point.z[-1]:.10g}"
