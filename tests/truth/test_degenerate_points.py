"""Degenerate branch points: every solution beside the point that shrinks to it is on a branch of the diagram."""

import numpy as np
import pytest

import contin
from tests.diagram.crossings import solutions

BESIDE = 2e-3  # of the parameter: where solutions are counted
BOX = 0.6  # ... within this distance
STARTS = 600


def random_system(generator: np.random.Generator) -> dict[str, str]:
    """Two critical directions with a leading part whose solutions are not simple, rotated."""
    a, b, c, d, e, f = (float(generator.choice([-1.0, 1.0]) * generator.uniform(0.5, 2.0)) for _ in range(6))
    kind = int(generator.integers(3))
    X, Y = "X", "Y"
    fields = [
        (f"{a}*p*{X} + {b}*{X}^3 + {c}*{Y}^2", f"{d}*p*{Y} + {e}*{Y}*{X}^2 + {f}*{Y}^3"),
        (f"{a}*p*{X} + {b}*{X}^2", f"{d}*p*{Y} + {e}*{Y}^3"),
        (f"{a}*{X}*({X} - {b}*p^2)", f"{d}*p*{Y} + {e}*{Y}^2 + {c}*{X}*{Y}"),
    ][kind]
    t = float(generator.uniform(0.0, 2.0 * np.pi))
    cos, sin = float(np.cos(t)), float(np.sin(t))
    inner = {"X": f"({cos}*x + {sin}*y)", "Y": f"({-sin}*x + {cos}*y)"}
    first, second = (field.replace("X", inner["X"]).replace("Y", inner["Y"]) for field in fields)
    return {"x": f"{cos}*({first}) - {sin}*({second})", "y": f"{sin}*({first}) + {cos}*({second})"}


def newton(problem, u, p):
    for _ in range(60):
        f, jacobian = problem.linearise(np.append(u, p))
        try:
            step = np.linalg.solve(jacobian[:, :-1], -f)
        except np.linalg.LinAlgError:
            return None
        u = u + step * min(1.0, 0.3 / max(float(np.abs(step).max()), 1e-300))
        if np.abs(step).max() < 1e-14:
            return u
    return None


def shrinking(problem, p, generator):
    """Solutions at p from many starts of all sizes, those that come nearer to the origin as p does."""
    found = []
    for _ in range(STARTS):
        start = generator.normal(size=2) * 10.0 ** generator.uniform(-4, -0.3)
        u = newton(problem, start, p)
        if u is None or np.abs(u).max() > BOX or any(np.abs(u - v).max() < 1e-9 for v in found):
            continue
        found.append(u)
    kept = []
    for u in found:
        v, q = u, p
        while v is not None and abs(q) > abs(p) / 64.0:
            q *= 0.8
            v = newton(problem, v, q)
        if v is not None and np.abs(v).max() <= 0.5 * np.abs(u).max() + 1e-12:
            kept.append(u)
    return kept


def missing(seed: int) -> list[str]:
    """Solutions beside the point that no branch of the diagram passes, unless a note says that some may be missing."""
    generator = np.random.default_rng(seed)
    equations = random_system(generator)
    states = {"x": 0.0, "y": 0.0}
    model = contin.Model("case", states=states, parameters={"p": -0.05}, equations=equations)
    diagram = contin.diagram(model, "p", (-0.05, 0.05), start=states, orbits=False)
    if any("may not be followed" in note for note in diagram.notes):
        return ["noted"]
    problem = diagram["start"].problem
    lost = []
    for p in (-BESIDE, BESIDE):
        passed = solutions(diagram, p)
        for u in shrinking(problem, p, generator):
            if np.abs(passed - u).max(axis=1).min() > 1e-8:
                lost.append(f"seed {seed}, {equations}: ({u[0]:.6g}, {u[1]:.6g}) at p = {p}")
    return lost


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2))])
@pytest.mark.seldom
def test_every_solution_that_shrinks_to_the_point_is_on_a_branch(seed):
    assert missing(seed) == []


@pytest.mark.long
def test_every_solution_that_shrinks_to_a_degenerate_point_is_on_a_branch_in_many_systems():
    found = [text for seed in range(100, 300) for text in missing(seed)]
    assert [text for text in found if text != "noted"] == []


@pytest.mark.parametrize("kind", ["algebraic", "flow"])
def test_a_shallow_arch_whose_second_mode_only_touches_zero(kind):
    """Of height h = 4: 16 + (a^2 - h^2) = a^2 is zero at a = 0, P = 10 h, where no branch leaves.

    Where the point lies is known to the root of rounding, and its coefficients no better than that.
    """
    arch = contin.Model(
        "arch", kind=kind, states={"a": 4.0, "b": 0.0}, parameters={"P": 0.0},
        equations={"a": "-(a - 4) - a*(a^2 - 16 + 4*b^2)/4 - P/10", "b": "-16*b - b*(a^2 - 16 + 4*b^2)"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(arch), "P", (-300.0, 300.0))
    touching = [point for point in line.points if point.type == "BP"]
    for point in touching:
        assert point.normal_form["kind"] == "degenerate"
        assert abs(point.values["P"] - 40.0) <= point.error
        assert abs(point.normal_form["b11"]) <= point.normal_form["errors"]["b11"]
    assert touching or any("touches zero" in note for note in line.notes)
