"""Notes say where a solution is by the places of its parameters among the unknowns."""

import sys

import numpy as np

import contin
from contin.continuation.position import position
from contin.model.model import Model


class Placed:
    """A curve whose second parameter stands among other unknowns, as on connecting orbits."""

    parameters = ("p", "q")
    walls = ((2, 0.0, 1.0), (-1, 0.0, 1.0))


def test_parameters_are_read_where_the_walls_say_that_they_stand(monkeypatch):
    monkeypatch.setattr(sys.modules[position.__module__], "in_two_parameters", lambda problem: True)
    assert position(Placed(), np.array([0.1, 0.2, 0.3, 0.4, 0.5])) == "p = 0.5, q = 0.3"


def test_positions_on_branches_and_curves_are_those_of_their_columns():
    model = Model("cusp", states={"x": 1.0}, parameters={"p": 0.0, "q": 1.0}, equations={"x": "p + q*x - x^3"})
    line = contin.continuation(contin.equilibrium(model, {"x": 1.0}), "p", (-1.0, 1.0))
    folds = contin.continuation(line["LP1"].locus(), ("p", "q"), {"p": (-1, 1), "q": (-1, 2)})
    assert position(line.problem, line.z[2]) == f"p = {line.columns['p'][2]:.10g}"
    p, q = folds.columns["p"][3], folds.columns["q"][3]
    assert position(folds.problem, folds.z[3]) == f"p = {p:.10g}, q = {q:.10g}"
