"""SBML: compartments, amounts, reactions and events mean what the standard says."""

import numpy as np
import pytest

from contin.errors import InputError
from tests.exchange.sbml.writing import (
    assignment,
    compartment,
    event,
    parameter,
    reaction,
    read,
    reference,
    rule,
    simulated,
    species,
)


def test_decay_in_a_compartment_of_size_4(tmp_path):
    k = '<listOfLocalParameters><localParameter id="k" value="3"/></listOfLocalParameters>'
    got = simulated(
        tmp_path, Compartments=[compartment(size=4)], Parameters=[parameter("k", 7)],
        Species=[species("A", amount=2), species("B", concentration=1)],
        Reactions=[reaction("R", ["A"], [reference("B", 2)], "k*A", k)],
    )  # fmt: skip
    a = 0.5 * np.exp(-0.75 * got["t"])  # dA/dt = -3 A/4
    np.testing.assert_allclose(got["A"], a, rtol=1e-8)
    np.testing.assert_allclose(got["amount_A"], 4 * a, rtol=1e-8)
    np.testing.assert_allclose(got["B"], 1 + 2 * (0.5 - a), rtol=1e-8)
    np.testing.assert_allclose(got["concentration_B"], got["B"])
    np.testing.assert_allclose(got["R"], 3 * a, rtol=1e-8)
    assert (got["k"] == 7).all()
    assert (got["C"] == 4).all()


def test_events_reset_what_nothing_else_changes_and_compartments_keep_amounts(tmp_path):
    """p' = 1 falls by 2 wherever p > 1.5 and time > 1.7; k counts; C shrinks at 0.25, and the amount of A stays."""
    got = simulated(
        tmp_path, time=6.0, samples=61, Compartments=[compartment(size=4, constant="false")],
        Species=[species("A", concentration=3)],
        Parameters=[parameter("p", 0, "false"), parameter("k", 0, "false")], Rules=[rule("rate", "p", "1")],
        Events=[
            event("fall", "p > 1.5 && time > 1.7", {"p": "p - 2", "k": "k + 1"}),
            event("shrink", "!(time < 0.25)", {"C": "C/2"}),
        ],
    )  # fmt: skip
    falls = np.array([1.7, 3.5, 5.5])
    count = (got["t"][:, None] > falls + 1e-9).sum(axis=1)
    away = np.abs(got["t"][:, None] - falls).min(axis=1) > 1e-6
    np.testing.assert_array_equal(got["k"][away], count[away])
    np.testing.assert_allclose(got["p"][away], (got["t"] - 2 * count)[away], atol=1e-8)
    np.testing.assert_allclose(got["amount_A"], 12.0)
    np.testing.assert_allclose(got["A"], np.where(got["t"] > 0.25, 6.0, 3.0))


def test_amounts_are_states_where_only_substance_units_count(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment(size=4)],
        Species=[species("A", concentration=2, hosu="true"), species("B", amount=3, hosu="true", boundary="true")],
        Reactions=[reaction("R", ["A", "B"], [], "0.5*A")],
    )  # fmt: skip
    np.testing.assert_allclose(got["A"], 8 * np.exp(-0.5 * got["t"]), rtol=1e-8)
    np.testing.assert_allclose(got["concentration_A"], got["A"] / 4)
    assert (got["B"] == 3).all()


def test_concentrations_follow_a_compartment_that_grows(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment(size=2, constant="false")],
        Species=[species("A", concentration=3), species("B", amount=1, boundary="true"), species("S", concentration=1)],
        Rules=[rule("rate", "C", "C"), rule("rate", "S", "0.5")],
        Reactions=[reaction("R", ["A"], [], "A*C")],
    )  # fmt: skip
    size = 2 * np.exp(got["t"])
    np.testing.assert_allclose(got["C"], size, rtol=1e-8)
    np.testing.assert_allclose(got["amount_A"], 6 * np.exp(-got["t"]), rtol=1e-8)  # d amount/dt = -A C = -amount
    np.testing.assert_allclose(got["A"], 6 * np.exp(-got["t"]) / size, rtol=1e-8)
    np.testing.assert_allclose(got["B"], 1 / size, rtol=1e-8)
    np.testing.assert_allclose(got["S"], 1 + 0.5 * got["t"], rtol=1e-8)  # the rule is one of the concentration
    np.testing.assert_allclose(got["amount_S"], got["S"] * size, rtol=1e-8)


