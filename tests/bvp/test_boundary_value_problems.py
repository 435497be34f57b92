"""Branches of boundary-value problems against closed forms, by their own stated errors."""

import numpy as np
import pytest

import contin
from contin.bvp.from_guess import boundary_guess
from contin.errors import InputError, NoSolutionError
from contin.linalg.balanced import Balanced
from contin.machine import elementary
from contin.model.model import Model

BRATU = {
    "kind": "bvp", "time": {"name": "x"}, "states": {"u": 0, "v": 0},
    "parameters": {"lam": {"value": 0, "range": [0, 4]}}, "equations": {"u": "v", "v": "-lam*exp(u)"},
    "conditions": ["u(start) = 0", "u(end) = 0"],
    "observables": {"height": "max(u)", "action": "integral(v^2/2 - lam*exp(u))", "slope": "v(start)"},
}  # fmt: skip
SINE = {
    "kind": "bvp", "states": {"u": 0, "v": 0}, "parameters": {"q": {"value": 0.5, "range": [0.5, 3.5]}},
    "equations": {"u": "v", "v": "-(q*pi)^2*u + u^3"}, "conditions": ["u(start) = 0", "u(end) = 0"],
}  # fmt: skip


def follow(parts, parameter, bounds, free=(), start=None, **options):
    model = Model("m", **parts)
    return contin.continuation(boundary_guess(model, start, None, free), parameter, bounds, **options)


def bratu_fold():
    """lam = 8 c^2 / cosh^2 c, largest where c tanh c = 1 (the unit interval; u = 2 log(cosh c / cosh(c (2 x - 1))))."""
    c = 1.2
    for _ in range(50):
        t = float(elementary.tanh(c))
        c -= (c * t - 1.0) / (t + c * (1.0 - t * t))
    return 8.0 * c**2 / float(elementary.cosh(c)) ** 2, 2.0 * float(elementary.log(elementary.cosh(c)))


@pytest.mark.seldom
def test_the_fold_of_bratus_problem():
    line = follow(BRATU, "lam", (0, 4), direction="up", values={"height": [2.0]})
    lam, height = bratu_fold()
    fold = line["LP1"]
    assert [p.type for p in line.points] == ["LP", "UZ"]
    assert abs(fold.values["lam"] - lam) <= fold.error < 1e-8
    assert fold.values["height"] == pytest.approx(height, abs=1e-7)
    assert "stable" not in line.columns
    assert line.ends[1].reason == "bound"
    assert "lam stays at" in line.ends[1].text


def test_columns_are_those_of_the_closed_form():
    line = follow(BRATU, "lam", (0, 4), direction="up", settings={"steps": 12})
    for row in range(len(line)):
        lam, height = line.columns["lam"][row], line.columns["height"][row]
        c = np.arccosh(np.exp(height / 2.0))
        assert lam == pytest.approx(8.0 * c**2 / np.cosh(c) ** 2, abs=1e-9)
        assert line.columns["v.start"][row] == pytest.approx(4.0 * c * np.tanh(c), abs=1e-8)
        assert line.columns["v.end"][row] == pytest.approx(-4.0 * c * np.tanh(c), abs=1e-8)
        x = np.linspace(0.0, 1.0, 2001)
        u = 2.0 * np.log(np.cosh(c) / np.cosh(c * (2.0 * x - 1.0)))
        assert line.columns["u.norm"][row] == pytest.approx(np.sqrt(np.trapezoid(u * u, x)), abs=1e-6)
        v = -4.0 * c * np.tanh(c * (2.0 * x - 1.0))
        action = np.trapezoid(v * v / 2.0 - lam * np.exp(u), x)
        assert line.columns["action"][row] == pytest.approx(action, abs=1e-5)


