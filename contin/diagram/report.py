"""A diagram in words and numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from contin.continuation.branch import Branch, SpecialPoint
from contin.normalforms.words import describe

if TYPE_CHECKING:
    from contin.continuation.branch import Branch


def report(parameter: str, bounds: tuple[float, float], branches: Sequence[Branch], notes: Sequence[str]) -> str:
    """Branches with their special points and ends, then notes."""
    computed = [b for b in branches if b.image_of is None]
    mirrored = len(branches) - len(computed)
    images = f" and {mirrored} mirror image{'s' if mirrored != 1 else ''}" if mirrored else ""
    lines = [
        f"{len(computed)} branch{'es' if len(computed) != 1 else ''}{images} "
        f"in {parameter} from {bounds[0]:g} to {bounds[1]:g}"
    ]
    for branch in branches:
        lines += ["", *_branch_lines(branch)]
    if notes:
        lines += ["", "notes:", *(f"  {note}" for note in notes)]
    return "\n".join(lines)


def _branch_lines(branch: Branch) -> list[str]:
    if branch.image_of is not None:
        return [f"{branch.name}: image of {branch.image_of.branch} under {branch.image_of.symmetry}"]
    born = f", born at {branch.parent.branch}.{branch.parent.label}" if branch.parent else ""
    lines = [f"{branch.name}: {branch.kind}{born}, {len(branch)} points{_stability(branch)}"]
    lines += [f"  {_point_line(branch, p)}" for p in branch.points]
    return [*lines, f"  ends: {branch.ends[0].text}; {branch.ends[1].text}"]


def _stability(branch: Branch) -> str:
    if "stable" not in branch.columns:
        return ""
    share = float(branch.columns["stable"].mean())
    return ", stable" if share == 1.0 else ", unstable" if share == 0.0 else ", partly stable"


def _point_line(branch: Branch, point: SpecialPoint) -> str:
    where = ", ".join(f"{name} = {point.values[name]:.12g}" for name in branch.parameters)
    return f"{point.label:<5} {where:<28} {describe(point.type, point.normal_form)}"
