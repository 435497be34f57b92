"""Branches, special points, diagrams and phase diagrams."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from contin.continuation.branch import Branch, SpecialPoint
from contin.errors import InputError
from contin.normalforms.words import describe
from contin.notebook import html
from contin.plot.figure import draw
from contin.plot.spectrum import spectrum

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contin.diagram.diagram import Diagram
    from contin.diagram.phase.diagram import PhaseDiagram


def branch_page(branch: Branch) -> str:
    """Picture, labels, ends."""
    return (
        _picture(lambda: draw([branch]), repr(branch))
        + html.paragraph(_one_line(branch))
        + _points([branch], named=False)
        + html.notes(branch.notes)
        + html.details("ends and effort", _ends(branch))
    )


def point_page(point: SpecialPoint) -> str:
    """Where it is, what it is, eigenvalues and normal form."""
    names = getattr(point.problem, "parameters", ())
    where = ", ".join(f"{name} = {point.values[name]:.12g}" for name in names)
    multipliers = getattr(point.problem, "kind", "") in ("orbit", "fixed-point")
    critical = [(f"{value:.10g}",) for value in point.eigenvalues]
    return (
        html.paragraph(f"{point.label} at {where}: {describe(point.type, point.normal_form)}")
        + _picture_of_point(point, multipliers)
        + html.values({**point.normal_form, "error": point.error, "residual": point.residual})
        + html.details("values", html.values(point.values))
        + html.details("multipliers" if multipliers else "eigenvalues", html.table(("value",), critical))
    )


def _picture_of_point(point: SpecialPoint, multipliers: bool) -> str:
    """The orbit, where there is one; else the eigenvalues in the complex plane."""
    if getattr(point.problem, "kind", "") == "orbit":
        return _picture(lambda: point.orbit.plot(), f"orbit at {point.label}")
    values = [complex(value) for value in point.eigenvalues]
    if not values:
        return ""
    return html.image(spectrum(values, multipliers), f"eigenvalues at {point.label}")


def diagram_page(diagram: Diagram) -> str:
    """Picture, labels of all branches, notes."""
    if not diagram.branches:
        return html.paragraph("a diagram without branches") + html.notes(diagram.notes)
    lines = [(branch.name, _one_line(branch)) for branch in diagram.branches]
    return (
        _picture(diagram.plot, f"bifurcation diagram in {diagram.parameter}")
        + _points(diagram.branches, named=True)
        + html.notes(diagram.notes)
        + html.details(f"{len(lines)} branches", html.table(("branch", "what"), lines))
    )


def phase_page(diagram: PhaseDiagram) -> str:
    """Picture and the report, folded."""
    first, second = diagram.parameters
    return html.image(diagram.plot(), f"phase diagram in {first} and {second}") + html.details(
        "regions and notes", f"<pre>{html.text(diagram)}</pre>"
    )


def _picture(make: Callable[[], Figure], words: str) -> str:
    """The picture, or why there is none (a function of many states without columns, say)."""
    try:
        return html.image(make(), words)
    except InputError as error:
        return html.paragraph(f"no picture: {error}")


def _one_line(branch: Branch) -> str:
    what = f"curve of {branch.locus}" if branch.locus else branch.kind
    born = f", born at {branch.parent.branch}.{branch.parent.label}" if branch.parent else ""
    image = f", image of {branch.image_of.branch}" if branch.image_of else ""
    varied = f" in {' and '.join(branch.parameters)}" if branch.parameters else ""
    return f"{what}{varied}{born}{image}, {len(branch)} points"


def _points(branches: Iterable[Branch], *, named: bool) -> str:
    branches = [branch for branch in branches if branch.image_of is None]
    parameters = list(dict.fromkeys(name for branch in branches for name in branch.parameters))
    rows = [
        (
            *([branch.name] if named else []),
            point.label,
            *(point.values.get(name, "") for name in parameters),
            describe(point.type, point.normal_form),
        )
        for branch in branches
        for point in branch.points
    ]
    return html.table((*(["branch"] if named else []), "label", *parameters, "what"), rows)


def _ends(branch: Branch) -> str:
    ends = [(which, end.text) for which, end in zip(("first row", "last row"), branch.ends, strict=True)]
    effort = {"steps": branch.steps, "seconds": round(branch.seconds, 3), **branch.effort}
    return html.table(("end", "reason"), ends) + html.values(effort)
