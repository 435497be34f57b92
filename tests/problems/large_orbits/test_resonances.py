"""Curves of tori of large orbits through strong resonances, where two of them meet, and with folds, as planted."""

import numpy as np
import pytest
from scipy import sparse

import contin
from contin.problems.large_orbits.codimension_two import LargeFlow
from contin.problems.large_orbits.cycle import LargeCycle
from tests.problems.large_orbits.test_codimension_two import LONG, MESH, agrees, found_on
from tests.problems.large_orbits.test_normal_forms import family, function

BORN = 0.05  # mu at which the plane's trace vanishes on r = sqrt(mu)


def circle(x, y, mu):
    growth = mu - x * x - y * y
    return [growth * x - y, growth * y + x]


def beside_a_fold(z, p):
    """A plane v'' = k + s v' + v^2 + v v'/2: NS at s = -v/2, k = -v^2, whose flow has a Bogdanov-Takens point at 0."""
    x, y, v, w = z.tolist()
    return np.array([*circle(x, y, p["mu"]), w, p["k"] + (p["mu"] - BORN) * w + v * v + 0.5 * v * w])


def half_turned(z, p):
    """w = R(phi/2) y, y' = s y + r diag(1, -1) y + h J y - |y|^2 y: multipliers -exp(2 pi (s +- sqrt(r^2 - h^2)))."""
    x, y, v, w = z.tolist()
    s, h = p["mu"] - BORN - v * v - w * w, p["h"] + 0.5
    return np.array([*circle(x, y, p["mu"]), s * v + x * v + y * w - h * w, s * w + y * v - x * w + h * v])


TURNED = np.linalg.qr(np.random.default_rng(2).normal(size=(7, 7)))[0]
C4, D4 = -0.7 - 0.4j, 0.3


def two_planes_and_a_fold(z, p):
    """Turned by a constant matrix: v' = (s + i omega) v + C4 |v|^2 v + D4 (x + i y) conj(v)^3, a second plane with
    s - e and frequency .17, and u' = k + u^2."""
    x, y, *rest, u = (TURNED.T @ z).tolist()
    s, parts = p["mu"] - BORN, []
    for (v, w), gain, turn, last in ((rest[:2], s, p["omega"], D4), (rest[2:], s - p["e"], 0.17, 0.0)):
        q = v * v + w * w
        a, b = v**3 - 3 * v * w * w, w**3 - 3 * v * v * w  # conj(v + i w)^3
        re, im = gain + C4.real * q, turn + C4.imag * q
        parts += [re * v - im * w + last * (x * a - y * b), re * w + im * v + last * (x * b + y * a)]
    return TURNED @ [*circle(x, y, p["mu"]), *parts, p["k"] + u * u]


def tori(residual, start, parameters, names, span, **settings):
    """The curve of the first torus bifurcation."""
    full = sparse.csc_matrix(np.ones((len(start), len(start))))
    problem = contin.FunctionProblem(residual, start, {"mu": -0.05, **parameters}, sparsity=full)
    line = contin.continuation(problem, "mu", (-0.1, 0.5), settings={"stop_at": ("HB",)})
    orbits = contin.continuation(
        line["HB1"].switch(), "mu", (-0.1, 0.45), settings={"intervals": 8, "step": 0.05, "stop_at": ("NS",)}
    )
    return contin.continuation(orbits["NS1"].locus(), names, span, settings={**LONG, **settings})


def test_forms_along_orbits_of_few_states_take_few_evaluations():
    """Of four states 20 pure derivatives of order 3 at a point, of 9 values each, serve every form there."""
    calls = []

    def counted(z, p):
        calls.append(1)
        return half_turned(z, p)

    full = sparse.csc_matrix(np.ones((4, 4)))
    problem = contin.FunctionProblem(counted, np.zeros(4), {"mu": -0.05, "h": 0.23}, sparsity=full)
    line = contin.continuation(problem, "mu", (-0.1, 0.1), settings={"stop_at": ("HB",)})
    orbits = contin.continuation(line["HB1"].switch(), "mu", (-0.1, 0.1), settings={"intervals": 6, "steps": 2})
    cycle = LargeCycle(orbits.problem, orbits.z[-1], 1.0, np.zeros(4))
    flow, rng = LargeFlow(cycle, 2.0), np.random.default_rng(5)
    for order in (2, 3):
        for _ in range(3):
            w = [rng.normal(size=cycle.orbit.U.shape) + 1j * rng.normal(size=cycle.orbit.U.shape) for _ in range(order)]
            exact = cycle.apply(*(2.0 * each for each in w)) / 2.0
            before = len(calls)
            np.testing.assert_allclose(flow.apply(*w), exact, atol=1e-9 * np.abs(exact).max())
    assert len(calls) == before  # those of the first form of an order serve all
    flow.tensors("start", cycle.orbit.beginnings[:1], 3)
    assert len(calls) - before <= 20 * 9 * 2


