"""Python functions with a mass matrix, M u' = F: the same system divided by M, reduced, or with known answers."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, splu

import contin
from contin.errors import InputError
from contin.linalg.copies import every
from contin.linalg.eigen import leading
from contin.linalg.factor import Factoriser
from contin.linalg.linear import DirectLinear
from contin.linalg.pencil import OnRange
from tests.loci.equilibria.planes import BOGDANOV_TAKENS, BOX, DOUBLE_HOPF, follow, zero_hopf
from tests.loci.sparse.test_loci import NEAR, as_large, brusselator, combustion

PLANES = [
    pytest.param(BOGDANOV_TAKENS, "BT", id="BT"),
    pytest.param(DOUBLE_HOPF, "HH", id="HH", marks=pytest.mark.long),
    pytest.param(zero_hopf(-1, 0.8), "ZH", id="ZH", marks=pytest.mark.long),
]
DECIDED = ("errors", "criticality", "kind", "case", "at")
FEW = {"max_step": 0.15}  # of the range: curves are compared by their labels
ABOUT = {BOGDANOV_TAKENS.field: {"stop_at": ("BT",), "max_step": 0.25}}  # from where its curves begin to their point


def weighed(function: contin.FunctionProblem, mass, **more) -> contin.FunctionProblem:
    """M u' = M F: the same flow."""
    matrix = sp.csc_matrix(mass)
    return contin.FunctionProblem(
        lambda u, p: matrix @ function.residual(u, p), function.u0, function.values,
        lambda u, p: sp.csc_matrix(matrix @ function.jacobian(u, p)), mass=mass, **more,
    )  # fmt: skip


def regular(n: int, seed: int = 2):
    return (sp.identity(n) + 0.4 * sp.random(n, n, 3.0 / n, random_state=seed)).tocsc()


def assert_alike(ours, theirs, digits: float = 1e-9) -> list[str]:
    """Labels, places, coefficients and eigenvalues next to the axis."""
    assert [p.type for p in ours.points] == [p.type for p in theirs.points]
    for a, b in zip(ours.points, theirs.points, strict=True):
        for name in ours.parameters:
            assert a.values[name] == pytest.approx(b.values[name], abs=digits, rel=digits)
        assert set(a.normal_form) == set(b.normal_form)
        for key, value in a.normal_form.items():
            if key not in DECIDED:
                ours_, theirs_ = np.abs(value), np.abs(b.normal_form[key])  # the sense of a vector is by its components
                np.testing.assert_allclose(ours_, theirs_, rtol=2e-5, atol=1e-6 * np.max(ours_) + 1e-7)
        assert [a.normal_form.get(key) for key in DECIDED[1:4]] == [b.normal_form.get(key) for key in DECIDED[1:4]]
    assert ours.columns["unstable"].max() == theirs.columns["unstable"].max()
    return [p.type for p in ours.points]


@pytest.mark.parametrize("m", [pytest.param(20, marks=pytest.mark.long), 31])  # all eigenvalues; Arnoldi's method
def test_a_regular_mass_matrix_changes_no_label_and_no_coefficient(m):
    plain = brusselator(m)
    lines = [contin.continuation(f, "B", (5.0, 5.3)) for f in (weighed(plain, regular(2 * m)), plain)]
    assert "HB" in assert_alike(*lines)


@pytest.mark.long  # every day: curves of folds with a singular one, to their BT point
def test_a_regular_mass_matrix_changes_no_curve_of_folds():
    plain, curves = combustion(70), []
    for f in (weighed(plain, regular(70)), plain):
        fold = contin.continuation(f, "lam", (0, 6), settings={"stop_at": ("LP",)})["LP1"]
        span, settings = {"lam": (2, 10), "e": (0, 0.4)}, {**FEW, "stop_at": ("CP",)}
        curves.append(contin.continuation(fold.locus(), ["lam", "e"], span, settings=settings))
    assert assert_alike(*curves) == ["CP"]


@pytest.mark.long  # singular ones below are followed every day
@pytest.mark.parametrize(("plane", "expected"), PLANES)
def test_a_regular_mass_matrix_changes_no_point_of_codimension_two(plane, expected):
    n = len(plane.field)
    skewed = np.eye(n) + 0.3 * np.random.default_rng(8).normal(size=(n, n))
    assert expected in same_in_the_plane(plane, lambda function: weighed(function, skewed))


