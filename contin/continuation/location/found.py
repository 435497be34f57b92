"""What is found between two points of a curve: verified points with their places, or notes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.outcome import Rejected, Verified
from contin.continuation.position import position
from contin.continuation.problem import in_two_parameters
from contin.continuation.sample import Sample
from contin.continuation.sentence import Sentence
from contin.errors import InputError, NotFiniteError
from contin.linalg.vectors import dot

CROSSINGS = ("BP", "BPC")  # types of points through which another branch passes
CHORD = 1e-7  # shorter chords have no direction
ALIGNED = 0.99  # cosine from which the tangent at a point is that of the branch that was followed


@dataclass(frozen=True, eq=False)
class Found:
    """A verified point and where it lies on the stretch."""

    length: float
    point: Verified
    sample: Sample  # the located sample next to it, with the branch's tangent at the point itself


@dataclass(frozen=True)
class Note:
    """Something seen that did not become a label; `suspect` where a jump to another branch would explain it."""

    said: Sentence
    suspect: bool = False
    hides: bool = False  # events may lie there that were not told from each other
    at: Array | None = None  # where tests are rounding errors: next to a labelled point they are, and that says nothing
    jump: float | None = None  # arclength at which unstable values change for want of smoothness: no riddle
    place: Array | None = None  # a point next to it


def where(stretch: Stretch, a: Sample, text: str) -> Sentence:
    return Sentence.near(stretch.problem, a.z, text)


def noted(
    stretch: Stretch, sample: Sample, text: str, suspect: bool = False, hides: bool = False, at: Array | None = None
) -> Note:  # fmt: skip
    """A note of what was seen next to a sample."""
    return Note(where(stretch, sample, text), suspect, hides, at, place=sample.z)


def rejected(stretch: Stretch, sample: Sample, found: Rejected, suspect: bool = False, hides: bool = False) -> Note:
    """A note of what was rejected next to a sample, and why."""
    said = Sentence.near(stretch.problem, sample.z, found.reason, defect=found.defect)
    return Note(said, suspect, hides, place=sample.z)


def exactly(stretch: Stretch, z: Array, text: str) -> Sentence:
    return Sentence(f"at {position(stretch.problem, z)}, {text}")


def anchored(point: Verified, place: Array) -> Verified:
    """The point with this place on its own branch."""
    return replace(point, vectors={**point.vectors, "beside": place})


def anchored_on_branch(point: Verified, beside: Sample) -> Verified:
    """The point with a place on its own branch, which tells that from others with the same tangent."""
    return anchored(point, beside.z) if point.type == "BP" else point


def at_point(stretch: Stretch, near: Sample, point: Verified) -> Sample:
    """`near` with the tangent at the point: of the branches through it, the one that the stretch follows.

    Close to a branch point the Jacobian is too small to give a direction, so the tangents of samples next to it are
    useless; the stretch's base and the chord from there to the point (a circle through both) tell which branch it is.
    """
    base, scale = stretch.base, stretch.frame.scale
    chord = (point.z - base.z) / scale
    length = float(base.tangent @ chord)
    expected = base.tangent if abs(length) < CHORD else 2.0 * chord / length - base.tangent
    expected = expected / np.linalg.norm(expected)
    if point.vectors.get("crossed"):  # another curve crosses, and the equations have no one tangent there
        return replace(near, tangent=expected)
    if point.type not in CROSSINGS and not point.touches:  # one branch, and a regular point
        if not stretch.problem.adaptive:
            sample = stretch.problem.probe(base, length, point.z.copy(), stretch.frame, stretch.settings)
        elif not in_two_parameters(stretch.problem):  # in the point's own phase, without the sparse matrices below
            there = replace(near, z=point.z, tangent=expected)
            sample = stretch.problem.probe(there, 0.0, point.z.copy(), stretch.frame, stretch.settings)
        else:
            sample = None
        if sample is not None and dot(sample.tangent, expected) > ALIGNED:
            return replace(near, tangent=sample.tangent)
    try:
        tangents = stretch.problem.tangents(point.z, scale)
    except (InputError, NotFiniteError):  # the equations are singular at the point itself, where curves meet
        return replace(near, tangent=expected)
    best = max(tangents, key=lambda t: abs(float(t @ expected)))
    alignment = float(best @ expected)
    return replace(near, tangent=best * np.sign(alignment) if abs(alignment) > 0.9 else expected)


def found_at(stretch: Stretch, near: Sample, point: Verified, anchor: Sample) -> Found:
    """A point where a test touches zero."""
    length = float(stretch.base.tangent @ ((point.z - stretch.base.z) / stretch.frame.scale))
    return Found(length, anchored_on_branch(point, anchor), at_point(stretch, near, point))
