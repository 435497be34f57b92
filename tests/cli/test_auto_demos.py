"""Demos of AUTO-07p as run files: what they find beside closed forms and published numbers."""

import json
from math import acosh, e, exp, sqrt
from pathlib import Path

import pytest

from tests.cli.calls import call

FOLDER = Path(__file__).parents[2] / "examples" / "auto"
FOLDS_OF_AB = [u / (1 - u) * exp(-14 * u / 3) for u in ((1 - sqrt(1 / 7)) / 2, (1 + sqrt(1 / 7)) / 2)]
FOLD = 2 / (3 * sqrt(3))  # of mu + x - x^3
BRATU = 3.513830719125161  # 8 k^2 / cosh(k)^2 where k tanh(k) = 1
HEIGHT_TWO = 8 * acosh(e) ** 2 / e**2  # Bratu's solution 2 log(cosh(k)/cosh(k (1 - 2 t))) of height 2

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
