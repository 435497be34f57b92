"""Demos of AUTO-07p as run files: what they find beside closed forms and published numbers."""

from math import acosh, e, exp, pi, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.cli.auto_demos.results import FOLDER, branches_of, result_of
from tests.cli.calls import call

FOLDS_OF_AB = [u / (1 - u) * exp(-14 * u / 3) for u in ((1 - sqrt(1 / 7)) / 2, (1 + sqrt(1 / 7)) / 2)]
FOLD = 2 / (3 * sqrt(3))  # of mu + x - x^3
BRATU = 3.513830719125161  # 8 k^2 / cosh(k)^2 where k tanh(k) = 1
HEIGHT_TWO = 8 * acosh(e) ** 2 / e**2  # Bratu's solution 2 log(cosh(k)/cosh(k (1 - 2 t))) of height 2


def saturation(slope: float, low: float, high: float) -> float:
    """s0 = s + 100 R(s) where R(s) = s/(1 + s + s^2) has this slope, between two values of s."""
    s = brentq(lambda s: (1 - s * s) / (1 + s + s * s) ** 2 - slope, low, high, xtol=1e-15)
    return float(s + 100 * s / (1 + s + s * s))


def turning_of_tor(nu: float) -> float:
    """Routh and Hurwitz's condition of (s + a)(s^2 + b s + 1) - c s, the circuit at rest."""
    a, b, c = (0.5 + nu) / 0.6, 0.5 - 0.6, 0.25 / 0.6
    return (a + b) * (1 + a * b - c) - a


def turning_of_ops(l3: float) -> float:
    """The same for (l1 s - l4 (1 - l3^2) + 1/l2)(s + 1/l2) s + s + 1/l2 - s/l2^2, times l1^2: of the circuit ops."""
    l1, l2, l4 = 0.5, 4.0, 2.0
    a, b = (l4 * (l3 * l3 - 1) + 1 / l2) / l1, 1 / l2
    first, second, third = a + b, a * b + 1 / l1 - b * b / l1, b / l1
    return first * second - third


def trace_of_plp(rho: float) -> float:
    """Of the enzyme's equilibrium, between a = 50 and 110; s from s0 - s = 0.2 (500 - a)."""

    def balance(s: float) -> float:
        a = 500 - (110 - s) / 0.2
        return 110 - s - rho * s * a / (1 + s + 0.1 * s * s)

    s = brentq(balance, 10.5 if rho > 4.2 else 25.0, 26.0 if rho > 4.2 else 35.0, xtol=1e-14)
    a, d = 500 - (110 - s) / 0.2, 1 + s + 0.1 * s * s
    return float(-1 - rho * (a * d - s * a * (1 + 0.2 * s)) / d**2 - 0.2 - rho * s / d)


def turning_of_wav(p3: float) -> float:
    """det(J - k^2 D + i c k) = 0, k^2 = tr J/(1 + beta), of the enzyme's state with u near 27."""

    def off(u: float) -> float:
        v = p3 - (145 - u) / 0.2
        return 145 - u - 210 * v / (3.4 + v) * u / (1 + u + 0.023 * u * u)

    u = brentq(off, 25.0, 30.0, xtol=1e-14)
    v, d = p3 - (145 - u) / 0.2, 1 + u + 0.023 * u * u
    r1, r2 = 210 * v / (3.4 + v) * (1 - 0.023 * u * u) / d**2, 210 * 3.4 / (3.4 + v) ** 2 * u / d
    j = -3 * np.array([[r1 + 1, r2], [r1, r2 + 0.2]])
    square = np.trace(j) / 6
    return float((j[0, 0] - square) * (j[1, 1] - 5 * square) - j[0, 1] * j[1, 0] - 0.05**2 * square)


