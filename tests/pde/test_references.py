"""Classical problems with known folds, bifurcations and solutions, from their equations to the label."""

import numpy as np
import pytest
from scipy.optimize import brentq

import contin


def model(equation, *, boundary="u = 0", lam=0.0, **axis):
    domain = axis.pop("domain", {"x": {"points": 16, "method": "chebyshev", **axis}})
    return contin.load({
        "name": "case", "kind": "pde", "domain": domain, "fields": {"u": 0}, "parameters": {"lam": lam},
        "equations": {"u": equation}, **({"boundary": {"all": boundary}} if boundary else {}),
    })  # fmt: skip


def fold(problem, upper):
    to_fold = {"steps": 40, "stop_at": ("LP",)}
    return contin.continuation(problem, "lam", (0, upper), direction="up", settings=to_fold)["LP1"]


def test_bratu_fold_on_an_interval():
    s = brentq(lambda s: s * np.tanh(s) - 1.0, 1.0, 2.0)
    exact = 8.0 * (s / np.cosh(s)) ** 2  # 3.513830719
    assert fold(model("dxx(u) + lam*exp(u)"), 4).values["lam"] == pytest.approx(exact, abs=1e-8)
    errors = []
    for points in (21, 41):
        found = fold(model("dxx(u) + lam*exp(u)", points=points, method="differences"), 4)
        errors.append(found.values["lam"] - exact)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


def test_a_parameter_in_a_condition_for_a_slope_moves_eigenvalues_as_a_number_does():
    # u'' + lam u = 0, u(0) = 0, u'(1) = -k u(1): s cos s + k sin s = 0, lam = s^2
    boundary = {"x.start": "u = 0", "x.end": "dn(u) = -k*u"}
    given = {"domain": {"x": {"points": 20, "method": "chebyshev"}}, "fields": {"u": 0}, "kind": "pde", "name": "case"}
    for k in (0.5, 3.0):
        s = brentq(lambda s, k=k: s * np.cos(s) + k * np.sin(s), np.pi / 2, np.pi)
        forms = []
        for right in ("-k*u", f"-{k}*u"):
            problem = contin.load({
                **given, "parameters": {"lam": 1.0, "k": k}, "equations": {"u": "dxx(u) + lam*(u - u^3)"},
                "boundary": {**boundary, "x.end": f"dn(u) = {right}"},
            })  # fmt: skip
            line = contin.continuation(contin.equilibrium(problem), "lam", (0.5, 20))
            assert [p.label for p in line.points] == ["BP1"]
            assert line["BP1"].values["lam"] == pytest.approx(s * s, abs=1e-11)
            assert line.columns["unstable"][[0, -1]].tolist() == [0, 1]
            forms.append(line["BP1"].normal_form["b30"])
        assert forms[0] == pytest.approx(forms[1], rel=1e-9)  # <p, M q> = 1, |q| = 1 over the states with mass


def test_a_nonlinear_slope_on_a_chebyshev_axis_is_the_limit_of_that_by_differences():
    def at(points, method):
        domain = {"x": {"points": points, "method": method}}
        return fold(model("dxx(u) + lam*exp(u)", boundary="dn(u) = -2*((1 + u)^4 - 1)", domain=domain), 5).values["lam"]

    fine = at(24, "chebyshev")
    assert at(18, "chebyshev") == pytest.approx(fine, abs=1e-8)
    assert np.log2((at(51, "differences") - fine) / (at(101, "differences") - fine)) == pytest.approx(2.0, abs=0.05)


def test_orbits_with_a_parameter_in_a_condition_return():
    problem = contin.load({
        "name": "case", "kind": "pde", "domain": {"x": {"points": 10, "method": "chebyshev"}},
        "fields": {"X": "A", "Y": "B/A"}, "parameters": {"B": 3, "A": 2, "D": 0.02, "k": 1},
        "equations": {"X": "D*dxx(X) + A - (B + 1)*X + X^2*Y", "Y": "2*D*dxx(Y) + B*X - X^2*Y"},
        "boundary": {"all": ["dn(X) = -k*(X - A)", "dn(Y) = -k*(Y - B/A)*X"]},
    })  # fmt: skip
    line = contin.continuation(contin.equilibrium(problem), "B", (3, 6), settings={"stop_at": ("HB",)})
    family = contin.continuation(line["HB1"].switch(), "B", (3, 6), settings={"steps": 2})
    assert family.columns["period"][0] == pytest.approx(2 * np.pi / line["HB1"].normal_form["omega"], rel=1e-9)
    assert np.ptp(family.columns["X.max.max"]) > 0.01
    assert not family.columns["unstable"].any()


@pytest.mark.parametrize(
    ("equation", "told"), [("lam*u + dxx(u) - u^3", True), ("lam*u*cos(x)^2 + dxx(u) - u^3", False)]
)
def test_branches_that_translations_move_are_told_what_follows_them(equation, told):
    domain = {"x": {"to": "2*pi", "points": 16, "method": "fourier"}}
    problem = model(equation, boundary=None, domain=domain, lam=0.5)
    problem = contin.equilibrium(problem, start={"u": "0*x"})
    text = problem.system.model.advice(np.cos(np.arange(16)))
    assert ("travelling: {axis: x" in text) is told
    assert problem.system.model.advice(np.ones(16)) == ""


