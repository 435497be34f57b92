"""Coefficients of bifurcations of large orbits against closed forms and the collocation of small systems."""

import numpy as np
import pytest
from scipy import sparse

import contin


def function(residual, states, parameters, **options):
    full = sparse.csc_matrix(np.ones((states, states)))
    return contin.FunctionProblem(residual, np.zeros(states), parameters, sparsity=full, **options)


def family(problem, span, **settings):
    line = contin.continuation(problem, "mu", (-0.6, 0.2))
    hopf = next(p for p in line.points if p.type == "HB" and abs(p.values["mu"]) < 1e-6)
    return contin.continuation(hopf.switch(), "mu", span, settings={"intervals": 10, "step": 0.05, **settings})


def known(point, name):
    """A coefficient, which has an error and no remark."""
    return np.array(point.normal_form[name]), point.normal_form["errors"][name]


def turning(shear, real=False):
    """r' = r (mu + r^2 - r^4), angle' = 1 + shear r^2; and a state that follows. `real`: refuses complex numbers."""

    def residual(z, p):
        x, y, s = (float(each) for each in z) if real else z.tolist()
        r2 = x * x + y * y
        growth, speed = p["mu"] + r2 - r2 * r2, 1.0 + shear * r2
        return np.array([growth * x - speed * y, growth * y + speed * x, -2.0 * s + x * s + x * y * y])

    return residual


MASS = np.array([[2.0, 0.3, 0.0], [0.1, 1.0, 0.2], [0.0, 0.4, 3.0]])


@pytest.mark.parametrize(
    ("residual", "options", "settings"),
    [
        (turning(0.5), {}, {}),
        (turning(0.5, real=True), {}, {}),
        (lambda z, p: MASS @ turning(0.5)(z, p), {"mass": MASS}, {}),
        (turning(0.5), {}, {"method": "shooting", "intervals": 3}),
    ],
    ids=["complex steps", "differences", "mass", "shooting"],
)
@pytest.mark.seldom
def test_b_of_a_fold_of_cycles_whose_period_changes(residual, options, settings):
    """r moves by -w xi / (2 shear r) where the phase falls behind by xi: b = w / shear, w = 1 + shear/2."""
    settings = {"stop_at": ("LPC",), "max_step": 0.25, **settings}
    found = family(function(residual, 3, {"mu": -0.5}, **options), (-0.4, 0.1), **settings)
    value, error = known(found["LPC1"], "b")
    assert abs(value - 2.5) < error < 1e-4
    assert abs(found["LPC1"].values["mu"] + 0.25) < found["LPC1"].error < 1e-4  # where 2 r^2 = 1


def test_b_of_a_fold_of_cycles_whose_period_does_not_change():
    """r'' = 2 r (1 - ..): b = -sqrt(2) for v of radial length 1, its sign that of v."""

    def residual(z, p):
        x, y = z.tolist()
        growth = p["mu"] + x * x + y * y - (x * x + y * y) ** 2
        return np.array([growth * x - y, growth * y + x])

    found = family(function(residual, 2, {"mu": -0.5}), (-0.4, 0.1), stop_at=("LPC",))
    value, error = known(found["LPC1"], "b")
    assert abs(abs(value) - np.sqrt(2.0)) < error < 1e-5


K, M, TURNS, GAIN = 0.3, 0.7, 0.4, 0.25


def doubling_and_torus(z, p):
    """A plane that turns by half an angle, w' = (r - 1/2) p - K p^3 along p, and V' = (mu - 0.3 + 0.4 i) V
    - (K + i TURNS) |V|^2 V + GAIN (r^2 - mu) V; r^2 = mu + M (|w|^2 + |V|^2) and the angle's speed depends on |V|^2."""
    x, y, w1, w2, v1, v2 = z.tolist()
    mu, r2, w, v = p["mu"], x * x + y * y, w1 * w1 + w2 * w2, v1 * v1 + v2 * v2
    growth, speed = mu - r2 + M * (w + v), 1.0 + 0.2 * v
    gain = mu - 0.3 + GAIN * (r2 - mu) - K * v
    turn = 0.4 - TURNS * v
    return np.array([
        growth * x - speed * y, growth * y + speed * x,
        (x - 0.5 - K * w) * w1 + (y - 0.5) * w2, (y + 0.5) * w1 - (x + 0.5 + K * w) * w2,
        gain * v1 - turn * v2, gain * v2 + turn * v1,
    ])  # fmt: skip


