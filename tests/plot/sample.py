"""Branches with closed forms, built by hand, for tests of plots, reports and files."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from contin.continuation.branch import Branch, End, ImageOf, Parent, SpecialPoint


def special(type_: str, label: str, index: int, values: Mapping[str, float], eigenvalues: Any = (), **normal_form: Any):
    """A labelled point with the given values; unknowns and tangent are left out."""
    empty = np.empty(0)
    return SpecialPoint(
        type_, label, index, empty, empty, dict(values), 1e-15, 2e-14, np.asarray(eigenvalues, complex), normal_form
    )


def branch(
    name: str, columns: Mapping[str, Any], points=(), ends=None, kind="equilibrium", parameters=("p",), **more: Any
):
    """A Branch of the given columns."""
    columns = {key: np.asarray(column) for key, column in columns.items()}
    rows = len(next(iter(columns.values())))
    ends = ends or (End("bound", "p reached its lower bound"), End("bound", "p reached its upper bound"))
    z = np.zeros((rows, 2))
    settings = {"start_row": 0, "steps": rows - len(points), "seconds": 0.001, "effort": {"residuals": 3 * rows}}
    return Branch(
        name,
        kind,
        parameters,
        columns,
        tuple(points),
        ends,
        z,
        z,
        np.zeros((rows, 2), complex),
        **settings,
        problem=None,
        **more,
    )


def pitchfork() -> list[Branch]:
    """x' = p x - x^3: the line x = 0 and the two half-branches x = +-sqrt(p), one the image of the other."""
    p = np.linspace(-1.0, 1.0, 41)
    line = branch(
        "line",
        {"p": p, "x": 0 * p, "unstable": (p > 0).astype(int), "stable": p <= 0},
        [
            special(
                "BP", "BP1", 20, {"p": 0.0, "x": 0.0}, [0.0], kind="pitchfork", criticality="supercritical", b30=-6.0
            )
        ],
    )
    x = np.linspace(0.0, 1.0, 21)
    columns = {"p": x**2, "x": x, "unstable": np.zeros(21, int), "stable": np.ones(21, bool)}
    ends = (End("start", "born at line.BP1"), End("bound", "p reached 1"))
    fork = branch("fork", columns, ends=ends, parent=Parent("line", "BP1"))
    mirror = branch("fork~flip", {**columns, "x": -x}, ends=ends, parent=fork.parent, image_of=ImageOf("fork", "flip"))
    return [line, fork, mirror]


def hysteresis() -> list[Branch]:
    """x' = p + 3 x - x^3: an S of equilibria with folds at x = +-1, p = -+2."""
    x = np.linspace(-2.2, 2.2, 111)
    x = np.sort(np.append(x, [-1.0, 1.0]))
    p = x**3 - 3 * x
    rows = [int(np.flatnonzero(x == value)[0]) for value in (-1.0, 1.0)]
    points = [
        special("LP", f"LP{k + 1}", row, {"p": p[row], "x": x[row]}, [0.0], a=-3 * x[row]) for k, row in enumerate(rows)
    ]
    unstable = (np.abs(x) < 1).astype(int)
    return [branch("states", {"p": p, "x": x, "unstable": unstable, "stable": unstable == 0}, points)]


def bautin() -> list[Branch]:
    """r' = r (p + r^2 - r^4): a subcritical Hopf point at p = 0, orbits that turn at p = -1/4, r^2 = 1/2."""
    p = np.linspace(-0.5, 0.5, 41)
    rest = branch(
        "rest",
        {"p": p, "x": 0 * p, "y": 0 * p, "unstable": np.where(p > 0, 2, 0), "stable": p <= 0},
        [
            special(
                "HB", "HB1", 20, {"p": 0.0, "x": 0.0, "y": 0.0}, [1j, -1j], omega=1.0, l1=2.0, criticality="subcritical"
            )
        ],
    )
    r2 = np.sort(np.append(np.linspace(0.0, 1.35, 60), 0.5))
    r, row = np.sqrt(r2), int(np.flatnonzero(r2 == 0.5)[0])
    at = r2**2 - r2
    columns = {"p": at, "x.min": -r, "x.max": r, "y.min": -r, "y.max": r, "period": np.full(len(r), 2 * np.pi)}
    columns |= {"unstable": (r2 < 0.5).astype(int), "stable": r2 >= 0.5}
    fold = special("LPC", "LPC1", row, {"p": -0.25, "x.max": r[row], "period": 2 * np.pi}, [1.0, 1.0])
    ends = (End("start", "born at rest.HB1"), End("bound", "p reached 0.5"))
    cycles = branch("cycles", columns, [fold], ends, kind="orbit", parent=Parent("rest", "HB1"))
    q = np.linspace(0.0, 1.4, 40)
    locus = branch(
        "folds",
        {"p": -(q**2) / 4, "q": q, "x.max": np.sqrt(q / 2), "unstable": 0 * q.astype(int), "stable": q >= 0},
        kind="locus",
        locus="LPC",
        parameters=("p", "q"),
        parent=Parent("cycles", "LPC1"),
    )
    return [rest, cycles, locus]