def same_in_the_plane(plane, changed) -> list[str]:
    """The labels in one parameter and two, which a change of the function must not change."""
    plain, curves = without_mass(plane)
    heavy = contin.continuation(changed(plain.problem.system.model), "p", (plane.box or BOX)["p"])
    seen = assert_alike(heavy, plain)
    for point, curve in zip(heavy.points, curves, strict=True):
        seen += assert_alike(follow(point, box=NEAR, settings=ABOUT.get(plane.field, FEW)), curve)
    return seen


_without_mass = {}


def without_mass(plane):
    """The line of the plain function and the curves of its points, followed once for all mass matrices."""
    if plane.field not in _without_mass:
        plain, settings = as_large(plane), ABOUT.get(plane.field, FEW)
        _without_mass[plane.field] = plain, [follow(point, box=NEAR, settings=settings) for point in plain.points]
    return _without_mass[plane.field]


def with_algebraic(function: contin.FunctionProblem) -> contin.FunctionProblem:
    """Index 1: w = s + s^2 with s a sum of states, and terms with w that vanish there; the value alone is given."""
    n, mixed = function.n, np.random.default_rng(5).normal(size=(function.n + 1, function.n + 1))
    mixed += 3.0 * np.eye(n + 1)

    def residual(u, p):
        x, w = u[:-1], u[-1]
        s = np.sum(x) / n
        own = s + s * s
        return mixed @ np.append(function.residual(x, p) + 0.7 * (w * w - own * own), w - own)

    mass = mixed @ np.diag([*np.ones(n), 0.0])
    start = np.append(function.u0, np.mean(function.u0) + np.mean(function.u0) ** 2)
    return contin.FunctionProblem(residual, start, function.values, mass=mass)


def incompressible(function: contin.FunctionProblem, constraints: int = 2) -> contin.FunctionProblem:
    """Index 2: M v' = F(v) + G q, G^T v = 0, with v = Z x on the constraints, Z^T Z = 1, and x' = f(x) the given flow.

    F = M Z f(Z^T v) + G h(v) + what vanishes there: h is taken up by the pressures q, in reverse.
    """
    n, k = function.n, constraints
    random = np.random.default_rng(7)
    turn = np.linalg.qr(random.normal(size=(n + k, n + k)))[0]
    z, g = turn[:, :n], turn[:, n:] @ (np.eye(k) + 0.3 * random.normal(size=(k, k)))
    root = np.eye(n + k) + 0.2 * random.normal(size=(n + k, n + k)) / np.sqrt(n + k)
    m = root @ root.T
    along, away = m @ z, 2.0 * (m - m @ z @ z.T)

    def residual(u, p):
        v, q = u[: n + k], u[n + k :]
        forces = along @ function.residual(z.T @ v, p) - away @ v + g @ (q + v[:k] ** 2 - 0.3)
        return np.concatenate([forces, g.T @ v])

    def jacobian(u, p):
        v = u[: n + k]
        a = along @ (function.jacobian(z.T @ v, p) @ z.T) - away
        a[:, :k] += 2.0 * g * v[:k]
        return sp.csc_matrix(np.block([[a, g], [g.T, np.zeros((k, k))]]))

    v = z @ function.u0
    mass = np.zeros((n + 2 * k, n + 2 * k))
    mass[: n + k, : n + k] = m
    return contin.FunctionProblem(
        residual, np.concatenate([v, 0.3 - v[:k] ** 2]), function.values, jacobian, mass=sp.csc_matrix(mass)
    )


LONG = pytest.mark.long
INDEX_1 = pytest.param(with_algebraic, id="index 1")
INDEX_2 = pytest.param(incompressible, id="index 2")


@pytest.mark.parametrize(("plane", "expected"), PLANES)
@pytest.mark.parametrize("changed", [pytest.param(with_algebraic, id="index 1", marks=LONG), INDEX_2])
@pytest.mark.seldom
def test_singular_mass_matrices_have_the_points_of_the_reduced_flow(plane, expected, changed):
    assert expected in same_in_the_plane(plane, changed)


@pytest.mark.seldom
def test_an_incompressible_flow_of_many_unknowns_has_the_labels_of_the_reduced_one():
    plain = brusselator(30)
    lines = [contin.continuation(f, "B", (5.0, 5.3)) for f in (incompressible(plain, 10), plain)]
    assert "HB" in assert_alike(*lines)


