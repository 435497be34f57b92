"""Zero-Hopf points on invariant planes, planted with all coefficients in random smooth coordinates.

    w' = w (nu + b w + c R),  z' = (alpha + d w + e R + i omega) z,  R = |z|^2,  nu and alpha affine in p and q

(with w^2 for w in the brackets: a reflection). Hopf curves: alpha = 0 in the plane w = 0, b alpha = d nu off it; they
and the branch points nu = 0 meet at nu = alpha = 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from contin import api
from contin.model.model import Model

BOX = {"p": (-1.0, 1.0), "q": (-1.0, 1.0)}


@dataclass(frozen=True)
class Planted:
    """The model, its start, and the numbers in it: nu = slopes[0] . (p, q) - at, likewise alpha."""

    model: Model
    b: float
    c: float
    d: float
    e: float
    slopes: Any
    at: Any

    def unfolding(self, p: Any, q: Any) -> Any:
        """(nu, alpha)."""
        return self.slopes @ (np.array([p, q]) - self.at[:, None] if np.ndim(p) else np.array([p, q]) - self.at)


def planted(
    seed: int, extra: int = 0, reflection: bool = False, bend: float = 0.0, rate: float = 1.0
) -> Planted:
    rng = np.random.default_rng(seed)
    n = 3 + extra
    b, c, d, e = (rng.uniform(0.4, 1.5, 4) * rng.choice([-1.0, 1.0], 4)).tolist()
    angle = rng.uniform(0.0, 2.0 * np.pi)
    slopes = np.array([[np.cos(angle), np.sin(angle)], [np.sin(angle), -np.cos(angle) * rng.uniform(0.7, 1.4)]])
    at = rng.uniform(-0.2, 0.2, 2)
    matrix = np.linalg.qr(rng.normal(size=(n, n)))[0] @ np.diag(rng.uniform(0.5, 2.0, n))
    inverse, shear = np.linalg.inv(matrix), rng.uniform(-0.4, 0.4, n)
    shear[1] = 0.0  # u = y + shear y1^2
    names = [f"x{k}" for k in range(n)]
    number = "({!r})".format
    u = {f"u{k}": " + ".join(f"{number(float(inverse[k, j]))}*{names[j]}" for j in range(n)) for k in range(n)}
    y = {f"y{k}": f"u{k} - {number(float(shear[k]))}*u1^2" for k in range(n)}
    away = f"(p - {number(float(at[0]))})", f"(q - {number(float(at[1]))})"
    nu, alpha = (f"{number(float(s[0]))}*{away[0]} + {number(float(s[1]))}*{away[1]}" for s in slopes)
    w = "y0^2" if reflection else "y0"
    rates = {
        "g0": f"y0*(nu + {b!r}*{w} + {c!r}*R)", "g1": "S*y1 - 1.3*y2", "g2": "S*y2 + 1.3*y1",
        **{f"g{k + 3}": f"{-float(r)!r}*y{k + 3} + 0.3*y0*y1" for k, r in enumerate(rng.uniform(0.5, 2.0, extra))},
    }  # fmt: skip
    parts = {"nu": nu, "alpha": alpha, "R": "y1^2 + y2^2", "S": f"alpha + {d!r}*{w} + ({e!r} + {bend!r}*nu)*R"}
    turned = {f"f{k}": f"g{k} + 2*{number(float(shear[k]))}*y1*g1" for k in range(n)}
    matrix = rate * matrix
    equations = {names[j]: " + ".join(f"{number(float(matrix[j, k]))}*f{k}" for k in range(n)) for j in range(n)}
    model = Model(
        "plane", states=dict.fromkeys(names, 0.0), parameters={"p": 0.0, "q": 0.0}, equations=equations,
        definitions=u | y | parts | rates | turned,
    )  # fmt: skip
    return Planted(model, b, c, d, e, slopes, at)


def curve(case: Planted, type_: str) -> Any:
    """The curve of on-plane Hopf points or of branch points, from a point of it found along p or q."""
    for parameter in ("p", "q"):
        for other in (0.35, -0.35, 0.15, -0.15, 0.6, -0.6):
            held = {"q" if parameter == "p" else "p": other}
            line = api.continuation(api.equilibrium(case.model, None, held), parameter, (-0.95, 0.95))
            point = next((p for p in line.points if p.type == type_), None)
            if point is not None:
                return api.continuation(point.locus(("p", "q")), ("p", "q"), BOX)
    raise AssertionError("no such point on any of the lines")


def check(seed: int, extra: int = 0, reflection: bool = False, rate: float = 1.0) -> None:
    case = planted(seed, extra, reflection, rate=rate)
    hopf = curve(case, "HB")
    assert [p.type for p in hopf.points] == ["ZH"], (seed, extra, reflection, hopf.points, hopf.notes)
    point = hopf.points[0]
    assert abs(point.values["p"] - case.at[0]) <= max(10.0 * point.error, 1e-12)
    assert abs(point.values["q"] - case.at[1]) <= 1e-8
    assert point.residual < 1e-8
    form = point.normal_form
    assert "l2" not in form
    if reflection:
        assert form["case"].startswith("Hopf-pitchfork")
    else:
        # up to the scales of w0 and w1
        found = form["amplitudes"]
        assert np.sign([found["e"]]) == np.sign([case.e])
        assert found["c"] * found["d"] / (found["b"] * found["e"]) == pytest.approx(
            case.c * case.d / (case.b * case.e), rel=1e-6
        )
        determinant = case.b * case.e - case.c * case.d
        torus = case.b * case.e * determinant < 0.0
        assert form["case"] == "Hopf-transcritical (invariant plane): " + (
            "a torus branches off the cycles beside the plane" if torus else "no torus"
        )
    others = point.locus(("p", "q"))
    assert [s.problem.locus for s in others] == ["HB", "BP"]
    other = api.continuation(others[0], ("p", "q"), BOX)
    assert not other.points, (seed, extra, reflection, other.points)
    assert len(other) > 5
    assert not [note for note in other.notes if "not" in note]
    nu, alpha = case.unfolding(other.columns["p"], other.columns["q"])
    np.testing.assert_allclose(case.b * alpha, case.d * nu, atol=1e-8)
    branching = curve(case, "BP")
    assert [p.type for p in branching.points] == ["ZH"]
    assert branching.points[0].normal_form["case"] == form["case"]
    through = branching.points[0].locus(("p", "q"))
    assert len(through) == 2
    lines = [api.continuation(seed, ("p", "q"), BOX) for seed in through]
    gaps = [case.unfolding(b.columns["p"], b.columns["q"]) for b in lines]
    off = [float(np.abs(alpha).max()) > 1e-8 for _, alpha in gaps]
    assert sorted(off) == [False, True]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("reflection", [False, True])
def test_one_zero_hopf_point_and_the_other_hopf_curve(seed, reflection):
    check(seed, seed % 2, reflection)


@pytest.mark.parametrize("rate", [1e9, *(pytest.param(rate, marks=pytest.mark.long) for rate in (1e-9, 1e-6, 1e6))])
def test_zero_hopf_points_in_any_unit_of_time(rate):
    check(4, rate=rate)


@pytest.mark.seldom
def test_the_other_hopf_curve_is_the_other_one_where_the_tangent_at_the_point_is_none():
    """Two curves cross there: a tangent that was computed at the point was .99 along one of them, and not it."""
    check(471106, 2)


def test_a_generalised_hopf_point_beside_it_is_still_found():
    case = planted(1, bend=4.0)
    hopf = curve(case, "HB")
    assert sorted(p.type for p in hopf.points) == ["GH", "ZH"]
    at = next(p for p in hopf.points if p.type == "GH")
    nu, alpha = case.unfolding(at.values["p"], at.values["q"])
    assert (nu, alpha) == (pytest.approx(-case.e / 4.0, abs=1e-9), pytest.approx(0.0, abs=1e-9))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(100, 150))
def test_zero_hopf_points_in_many_coordinates(seed):
    check(seed, seed % 4, seed % 3 == 0)


def superpredator() -> Model:
    """The equations of AUTO's demo ppp (Doedel 1984; prey, predator, superpredator, with a fishing quota p1)."""
    return Model(
        "ppp", states={"u1": 1.0, "u2": 0.0, "u3": 0.0},
        parameters={"p1": 0.0, "p2": 0.25, "p3": 0.5, "p4": 3.0, "p5": 3.0, "p6": 5.0},
        equations={
            "u1": "u1*(1 - u1) - p4*u1*u2",
            "u2": "-p2*u2 + p4*u1*u2 - p5*u2*u3 - p1*(1 - exp(-p6*u2))",
            "u3": "-p3*u3 + p5*u2*u3",
        },
    )  # fmt: skip


