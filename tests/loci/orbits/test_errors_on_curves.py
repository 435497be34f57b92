"""Extrema and user values on curves of folds of cycles: their errors hold the mesh's own share.

u' = u g - w v, v' = v g + w u with g = p + a R - R^2, R = u^2 + v^2, w = 1 + R/2 and x = u + 2/5 v^2, y = v. Cycles
fold at R = a/2, p = -a^2/4. With a = 1 + (q - 3/10)^2 the curve turns in p at q = 3/10.
"""

from math import pi

import pytest

import contin
from contin import api

U = "(x - 0.4*y^2)"
R = f"({U}^2 + y^2)"
G = f"(p + a(q)*{R} - {R}^2)"
TURN = f"(1 + {R}/2)"
PULLED_EQUATIONS = {"x": f"{U}*{G} - {TURN}*y + 0.8*y*(y*{G} + {TURN}*{U})", "y": f"y*{G} + {TURN}*{U}"}
PULLED = contin.Model(
    "pulled", states={"x": 0, "y": 0}, parameters={"p": -0.5, "q": 0.0},
    functions={"a(q)": "1 + (q - 0.3)^2"},
    equations=PULLED_EQUATIONS,
)  # fmt: skip

GROWING = contin.Model(
    "growing", states={"x": 0, "y": 0}, parameters={"p": -0.5, "q": 0.0},
    functions={"w(R, q)": "1 + R/2 + (q - 0.3)^2"},
    equations={
        name: text.replace("a(q)*", "").replace(TURN, f"w({R}, q)") for name, text in PULLED_EQUATIONS.items()
    },
)  # fmt: skip


def a_at(q):
    return 1.0 + (q - 0.3) ** 2


@pytest.mark.parametrize("intervals", [6, 10, None])
def test_extrema_and_user_values_hold_the_error_of_the_mesh(intervals):
    """And of trajectories, by shooting (None)."""
    settings = {"intervals": intervals} if intervals else {"method": "shooting"}
    line = api.continuation(api.equilibrium(PULLED), "p", (-1, 1))
    cycles = api.continuation(line["HB1"].switch(), "p", (-1, 1), settings=settings)
    curve = api.continuation(
        cycles["LPC1"].locus(), ["p", "q"], {"p": (-1, 1), "q": (-1, 1)}, extrema=["p"], values={"q": [0.55]},
        settings=settings,
    )  # fmt: skip
    (turn,), (value,) = ([point for point in curve.points if point.type == type_] for type_ in ("EX", "UZ"))
    for point, q in ((turn, 0.3), (value, 0.55)):
        off = abs(point.values["p"] + a_at(q) ** 2 / 4)
        assert (1e-12 if intervals else 0.0) <= off <= point.error < (10.0 * off if intervals else 1e-12)
    assert abs(turn.values["q"] - 0.3) <= turn.errors["q"] < 1e-10


@pytest.mark.parametrize("intervals", [6, None])
@pytest.mark.seldom
def test_orbits_of_one_period(intervals):
    """T = 4.5 = 2 pi/(1 + R/2 + (q - 3/10)^2) and p = R^2 - R."""
    settings = {"intervals": intervals} if intervals else {"method": "shooting"}
    line = api.continuation(api.equilibrium(GROWING), "p", (-1, 1))
    cycles = api.continuation(line["HB1"].switch(), "p", (-1, 1), values={"period": [4.5]}, settings=settings)
    curve = api.continuation(
        cycles["UZ1"].locus(), ["p", "q"], {"p": (-1, 3), "q": (-1, 1)}, extrema=["p"], values={"q": [0.55]},
        settings=settings,
    )  # fmt: skip
    assert len(curve.points) == 4
    for point in curve.points:
        square = 2.0 * (2.0 * pi / 4.5 - 1.0 - (point.values["q"] - 0.3) ** 2)
        off = abs(point.values["p"] - square**2 + square)
        assert (1e-12 if intervals else 0.0) <= off <= point.error < (10.0 * off if intervals else 1e-12)