GRAZED = (2 + sqrt(8.5)) / 6
A_OF_FHN = sqrt(1 - 0.8 / 9) * (1 - 0.8 + 0.8 * (1 - 0.8 / 9) / 3)  # a = x + b (x^3/3 - x)
OPS = brentq(turning_of_ops, 0.8, 1.0)
WANTED = {
    "cusp": {"line.LP": ("mu", [-FOLD, FOLD]), "folds.CP": ("mu", [0])},
    "ab": {"line.LP": ("p1", FOLDS_OF_AB)},
    # Doedel and Heinemann (1983), to the digits of AUTO's own output
    "abc": {"line.HB": ("p1", [0.2041845, 0.2298390, 0.2599579, 0.3462085])},
    "dd2": {"line.PD": ("p1", [3]), "two.PD": ("p1", [1 + sqrt(6)])},
    # OEIS A086181, A091517: 3.5440903595519, 3.5644072660954, and the fifth doubling
    "log": {"one.PD": ("mu", [3]), "two.PD": ("mu", [1 + sqrt(6)]), "four.PD": ("mu", [3.5440903595519])},
    # Hopf points at s (s + b + 3)/(s - b - 1); the homoclinic orbit as Barrio, Shilnikov and Shilnikov (2012)
    "lrz": {"rest.BP": ("rho", [1]), "states.HB": ("rho", [470 / 19] * 2), "cycles.HOM": ("rho", [13.926557407])},
    "pp2": {"none.BP": ("p1", [0.6]), "prey.BP": ("p1", [2 / 3 / (1 - exp(-5 / 3))])},
    "exp": {"line.LP": ("p1", [BRATU])},
    "int": {"line.LP": ("p1", [11.9237902])},
    "bvp": {"zero.BP": ("p1", [1, 2, 3, 4, 5])},
    "ezp": {"line.BP": ("p1", [BRATU])},
    "opt": {"one.EX": ("x2", [-sqrt(1 / 2), sqrt(1 / 2)]), "two.EX": ("x2", [-sqrt(1 / 3), sqrt(1 / 3)]),
        "three.EX": ("x2", [-1 / 2, 1 / 2])},
    "pvl": {"line.UZ": ("p1", [HEIGHT_TWO])},
    "phs": {"line.HB": ("lambda", [0])},
    # the sum of both compartments turns where 1 + 100 R' = 0, their difference grows where 3 + 100 R' = 0
    "enz": {
        "line.LP": ("s0", [saturation(-1 / 100, 1.0, 1.5), saturation(-1 / 100, 5.0, 20.0)]),
        "line.BP": ("s0", [saturation(-3 / 100, 1.0, 1.5), saturation(-3 / 100, 2.0, 10.0)]),
    },
    # multipliers exp(+-i theta) on beta = 1: x = -cos(theta), alpha = 2 x + x^2; the fold's curve meets x = 0 at -1
    "hen": {
        "tori.R1": ("alpha", [-1]), "tori.R2": ("alpha", [3]), "tori.R3": ("alpha", [1.25]), "tori.R4": ("alpha", [0]),
        "folds.R1": ("alpha", [-1]), "folds.LPPD": ("alpha", [0]),
    },
    "pp3": {"start.BP": ("p1", [3 / 4])},  # (4 - 1/4)/5
    "apbp": {"one.BP": ("p2", [1]), "folds.LP": ("p3", [1 / 4])},
    "lcbp": {"cycles.BPC": ("p1", [2])},
    "vhb": {"rest.HB": ("p", [0]), "cycles.HOM": ("p", [0])},
    "nep": {"zero.BP": ("p", [n * n * pi * pi / 2 for n in (1, 2, 3)])},
    "sspg": {"bare.BP": ("s", [1 / (1 - exp(-1))])},
    "ext": {"zero.BP": ("lam", [1, 2, 3])},
    "tim": {"line.BP": ("p", [BRATU])},
    # u = (1 + exp(z/sqrt 6))^-2 at c = 5/sqrt 6, its steepest slope
    "fsh": {"front.UZ": ("v.max", [8 / 27 / sqrt(6), 0.04998011])},
    "nag": {"front.UZ": ("c", [sqrt(2) / 4, -sqrt(2) / 4])},
    "ppp": {"two.BP": ("p1", [0.55]), "prey.BP": ("p1", [1.25 / 6 / (1 - exp(-5 / 6))])},
    # x = (b1 - 1)/(2 b1); and y = 1/8 on the prey's nullcline 8 (1 - x) (1 + 3 x) = 5
    "tfc": {"two.HB": ("d1", [5 / 6]), "two.BP": ("d1", [5 * GRAZED / (1 + 3 * GRAZED)])},
    "tor": {"rest.BP": ("nu", [-1 / 2]), "rest.HB": ("nu", [brentq(turning_of_tor, -0.7, -0.55)])},
    "ops": {"rest.HB": ("l3", [-OPS, OPS])},
    "plp": {"rest.HB": ("rho", [brentq(trace_of_plp, 3.2, 3.8), brentq(trace_of_plp, 4.3, 5.0)])},
    # tested below; the doubled rotations of period 68 are at 0.17362879276
    "pen": {"turns.PD": ("I", [0.17916378]), "doubled.HOM": ("I", [0.17362879276])},
    # where the folds of cycles turn in p2 two families cross, and there the curve in three parameters begins
    "abcb": {"folds.EX": ("p2", [0.98218259, 1.26865801]), "across.BPC": ("p2", [0.98218259])},
    # x^2 = 1 - b/c^2 where the trace is zero; x^2 = (1 - b)/b where l1 is, of x" + (c (x^2 - 1) + b/c) x' + x - a - b x
    # + b x^3/3 = 0, as 2 c g' = 4 b c x^2
    "fhn": {"rest.HB": ("a", [-A_OF_FHN, A_OF_FHN]), "turning.GH": ("a", [-2 / 15, 2 / 15])},
    # u = sqrt(15/8)/cosh(x/sqrt 8)^2 at P = -5/2, and its image
    "rev": {"even.UZ": ("u.min", [-sqrt(15 / 8)])},
    # q = 2 k^2/cosh(k x)^2, k^2 = 3/4 (2 b + 1), where a = 3/5 (2 b + 1)(b - 2): Champneys and Groves (1997)
    "kdv": {"wave.UZ": ("q.max", [1.5 + 3 * (3 + sqrt(65)) / 4])},
    "ph1": {"rest.HB": ("rho", [brentq(trace_of_plp, 3.2, 3.8), brentq(trace_of_plp, 4.3, 5.0)])},
    # a wave of speed c: frequency^2 = trace/(1 + beta), and the determinant
    "wav": {"rest.HB": ("p3", [brentq(turning_of_wav, 635, 636)])},
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(WANTED))
def test_a_demo_of_auto(name):
    branches = branches_of(name)
    for place, (parameter, expected) in WANTED[name].items():
        branch, type_ = place.split(".")
        found = sorted(p["values"][parameter] for p in branches[branch]["points"] if p["type"] == type_)
        assert found == pytest.approx(sorted(expected), rel=3e-7, abs=1e-7), place


