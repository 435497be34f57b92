"""Random flows and maps of three to five states against numpy, and runs whose range begins or ends on a bifurcation.

Every row lies on the curve, `unstable` is what numpy's eigenvalues of the Jacobian say, and what changes between rows
is labelled. A run from a labelled point, which is an edge of its range, has that label, and rows on the curve only.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import contin
from contin.model.model import Model

MOVED = {"LP": 1, "BP": 1, "PD": 1, "HB": 2, "NS": 2}
CLEAR = 1e-9  # of the largest eigenvalue: one this near to the stability boundary has no side


@dataclass(frozen=True)
class Polynomial:
    """f_i = A_ij x_j + (B_ij x_j)(C_ij x_j) - (D_i . x)^3 + p (e_i + E_ij x_j), a flow or a map."""

    kind: str
    a: Any
    b: Any
    c: Any
    d: Any
    e: Any
    by: Any

    @classmethod
    def random(cls, seed: int) -> Polynomial:
        random = np.random.default_rng(seed)
        n, kind = int(random.integers(3, 6)), ("flow", "map")[seed % 2]
        a = random.normal(size=(n, n))
        a *= (0.8 if kind == "map" else 1.0) / np.abs(np.linalg.eigvals(a)).max()
        if kind == "flow":
            a -= 1.2 * np.eye(n)
        b, c, d, by = (0.5 * random.normal(size=(n, n)) for _ in range(4))
        return cls(kind, a, b, c, d, random.normal(size=n), by)

    @property
    def names(self) -> list[str]:
        return [f"x{k}" for k in range(len(self.e))]

    def value(self, x: Any, p: float) -> Any:
        cubic = (self.d @ x) ** 3
        return self.a @ x + (self.b @ x) * (self.c @ x) - cubic + p * (self.e + self.by @ x)

    def jacobian(self, x: Any, p: float) -> Any:
        bilinear = self.b * (self.c @ x)[:, None] + self.c * (self.b @ x)[:, None]
        return self.a + bilinear - 3.0 * ((self.d @ x) ** 2)[:, None] * self.d + p * self.by

    def model(self) -> Model:
        def along(row: Any) -> str:
            return "(" + " + ".join(f"({v!r})*{name}" for v, name in zip(row.tolist(), self.names, strict=True)) + ")"

        equations = {
            name: f"{along(self.a[i])} + {along(self.b[i])}*{along(self.c[i])} - {along(self.d[i])}^3 "
            f"+ p*(({float(self.e[i])!r}) + {along(self.by[i])})"
            for i, name in enumerate(self.names)
        }
        states = dict.fromkeys(self.names, 0)
        return Model("p", kind=self.kind, states=states, parameters={"p": 0}, equations=equations)

    def complaints(self, branch: Any) -> list[str]:
        rows = np.column_stack([branch.columns[name] for name in self.names])
        labels = {point.index: point.type for point in branch.points}
        found, counted = [], []
        for k, (x, p) in enumerate(zip(rows, branch.columns["p"], strict=True)):
            rest = self.value(x, p) - (x if self.kind == "map" else 0.0)
            if np.abs(rest).max() > 1e-7 * (1.0 + np.abs(x).max() ** 3):
                found.append(f"row {k}, p = {p}: off the curve by {rest}")
            values = np.linalg.eigvals(self.jacobian(x, p))
            sides = np.abs(values) - 1.0 if self.kind == "map" else values.real
            if k in labels or np.abs(sides).min() < CLEAR * np.abs(values).max():
                continue
            counted.append(k)
            if int((sides > 0.0).sum()) != branch.columns["unstable"][k]:
                found.append(f"row {k}, p = {p}: unstable = {branch.columns['unstable'][k]}, eigenvalues {values}")
        for a, b in pairwise(counted):
            change = abs(int(branch.columns["unstable"][b]) - int(branch.columns["unstable"][a]))
            if change > sum(MOVED[labels[k]] for k in range(a, b) if k in labels) and not branch.notes:
                found.append(f"rows {a} to {b}: {change} more or less unstable without a label")
        return found


def run(seed: int, edges: int) -> list[str]:
    system = Polynomial.random(seed)
    model = system.model()
    branch = contin.continuation(contin.equilibrium(model), "p", (-2, 2), settings={"steps": 300})
    found = system.complaints(branch)
    for point in branch.points[:edges]:
        at = {name: point.values[name] for name in system.names}
        p = point.values["p"]
        for bounds in ((p, p + 1.0), (p - 1.0, p)):
            start = contin.equilibrium(model, at, {"p": p})
            again = contin.continuation(start, "p", bounds, settings={"steps": 80})
            found += system.complaints(again)
            same = [q for q in again.points if q.type == point.type and abs(q.values["p"] - p) < 1e-6]
            if not same and not again.notes:
                found.append(f"{point.label} at {p} is lost in {bounds}")
    return [f"seed {seed}: {text}" for text in found]


@pytest.mark.parametrize("seed", range(2))
def test_rows_and_labels_are_what_numpy_says(seed):
    assert run(seed, 1) == []


@pytest.mark.long
def test_rows_and_labels_are_what_numpy_says_of_many():
    assert [text for seed in range(2, 300) for text in run(seed, 3)] == []


@pytest.mark.parametrize(("equation", "inside"), [("p + x^2", -1), ("p - x^2", 1)])
@pytest.mark.parametrize("at", [0.0, 0.7])
def test_a_fold_on_the_edge_of_the_range_has_rows_on_the_curve_only(equation, inside, at):
    """Where the branch turns away from the range, the fold is all there is of it."""
    shifted = equation.replace("x", f"(x - {at})").replace("p", f"(p - {3 * at})")
    model = Model("fold", states={"x": {"value": at, "scale": 1}}, parameters={"p": 3 * at}, equations={"x": shifted})
    for side in (-1, 1):
        bounds = sorted((3 * at, 3 * at + side))
        branch = contin.continuation(contin.equilibrium(model), "p", bounds)
        assert [p.type for p in branch.points] == ["LP"]
        rest = (branch.columns["p"] - 3 * at) - inside * (branch.columns["x"] - at) ** 2
        np.testing.assert_allclose(rest, 0.0, atol=1e-9)
        assert (len(branch) == 1) == (side != inside)
        assert [end.reason for end in branch.ends] == ["bound", "bound"]


@pytest.mark.parametrize("beside", [1e-6, 1e-8, 1e-9, -1e-9, -1e-8, -1e-6])
def test_both_halves_of_a_fold_on_the_edge_are_followed_from_a_start_that_is_the_fold_to_rounding(beside):
    """A double root is found to 1e-8: along its tangent the parameter leaves the range, but by 1e-16."""
    model = Model("fold", states={"x": 1.0 + beside}, parameters={"p": 0.0}, equations={"x": "p - (x - 1)^2"})
    at = beside * beside
    branch = contin.continuation(contin.equilibrium(model, {"x": 1.0 + beside}, {"p": at}), "p", (at, 1.0))
    assert [p.type for p in branch.points] == ["LP"]
    assert sorted(branch.columns["x"][[0, -1]]) == pytest.approx([0.0, 2.0])


def test_a_range_next_to_rounding_about_a_fold_has_no_branch_point():
    """x' = p + x - x^3 with a state that follows: in a width of 1e-9 the derivative by p is next to nothing."""
    place, x = -2.0 / 3.0**1.5, 3.0**-0.5
    for width in (1e-8, 1e-9, 2e-10):
        model = contin.Model(
            "narrow", states={"x": x, "y": x}, parameters={"p": place + width / 2},
            equations={"x": "p + x - x^3 + 0.1*(y - x)", "y": "x - y"},
        )  # fmt: skip
        start = contin.equilibrium(model, dict.fromkeys("xy", x + (width / 2 / 3**0.5) ** 0.5))
        branch = contin.continuation(start, "p", (place - width / 2, place + width / 2), settings={"steps": 60})
        assert "BP" not in {point.type for point in branch.points}