def test_without_extent_a_species_is_an_amount(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment(size=None, dimensions=0)], Species=[species("A", amount=2)],
        Reactions=[reaction("R", ["A"], [], "A")],
    )  # fmt: skip
    np.testing.assert_allclose(got["A"], 2 * np.exp(-got["t"]), rtol=1e-8)


def test_values_at_the_start_are_worked_out_in_the_order_of_their_needs(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment(size=9)],
        Parameters=[
            parameter("p", 1), parameter("q"), parameter("r", constant="false"), parameter("s", constant="false"),
            parameter("y", 0, "false"),
        ],
        Species=[species("A", amount=5), species("B", concentration=1)],
        InitialAssignments=[
            assignment("p", "q + 1"), assignment("q", "2*r"), assignment("C", "q/3"), assignment("B", "p + time"),
            assignment("y", "R"),
        ],
        Rules=[rule("assignment", "r", "s + time"), rule("assignment", "s", "3"), rule("rate", "y", "1")],
        Reactions=[reaction("R", [], ["A"], "6*p")],
    )  # fmt: skip
    t = got["t"]
    np.testing.assert_allclose(got["r"], 3 + t)
    assert got["q"][0] == 6
    assert got["p"][0] == 7
    assert got["C"][0] == 2
    assert got["B"][0] == 7
    np.testing.assert_allclose(got["A"], 5 / 2 + 42 * t / 2, rtol=1e-9)
    np.testing.assert_allclose(got["y"], 42 + t, rtol=1e-9)


def test_initial_values_in_a_circle_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"in a circle: (p -> q -> p|q -> p -> q)"):
        read(tmp_path, Parameters=[parameter("p"), parameter("q")],
             InitialAssignments=[assignment("p", "q"), assignment("q", "p")])  # fmt: skip


def test_conversion_factors_scale_what_reactions_do(tmp_path):
    got = simulated(
        tmp_path, attributes='conversionFactor="f"', Compartments=[compartment(size=2)],
        Parameters=[parameter("f", 3), parameter("g", 5)],
        Species=[species("A", amount=1), species("B", amount=1, more='conversionFactor="g"')],
        Reactions=[reaction("R", [], ["A", "B"], "1")],
    )  # fmt: skip
    np.testing.assert_allclose(got["amount_A"], 1 + 3 * got["t"], rtol=1e-9)
    np.testing.assert_allclose(got["amount_B"], 1 + 5 * got["t"], rtol=1e-9)


def test_stoichiometries_are_symbols_of_level_3(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment()], Parameters=[parameter("k", 2)],
        Species=[species("A", amount=1), species("B", amount=0), species("D", amount=0)],
        InitialAssignments=[assignment("n", "3*k")],
        Rules=[rule("assignment", "o", "time"), rule("rate", "p", "n")],
        Reactions=[reaction("R", [], [
            reference("A", 1, 'id="n" constant="true"'), reference("B", 1, 'id="o" constant="false"'),
            reference("D", 4, 'id="p" constant="false"')], "k")],
    )  # fmt: skip
    t = got["t"]
    np.testing.assert_allclose(got["A"], 1 + 12 * t, rtol=1e-9)
    np.testing.assert_allclose(got["B"], t**2, atol=1e-9)
    np.testing.assert_allclose(got["D"], 2 * (4 * t + 3 * t**2), atol=1e-9)
    assert (got["n"] == 6).all()
    np.testing.assert_allclose(got["p"], 4 + 6 * t, rtol=1e-9)