def test_hopf_curves_of_prey_predator_and_superpredator():
    """In the plane u3 = 0, at u2 = p3/p5: u1 = 1 - p4 u2, and trace and second row of the planar Jacobian vanish."""
    u2 = 1.0 / 6.0

    def closed_form() -> list[tuple[float, float]]:
        # f2 = 0: p1 (1 - E) = u2 (p4 u1 - 1/4); trace: -u1 + p4 u1 - 1/4 - 5 p1 E = 0, with E = exp(-5 u2)
        decay = np.exp(-5.0 * u2)
        k = 5.0 * decay / (1.0 - decay) * u2
        # u1 = 1 - p4 u2: (p4 - 1) u1 - 1/4 - k (p4 u1 - 1/4) = 0
        a = np.poly1d([-u2, 1.0])
        x = np.poly1d([1.0, 0.0])
        roots = ((x - 1.0) * a - 0.25 - k * (x * a - 0.25)).roots
        found = [(float(u2 * (p4 * a(p4) - 0.25) / (1.0 - decay)), float(p4)) for p4 in roots.real]
        return sorted(found)

    diagram = api.diagram(superpredator(), "p1", (0.0, 1.0), orbits=False)
    box = {"p1": (0.0, 1.0), "p4": (0.0, 8.0)}
    start = diagram["start/BP1"]["HB1"].locus(("p1", "p4"))
    hopf = api.continuation(start, ("p1", "p4"), box)
    assert [p.type for p in hopf.points] == ["ZH", "ZH"]
    found = sorted((p.values["p1"], p.values["p4"]) for p in hopf.points)
    np.testing.assert_allclose(found, closed_form(), rtol=1e-11)
    np.testing.assert_allclose(found, [(0.077291, 5.4345), (0.362537, 3.34749)], rtol=1e-5)  # AUTO's
    other = api.continuation(hopf.points[0].locus(("p1", "p4"))[0], ("p1", "p4"), box)
    assert sorted(p.type for p in other.points) == ["GH", "GH", "ZH"]  # the parent is no label of its own
    assert [end.reason for end in other.ends] == ["closed", "closed"]