@pytest.mark.seldom
def test_c_of_a_period_doubling_and_d_of_a_torus_bifurcation():
    """c = -K + M/(2 r), r = 1/2; V = sqrt(2) xi: d = -2 (K + i TURNS) + 2 GAIN M."""
    found = family(function(doubling_and_torus, 6, {"mu": -0.5}), (-0.1, 0.35))
    c, error = known(found["PD1"], "c")
    assert abs(c - (M - K)) < error < 5e-4
    assert found["PD1"].normal_form["criticality"] == "subcritical"
    d, error = known(found["NS1"], "d")
    assert abs(complex(*d) - (2.0 * GAIN * M - 2.0 * K - 2.0j * TURNS)) < error < 5e-4
    assert found["NS1"].normal_form["criticality"] == "supercritical"
    assert found["NS1"].normal_form["theta"] == pytest.approx(0.8 * np.pi, abs=1e-4)


@pytest.mark.long  # every day: c in closed form, above
def test_the_doubling_of_roesslers_cycle_in_turned_coordinates_is_that_of_the_small_collocation():
    turned = np.linalg.qr(np.random.default_rng(1).normal(size=(4, 4)))[0]

    def residual(z, p):
        x, y, s, *others = (turned.T @ z).tolist()
        return turned @ [
            -y - s,
            x + p["a"] * y,
            2 + s * (x - 4),
            *(-k * w + 0.1 * x * w for k, w in enumerate(others, 1)),
        ]

    a = 0.1
    s = (4 - np.sqrt(16 - 8 * a)) / (2 * a)
    start = turned @ [a * s, -s, s, 0.0]
    large = contin.FunctionProblem(residual, start, {"a": a}, sparsity=sparse.csc_matrix(np.ones((4, 4))))
    model = contin.load("classics/roessler")
    points = []
    for problem in (large, contin.equilibrium(model, start="inner", parameters={"a": a})):
        line = contin.continuation(problem, "a", (0.1, 0.15))
        settings = {"stop_at": ("PD",), "intervals": 20}
        points.append(contin.continuation(line["HB1"].switch(), "a", (0.1, 0.4), settings=settings)["PD1"])
    (large_c, error), (c, other) = (known(point, "c") for point in points)
    assert abs(large_c - c) < error + other < 1e-5
    assert points[0].normal_form["criticality"] == points[1].normal_form["criticality"] == "supercritical"


PARTING = {"e": 1.0, "d": 1.0}


def parting(z, p):
    """s leaves a circle that it moves, r^2 = mu + d s: s' = (mu - 0.4) s - e s^2 - s^3."""
    x, y, s = z.tolist()
    growth = p["mu"] + p["d"] * s - x * x - y * y
    return np.array([growth * x - y, growth * y + x, (p["mu"] - 0.4) * s - p["e"] * s * s - s**3])


@pytest.mark.parametrize("e", [1.0, pytest.param(1e-3, marks=pytest.mark.long), 0.0])
@pytest.mark.seldom
def test_kind_and_slope_of_a_branch_point_of_cycles(e):
    """The families part by s (d/(2 r), 1), mu - 0.4 = e s."""
    slope = e / np.sqrt(1.0 + PARTING["d"] ** 2 / (4.0 * 0.4))
    problem = function(parting, 3, {"mu": -0.5, **PARTING, "e": e})
    found = family(problem, (-0.1, 0.45), stop_at=("BPC",))
    form = found["BPC1"].normal_form
    assert form["kind"] == ("transcritical" if e else "pitchfork")
    assert abs(form["slope"] - slope) < form["errors"]["slope"] < 1e-5


def test_the_slope_of_a_branch_point_of_small_cycles_does_not_depend_on_how_the_own_family_moves():
    equations = {
        "x": "(mu + d*s - x^2 - y^2)*x - y",
        "y": "(mu + d*s - x^2 - y^2)*y + x",
        "s": "(mu - 0.4)*s - s^2 - s^3",
    }
    model = contin.load({
        "contin": 1, "name": "parting", "states": dict.fromkeys("xys", 0), "parameters": {"mu": -0.5, "d": 1.0},
        "equations": equations,
    })  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "mu", (-0.6, 0.2))
    form = contin.continuation(line["HB1"].switch(), "mu", (-0.1, 0.45))["BPC1"].normal_form
    assert form["kind"] == "transcritical"
    assert abs(form["slope"] - 1.0 / np.sqrt(1.0 + 1.0 / 1.6)) < form["errors"]["slope"] < 1e-4
