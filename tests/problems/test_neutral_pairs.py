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
    assert any("stay" in note and "along the branch" in note for note in branch.notes) == stays
    assert not any("without a label" in note for note in branch.notes)


@pytest.mark.parametrize("method", ["collocation", "shooting"])
@pytest.mark.seldom
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


@pytest.mark.parametrize("by_multipliers", [False, True])
def test_pairs_are_suspected_alike_among_few_and_among_many(by_multipliers):
    """Others that are no pairs do not change the answer."""
    chance = np.random.default_rng(3)
    seen = set()
    for trial in range(300):
        values = chance.uniform(0.5, 2.0, 4) + 1j * chance.standard_normal(4)
        if trial % 2:
            gap = 10.0 ** chance.uniform(-9, -4)
            values[1] = (1.0 / values[0] if by_multipliers else -values[0]) * (1.0 + gap)
        among_many = np.concatenate([values, 100.0 * 3.0 ** np.arange(6)])
        seen.add(neutral_pairs.is_suspect(values, by_multipliers))
        assert neutral_pairs.is_suspect(values, by_multipliers) == neutral_pairs.is_suspect(among_many, by_multipliers)
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


def rikitake(a: float, mu: float):
    """Rikitake's dynamo at its equilibrium x = K, y = 1/K, z = mu K^2, mu (K^2 - 1/K^2) = a.

    Its characteristic polynomial is (l + 2 mu)(l^2 + K^2 + 1/K^2): a centre and a stable direction, for all a and mu.
    """
    model = contin.Model(
        "dynamo", states=dict.fromkeys("xyz", 1.0), parameters={"mu": mu, "a": a},
        equations={"x": "-mu*x + z*y", "y": "-mu*y + (z - a)*x", "z": "1 - x*y"},
    )  # fmt: skip
    k = np.sqrt(0.5 * (a / mu + np.sqrt((a / mu) ** 2 + 4.0)))
    return contin.equilibrium(model, {"x": k, "y": 1.0 / k, "z": mu * k * k})


@pytest.mark.parametrize("seed", range(12))
def test_a_centre_that_is_one_on_its_branch_alone_is_no_crossing_anywhere(seed):
    """Beside the equilibrium the pair is off the axis: of a row, the distance to the solution counts as an error."""
    chance = np.random.default_rng(seed)
    name = ("a", "mu")[seed % 2]
    branch = contin.continuation(rikitake(chance.uniform(0.5, 7.5), chance.uniform(0.5, 3.0)), name, (0.1, 8.0))
    assert not branch.columns["unstable"].any()
    assert not branch.points
    assert branch.unexplained == 0
    assert any("on the imaginary axis along the branch" in note for note in branch.notes)


ROUTH = 0.5 * (1.0 - np.sqrt(23.0 / 27.0))


def three_bodies() -> contin.Model:
    """The restricted problem, in the turning frame, near its triangular point (1/2 - m, sqrt(3)/2)."""
    first, second = "((x + m)^2 + y^2)^1.5", "((x - 1 + m)^2 + y^2)^1.5"
    return contin.Model(
        "triangle", states={"x": 0.49, "y": 0.866, "u": 0, "v": 0}, parameters={"m": 0.01},
        equations={
            "x": "u", "y": "v", "u": f"2*v + x - (1 - m)*(x + m)/{first} - m*(x - 1 + m)/{second}",
            "v": f"-2*u + y - (1 - m)*y/{first} - m*y/{second}",
        },
    )  # fmt: skip


def kicked() -> contin.Model:
    """Kicks of matrix [[.5, e], [-e, .7]]: angles with 2 - 2 cos w = its eigenvalues, which meet in .6 at e = .1."""
    return contin.Model(
        "kicked", kind="map", states=dict.fromkeys("qprs", 0.0), parameters={"e": 0.0},
        equations={
            "q": "q + p - 0.5*sin(q) - e*sin(r)", "p": "p - 0.5*sin(q) - e*sin(r)",
            "r": "r + s - 0.7*sin(r) + e*sin(q)", "s": "s - 0.7*sin(r) + e*sin(q)",
        },
    )  # fmt: skip


@pytest.mark.parametrize(
    ("model", "name", "bounds", "place", "where"),
    [
        (three_bodies(), "m", (0.01, 0.1), ROUTH, "+-0.707107 i"),  # w^2 = 1/2
        (kicked(), "e", (0.0, 1.0), 0.1, "exp(+-0.795399 i)"),
    ],
)
def test_two_pairs_that_meet_and_leave_the_boundary_are_told_as_such(model, name, bounds, place, where):
    branch = contin.continuation(contin.equilibrium(model), name, bounds)
    assert not branch.points
    value = branch.columns[name]
    assert np.array_equal(branch.columns["unstable"], np.where(value < place, 0, 2))
    note = next(n for n in branch.notes if "Hamiltonian Hopf" in n)
    assert where in note
    assert float(note.rsplit(" = ", 1)[1].split(" and ")[0]) == pytest.approx(place, rel=1e-5)
    assert not any("not verified" in n for n in branch.notes)


def test_a_centre_along_a_part_of_a_branch_is_told():
    """x'' = k - sin(x): a centre where cos(x) > 0, a saddle beyond the fold."""
    model = contin.Model(
        "pendulum", states={"x": 0.0, "v": 0.0}, parameters={"k": 0.0}, equations={"x": "v", "v": "k - sin(x)"}
    )
    branch = contin.continuation(contin.equilibrium(model, {"x": 0, "v": 0}), "k", (-0.9, 1.5))
    assert [p.type for p in branch.points] == ["LP"]
    assert any("stays on the imaginary axis along a part of the branch" in note for note in branch.notes)


@pytest.mark.parametrize("kind", ["flow", "map"])
def test_three_crossings_are_no_part_on_the_boundary(kind):
    """Three rows are on the boundary, the labelled ones; those between them are off it by up to 1e-6."""
    growth = "3*p*(p - 0.01)*(p + 0.01)"
    if kind == "map":
        a, b = f"(1 + {growth})*cos(1)", f"(1 + {growth})*sin(1)"
        equations = {"x": f"{a}*x - {b}*y - x*(x^2 + y^2)", "y": f"{b}*x + {a}*y - y*(x^2 + y^2)"}
    else:
        equations = {"x": f"{growth}*x - y - x*(x^2 + y^2)", "y": f"x + {growth}*y - y*(x^2 + y^2)"}
    states, parameters = dict.fromkeys("xy", 0.0), {"p": -0.53}
    model = contin.Model("three", kind=kind, states=states, parameters=parameters, equations=equations)
    branch = contin.continuation(contin.equilibrium(model), "p", (-0.53, 0.6))
    assert [point.type for point in branch.points] == ["HB" if kind == "flow" else "NS"] * 3
    assert branch.notes == ()
