"""A special point on a bound of the run is found, one beyond the bound is not, one before it is: also by rounding."""

import pytest

import contin
from contin import api

OFF = [0.0, 1e-15, -1e-9, 1e-9, 1e-6]  # how far beyond the point the bound lies, but for the third


def spiral(at, bent="-1"):
    """r' = r (p - at + bent r^2), turned so that states and rates are not those of the plain formula."""
    r2 = "((x - 0.3)^2 + (y - 0.1)^2)"
    return contin.Model(
        "spiral", states={"x": 0.3, "y": 0.1}, parameters={"p": at - 1.0, "q": -1.0},
        equations={
            "x": f"(p - {at} + ({bent})*{r2})*(x - 0.3) - 1.3*(y - 0.1)",
            "y": f"1.3*(x - 0.3) + (p - {at} + ({bent})*{r2})*(y - 0.1)",
        },
    )  # fmt: skip


def assert_one(branch, type_, name, at, off):
    """One label where the bound is not before the point, at most one where rounding decides that."""
    found = [p for p in branch.points if p.type == type_]
    if off < -1e-12:
        assert found == []
        return
    assert len(found) == 1
    assert abs(found[0].values[name] - at) <= max(found[0].error, 4e-16)
    assert found[0].values[name] <= at + off
    assert branch.columns[name].max() <= at + off


@pytest.mark.parametrize("off", OFF)
@pytest.mark.parametrize("at", [0.0, 0.1, 1 / 3])
def test_hopf_point(at, off):
    line = api.continuation(api.equilibrium(spiral(at)), "p", (at - 1.0, at + off))
    assert_one(line, "HB", "p", at, off)


@pytest.mark.parametrize("off", OFF)
def test_doubling_and_circle_of_maps(off):
    logistic = contin.Model(
        "logistic", kind="map", states={"x": 0.6}, parameters={"r": 2.5}, equations={"x": "r*x*(1 - x)"}
    )
    assert_one(api.continuation(api.equilibrium(logistic), "r", (2.0, 3.0 + off)), "PD", "r", 3.0, off)
    delayed = contin.Model(
        "delayed", kind="map", states={"x": 0.4, "y": 0.4}, parameters={"a": 1.8},
        equations={"x": "a*x*(1 - y)", "y": "x"},
    )  # fmt: skip
    assert_one(api.continuation(api.equilibrium(delayed), "a", (1.5, 2.0 + off)), "NS", "a", 2.0, off)


@pytest.mark.parametrize("off", OFF)
def test_generalised_hopf_point_on_a_curve(off):
    """l1 is proportional to q: GH at q = 0."""
    line = api.continuation(api.equilibrium(spiral(0.0, "q")), "p", (-1.0, 1.0))
    curve = api.continuation(line["HB1"].locus(), ["p", "q"], {"p": (-1.0, 1.0), "q": (-2.0, off)})
    assert_one(curve, "GH", "q", 0.0, off)


@pytest.mark.parametrize("wide", [1e12, 1e-3])
@pytest.mark.parametrize("off", [0.0, -1e-7, 1e-7])
def test_the_range_of_one_parameter_says_nothing_about_the_bound_of_the_other(off, wide):
    line = api.continuation(api.equilibrium(spiral(0.0, "q")), "p", (-1.0, 1.0))
    curve = api.continuation(line["HB1"].locus(), ["p", "q"], {"p": (-wide, wide), "q": (-2.0, off)})
    assert_one(curve, "GH", "q", 0.0, off)


@pytest.mark.parametrize("off", [0.0, -1e-6, 1e-6])
def test_doubling_of_cycles(off):
    """A cycle of radius 1 around which (u, v) make half a turn and grow: multipliers -exp(2 pi p), -exp(-2 pi)."""
    model = contin.Model(
        "strip", states={"x": 1, "y": 0, "u": 0, "v": 0}, parameters={"p": -0.5},
        equations={
            "x": "x*(1 - x^2 - y^2) - y", "y": "y*(1 - x^2 - y^2) + x",
            "u": "((p - 1)/2 + (p + 1)/2*x)*u + ((p + 1)/2*y - 1/2)*v - u*(u^2 + v^2)",
            "v": "((p + 1)/2*y + 1/2)*u + ((p - 1)/2 - (p + 1)/2*x)*v - v*(u^2 + v^2)",
        },
    )  # fmt: skip
    cycle = api.periodic_orbit(model, start={"x": 1, "y": 0, "u": 0, "v": 0}, period=6.283185307179586)
    family = api.continuation(cycle, "p", (-0.5, off))
    found = [p for p in family.points if p.type == "PD"]
    assert len(found) == (off >= 0.0)
    assert all(abs(p.values["p"]) <= p.error for p in found)