def test_a_hopf_curve_that_touches_the_zero_eigenvalue_has_a_zero_hopf_point_there():
    """w' = w (p + b w^2 + c R), z' = (q + d w + e R + 2 i) z: off the plane w = 0, Hopf points at p = -b w^2, q = -d w.

    Their real eigenvalue is 2 b w^2: it touches zero at w = 0, where l1 = (e - c d/(2 b w))/2 has a pole, and changes
    its sign as it does at the generalised Hopf point at w = c d/(2 b e).
    """
    b, c, d, e = -0.8, 0.6, 0.7, 0.9
    model = Model(
        "touching", states={"w": 0.9, "x": 0.0, "y": 0.0}, parameters={"p": 0.648, "q": -0.9},
        definitions={"R": "x^2 + y^2", "S": f"q + {d}*w + {e}*R"},
        equations={"w": f"w*(p + {b}*w^2 + {c}*R)", "x": "S*x - 2*y", "y": "2*x + S*y"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "q", (-0.95, 0.95))
    hopf = api.continuation(line["HB1"].locus(("p", "q")), ("p", "q"), {"p": (-0.9, 0.9), "q": (-0.7, 0.7)})
    assert sorted(p.type for p in hopf.points) == ["GH", "ZH"]
    at = c * d / (2.0 * b * e)
    assert (hopf["GH1"].values["p"], hopf["GH1"].values["q"]) == pytest.approx((-b * at * at, -d * at), abs=1e-9)
    assert abs(hopf["ZH1"].values["p"]) <= hopf["ZH1"].error
    assert hopf["ZH1"].values["q"] == pytest.approx(0.0, abs=1e-9)
    assert "l2" not in hopf["ZH1"].normal_form
    assert hopf["ZH1"].normal_form["case"] == "Hopf-transcritical (invariant plane): degenerate"


@pytest.mark.parametrize(
    ("bend", "c", "case"),
    [
        ("w^2", 0.6, "Hopf-pitchfork (reflection symmetry)"),
        ("w", 0.0, "Hopf-transcritical (invariant plane): degenerate"),
    ],
)
def test_a_zero_eigenvalue_that_is_only_touched_leaves_a_zero_hopf_point(bend, c, case):
    """As above, with q = -0.7 w^2 (the curve is its own mirror image) or c = 0: l1 has no pole there."""
    model = Model(
        "touching", states={"w": 0.9, "x": 0.0, "y": 0.0}, parameters={"p": 0.648, "q": -0.95},
        definitions={"R": "x^2 + y^2", "S": f"q + 0.7*{bend} - 0.9*R"},
        equations={"w": f"w*(p - 0.8*w^2 + {c}*R)", "x": "S*x - 2*y", "y": "2*x + S*y"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "q", (-0.98, 0.95))
    hopf = api.continuation(line["HB1"].locus(("p", "q")), ("p", "q"), {"p": (-0.9, 0.9), "q": (-0.7, 0.7)})
    assert [p.type for p in hopf.points] == ["ZH"]
    assert hopf.points[0].normal_form["case"] == case
    assert (hopf.points[0].values["p"], hopf.points[0].values["q"]) == pytest.approx((0.0, 0.0), abs=1e-12)


def test_the_food_chain_has_a_zero_hopf_point_where_the_prey_isocline_has_its_top():
    """Rosenzweig and MacArthur's chain of three (Hastings and Powell 1991; Kuznetsov, De Feo and Rinaldi, SIAM J. Appl.
    Math. 62 (2001) 462): the planar Hopf point is at the top of the prey isocline, where the superpredator's density
    does not move the predator's, so that the branch point there is degenerate too.
    """
    model = Model(
        "chain", states={"x": 0.8, "y": 0.2, "z": 9.0},
        parameters={"K": 1.0, "a": 5.0, "b": 3.0, "c": 0.1, "h": 2.0, "m": 0.4, "n": 0.01},
        equations={
            "x": "x*(1 - x/K) - a*x*y/(1 + b*x)",
            "y": "a*x*y/(1 + b*x) - c*y*z/(1 + h*y) - m*y",
            "z": "c*y*z/(1 + h*y) - n*z",
        },
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "K", (0.2, 3.0))
    hopf = api.continuation(line["HB1"].locus(("K", "n")), ("K", "n"), {"K": (0.1, 4.0), "n": (0.001, 0.03)})
    x = 0.4 / (5.0 - 3.0 * 0.4)
    capacity = 2.0 * x + 1.0 / 3.0
    y = (1.0 - x / capacity) * (1.0 + 3.0 * x) / 5.0
    (point,) = [p for p in hopf.points if p.type == "ZH"]
    assert abs(point.values["K"] - capacity) <= max(point.error, 1e-14)
    assert point.values["n"] == pytest.approx(0.1 * y / (1.0 + 2.0 * y), abs=1e-11)
    assert "l2" not in point.normal_form
    assert point.normal_form["case"].endswith("degenerate")
    for other in (p for p in hopf.points if p.type == "GH"):  # one on either side, and none at the point
        assert abs(other.values["K"] - capacity) > 1e-5


def test_the_chain_without_superpredators_has_its_zero_hopf_point_in_slow_units_of_time_as_well():
    """There the planar Hopf curve is K = 2 x + 1/3 for any growth r of the prey; the superpredator comes in at y = 1/8.

    With rates of 1e-7 the curve's equations were too small beside its conditions, which have no unit.
    """
    model = Model(
        "chain", states={"x": 0.8, "y": 0.2, "z": 5.0}, parameters={"K": 1.0, "r": 1.0},
        equations={
            "x": "1e-7*x*(r*(1 - x/K) - 5*y/(1 + 3*x))",
            "y": "1e-7*y*(5*x/(1 + 3*x) - 0.1*z/(1 + 2*y) - 0.4)",
            "z": "1e-7*z*(0.1*y/(1 + 2*y) - 0.01)",
        },
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "K", (0.2, 1.5))
    planar = api.continuation(line["BP1"].switch(), "K", (0.2, 1.5))
    hopf = api.continuation(planar["HB1"].locus(("K", "r")), ("K", "r"), {"K": (0.2, 1.5), "r": (0.3, 3.0)})
    x = 0.4 / (5.0 - 3.0 * 0.4)
    capacity = 2.0 * x + 1.0 / 3.0
    growth = 0.125 * 5.0 / ((1.0 - x / capacity) * (1.0 + 3.0 * x))
    assert [point.type for point in hopf.points] == ["ZH"]
    assert (hopf.points[0].values["K"], hopf.points[0].values["r"]) == pytest.approx((capacity, growth), abs=1e-12)
    assert not hopf.notes
