"""The table of special point types: its names lead somewhere, and its rows agree with one another."""

import pytest

from contin.normalforms.result import NormalForm
from contin.special import table as types
from contin.special.table import (
    UNKNOWN,
    codes,
    crossings,
    curves_of_orbits,
    function,
    of_cycle,
    signs_of_points,
    special_type,
    table,
)
from contin.transitions.registry import everything

POINTS, ORBITS = ("LP", "HB", "BP", "PD", "NS"), ("LPC", "BPC", "PD", "NS")


@pytest.mark.parametrize("code", [code for code, row in table().items() if row.normal_form])
def test_a_normal_form_is_a_function_of_a_jet(code):
    assert function(special_type(code).normal_form).__annotations__["return"] == NormalForm.__name__


def test_births_are_leaves_that_say_so_of_the_type():
    leaves = {}
    for row in everything():
        name = row.make.__module__.rpartition(".")[2]
        leaves.setdefault(name, set()).update(row.labels)
    for code, row in table().items():
        for name in row.births:
            assert code in leaves[name], (code, name)
    for name, labels in leaves.items():
        for code in labels:
            row = special_type(code)
            named = name in row.births or name in ("locus_to_loci", "map_to_births_of_iterate")
            assert named, f"{name} is born at {code}, whose row does not name it"


@pytest.mark.parametrize("locus", POINTS)
def test_the_tests_of_a_curve_of_points_are_one_for_each_type_of_flows_and_of_maps(locus):
    of_flows, of_maps = signs_of_points(locus, False), signs_of_points(locus, True)
    seen = {code: index for signs in (of_flows, of_maps) for index, (code, _) in signs.items()}
    assert seen == types.tests_of_points(locus)
    for code in seen:
        assert locus in special_type(code).on


@pytest.mark.parametrize("locus", ORBITS)
def test_the_tests_of_a_curve_of_cycles_stand_one_after_the_other(locus):
    rows = [special_type(code) for code in types.tests_of_orbits(locus)]
    assert [row.orbits[locus] for row in rows] == list(range(2, 2 + len(rows)))
    assert all(locus in row.on for row in rows)


def test_flips_and_resonances_of_connections_stand_in_the_order_of_their_tests():
    assert types.tests_of_connections() == (
        "NSS", "NCH", "OFS", "OFU", "IFS", "IFU", "DRS", "DRU", "NDS", "NDU", "TLS", "TLU",
    )


def test_curves_that_meet_are_those_of_the_points_with_folds_of_cycles_for_folds():
    assert curves_of_orbits("LPPD") == ("LPC", "PD")
    assert of_cycle("BP") == "BPC"
    assert of_cycle("NS") == "NS"
    assert curves_of_orbits("CP") == ()


def test_a_type_lies_on_branches_or_on_curves_by_its_codimension():
    for code, row in table().items():
        kinds = ("equilibrium", "fixed-point", "orbit", "algebraic", "bvp", "connection")
        where = kinds if row.codimension < 2 else (*POINTS, "LPC", "BPC", "HOM")
        where = (*where, "CP", "BT", "GH", "ZH", "HH") if row.codimension > 2 else where
        assert row.on, code
        assert set(row.on) <= set(where), code
        assert row.condition, code
        assert (row.source != "") is (row.codimension > 0), code


def test_the_explorer_of_a_plane_turns_off_at_points_where_curves_of_another_type_pass():
    assert set(crossings()) == {
        "BT", "ZH", "HH", "DP", "GH", "R1", "R2", "GPD", "LPPD", "LPNS", "PDNS", "NSNS",
    }  # fmt: skip
    assert set(codes("equilibrium")) == {"LP", "BP", "HB", "BE"}


def test_a_type_of_a_later_version_is_a_special_point():
    assert special_type("XYZ") is UNKNOWN
    assert special_type("XYZ").plural == "special points"
