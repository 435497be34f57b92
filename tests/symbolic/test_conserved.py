"""Conserved totals: found, proved, eliminated; the reduced system is the one that a person would write."""

from __future__ import annotations

import copy  # by the model's text, as pickling

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.printing import to_text
from contin.symbolic.calculus.monomials import Monomials
from contin.symbolic.passes.conserved import without_conserved
from contin.symbolic.passes.conserved_laws import conserved_laws

SWITCH = {"X": "-k1*X/(J + X) + k2*XP/(J + XP)", "XP": "k1*X/(X + J) - k2*XP/(XP + J)"}


def switch(**entries):
    values = {"k1": 1.0, "k2": 0.9, "J": 0.05}
    return contin.Model("switch", states={"X": 0.7, "XP": 0.3}, parameters=values, equations=SWITCH, **entries)


def goldbeter_koshland(v1, v2, J):
    """Phosphorylated part in the steady state (Goldbeter and Koshland, PNAS 78, 1981), total 1."""
    b = v2 - v1 + v2 * J + v1 * J
    return 2 * v1 * J / (b + np.sqrt(b * b - 4 * (v2 - v1) * v1 * J))


def laws_of(model):
    return [{n: float(c.value) for n, c in law.coefficients.items()} for law in conserved_laws(model)]


def test_the_switch_of_goldbeter_and_koshland_along_its_whole_curve():
    branch = contin.continuation(contin.equilibrium(switch()), "k1", (0.1, 3.0))
    assert branch.columns["XP"] == pytest.approx(goldbeter_koshland(branch.columns["k1"], 0.9, 0.05), rel=1e-9)
    assert branch.columns["X"] + branch.columns["XP"] == pytest.approx(np.ones(len(branch)), rel=1e-14)
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    assert "X + XP is conserved" in branch.notes[0]


def test_the_total_is_a_parameter_that_can_be_varied_and_set():
    branch = contin.continuation(contin.equilibrium(switch()), "total_X", (0.2, 5.0))
    assert branch.columns["X"] + branch.columns["XP"] == pytest.approx(branch.columns["total_X"], rel=1e-13)
    found = contin.equilibrium(switch(), {"X": 2.0, "XP": 0.5})
    assert found.p[-1] == 2.5  # the start's own total
    assert contin.equilibrium(switch(), {"X": 2.0, "XP": 0.5}, {"total_X": 4.0}).p[-1] == 4.0  # what is said wins
    assert contin.equilibrium(switch(), [2.0, 0.5]).p[-1] == 2.5


def test_named_starts_have_totals_of_their_own():
    reduced = without_conserved(switch(starts={"far": {"X": 3, "parameters": {"k1": 2}}}))
    u, p = reduced.start_point("far")
    assert (u.tolist(), p.tolist()) == ([0.3], [2.0, 0.9, 0.05, 3.3])


def test_the_reduced_model_survives_being_written_and_read():
    reduced = without_conserved(switch(starts={"far": {"X": 3}}))
    again = copy.copy(reduced)
    assert (again, again.totals, again.text()) == (reduced, reduced.totals, reduced.text())
    assert again.start_point({"X": 1, "XP": 2})[1][-1] == 3.0


def test_it_is_turned_off_by_a_key():
    model = switch(conserved=False)
    assert without_conserved(model) is model
    assert "conserved: false" in model.text()
    assert copy.copy(model).conserved is False


def test_laws_of_an_enzyme_are_its_moieties():
    """S + E <-> ES -> P + E (Michaelis and Menten): E + ES and S + ES + P."""
    rates = {
        "ES": "k1*S*E - (km + k2)*ES", "S": "-k1*S*E + km*ES", "E": "(km + k2)*ES - k1*S*E", "P": "k2*ES",
    }  # fmt: skip
    model = contin.Model("mm", states=dict.fromkeys(rates, 1), parameters={"k1": 1, "km": 2, "k2": 3}, equations=rates)
    assert laws_of(model) == [{"ES": 1, "S": 1, "P": 1}, {"ES": 1, "E": 1}]