def test_eigenvalues_are_branch_points_and_their_branches_are_elliptic_functions():
    """u'' = -(q pi)^2 u + u^3: born at q = 1, with the amplitude a: q = 1 + 3 (a/pi)^2/8 + O(a^4)."""
    line = follow(SINE, "q", (0.5, 3.5), direction="up")
    points = [p for p in line.points if p.type == "BP"]
    assert [p.type for p in line.points] == ["BP"] * 3
    for n, point in enumerate(points, 1):
        assert abs(point.values["q"] - n) <= point.error < 1e-7
        assert point.normal_form["kind"] == "pitchfork"
    fork = contin.continuation(points[0].switch(), "q", (0.5, 1.05))
    small = np.abs(fork.columns["u.max"] - fork.columns["u.min"]) < 0.2
    a = (fork.columns["u.max"] - fork.columns["u.min"])[small]
    assert fork.columns["q"][small] == pytest.approx(1.0 + 0.375 * (a / np.pi) ** 2, abs=1e-6)


@pytest.mark.seldom
def test_the_mesh_of_a_trivial_solution_serves_the_functions_that_branch_off():
    """sin(n pi x) up to n = 12: on the ten intervals that u = 0 asks for, the twelfth was 7e-5 off."""
    line = follow(SINE, "q", (0.5, 12.5), direction="up")
    assert [p.type for p in line.points] == ["BP"] * 12
    for n, point in enumerate(line.points, 1):
        assert abs(point.values["q"] - n) <= point.error < 1e-9


def test_an_integral_condition_frees_a_parameter():
    """u'' = -lam, u(0) = u'(1) = 0: integral(u) = lam/3."""
    parts = {
        "kind": "bvp", "states": {"u": 0, "v": 0}, "parameters": {"lam": 0, "s": 0},
        "equations": {"u": "v", "v": "-lam"}, "conditions": ["u(start) = 0", "v(end) = 0", "integral(u) = s"],
    }  # fmt: skip
    line = follow(parts, "s", (0, 1), free=["lam"], extrema=["lam"])
    assert line.columns["lam"] == pytest.approx(3.0 * line.columns["s"], abs=1e-10)
    with pytest.raises(InputError, match=r"3 conditions for 2 states, so 1 parameter must be solved for"):
        follow(parts, "s", (0, 1))
    with pytest.raises(InputError, match="is solved for"):
        follow(parts, "lam", (0, 1), free=["lam"])


@pytest.mark.parametrize(("kind", "power"), [("mean", 1), ("norm", 1), ("integral", 2)])
def test_the_interval_may_depend_on_parameters(kind, power):
    """u' = -u on [1, 1 + L], u(start) = 1: mean, norm, and integral of the square in closed form."""
    inner = "u^2" if power == 2 else "u"
    parts = {
        "kind": "bvp", "time": {"name": "y", "from": 1, "to": "1 + L"}, "states": {"u": 1},
        "parameters": {"L": {"value": 1, "range": [0.5, 2]}}, "equations": {"u": "-u*y/y"},
        "conditions": ["u(start) = 1"], "observables": {"m": f"{kind}({inner})", "last": "u(end)"},
    }  # fmt: skip
    line = follow(parts, "L", (0.5, 2))
    length = line.columns["L"]
    exact = {
        "mean": (1.0 - np.exp(-length)) / length,
        "norm": np.sqrt((1.0 - np.exp(-2.0 * length)) / 2.0 / length),
        "integral": (1.0 - np.exp(-2.0 * length)) / 2.0,
    }[kind]
    assert line.columns["m"] == pytest.approx(exact, abs=1e-8)
    assert line.columns["last"] == pytest.approx(np.exp(-length), abs=1e-9)


def test_the_independent_variable_stands_in_equations_and_starts():
    """u' = 2 t p, u(0) = 0: u = p t^2, whatever the guess is."""
    parts = {
        "kind": "bvp", "states": {"u": "t"}, "parameters": {"p": {"value": 1, "range": [0, 2]}},
        "equations": {"u": "2*t*p"}, "conditions": ["u(start) = 0"], "starts": {"wave": {"u": "sin(pi*t)"}},
    }  # fmt: skip
    for start in (None, "wave", {"u": "p*t"}):
        line = follow(parts, "p", (0, 2), start=start)
        assert line.columns["u.end"] == pytest.approx(line.columns["p"], abs=1e-12)
        assert line.columns["u.norm"] == pytest.approx(line.columns["p"] / np.sqrt(5.0), abs=1e-12)


