"""User values are hit wherever they are on the branch."""

import pytest

from tests.problems.follow import follow


@pytest.mark.parametrize("value", [0.001, 0.01, 0.03, -0.02])
def test_a_user_value_in_the_same_step_as_a_branch_point_is_hit(value):
    # x' = p x - x^3: a branch point at p = 0, where Newton on the curve fails
    branch = follow({"x": "p*x - x^3"}, {"x": 0.0}, {"p": -1.0}, (-1.0, 1.0), values={"p": [value]})
    assert [p.type for p in branch.points] == (["BP", "UZ"] if value > 0 else ["UZ", "BP"])
    uz = next(p for p in branch.points if p.type == "UZ")
    assert uz.values["p"] == value
