"""Conditions and observables of boundary-value problems as they are written."""

import pytest

from contin.errors import InputError
from contin.model.model import Model
from contin.model.yaml_loader import load_model_text


def model(*conditions, **more):
    return Model(
        "b", kind="bvp", states={"u": 0, "v": 0}, parameters={"p": 1}, equations={"u": "v", "v": "-p*u"},
        conditions=list(conditions), **more,
    )  # fmt: skip


def test_a_model_is_written_as_it_is_read():
    observables = {"h": "max(u)", "e": "integral(v^2)/2 + p*u(end)"}
    m = model("u(start) = p", "mean(u^2) = 1", time={"name": "x", "from": -1, "to": "p"}, observables=observables,
              starts={"arch": {"u": "sin(pi*x)"}})  # fmt: skip
    assert load_model_text(m.text(), "b", False) == m
    assert {f.kind for f in m.functionals.values()} == {"max", "integral", "end", "start", "mean"}


@pytest.mark.parametrize(
    ("condition", "message"),
    [
        ("u(start) = u", r"u has a value everywhere on the interval: write u\(start\)"),
        ("u(2) = 1", r"write u\(start\) or u\(end\)"),
        ("max(u) = 1", "no smooth conditions"),
        ("p = 1", "must contain a value at an end"),
        ("integral(u(start)) = 1", "is a number already"),
        ("integral(w) = 1", "unknown name 'w'"),
        ("u(start) == 0", "an equation with one `=`"),
        ("integral(u, v) = 1", "integral takes 1 argument"),
    ],
)
def test_what_is_no_condition(condition, message):
    with pytest.raises(InputError, match=message):
        model(condition, "u(end) = 0")


def test_conditions_belong_to_boundary_value_problems():
    with pytest.raises(InputError, match="`conditions` belongs to kind: bvp"):
        Model("f", states={"u": 0}, parameters={"p": 1}, equations={"u": "p"}, conditions=["u(start) = 0"])
    with pytest.raises(InputError, match="takes no `forcing`"):
        model("u(start) = 0", forcing={"period": 1})