def test_layers_get_a_mesh_of_their_own():
    """eps u'' + u' = 0, u(0) = 0, u(1) = 1: u = (1 - exp(-x/eps))/(1 - exp(-1/eps)), down to eps = 1e-4."""
    parts = {
        "kind": "bvp", "states": {"u": "t", "v": "1/exp(k)"}, "parameters": {"k": {"value": 0, "range": [-9.2, 0]}},
        "definitions": {"eps": "exp(k)"}, "equations": {"u": "v/eps", "v": "-v/eps"},
        "conditions": ["u(start) = 0", "u(end) = 1"],
    }  # fmt: skip
    line = follow(parts, "k", (-9.2, 0))
    assert line.ends[0].reason == "bound"
    eps = np.exp(line.columns["k"])
    assert line.columns["v.start"] == pytest.approx(1.0 / (1.0 - np.exp(-1.0 / eps)), rel=1e-6)


def test_a_start_without_a_solution_says_so():
    parts = {
        "kind": "bvp", "states": {"u": 0}, "parameters": {"p": {"value": 1, "range": [0, 2]}},
        "equations": {"u": "p"}, "conditions": ["u(start)^2 + 1 = 0"],
    }  # fmt: skip
    with pytest.raises(NoSolutionError, match="no solution of m found"):
        follow(parts, "p", (0, 2))


@pytest.mark.parametrize("kind", ["bvp", "algebraic"])
def test_verbs_of_flows_say_that_there_is_no_time(kind):
    model = Model("b", **BRATU) if kind == "bvp" else Model(
        "b", kind=kind, states={"u": 1}, parameters={"lam": {"value": 1, "range": [0, 2]}}, equations={"u": "lam - u^2"}
    )  # fmt: skip
    verbs = [
        lambda: contin.simulate(model), lambda: contin.sweep(model, "lam", (0, 1)),
        lambda: contin.scan(model, {"lam": [0.1]}), lambda: contin.periodic_orbit(model),
        lambda: contin.phase(model, ("lam", "lam")), lambda: contin.connecting_orbit(model, None),
    ]  # fmt: skip
    for verb in verbs if kind == "algebraic" else [*verbs, lambda: contin.equilibrium(model)]:
        with pytest.raises(InputError, match="follow its solutions with"):
            verb()


def test_eulers_elastica_buckles_where_it_should():
    """theta'' = -P sin(theta), theta' = 0 at the ends: P = (n pi)^2; at P = 0 any constant will do."""
    parts = {
        "kind": "bvp", "states": {"theta": 0, "m": 0}, "parameters": {"P": {"value": 1, "range": [0, 50]}},
        "equations": {"theta": "m", "m": "-P*sin(theta)"}, "conditions": ["m(start) = 0", "m(end) = 0"],
    }  # fmt: skip
    line = follow(parts, "P", (0, 50))
    assert not line.notes
    for n, point in enumerate(line.points):
        assert abs(point.values["P"] - (n * np.pi) ** 2) <= point.error
    assert [p.normal_form.get("criticality") for p in line.points] == ["degenerate", None, None]


@pytest.mark.parametrize("intervals", [12, 30])
def test_normal_forms_of_pitchforks_do_not_depend_on_the_mesh(intervals):
    """u'' = -lam (u - u^3): u = A sin(n t), lam = n^2 (1 + 3 A^2/4); mean(q^2) = 1 is A^2 = 2 x^2/(1 + n^2)."""
    parts = {
        "kind": "bvp", "time": {"name": "t", "from": 0, "to": "pi"}, "states": {"u": 0, "v": 0},
        "parameters": {"lam": {"value": 0.5, "range": [0.5, 5]}},
        "equations": {"u": "v", "v": "-lam*(u - u^3)"}, "conditions": ["u(start) = 0", "u(end) = 0"],
    }  # fmt: skip
    line = follow(parts, "lam", (0.5, 5), settings={"intervals": intervals})
    assert [p.type for p in line.points] == ["BP", "BP"]
    for n, point in enumerate(line.points, 1):
        form = point.normal_form
        error = 3.0 * form["errors"]["b30"] + 1e-8
        assert form["kind"] == "pitchfork"
        assert form["b11"] == pytest.approx(1.0, abs=1e-9)
        assert abs(form["b30"] + 6.0 * 1.5 * n**2 / (1.0 + n**2)) <= error


