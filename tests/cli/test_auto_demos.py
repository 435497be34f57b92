"""Demos of AUTO-07p as run files: what they find beside closed forms and published numbers."""

import json
from math import acosh, e, exp, pi, sin, sqrt
from pathlib import Path

import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tests.cli.calls import call

FOLDER = Path(__file__).parents[2] / "examples" / "auto"
FOLDS_OF_AB = [u / (1 - u) * exp(-14 * u / 3) for u in ((1 - sqrt(1 / 7)) / 2, (1 + sqrt(1 / 7)) / 2)]
FOLD = 2 / (3 * sqrt(3))  # of mu + x - x^3
BRATU = 3.513830719125161  # 8 k^2 / cosh(k)^2 where k tanh(k) = 1
HEIGHT_TWO = 8 * acosh(e) ** 2 / e**2  # Bratu's solution 2 log(cosh(k)/cosh(k (1 - 2 t))) of height 2

def saturation(slope: float, low: float, high: float) -> float:
    """s0 = s + 100 R(s) where R(s) = s/(1 + s + s^2) has this slope, between two values of s."""
    s = brentq(lambda s: (1 - s * s) / (1 + s + s * s) ** 2 - slope, low, high, xtol=1e-15)
    return float(s + 100 * s / (1 + s + s * s))


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
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(WANTED))
def test_a_demo_of_auto(name, tmp_path):
    out = tmp_path / "out.json"
    call("run", str(FOLDER / f"{name}.yaml"), "--quiet", "--json", str(out))
    branches = {branch["name"]: branch for branch in json.loads(out.read_text())["branches"]}
    for place, (parameter, expected) in WANTED[name].items():
        branch, type_ = place.split(".")
        found = sorted(p["values"][parameter] for p in branches[branch]["points"] if p["type"] == type_)
        assert found == pytest.approx(sorted(expected), rel=3e-7, abs=1e-7), place


def test_the_fold_of_a_complex_equation_has_two_null_vectors_and_no_coefficients(tmp_path):
    """F(u + iv) is analytic: its derivative vanishes on q and on i q at once."""
    out = tmp_path / "out.json"
    call("run", str(FOLDER / "ezp.yaml"), "--quiet", "--json", str(out))
    (point,) = json.loads(out.read_text())["branches"][0]["points"]
    assert point["normal_form"] == {"kind": "degenerate", "kernel": 2}


def run(name, folder):
    out = folder / "out.json"
    call("run", str(FOLDER / f"{name}.yaml"), "--quiet", "--json", str(out))
    return {branch["name"]: branch["columns"] for branch in json.loads(out.read_text())["branches"]}


def test_an_eigenvalue_under_a_condition(tmp_path):
    """u = a sin(k (1 - t)), k = pi p1, with u(0) = p2 and integral(u^2) = a^2 (1/2 - sin(2 k)/(4 k)) = 1/2."""
    columns = run("lin", tmp_path)["eigenvalue"]
    for p1, p2 in zip(columns["p1"], columns["p2"], strict=True):
        k = pi * p1
        assert p2 == pytest.approx(abs(sin(k)) / sqrt(1 - sin(2 * k) / (2 * k)), abs=1e-6)


def test_a_problem_that_depends_on_the_place_ends_where_its_trajectory_does(tmp_path):
    columns = run("non", tmp_path)["line"]
    for row in (len(columns["p1"]) // 2, -1):
        p1 = columns["p1"][row]
        start = [0.0, columns["u2.start"][row]]
        end = solve_ivp(lambda x, u, p1=p1: [u[1], -p1 * exp(x**3 * u[0])], (0, 1), start, rtol=1e-11, atol=1e-12)
        assert end.y[:, -1] == pytest.approx([0.0, columns["u2.end"][row]], abs=1e-7)