@pytest.mark.parametrize("seed", range(12))
def test_laws_of_random_networks_span_the_left_kernel_of_their_stoichiometry(seed):
    """Mass action of generic complexes: c . f = 0 for all x and k exactly where c . N = 0 (Horn and Jackson 1972)."""
    chance = np.random.default_rng(seed)
    n, reactions = 7, 6
    left, right = (chance.integers(0, 3, (n, reactions)) * (chance.random((n, reactions)) < 0.3) for _ in range(2))
    change = right - left
    keep = change.any(axis=0)
    left, change = left[:, keep], change[:, keep]
    left = np.vstack([left, np.arange(left.shape[1])])  # a catalyst makes every rate different
    change = np.vstack([change, np.zeros(left.shape[1], int)])
    states = [f"A{i}" for i in range(n + 1)]
    rate = [f"k{j}" + "".join(f"*{s}^{e}" for s, e in zip(states, left[:, j], strict=True) if e)
            for j in range(left.shape[1])]  # fmt: skip
    equations = {
        s: " + ".join(f"({change[i, j]})*{rate[j]}" for j in range(len(rate)) if change[i, j]) or "0"
        for i, s in enumerate(states)
    }
    parameters = {f"k{j}": float(chance.uniform(0.1, 5)) for j in range(len(rate))}
    model = contin.Model("network", states=dict.fromkeys(states, 1.3), parameters=parameters, equations=equations)
    found = laws_of(model)
    matrix = np.array([[law.get(s, 0.0) for s in states] for law in found]).reshape(-1, n + 1)
    assert len(found) == n + 1 - np.linalg.matrix_rank(change)
    assert np.linalg.matrix_rank(matrix) == len(found)
    assert np.all(matrix @ change == 0.0)


def test_amounts_in_compartments_are_weighted_by_their_volumes():
    model = contin.Model(
        "cell", states={"A": 2.0, "B": 1.0}, parameters={"k": 1.0, "q": 0.5, "V": 2.0, "W": 3.0},
        equations={"A": "(q*B - k*A)/V", "B": "(k*A - q*B)/W"},
    )  # fmt: skip
    (law,) = conserved_laws(model)
    assert {n: to_text(c) for n, c in law.coefficients.items()} == {"A": "V", "B": "W"}
    branch = contin.continuation(contin.equilibrium(model), "V", (0.5, 4.0))
    volume, a, b = (branch.columns[n] for n in ("V", "A", "B"))
    assert volume * a + 3.0 * b == pytest.approx(np.full(len(branch), 7.0), rel=1e-13)
    assert a == pytest.approx(0.5 * b, rel=1e-12)


def test_of_maps_it_is_what_the_map_leaves_as_it_is():
    model = contin.Model(
        "map", kind="map", states={"x": 0.3, "y": 0.5}, parameters={"a": 0.7},
        equations={"x": "x + a*x*y - 0.5*x", "y": "y - a*x*y + 0.5*x"},
    )  # fmt: skip
    assert laws_of(model) == [{"x": 1, "y": 1}]
    branch = contin.continuation(contin.equilibrium(model, {"x": 0.1, "y": 0.7}), "a", (0.65, 0.8))
    assert branch.columns["y"] == pytest.approx(0.5 / branch.columns["a"], rel=1e-10)
    assert branch.kind == "fixed-point"


def test_a_state_that_nothing_moves_is_a_total_of_its_own():
    rates = {"x": "c - a*x", "c": "0"}
    model = contin.Model("held", states={"x": 1.0, "c": 2.0}, parameters={"a": 1.0}, equations=rates)
    branch = contin.continuation(contin.equilibrium(model), "total_c", (1.0, 3.0))
    assert branch.columns["x"] == pytest.approx(branch.columns["c"], rel=1e-12)