def test_normal_form_of_a_fold_is_how_the_parameter_turns():
    """a = lam''/2 along unit x = mean(q . (u - u0)): from the rows of the curve beside Bratu's fold."""
    line = follow(BRATU, "lam", (2.5, 4), start={"parameters": {"lam": 2.5}}, settings={"max_step": 0.02})
    fold = line["LP1"]
    height, lam = fold.values["height"], fold.values["lam"]
    near = np.abs(line.columns["height"] - height) < 0.05
    x, p = line.columns["height"][near] - height, line.columns["lam"][near] - lam
    bend = np.polynomial.polynomial.polyfit(x, p, [2, 3, 4])[2]
    c = float(np.arccosh(np.exp(height / 2.0)))
    t = np.linspace(0.0, 1.0, 4001)
    u, v = (_along_bratu(t, c, k) for k in (0, 1))
    across = np.trapezoid(u * u + v * v, t)  # of the solutions for one unit of height
    assert fold.normal_form["a"] == pytest.approx(bend / across, rel=1e-4)


def _along_bratu(t, c, derivative):
    """d/d(height) of u or u' of Bratu's problem at the fold, from its closed form, by differences."""

    def solution(c):
        if derivative == 0:
            return 2.0 * np.log(np.cosh(c) / np.cosh(c * (2.0 * t - 1.0)))
        return -4.0 * c * np.tanh(c * (2.0 * t - 1.0))

    step = 1e-5
    change = 4.0 * np.log(np.cosh(c + step) / np.cosh(c - step)) / 2.0
    return (solution(c + step) - solution(c - step)) / change


def test_an_eigenvalue_problem_starts_where_the_derivative_and_the_eigenvalue_vanish():
    """Mathieu's a_0(q): a constant at q = 0, where y' and a are zero and their sizes rounding. (DLMF 28.6: -q^2/2.)"""
    parts = {
        "kind": "bvp", "time": {"name": "t", "from": 0, "to": "pi"}, "states": {"y": "sqrt(1/2)", "v": 0},
        "parameters": {"q": {"value": 0, "range": [0, 6]}, "a": 0},
        "equations": {"y": "v", "v": "-(a - 2*q*cos(2*t))*y"},
        "conditions": ["v(start) = 0", "v(end) = 0", "integral(y^2) = pi/2"],
    }  # fmt: skip
    line = follow(parts, "q", (0, 5), free=("a",), values={"q": [5]})
    assert line["UZ1"].values["a"] == pytest.approx(-5.800046020851508, abs=1e-8)  # DLMF, table 28.1.1


@pytest.mark.seldom
def test_a_pulse_on_a_long_interval_is_found_although_its_place_is_hardly_determined():
    """u'' = u - 2 u^3 on [-10, 10], u = 0 at the ends: sech, its shift determined to exp(-20)."""
    parts = {
        "kind": "bvp", "time": {"name": "x", "from": -10, "to": 10},
        "states": {"u": "1/cosh(x)", "v": "-tanh(x)/cosh(x)"}, "parameters": {"N": 2, "mu": -0.5},
        "equations": {"u": "v", "v": "-2*mu*u - 2*u^3"},
        "conditions": ["u(start) = 0", "u(end) = 0", "integral(u^2) = N"],
    }  # fmt: skip
    line = follow(parts, "N", (1.9, 2.0), free=("mu",))
    assert line.columns["mu"] == pytest.approx(-(line.columns["N"] ** 2) / 8.0, abs=1e-6)  # N = 2 sqrt(-2 mu)
    far = follow(parts, "N", (2.0, 4.0), free=("mu",))
    assert "do not determine the solution" in far.ends[1].text


