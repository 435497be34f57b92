"""Curves from points whose branch came from far away: a gas whose liquid has a thousandth of its volume."""

import pytest

import contin


@pytest.mark.parametrize("kind", ["flow", "algebraic"])
@pytest.mark.parametrize("unit", [1.0, 1e-3])
def test_the_spinodals_of_a_van_der_waals_gas_meet_in_its_critical_point(kind, unit):
    """P = R T/(v - b) - a/v^2: v = 3 b, T = 8 a/(27 R b), P = a/(27 b^2); from a gas 600 times as thin."""
    b, a, r = 4e-5 * unit, 0.36 * unit, 8.314  # volumes in `unit`s, and a in units of P v^2 with P / unit
    model = contin.Model(
        name="gas", kind=kind, states={"v": 2e-2 * unit}, parameters={"P": 1e5, "T": 250},
        equations={"v": f"{r * unit}*T/(v - {b}) - {a * unit}/v^2 - P"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "P", (1e4, 1e7))
    ends = {"P": (1e4, 1e7), "T": (200, 340)}
    curve = contin.continuation(line["LP1"].locus(), ("P", "T"), ends)
    assert [p.type for p in curve.points] == ["CP"]
    point = curve["CP1"]
    assert point.values["v"] == pytest.approx(3.0 * b, rel=1e-6)
    assert point.values["T"] == pytest.approx(8.0 * a / (27.0 * r * b), rel=1e-9)
    assert point.values["P"] == pytest.approx(a * unit / (27.0 * b * b), rel=1e-9)
    v, p, t = (curve.columns[name] for name in "vPT")
    assert t == pytest.approx(2.0 * a * (v - b) ** 2 / (r * v**3), rel=1e-8)
    assert p == pytest.approx(r * unit * t / (v - b) - a * unit / v**2, rel=1e-8)
    assert {end.reason for end in curve.ends} == {"bound"}