def test_the_fold_of_a_complex_equation_has_two_null_vectors_and_no_coefficients():
    """F(u + iv) is analytic: its derivative vanishes on q and on i q at once."""
    (point,) = result_of("ezp")["branches"][0]["points"]
    assert point["normal_form"] == {"kind": "degenerate", "kernel": 2}


def test_cycles_at_one_of_two_equilibria_begin_in_closed_form():
    """snh: nu1 = -sin(phi) at phi = 2 pi - acos(0.73); (2 cos(phi) + nu2)^2 has a double zero there."""
    branches = branches_of("snh")
    (hopf,) = branches["rest"]["points"]
    assert hopf["values"]["nu1"] == pytest.approx(sqrt(1 - 0.73**2), rel=1e-9)
    assert [point["type"] for point in branches["cycles"]["points"]] == ["LPC", "NS"]


def test_a_simulation_settles_where_prey_and_predators_rest():
    """ivp: (1/3, 2) where nothing is harvested."""
    (simulation,) = result_of("ivp")["simulations"]
    assert [simulation["columns"][name][-1] for name in "uv"] == pytest.approx([1 / 3, 2], abs=1e-5)


def test_folds_beside_a_canard_are_told_to_within_their_errors(capsys):
    """fhn: beside its folds a changes by 1e-14, so that tests are rounding; whatever lies there has the same a."""
    assert call("run", str(FOLDER / "fhn.yaml")) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "where a is the same to within its error near a = -0.430518245" in told
    folds = [p for p in branches_of("fhn")["cycles"]["points"] if p["type"] == "LPC"]
    first, second = (p["values"]["a"] for p in folds)
    assert abs(first + second) < sum(p["error"] for p in folds) < 1e-9  # (x, y, a) -> -(x, y, a)


@pytest.mark.parametrize("demo", ["pp3", "plp"])
def test_families_that_go_over_to_no_other_one_are_not_said_to(demo, tmp_path):
    """A state that is zero but for rounding (pp3), and solutions shifted in time (plp), are no other branches."""
    assert call("run", str(FOLDER / f"{demo}.yaml"), "--quiet", "--json", str(tmp_path / "out.json")) == 0
