"""States that a declared rotation moves branch off from one that it keeps: closed forms of amplitude equations."""

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model


def oscillators(k: float, size: float = 1.0) -> Model:
    """Averaged van der Pol oscillators x_i' = (a - r_i^2/4) x_i/2 + k (x_j - x_i)/2, states in units of `size`."""

    def rule(own: str, other: str, x: str) -> str:
        return f"(a - ((x{own}^2 + y{own}^2)/{size**2!r})/4)*{x}{own}/2 + k*({x}{other} - {x}{own})/2"

    return Model(
        "two", states=dict.fromkeys(["x1", "y1", "x2", "y2"], 0), parameters={"a": -0.5, "k": k},
        rotation={"x1": "-y1", "y1": "x1", "x2": "-y2", "y2": "x2"},
        equations={"x1": rule("1", "2", "x"), "y1": rule("1", "2", "y"), "x2": rule("2", "1", "x"),
                   "y2": rule("2", "1", "y")},
    )  # fmt: skip


def branch(line, label):
    return contin.continuation(line[label].switch(), "a", (-0.5, 2))


@pytest.mark.parametrize("size", [1.0, 1e-6, 1e4])
def test_in_phase_and_anti_phase_states_of_two_oscillators(size):
    """In phase r^2 = 4 a; anti-phase r^2 = 4 (a - 2 k), where unequal ones branch off at a = 3 k."""
    k = 0.3
    line = contin.continuation(contin.equilibrium(oscillators(k, size)), "a", (-0.5, 2))
    assert [(p.type, p.vectors["kernel"]) for p in line.points] == [("BP", 2), ("BP", 2)]
    assert [p.values["a"] for p in line.points] == pytest.approx([0.0, 2 * k], abs=1e-12)
    for label, start, sign in (("BP1", 0.0, 1.0), ("BP2", 2 * k, -1.0)):
        found = branch(line, label)
        c = found.columns
        np.testing.assert_allclose((c["x1"] / size) ** 2, 4 * (c["a"] - start), rtol=1e-8, atol=1e-10)
        np.testing.assert_allclose(c["x2"], sign * c["x1"], rtol=1e-8)
        assert c["a"].min() - start < 1e-3  # it begins at the point, as far as a picture shows
        assert c["a"].max() == 2
        assert [p.type for p in found.points] == (["BP"] if sign < 0 else [])
        if found.points:
            assert found.points[0].values["a"] == pytest.approx(3 * k, abs=1e-10)


def test_a_subcritical_rotating_wave():
    """r' = a r + r^3 - r^5, angle' = r^2: the branch goes back to a fold at a = -1/4, r^2 = 1/2."""
    model = Model(
        "wave", states={"x": {"value": 0, "scale": 1}, "y": {"value": 0, "scale": 1}}, parameters={"a": -1.0},
        definitions={"s": "x^2 + y^2"}, rotation={"x": "-y", "y": "x"},
        equations={"x": "a*x + s*x - s^2*x - s*y", "y": "a*y + s*y - s^2*y + s*x"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "a", (-1, 1))
    found = contin.continuation(line["BP1"].switch(), "a", (-1, 1))
    assert [p.type for p in found.points] == ["LP"]
    assert found["LP1"].values["a"] == pytest.approx(-0.25, abs=1e-12)
    assert found["LP1"].values["x"] == pytest.approx(np.sqrt(0.5), abs=1e-7)
    assert not found.notes


def test_a_diagram_has_all_of_them():
    found = contin.diagram(oscillators(0.3), "a", (-0.5, 2))
    assert [b.name for b in found] == ["start", "start/BP1", "start/BP2", "start/BP2/BP1"]
    assert not any("no second point" in end.text for b in found for end in b.ends)


def test_several_pairs_together_are_refused_in_words():
    line = contin.continuation(contin.equilibrium(oscillators(0.0)), "a", (-0.5, 2))
    with pytest.raises(InputError, match="2 pairs of eigenvalues vanish together"):
        line["BP1"].switch()