def planted(n: int, k: int, seed: int):
    """(A, M, finite eigenvalues) of index 2: n velocities, k constraints, n - k given eigenvalues."""
    random = np.random.default_rng(seed)
    values = np.concatenate([-np.exp(random.uniform(-3, 3, n - k - 2)), [0.0, 0.0]])
    block = np.diag(values)
    block[-2:, -2:] = [[0.1, 1.7], [-1.7, 0.1]]
    turn = np.linalg.qr(random.normal(size=(n, n)))[0]
    z, g = turn[:, : n - k], turn[:, n - k :]
    root = np.eye(n) + 0.3 * random.normal(size=(n, n)) / np.sqrt(n)
    m = root @ root.T
    mix = np.eye(n - k) + 0.3 * random.normal(size=(n - k, n - k)) / np.sqrt(n)
    f = m @ z @ (mix @ block @ np.linalg.inv(mix)) @ z.T - m @ (np.eye(n) - z @ z.T)
    a = np.block([[f, g], [g.T, np.zeros((k, k))]])
    mass = np.zeros_like(a)
    mass[:n, :n] = m
    return a, mass, np.append(values[:-2], [0.1 + 1.7j, 0.1 - 1.7j])


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("n", "k"), [(12, 5), (40, 15), (160, 50)])
def test_planted_eigenvalues_of_index_two(n, k, seed):
    a, mass, values = planted(n, k, seed)
    if n + k <= 60:
        found = every(a, mass).values
        assert len(found) == len(values)
    else:
        linear = DirectLinear(sp.csc_matrix(a), Factoriser(), mass=sp.csc_matrix(mass))
        inverse = OnRange(linear)
        start = mass @ np.random.default_rng(1).normal(size=n + k)
        found = inverse.back(leading(inverse, n + k, start, 2.0)).values
        assert np.sum(np.abs(found) < 1.9) == np.sum(np.abs(values) < 1.9)
    for value in found[np.abs(found) < 2.0]:
        assert np.min(np.abs(values - value)) < (1e-9 if n + k <= 60 else 1e-3 * abs(value))


def test_a_pencil_of_index_three_has_its_finite_eigenvalues_only():
    """A pendulum's positions, velocities and tension about rest: of five unknowns two move."""
    a = np.zeros((5, 5))
    a[0, 2] = a[1, 3] = 1.0
    a[2, 0], a[3, 4], a[4, 1] = -9.81, 1.0, 1.0
    found = every(a, np.diag([1.0, 1, 1, 1, 0])).values
    np.testing.assert_allclose(sorted(found.imag), [-np.sqrt(9.81), np.sqrt(9.81)], rtol=1e-12)
    np.testing.assert_allclose(found.real, 0.0, atol=1e-9)


def test_a_mass_matrix_that_cannot_be_one_is_refused_in_words():
    def made(mass, **more):
        return contin.FunctionProblem(lambda u, p: p["a"] - u, [0.0, 0.0], {"a": 0.0}, mass=mass, **more)

    with pytest.raises(InputError, match=r"shape \(2, 2\)"):
        made(np.ones(3))
    with pytest.raises(InputError, match="nothing moves"):
        made(np.zeros(2))
    with pytest.raises(InputError, match="finite"):
        made([np.nan, 1.0])
    with pytest.raises(InputError, match="changes with"):
        made(lambda u: u)
    with pytest.raises(InputError, match="flows"):
        made(np.ones(2), kind="map")
    with pytest.raises(InputError, match="equation 1 is algebraic"):
        contin.simulate(made([1.0, 0.0]), time=1.0)


def bratu_by(elements: bool, n: int) -> contin.FunctionProblem:
    """u'' + p exp(u) = 0 by linear finite elements (the nonlinear term interpolated), or by differences."""
    h = 1.0 / (n + 1)
    line = sp.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(n, n), format="csc") / h
    mass = sp.diags([1.0, 4.0, 1.0], [-1, 0, 1], shape=(n, n), format="csc") * h / 6.0
    mass = mass if elements else sp.identity(n, format="csc") * h
    return contin.FunctionProblem(
        lambda u, p: line @ u + p["p"] * (mass @ np.exp(u)), np.zeros(n), {"p": 0.0},
        lambda u, p: (line + p["p"] * mass @ sp.diags(np.exp(u))).tocsc(), mass=mass,
    )  # fmt: skip