def test_a_law_that_only_numbers_show_states_its_error():
    model = contin.Model(
        "circle", states={"x": 1.0, "y": 0.4}, parameters={"a": 1.0},
        equations={"x": "a*(1 - x/(x + y))*x - x", "y": "x - a*y/(x + y)*x"},
    )  # fmt: skip
    (law,) = conserved_laws(model)
    assert 0.0 < law.error < 1e-12
    assert "random states" in without_conserved(model).totals[0].note


@pytest.mark.parametrize(
    "equations",
    [
        {"x": "y", "y": "-x"},  # an energy is not linear
        {"x": "y + e*(x + y)", "y": "-y"},  # conserved at the parameter's value, not at others
        {"x": "a*y if x > -100 else 1", "y": "-a*y if y > -100 else 0"},  # conserved where one looks
    ],
)
def test_nothing_is_eliminated_that_is_not_a_linear_law_everywhere(equations):
    model = contin.Model("none", states={"x": 1.0, "y": 0.5}, parameters={"a": 1.0, "e": 0.0}, equations=equations)
    assert all(law.error > 0.0 for law in conserved_laws(model))
    if "if" not in equations["x"]:
        assert conserved_laws(model) == ()


@pytest.mark.parametrize(
    "equations",
    [
        {"x": "x - y if x < 0 else 1", "y": "x + y if x < 0 else 0.5"},  # x - 2 y on one side of the surface alone
        {"x": "1 if x < 2000 else 3", "y": "2 if x < 2000 else -1"},  # 2 x - y, up to far beyond the start
        {"x": "-abs(x)", "y": "x"},
        {"x": "2*sign(y) - x*y", "y": "x*abs(y) - 2"},  # x + y where y > 0
    ],
)
def test_a_law_of_one_side_of_a_surface_is_none(equations):
    model = contin.Model("sided", states={"x": 1.0, "y": 0.3}, parameters={}, equations=equations)
    assert conserved_laws(model) == ()


def test_a_law_that_holds_on_both_sides_of_a_surface_is_found():
    """sin(2 x) = 2 sin(x) cos(x) is told by numbers alone; the choice of formula is the same in both equations."""
    equations = {"x": "-sin(2*x) if x > 0.4 else -y", "y": "2*sin(x)*cos(x) if x > 0.4 else y"}
    model = contin.Model("both", states={"x": 1.0, "y": 0.3}, parameters={}, equations=equations)
    assert laws_of(model) == [{"x": 1.0, "y": 1.0}]


def test_models_without_laws_pay_one_evaluation_and_no_expansion(monkeypatch):
    monkeypatch.setattr(Monomials, "expand", lambda *_: pytest.fail("multiplied out"))
    assert conserved_laws(contin.load("classics/brusselator")) == ()


def double_phosphorylation():
    """S0 <-> S1 <-> S2 by a kinase E and a phosphatase F, distributive (Markevich, Hoek, Kholodenko, 2004)."""
    reactions = [
        (("S0", "E"), ("C0",), "a1"), (("C0",), ("S0", "E"), "b1"), (("C0",), ("S1", "E"), "c1"),
        (("S1", "E"), ("C1",), "a2"), (("C1",), ("S1", "E"), "b2"), (("C1",), ("S2", "E"), "c2"),
        (("S2", "F"), ("D2",), "a3"), (("D2",), ("S2", "F"), "b3"), (("D2",), ("S1", "F"), "c3"),
        (("S1", "F"), ("D1",), "a4"), (("D1",), ("S1", "F"), "b4"), (("D1",), ("S0", "F"), "c4"),
    ]  # fmt: skip
    states = {"S0": 10.0, "S1": 0.0, "S2": 0.0, "E": 1.0, "F": 1.0, "C0": 0.0, "C1": 0.0, "D1": 0.0, "D2": 0.0}
    values = {
        "a1": 2, "b1": 1, "c1": 0.5, "a2": 8, "b2": 1, "c2": 10,
        "a3": 8, "b3": 1, "c3": 0.5, "a4": 2, "b4": 1, "c4": 10,
    }  # fmt: skip
    terms = {s: [] for s in states}
    for before, after, k in reactions:
        rate = "*".join([k, *before])
        for s in before:
            terms[s].append(f"- {rate}")
        for s in after:
            terms[s].append(f"+ {rate}")
    return states, values, {s: " ".join(t) for s, t in terms.items()}


