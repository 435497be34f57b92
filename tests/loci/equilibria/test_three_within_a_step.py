"""Three points of codimension two within one step of a curve: all are labelled, or a note says what cannot be told.

Planted where q (q - e) (q + e) = 0 on Hopf curves p = 0, and at q = 0 and twice at -e^4/4 on a curve of folds.
"""

import pytest

import contin
from contin import api

SPACINGS = [0.05, 0.01, 1e-3, 1e-4, 1e-6]
R2 = "(x^2 + y^2)"
HOPF = {"x": f"p*x - y - x*{R2}", "y": f"x + p*y - y*{R2}"}


def model(equations):
    states = {name: {"value": 0.0, "scale": 1} for name in equations}
    return contin.Model("planted", states=states, parameters={"p": -0.5, "q": -0.73}, equations=equations)


def on_hopf_curve(equations):
    line = api.continuation(api.equilibrium(model(equations)), "p", (-0.5, 0.5))
    return api.continuation(line["HB1"].locus(), ["p", "q"], {"p": (-1.0, 1.0), "q": (-1.0, 1.0)})


def generalised(factor):
    bent = f"({factor})*{R2} - {R2}^2"
    return {"x": f"p*x - y + x*({bent})", "y": f"x + p*y + y*({bent})"}


def with_zero(factor):
    return {**HOPF, "z": f"({factor})*z - z^3"}


def with_pair(factor):
    size = "(z^2 + w^2)"
    return {**HOPF, "z": f"({factor} - {size})*z - 1.7*w", "w": f"1.7*z + ({factor} - {size})*w"}


@pytest.mark.parametrize("e", SPACINGS)
@pytest.mark.parametrize(("type_", "equations"), [("GH", generalised), ("ZH", with_zero), ("HH", with_pair)])
def test_on_a_curve_of_hopf_points(type_, equations, e):
    curve = on_hopf_curve(equations(f"10*q*(q - {e})*(q + {e})"))
    found = sorted(point.values["q"] for point in curve.points)
    assert {point.type for point in curve.points} <= {type_}
    if len(found) == 3:
        assert found == pytest.approx([-e, 0.0, e], abs=1e-6 * e)
        return
    assert e < 1e-3
    words = ("degenerate, or others lie closer", "lost in their rounding errors", "others lie about")
    assert any(word in note for note in curve.notes for word in words)
    assert all(min(abs(q - at) for at in (-e, 0.0, e)) < e for q in found)


@pytest.mark.parametrize("e", [0.05, 0.01, 1e-3, 1e-4])
def test_cusps_on_a_curve_of_folds(e):
    """f = p + q x - x^5/5 + e^2 x^3/3: folds at q = x^4 - e^2 x^2, cusps where that turns."""
    cubic = model({"x": f"p + q*x - x^5/5 + {e}^2*x^3/3"})
    line = api.continuation(api.equilibrium(cubic, {"x": 1.1}, {"p": 0.0, "q": 0.5}), "p", (-1.0, 1.0))
    fold = next(point for point in line.points if point.type == "LP")
    curve = api.continuation(fold.locus(), ["p", "q"], {"p": (-1.0, 1.0), "q": (-1.0, 1.0)})
    assert [point.type for point in curve.points] == ["CP"] * 3
    expected = [-(e**4) / 4, -(e**4) / 4, 0.0]
    assert sorted(point.values["q"] for point in curve.points) == pytest.approx(expected, rel=1e-6, abs=1e-20)