@pytest.mark.parametrize(
    "elements", [pytest.param(True, id="elements"), pytest.param(False, id="differences", marks=LONG)]
)
def test_folds_and_eigenvalues_of_linear_elements_converge_with_second_order(elements):
    exact, off, rates = 3.513830719125162, [], []
    for n in (15, 31, 63):
        line = contin.continuation(bratu_by(elements, n), "p", (0, 4), settings={"stop_at": ("LP",)})
        off.append(line["LP1"].values["p"] - exact)
        rates.append(float(np.nanmax(line.eigenvalues[0].real)) + np.pi**2)
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.03)
    assert off[1] / off[2] == pytest.approx(4.0, rel=0.01)
    assert rates[0] / rates[1] == pytest.approx(4.0, rel=0.05)
    assert (rates[2] < 0.0) == elements  # elements overestimate the rate of decay, differences underestimate it


@pytest.mark.parametrize("changed", [pytest.param(with_algebraic, id="index 1", marks=LONG), INDEX_2])
@pytest.mark.seldom
def test_orbits_with_a_singular_mass_matrix_are_those_of_the_reduced_flow(changed):
    """Stuart and Landau: r^2 = mu, period 2 pi / (1 + b mu), one multiplier exp(-2 mu T)."""

    def residual(u, p):
        x, y = u
        square = x * x + y * y
        turn = 1.0 + 0.3 * square
        return np.array([p["mu"] * x - turn * y - x * square, turn * x + p["mu"] * y - y * square])

    def jacobian(u, p):
        x, y = u
        return np.array(
            [
                [p["mu"] - 0.6 * x * y - 3 * x * x - y * y, -1.0 - 0.3 * x * x - 0.9 * y * y - 2 * x * y],
                [1.0 + 0.9 * x * x + 0.3 * y * y - 2 * x * y, p["mu"] + 0.6 * x * y - x * x - 3 * y * y],
            ]
        )

    flow = contin.FunctionProblem(residual, np.zeros(2), {"mu": -0.2}, jacobian, states=["x", "y"])
    rest = contin.continuation(changed(flow), "mu", (-0.2, 0.1))
    assert rest["HB1"].normal_form["l1"] == pytest.approx(-2.0, abs=1e-7)
    family = contin.continuation(rest["HB1"].switch(), "mu", (-0.2, 0.5), settings={"steps": 12})
    mu, period = family.columns["mu"], family.columns["period"]
    assert len(family) > 8
    np.testing.assert_allclose(period, 2.0 * np.pi / (1.0 + 0.3 * mu), rtol=1e-6)
    others = [min(row[np.isfinite(row)], key=lambda value: abs(value - np.exp(-2 * m * t))) for row, m, t in
              zip(family.eigenvalues[1:], mu[1:], period[1:], strict=True)]  # fmt: skip
    np.testing.assert_allclose(np.real(others), np.exp(-2 * mu[1:] * period[1:]), rtol=1e-4)


def test_trajectories_of_index_one_are_those_of_the_reduced_flow():
    """x' = -w, 0 = w + w^3 - x: t = log(w0/w) + 3 (w0^2 - w^2)/2; the given w is none and is replaced."""

    def residual(u, p):
        return np.array([-p["k"] * u[1], u[1] + u[1] ** 3 - u[0]])

    model = contin.FunctionProblem(residual, [2.0, 0.3], {"k": 1.0}, mass=[1.0, 0.0])
    for rtol in (1e-5, 1e-8):
        run = contin.simulate(model, time=4.0, method="Radau", samples=30, rtol=rtol)
        w = run.states[:, 1]
        np.testing.assert_allclose(np.log(1.0 / w) + 1.5 * (1.0 - w * w), run.t, atol=30.0 * rtol)
        assert run.steps < (40 if rtol == 1e-5 else 150)
    with pytest.raises(InputError, match="index is above 1"):
        contin.simulate(incompressible(brusselator(3), 1), time=1.0, method="Radau")


def test_a_pressure_that_is_determined_up_to_a_constant_is_told():
    """Three velocities in a ring of cells with pressures, whose sum of gradients vanishes."""
    g = np.array([[1.0, -1, 0], [0, 1, -1], [-1, 0, 1]])

    def residual(u, p):
        v, q = u[:3], u[3:]
        return np.concatenate([p["f"] - v + g @ q, g.T @ v])

    model = contin.FunctionProblem(residual, np.zeros(6), {"f": 1.0}, mass=[1.0, 1, 1, 0, 0, 0])
    with pytest.raises(InputError, match=r"M q = 0.*Fix one value"):
        contin.equilibrium(model)