def test_a_rough_guess_leads_somewhere_by_whole_steps():
    """A localised pattern of the Swift-Hohenberg equation from cos(x)/cosh(x/10): damped steps stay between two."""
    waves = {"u": "cos(x)", "v": "(-sin(x))", "w": "(-cos(x))", "z": "sin(x)"}
    parts = {
        "kind": "bvp", "time": {"name": "x", "from": 0, "to": "20*pi"},
        "states": {name: f"1.3*{wave}/cosh(x/10)" for name, wave in waves.items()},
        "parameters": {"r": -0.2, "b": 1.8},
        "equations": {"u": "v", "v": "w", "w": "z", "z": "-2*w - (1 - r)*u + b*u^2 - u^3"},
        "conditions": ["v(start) = 0", "z(start) = 0", "v(end) = 0", "z(end) = 0"],
    }  # fmt: skip
    seed = boundary_guess(Model("m", **parts)).seed("r")
    assert float(np.abs(seed.problem.profile(seed.z).u[:, 0]).max()) > 0.5


def test_the_place_of_a_failure_is_told_in_the_users_variable():
    """The independent variable has the name and the values of the model, not those of the unit interval."""
    parts = {
        "kind": "bvp", "time": {"name": "x", "from": -1, "to": 3}, "states": {"u": 0, "v": 0}, "parameters": {"q": 1},
        "equations": {"u": "v", "v": "q + sqrt(x)"}, "conditions": ["u(start) = 0", "u(end) = 0"],
    }  # fmt: skip
    with pytest.raises(NoSolutionError, match=r"square root of a negative number, 'x' = -0"):
        boundary_guess(Model("m", **parts)).seed("q")


@pytest.mark.parametrize("e", [1e-2, 1e-3, 1e-6])
def test_three_branch_points_within_one_step_are_three_labels(e):
    """Three copies of the sine's problem, at q = 1 - k e: one change of the determinant's sign tells of them all."""
    parts = {"kind": "bvp", "parameters": {"q": {"value": 0.53, "range": [0.5, 1.5]}}, "states": {}, "equations": {}}
    parts["conditions"] = []
    for k, name in enumerate("abc"):
        parts["states"] |= {name: 0, f"{name}p": 0}
        parts["equations"] |= {name: f"{name}p", f"{name}p": f"-((q + {k * e:.9f})*pi)^2*{name} + {name}^3"}
        parts["conditions"] += [f"{name}(start) = 0", f"{name}(end) = 0"]
    line = follow(parts, "q", (0.53, 1.5))
    assert [p.type for p in line.points] == ["BP"] * 3
    for point, place in zip(line.points, (1 - 2 * e, 1 - e, 1.0), strict=True):
        assert abs(point.values["q"] - place) <= point.error
        assert point.normal_form["kind"] == "pitchfork"


def test_both_ends_of_an_interval_have_one_neighbour():
    """u' = 5 u is steep at one end alone: nothing refines the mesh at the other, whose neighbour it is not."""
    parts = {
        "kind": "bvp", "states": {"u": "exp(5*t)"}, "parameters": {"a": {"value": 1, "range": [1, 2]}},
        "equations": {"u": "5*u"}, "conditions": ["u(start) = a"],
    }  # fmt: skip
    line = follow(parts, "a", (1, 2))
    h = line.problem.profile(line.z[-1]).h
    assert h[0] == pytest.approx(h.max(), rel=0.05)
    assert h[-1] < 0.5 * h[0]
    assert line.columns["u.end"] == pytest.approx(line.columns["a"] * np.exp(5.0), rel=1e-8)


