"""Two pairs of eigenvalues that cross together, or nearly: each family of cycles is followed, or a note says not."""

import contin


def two_oscillators(apart: float):
    """Two uncoupled oscillators z' = (growth + i) z - z |z|^2; the second one's growth rate is zero `apart` later."""
    equations = {
        "x": "p*x - y - x*(x^2 + y^2)", "y": "p*y + x - y*(x^2 + y^2)",
        "u": f"(p - {apart})*u - 1.5*v - u*(u^2 + v^2)", "v": f"(p - {apart})*v + 1.5*u - v*(u^2 + v^2)",
    }  # fmt: skip
    states = dict.fromkeys(equations, 0.0)
    model = contin.Model("pairs", states=states, parameters={"p": -0.5}, equations=equations)
    return contin.diagram(model, "p", (-0.53, 0.61), start=states)


def test_families_born_at_two_hopf_points_next_to_each_other_are_two():
    diagram = two_oscillators(1e-8)
    assert [p.type for p in diagram["start"].points] == ["HB", "HB"]
    for k, (mine, other) in ((1, ("x", "u")), (2, ("u", "x"))):
        family = diagram[f"start/HB{k}"]
        assert family.columns[f"{mine}.max"][-1] > 0.5
        assert family.columns[f"{other}.max"][-1] < 1e-6


def test_pairs_of_one_frequency_that_cross_at_once_have_a_note():
    equations = {
        "x": "p*x - y - x*(x^2 + y^2)", "y": "p*y + x - y*(x^2 + y^2)",
        "u": "p*u - v - u*(u^2 + v^2)", "v": "p*v + u - v*(u^2 + v^2)",
    }  # fmt: skip
    states = dict.fromkeys(equations, 0.0)
    model = contin.Model("pairs", states=states, parameters={"p": -0.5}, equations=equations)
    branch = contin.continuation(contin.equilibrium(model, states, {"p": -0.5}), "p", (-0.53, 0.61))
    assert [(p.type, p.normal_form["kernel"]) for p in branch.points] == [("HB", 2)]
    assert any("several pairs" in note for note in branch.notes)
