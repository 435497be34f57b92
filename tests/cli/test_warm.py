"""The branch that warms the engine up passes what it is meant to pass."""

from contin import api
from contin.model.yaml_loader import model_from_mapping
from contin.runs.warm import MODEL, is_compiled, warm_up


def test_the_warm_up_branch_has_a_hopf_point_at_1_and_a_fold_at_0():
    start = api.equilibrium(model_from_mapping(MODEL))
    branch = api.continuation(start, "p", (-0.5, 1.21), direction="down", settings={"steps": 200})
    found = {point.type: point.values["p"] for point in branch.points}
    assert abs(found["HB"] - 1) < 1e-9
    assert abs(found["LP"]) < 1e-9
    warm_up()


def test_the_warm_up_with_orbits_leaves_nothing_to_compile():
    warm_up(orbits=True)
    assert is_compiled(orbits=True)


def test_the_warm_up_with_curves_of_orbits_leaves_nothing_to_compile():
    warm_up(curves=True)
    assert is_compiled(orbits=True, curves=True)