def test_a_state_of_rest_has_the_natural_sizes_of_what_is_zero_there():
    """Libration points: x is found to rounding, and what rounding makes of the velocities is no size."""
    parts = {
        "kind": "bvp", "states": {"x": 0.74091, "y": 0, "u": 0, "v": 0},
        "parameters": {"T": {"value": 1.21, "range": [1.2, 1.3]}, "m": 0.04},
        "definitions": {"a": "(1 - m)/sqrt((x + m)^2 + y^2)^3", "b": "m/sqrt((x - 1 + m)^2 + y^2)^3"},
        "equations": {
            "x": "T*u", "y": "T*v", "u": "T*(2*v + x - a*(x + m) - b*(x - 1 + m))", "v": "T*(-2*u + y - (a + b)*y)",
        },
        "conditions": ["y(start) = 0", "u(start) = 0", "y(end) = 0", "u(end) = 0"],
    }  # fmt: skip
    line = follow(parts, "T", (1.2, 1.3))
    x = line.columns["x.start"][0]
    c = 0.96 / (x + 0.04) ** 3 + 0.04 / (0.96 - x) ** 3
    point = line["BP1"]
    assert abs(point.values["T"] - np.pi / np.sqrt((2 - c + np.sqrt(9 * c * c - 8 * c)) / 2)) <= point.error < 1e-9


def test_a_branch_point_takes_a_dozen_factorisations(monkeypatch):
    """On the branch's mesh, from a point beside it for its scatter, and on a mesh of twice as many intervals."""
    counted, whole = [], Balanced.of

    def of(matrix, factoriser):
        counted.append(matrix.shape)
        return whole(matrix, factoriser)

    monkeypatch.setattr(Balanced, "of", of)
    line = follow(SINE, "q", (0.5, 3.5), direction="up")
    assert len(line.points) == 3
    assert len(counted) <= 40  # 37 measured, 5 of them for errors; 85 when each step solved for the curve anew


def test_user_values_and_extrema_have_the_error_of_the_mesh():
    """u'' = -u, u(0) = 0, u(L) = 1: u'(0) = 1/sin L, which is least at pi/2 and 1.2 at asin(1/1.2), on 6 intervals."""
    parts = {
        "kind": "bvp", "time": {"name": "t", "to": "L"}, "states": {"u": "t", "v": 1}, "parameters": {"L": 1},
        "equations": {"u": "v", "v": "-u"}, "conditions": ["u(start) = 0", "u(end) = 1"],
    }  # fmt: skip
    wanted, settings = {"v.start": [1.2]}, {"intervals": 6}
    line = follow(parts, "L", (0.5, 2.5), values=wanted, extrema=["v.start"], settings=settings)
    first = float(elementary.atan2(1.0, np.sqrt(0.44)))
    exact = {"UZ1": first, "EX1": np.pi / 2.0, "UZ2": np.pi - first}
    assert [point.label for point in line.points] == list(exact)
    for point in line.points:
        assert abs(point.values["L"] - exact[point.label]) <= point.error < 1e-10


def test_errors_of_the_mesh_are_no_extrema():
    """Holmes and Spence: u'' = u^2 - x, u(0) = 0, u(L) = sqrt(L): u'(0) falls to a limit, ever more slowly.

    Where it has come to rest, what is left of its changes is discretisation.
    """
    model = Model(
        "painleve", kind="bvp", time={"name": "s"}, states={"u": 0, "v": 0}, parameters={"L": 1.0},
        equations={"u": "L*v", "v": "L*(u^2 - L*s)"}, conditions=["u(start) = 0", "u(end) = sqrt(L)"],
        observables={"slope": "v(start)", "bent": "v(start) + 1e-3*sin(L)"},
    )  # fmt: skip
    line = contin.continuation(boundary_guess(model, None, None, ()), "L", (0.5, 11), extrema=["slope", "bent"])
    assert {point.normal_form["of"] for point in line.points} == {"bent"}
    late = [point.values["L"] for point in line.points if point.values["L"] > 6.0]
    assert late == pytest.approx([2.5 * np.pi, 3.5 * np.pi], abs=1e-2)  # where nothing else moves
    assert line.columns["slope"][-1] == pytest.approx(0.92437548744, abs=1e-8)