def test_products_and_a_preconditioner_do_beside_a_mass_matrix():
    plain, mass = brusselator(31), regular(62)

    def matrix(u, p):
        return sp.csc_matrix(mass @ plain.jacobian(u, p))

    def products(u, p):
        made = matrix(u, p)
        return LinearOperator(made.shape, matvec=lambda v: made @ v, dtype=float)

    free = contin.FunctionProblem(
        lambda u, p: mass @ plain.residual(u, p), plain.u0, plain.values, products, mass=mass,
        preconditioner=lambda u, p: splu(matrix(u, p)).solve,
    )  # fmt: skip
    assert free.method == "matrix-free"
    lines = [contin.continuation(f, "B", (5.0, 5.3)) for f in (free, plain)]
    assert assert_alike(*lines) == ["HB"]


def test_an_unstable_pair_behind_many_slow_states_is_found_and_what_is_not_known_is_told():
    """An oscillation of frequency 9 beside 70 real eigenvalues -0.1 k, with an algebraic state between them."""
    n, rates = 70, -0.1 * np.arange(1.0, 71.0)

    def residual(u, p):
        x, y, w, rest = u[0], u[1], u[2], u[3:]
        turning = [p["mu"] * x - 9.0 * y - x * w, 9.0 * x + p["mu"] * y - y * w, w - x * x - y * y + x / 3.0]
        return np.concatenate([turning, rates * rest])

    pattern = sp.block_diag([np.ones((3, 3)), sp.identity(n)], format="csc")
    mass = np.ones(n + 3)
    mass[2] = 0.0
    model = contin.FunctionProblem(residual, np.zeros(n + 3), {"mu": -0.5}, sparsity=pattern, mass=mass)
    line = contin.continuation(model, "mu", (-0.5, 0.5))
    assert any("no region is known" in note for note in line.notes)
    fast = contin.FunctionProblem(
        lambda u, p: residual(u, p) * np.append([0.1, 0.1, 1.0], np.ones(n)), np.zeros(n + 3), {"mu": -0.5},
        sparsity=pattern, mass=mass,
    )  # fmt: skip
    slow = contin.continuation(fast, "mu", (-0.5, 0.5))
    assert [p.type for p in slow.points] == ["HB"]  # of frequency 0.9, behind eight real ones
    assert slow["HB1"].normal_form["omega"] == pytest.approx(0.9, abs=1e-9)


@pytest.mark.parametrize("changed", [INDEX_1, pytest.param(incompressible, id="index 2", marks=LONG)])
@pytest.mark.seldom
def test_a_generalised_hopf_point_has_the_second_coefficient_of_the_reduced_flow(changed):
    """z' = (mu + i) z + z (b |z|^2 - |z|^4), with |q| = 1 over x and y: l1 = 2 b, l2 = -4."""

    def residual(u, p):
        x, y = u
        pull = p["b"] * (x * x + y * y) - (x * x + y * y) ** 2
        return np.array([p["mu"] * x - y + x * pull, x + p["mu"] * y + y * pull])

    def jacobian(u, p):
        return np.column_stack([np.imag(residual(u + 1e-30j * e, p)) / 1e-30 for e in np.eye(2)])

    flow = contin.FunctionProblem(residual, np.zeros(2), {"mu": -0.1, "b": 1.0}, jacobian)
    line = contin.continuation(changed(flow), "mu", (-1, 1))
    assert line["HB1"].normal_form["l1"] == pytest.approx(2.0, abs=1e-7)
    span = {"mu": (-1, 1), "b": (-0.3, 1.05)}
    curve = contin.continuation(line["HB1"].locus(["mu", "b"]), ["mu", "b"], span, settings={"stop_at": ("GH",)})
    assert [p.type for p in curve.points] == ["GH"]
    assert curve["GH1"].values["b"] == pytest.approx(0.0, abs=1e-9)
    assert curve["GH1"].normal_form["l2"] == pytest.approx(-4.0, abs=1e-7)


def test_heat_in_finite_elements_decays_at_the_rates_of_the_pencil():
    n, modes = 60, (1, 3)
    model = bratu_by(True, n)
    h, x = 1.0 / (n + 1), np.arange(1, n + 1) / (n + 1)
    start = sum(np.sin(k * np.pi * x) for k in modes)
    run = contin.simulate(model, start, {"p": 0.0}, time=0.2, method="Radau", samples=9, rtol=1e-9)
    cosines = np.cos(np.pi * h * np.array(modes))
    rates = -6.0 * (1.0 - cosines) / (h * h * (2.0 + cosines))
    exact = sum(np.exp(rate * run.t)[:, None] * np.sin(k * np.pi * x) for k, rate in zip(modes, rates, strict=True))
    np.testing.assert_allclose(run.states, exact, atol=1e-7)