@pytest.mark.long
def test_tori_through_a_1_to_1_resonance_become_neutral():
    """(mu, k) = (BORN - v/2, -v^2): for v < 0 tori, for v > 0 two real multipliers with product 1."""
    v = -0.02
    span = {"mu": (0.045, 0.0605), "k": (-5e-4, 1e-4)}
    curve = tori(beside_a_fold, [0.0, 0.0, v, 0.0], {"k": -v * v}, ("mu", "k"), span)
    (point,) = found_on(curve, ["R1"])
    assert abs(point.values["mu"] - BORN) <= point.error + 1e-9
    agrees(point, a=4.0 * np.pi**2)
    mu, k = curve.columns["mu"], curve.columns["k"]
    np.testing.assert_allclose(k, -4.0 * (mu - BORN) ** 2, atol=1e-7)
    assert mu.min() < BORN - 0.004
    assert any("two real multipliers with product 1" in note for note in curve.notes)


@pytest.mark.seldom
def test_a_curve_of_folds_along_which_the_second_parameter_turns():
    """r' = r (mu - a^2 + a/5 + R - R^2), R = r^2: folds at mu = -1/4 + a^2 - a/5."""

    def residual(z, p):
        x, y = z.tolist()
        r2 = x * x + y * y
        growth = p["mu"] - p["a"] ** 2 + 0.2 * p["a"] + r2 - r2 * r2
        return np.array([growth * x - y, growth * y + x])

    folds = family(function(residual, 2, {"mu": -0.5, "a": 0.0}), (-0.4, 0.1), stop_at=("LPC",), intervals=8)
    span = {"a": (-0.05, 0.25), "mu": (-0.3, -0.1)}
    curve = contin.continuation(folds["LPC1"].locus(), ("a", "mu"), span, settings=LONG)
    a, mu = curve.columns["a"], curve.columns["mu"]
    np.testing.assert_allclose(mu, a * a - 0.2 * a - 0.25, atol=1e-4)  # of 8 intervals
    assert (a.min(), a.max()) == pytest.approx((-0.05, 0.25))
    assert not curve.points
    assert not curve.notes


@pytest.mark.parametrize("most", [3, pytest.param(500, marks=pytest.mark.long)], ids=["place", "coefficients"])
@pytest.mark.seldom
def test_tori_through_a_1_to_2_resonance_become_neutral(monkeypatch, most):
    monkeypatch.setattr("contin.problems.large_orbits.codimension_two.MOST", most)
    span = {"mu": (0.04, 0.06), "h": (0.21, 0.235)}
    curve = tori(half_turned, np.zeros(4), {"h": 0.23}, ("mu", "h"), span)
    (point,) = curve.points
    assert point.type == "R2"
    assert abs(point.values["h"] - np.sqrt(BORN)) < point.error < MESH
    if most > 4:
        agrees(point, C1=0.0)
    else:
        assert not point.normal_form
        assert any("R2" in note and "not computed for orbits of large systems" in note for note in curve.notes)
    np.testing.assert_allclose(curve.columns["mu"], BORN, atol=1e-4)
    assert curve.columns["h"].min() < 0.215


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "label", "start", "span"),
    [("e", "NSNS", 0.004, (-0.004, 0.005)), ("k", "LPNS", -4e-4, (-5e-4, 1e-3)), ("omega", "R4", 0.24, (0.235, 0.26))],
)
def test_second_planes_folds_and_quarters_on_curves_of_tori(monkeypatch, name, label, start, span):
    monkeypatch.setattr("contin.problems.large_orbits.codimension_two.MOST", 3)  # places alone
    parameters = {"e": 0.02, "k": -0.04, "omega": 0.3, name: start}
    first = TURNED @ np.array([0, 0, 0, 0, 0, 0, -np.sqrt(-parameters["k"])])
    curve = tori(two_planes_and_a_fold, first, parameters, ("mu", name), {"mu": (0.04, 0.06), name: span})
    (point,) = curve.points
    assert point.type == label
    assert abs(point.values[name] - {"R4": 0.25}.get(label, 0.0)) < max(point.error, 1e-9) < MESH
    assert abs(point.values["mu"] - BORN) < max(point.error, 1e-9)