def test_labels_of_the_bistable_double_phosphorylation_are_those_of_the_system_reduced_by_hand():
    states, values, equations = double_phosphorylation()
    model = contin.Model("sites", states=states, parameters=values, equations=equations)
    assert {frozenset(law) for law in laws_of(model)} == {
        frozenset({"S0", "S1", "S2", "C0", "C1", "D1", "D2"}), frozenset({"E", "C0", "C1"}),
        frozenset({"F", "D1", "D2"}),
    }  # fmt: skip
    gone = {"S1": "(T - S0 - S2 - C0 - C1 - D1 - D2)", "C1": "(Et - E - C0)", "D2": "(Ft - F - D1)"}
    hand = contin.Model(
        "hand", states={s: v for s, v in states.items() if s not in gone},
        parameters={**values, "T": 10.0, "Et": 1.0, "Ft": 1.0},
        definitions={s: e.strip("()") for s, e in gone.items()},
        equations={s: e for s, e in equations.items() if s not in gone},
    )  # fmt: skip
    start = {"S0": 9.0, "S1": 0.05, "S2": 0.01, "E": 0.2, "F": 0.9, "C0": 0.8, "C1": 0.0, "D1": 0.04, "D2": 0.0}
    found = {}
    for name, one, total in (("pass", model, "total_E"), ("hand", hand, "Et")):
        u0 = {n: v for n, v in start.items() if n in one.state_names}
        at = contin.equilibrium(one, u0, {"total_S0" if one is model else "T": 10.0, total: 0.5,
                                          "total_F" if one is model else "Ft": 1.0})  # fmt: skip
        branch = contin.continuation(at, total, (0.1, 3.0))
        found[name] = sorted((p.type, p.values[total], p.values["S0"]) for p in branch.points)
    assert [t for t, *_ in found["pass"]] == ["LP", "LP"]
    for one, other in zip(found["pass"], found["hand"], strict=True):
        assert one[1:3] == pytest.approx(other[1:3], rel=1e-8)


def test_a_symmetry_that_exchanges_states_of_a_law_is_kept():
    model = contin.Model(
        "pair", states={"x": 0.4, "y": 0.6}, parameters={"a": 1.0},
        equations={"x": "a*(y - x)*x*y", "y": "a*(x - y)*x*y"}, symmetries={"swap": {"x": "y", "y": "x"}},
    )  # fmt: skip
    reduced = without_conserved(model)
    assert [s.name for s in reduced.symmetries] == ["swap"]


def test_trajectories_and_sweeps_take_totals_too():
    path = contin.simulate(switch(), parameters={"total_X": 3.0}, time=5.0, samples=20)
    assert path.columns["X"] + path.columns["XP"] == pytest.approx(np.full(20, 3.0), rel=1e-14)
    assert list(contin.simulate(switch(), time=1.0).columns) == ["t", "X", "XP"]  # all states, as written
    steps = contin.sweep(switch(), "total_X", (0.5, 1.5), steps=2, down=False)
    assert steps.columns["X.mean"] + steps.columns["XP.mean"] == pytest.approx([0.5, 1.0, 1.5], rel=1e-6)


def test_an_unknown_parameter_is_refused_with_the_totals_among_those_offered():
    with pytest.raises(InputError, match="total_X"):
        contin.continuation(contin.equilibrium(switch()), "total_Y", (0.1, 1.0))
