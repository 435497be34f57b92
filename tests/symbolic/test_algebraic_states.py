"""Flows with algebraic states as formulas of a size that can be differentiated."""

import pytest

from contin.model.expression import postorder
from contin.model.model import Model
from contin.symbolic.calculus.remove_singularities import remove_singularities
from contin.symbolic.passes.index_one import index_one


def generator():
    """A generator behind a reactance with its field, and a load at a bus whose voltage is algebraic, V and th."""
    active = "E*V*sin(d - th)/a - V*sin(th)/b"
    reactive = "E*V*cos(d - th)/a - V^2/a - V^2/b + V*cos(th)/b"
    return Model(
        "power", states={"d": 0.3, "w": 0, "E": 1.2, "V": 1, "th": 0.1},
        parameters={"P": 0.5, "Q": 0.2, "L": 0.3, "D": 0.4, "T": 5, "F": 1.4, "a": 0.3, "b": 0.5, "c": 0.9},
        mass={"V": 0, "th": 0},
        equations={
            "d": "w", "w": "5*(P - E*V*sin(d - th)/a - D*w)", "E": "(F - E - (c - a)*(E - V*cos(d - th))/a)/T",
            "V": f"{active} - L*V", "th": f"{reactive} - Q*V^2",
        },
    )  # fmt: skip


@pytest.mark.seldom
def test_a_common_factor_of_the_algebraic_equations_is_not_multiplied_out():
    """All of them vanish at V = 0, which cancels; multiplied out in all other symbols that has some thousand nodes."""
    equations = index_one(generator()).equations
    assert len(postorder(remove_singularities(equations))) < 3 * len(postorder(equations))
