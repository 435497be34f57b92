"""Conservative systems: pairs of eigenvalues stay on the stability boundary, and rounding decides nothing."""

from math import pi

import numpy as np
import pytest

import contin
from contin.problems import neutral_pairs


def oscillators(count: int, condition: float, kind: str, seed: int) -> tuple[contin.Model, np.ndarray, np.ndarray]:
    """q'' = -(K + k D) q - q^3 (a map: kicks of 0.2), in coordinates of a given condition; K positive, D diagonal."""
    generator = np.random.default_rng(seed)
    n = 2 * count
    stiffness = generator.normal(size=(count, count))
    stiffness = stiffness @ stiffness.T + np.diag(generator.uniform(0.5, 2.0, count))
    change = np.diag(generator.uniform(-1.0, 1.0, count))
    left, right = (np.linalg.qr(generator.normal(size=(n, n)))[0] for _ in range(2))
    matrix = left @ np.diag(np.geomspace(1.0, 1.0 / condition, n)) @ right
    names = [f"u{i}" for i in range(n)]

    def combined(row, terms) -> str:
        return "(" + " + ".join(f"({float(c)!r})*{t}" for c, t in zip(row, terms, strict=True)) + ")"

    old = [combined(row, names) for row in np.linalg.inv(matrix)]
    q, p = old[:count], old[count:]
    force = [
        "-(" + " + ".join(f"({float(a)!r} + k*({float(b)!r}))*{x}" for a, b, x in zip(*rows, q, strict=True))
        + f" + {q[i]}^3)"
        for i, rows in enumerate(zip(stiffness, change, strict=True))
    ]  # fmt: skip
    if kind == "flow":
        fields = [*p, *force]
    else:
        kicked = [f"({a} + 0.2*{f})" for a, f in zip(p, force, strict=True)]
        fields = [f"({a} + {b})" for a, b in zip(q, kicked, strict=True)] + kicked
    equations = {name: combined(row, [f"({f})" for f in fields]) for name, row in zip(names, matrix, strict=True)}
    model = contin.Model("oscillators", kind=kind, states=dict.fromkeys(names, 0.0), parameters={"k": 0.0},
                         equations=equations)  # fmt: skip
    return model, stiffness, change


@pytest.mark.parametrize("kind", ["flow", "map"])
@pytest.mark.parametrize(("count", "condition", "seed"), [(1, 1e3, 1), (2, 1.0, 2), (2, 1e3, 5), (3, 1e3, 4)])
def test_unstable_counts_the_negative_stiffnesses_in_any_coordinates(kind, count, condition, seed):
    model, stiffness, change = oscillators(count, condition, kind, seed)
    branch = contin.continuation(contin.equilibrium(model, dict.fromkeys(model.state_names, 0.0)), "k", (-4.0, 4.0))
    squares = [np.linalg.eigvalsh(stiffness + k * change) for k in branch.columns["k"]]
    marked = {p.index for p in branch.points}
    for row, values in enumerate(squares):
        if row not in marked:
            assert branch.columns["unstable"][row] == np.sum(values < 0.0)
    assert {p.type for p in branch.points} <= {"BP"}
    crossings = int(np.sum(np.abs(np.diff([np.sum(v < 0.0) for v in squares]))))
    assert len(branch.points) == crossings
    stays = all(np.any(values > 1e-3) for values in squares)
    assert any("stay" in note and "boundary" not in note for note in branch.notes) == stays
    assert not any("without a label" in note for note in branch.notes)


@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_forced_pendulum_without_friction_has_its_fold_and_no_torus(method):
    model = contin.Model(
        "pendulum", states={"x": 0.1, "y": 0}, parameters={"w": {"value": 0.6, "range": [0.3, 3]}, "a": 0.2},
        equations={"x": "y", "y": "-sin(x) + a*cos(w*t)"}, forcing={"period": "2*pi/w"},
    )  # fmt: skip
    phase, size = np.linspace(0, 2 * pi, 101), 0.2 / (1 - 0.36)
    samples = np.column_stack([size * np.cos(phase), -0.6 * size * np.sin(phase)])
    orbit = contin.periodic_orbit(model, samples, period=2 * pi / 0.6, method=method)
    family = contin.continuation(orbit, "w", (0.55, 3.0))
    assert [p.type for p in family.points] == ["LPC"]
    assert family["LPC1"].values["w"] == pytest.approx(0.8255360214, abs=1e-8)
    assert set(family.columns["unstable"]) == {0, 1}
    assert "b" not in family["LPC1"].normal_form  # the multiplier 1 is double


def test_branch_point_of_a_double_eigenvalue_has_no_coefficients_of_rounding():
    """Two oscillators with a coupling: at det = 0 the eigenvalue 0 is double, with one eigenvector."""
    model = contin.Model(
        "coupled", states=dict.fromkeys("xyuv", 0.0), parameters={"k": 1.0},
        equations={"x": "u", "y": "v", "u": "-k*x - 0.5*y + x^2", "v": "-0.5*x - 2*y + y^2"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model, dict.fromkeys("xyuv", 0.0)), "k", (-1.0, 3.0))
    point = branch["BP1"]
    assert point.values["k"] == pytest.approx(0.125, abs=1e-12)
    assert dict(point.normal_form) == {}
    assert any("normal form" in note for note in branch.notes)


@pytest.mark.parametrize("is_map", [False, True])
def test_pairs_are_suspected_alike_among_few_and_among_many(is_map):
    """Others that are no pairs do not change the answer."""
    chance = np.random.default_rng(3)
    seen = set()
    for trial in range(300):
        values = chance.uniform(0.5, 2.0, 4) + 1j * chance.standard_normal(4)
        if trial % 2:
            gap = 10.0 ** chance.uniform(-9, -4)
            values[1] = (1.0 / values[0] if is_map else -values[0]) * (1.0 + gap)
        among_many = np.concatenate([values, 100.0 * 3.0 ** np.arange(6)])
        seen.add(neutral_pairs.is_suspect(values, is_map))
        assert neutral_pairs.is_suspect(values, is_map) == neutral_pairs.is_suspect(among_many, is_map)
    assert seen == {False, True}


def test_a_slow_growth_is_seen_beside_couplings_of_very_unlike_sizes():
    """x' = .3 x + p^2 y, y' = .3 y - x: .3 +- i p, two unstable ones, at every p."""
    model = contin.Model(
        "unlike", states={"x": 0, "y": 0}, parameters={"p": 1.0},
        equations={"x": "0.3*x + p^2*y", "y": "0.3*y - x"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model, {"x": 0, "y": 0}), "p", (1.0, 1e10))
    assert np.all(branch.columns["unstable"] == 2)
    assert not branch.points
