"""The branch that warms the engine up passes what it is meant to pass, and the wait for kernels is explained."""

from importlib import import_module

from contin import api
from contin.model.yaml_loader import model_from_mapping
from contin.runs.warm import MODEL, WAITS, waiting, warm_up


def test_the_warm_up_branch_has_a_hopf_point_at_1_and_a_fold_at_0():
    start = api.equilibrium(model_from_mapping(MODEL))
    branch = api.continuation(start, "p", (-0.5, 1.21), direction="down", settings={"steps": 200})
    found = {point.type: point.values["p"] for point in branch.points}
    assert abs(found["HB"] - 1) < 1e-9
    assert abs(found["LP"]) < 1e-9
    warm_up()


def test_long_waits_are_explained_by_what_is_compiled():
    assert "curves of periodic orbits" in waiting("contin.kernels.special_orbits.march")
    assert "curves in two parameters" in waiting("contin.kernels.locus")
    assert waiting("contin.kernels.tests_of_stability") is None
    for name in WAITS:  # modules that are there
        import_module(f"{name}_march" if name.endswith("collocation") else name)
