"""Births are found by the kind of the branch and the label, and only the leaves that are needed are imported."""

import subprocess
import sys
from types import SimpleNamespace

import pytest

import contin
from contin.errors import InputError
from contin.transitions import registry
from contin.transitions.births import departures, loci, switch
from contin.transitions.registry import Explored, born, everything

PITCHFORK = {"states": {"x": 0, "y": 0}, "parameters": {"p": -1.0, "q": 0.0}}


@pytest.fixture(scope="module")
def fork():
    model = contin.Model("fork", **PITCHFORK, equations={"x": "p*x - x^3", "y": "q - y"})
    return contin.continuation(contin.equilibrium(model), "p", (-1, 1))["BP1"]


class Mine:
    kind = "equilibrium"


class Special(Mine):
    pass


@pytest.fixture
def rows(monkeypatch):
    everything()
    mine: list[registry.Transition] = []
    monkeypatch.setattr(registry, "_rows", mine)
    return mine


def birth(*seeds):
    return lambda problem, point, parameter: list(seeds)


def point(type_):
    return SimpleNamespace(type=type_, branch="line", label=f"{type_}1", problem=None, normal_form={})


def test_curves_of_orbits_are_made_only_where_they_are_wanted(rows):
    born(Mine, "BT", "the other curve", parameters=2)(birth("curve"))
    born(Mine, "BT", "orbits", parameters=2, order=1, explored=Explored(orbits=True))(birth("orbits"))
    assert loci(Mine(), point("BT"), ("p", "q")) == ["curve", "orbits"]
    assert loci(Mine(), point("BT"), ("p", "q"), orbits=False) == ["curve"]


def test_a_row_for_the_label_comes_before_one_for_all_and_a_class_before_its_base(rows):
    born(Mine, "", "anything")(birth("any"))
    born(Mine, "LP", "at folds")(birth("fold"))
    born(Special, "LP", "at special folds")(birth("special"))
    assert switch(Mine(), point("LP"), "p") == ["fold"]
    assert switch(Mine(), point("HB"), "p") == ["any"]
    assert switch(Special(), point("LP"), "p") == ["special"]
    assert switch(Special(), point("HB"), "p") == ["any"]


def test_several_births_at_one_point_stand_in_their_order(rows):
    born(Mine, "LP", "the second", order=1)(birth("b"))
    born(Mine, "LP BP", "the first")(birth("a"))
    assert switch(Mine(), point("LP"), "p") == ["a", "b"]


def test_curves_are_not_branches(rows):
    born(Mine, "LP", "the curve", parameters=2)(birth("curve"))
    assert loci(Mine(), point("LP"), ("p", "q")) == ["curve"]
    with pytest.raises(InputError, match=r"line\.LP1: nothing is known to be born at points of type LP"):
        switch(Mine(), point("LP"), "p")
    with pytest.raises(InputError, match=r"line\.BP1: BP has no curve in two parameters; LP have"):
        loci(Mine(), point("BP"), ("p", "q"))


def test_the_explorer_asks_the_columns_of_the_table(rows):
    born(Mine, "LP", "by hand only")(birth("a"))
    born(Mine, "BP", "always", explored=Explored())(birth("b"))
    born(Mine, "HB", "orbits", explored=Explored(orbits=True))(birth("c"))
    born(Mine, "PD", "never here", explored=Explored(when=lambda problem: False))(birth("d"))
    followed = {code: departures(Mine(), point(code), "p", orbits=False) for code in ("LP", "BP", "HB", "PD")}
    assert followed == {"LP": [], "BP": ["b"], "HB": [], "PD": []}
    assert departures(Mine(), point("HB"), "p", orbits=True) == ["c"]


def test_a_birth_that_may_fail_without_news_fails_without_news(rows):
    def nothing(problem, point, parameter):
        raise InputError("no orbit was found")

    born(Mine, "HOM", "perhaps", explored=Explored(uncertain=True))(nothing)
    assert departures(Mine(), point("HOM"), "p", orbits=True) == []
    with pytest.raises(InputError, match="no orbit was found"):
        switch(Mine(), point("HOM"), "p")


def test_a_point_of_a_branch_asks_the_table(fork):
    assert len(fork.switch()) == 1
    assert {seed.problem.locus for seed in fork.locus(("p", "q"))} == {"BP"}


@pytest.mark.parametrize(
    ("name", "kind", "label", "needed"),
    [
        ("equilibrium_HB_to_orbits", "equilibrium", "HB", True),
        ("equilibrium_HB_to_orbits", "equilibrium", "BP", False),
        ("equilibrium_BP_to_branches", "fixed-point", "BP", True),
        ("orbit_PD_to_doubled_by_shooting", "orbit", "PD", True),
        ("map_PD_to_doubled", "orbit", "PD", False),
        ("HH_to_tori", "locus", "HH", True),
        ("locus_to_equilibria", "locus", "XYZ", True),
        ("orbit_to_locus", "orbit", "LPC", False),  # in two parameters only
    ],
)
def test_names_of_leaves_tell_when_they_are_needed(name, kind, label, needed):
    assert registry._needed(name, kind, label, 1) is needed


def test_following_equilibria_imports_no_birth_of_orbits():
    code = (
        "import sys, contin; from contin.transitions.births import explored\n"
        "m = contin.Model('m', states={'x': 0}, parameters={'p': -1.0}, equations={'x': 'p*x - x^3'})\n"
        "d = contin.diagram(m, 'p', (-1, 1))\n"
        "print([n for n in sys.modules if n.startswith('contin.transitions.orbit')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