def test_newtons_method_that_runs_into_zero_ends_there():
    # u'' - u - u^3: from u = .8 cos x corrections fall with the third power down to the smallest numbers
    domain = {"x": {"to": "2*pi", "points": 16, "method": "fourier"}}
    problem = model("dxx(u) - lam*u - u^3", boundary=None, domain=domain, lam=1.0)
    found = contin.equilibrium(problem, {"u": "0.8*cos(x)"})
    assert not found.u.any()


@pytest.mark.seldom
def test_bratu_fold_on_a_square():
    axis = {"points": 14, "method": "chebyshev"}
    found = fold(model("lap(u) + lam*exp(u)", domain={"x": axis, "y": axis}), 8)
    assert found.values["lam"] == pytest.approx(6.808124423, abs=1e-6)  # literature, e.g. Mohsen 2014
    axis = {"points": 21}
    found = fold(model("lap(u) + lam*exp(u)", domain={"x": axis, "y": axis}), 8)
    assert found.values["lam"] == pytest.approx(6.808124423, abs=0.02)


def test_chafee_infante_bifurcations_at_the_squares():
    problem = model("dxx(u) + lam*(u - u^3)", to=np.pi, points=24)
    line = contin.continuation(contin.equilibrium(problem, parameters={"lam": 0.5}), "lam", (0.5, 20))
    points = [p for p in line.points if p.type == "BP"]
    np.testing.assert_allclose([p.values["lam"] for p in points], [1, 4, 9, 16], atol=1e-8)
    assert {p.normal_form["kind"] for p in points} == {"pitchfork"}
    fork = contin.continuation(points[1].switch(), "lam", (0.5, 9), settings={"steps": 25})
    assert np.abs(fork.columns["u.max"] + fork.columns["u.min"]).max() < 1e-8  # mode sin(2x) is odd about the middle


TOP = 0.6  # one or two points below


@pytest.mark.parametrize(
    ("circumference", "points"), [*(pytest.param(2, n, marks=pytest.mark.long) for n in (32, 64)), (4, 64), (6, 32)]
)
@pytest.mark.seldom
def test_branch_points_of_swift_hohenberg_on_a_circle_lie_within_their_errors(circumference, points):
    # r = (1 - k^2)^2 with k = 2 j/circumference: zero eigenvalues of a matrix of rounded entries up to (points/2)^4
    domain = {"x": {"to": f"{circumference}*pi", "points": points, "periodic": True, "method": "fourier"}}
    problem = model("(lam - 1)*u - 2*dxx(u) - dxxxx(u) + u^2 - u^3", boundary=None, domain=domain)
    line = contin.continuation(contin.equilibrium(problem, parameters={"lam": -0.3}), "lam", (-0.31, TOP))
    k2 = np.square(2.0 * np.arange(points // 2) / circumference)
    exact = np.unique(np.round(np.square(1.0 - k2), 12))
    found = np.array([p.values["lam"] for p in line.points])
    np.testing.assert_allclose(found, exact[exact < TOP], atol=1e-9)
    for point in line.points:
        off = np.abs(np.square(1.0 - k2) - point.values["lam"]).min()
        assert off <= point.error < 1e4 * 2.2e-16 * (points / circumference) ** 4


@pytest.mark.parametrize(("method", "sizes"), [("differences", (81, 161)), ("chebyshev", (40, 41))])
def test_front_of_fishers_equation(method, sizes):
    # Ablowitz and Zeppetella (1979): u = (1 + exp(x/sqrt 6))^-2 moves with speed c = 5/sqrt 6
    exact = "(1 + exp(x/sqrt(6)))^(-2)"
    errors = []
    for points in sizes:
        problem = model(
            "dxx(u) + lam*dx(u) + u*(1 - u)", boundary=f"u = {exact}", lam="5/sqrt(6)", points=points, method=method,
            **{"from": -10, "to": 10},
        )  # fmt: skip
        u, p = contin.equilibrium(problem, {"u": f"{exact} + 0.01*sin(pi*x/10)"}).u, dict(problem.values)
        fields = problem.profile(u, p)
        errors.append(np.abs(fields["u"] - (1 + np.exp(fields["x"] / np.sqrt(6))) ** -2.0).max())
    if method == "differences":
        assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    else:
        assert max(errors) < 1e-8


def test_slopes_as_functions_of_the_field():
    # u'' = 0, u(0) = 0, u'(1) = lam exp(-u): u = s x with s = lam exp(-s), exact on a mesh of differences too
    problem = contin.load({
        "name": "source", "kind": "pde", "domain": {"x": {"points": 9}}, "fields": {"u": 0}, "parameters": {"lam": 0},
        "equations": {"u": "dxx(u)"}, "boundary": {"x.start": "u = 0", "x.end": "dx(u) = lam*exp(-u)"},
    })  # fmt: skip
    line = contin.continuation(problem, "lam", (0, 2), settings={"steps": 30})
    s = line.columns["u.max"]
    np.testing.assert_allclose(s, line.columns["lam"] * np.exp(-s), atol=1e-9)
