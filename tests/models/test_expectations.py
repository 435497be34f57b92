"""Every bundled model keeps what its `expect:` says: each entry is carried out and compared, point by point."""

import pytest

import contin
from contin.model import registry
from contin.runs.engine import ContinEngine
from contin.runs.expect import verify
from tests.models.loaded import load

NAMES = [line.name for line in registry.listing() if line.source == "contin"]
ENTRIES = [
    pytest.param(name, k, id=f"{name}-{k}-{item.label}") for name in NAMES for k, item in enumerate(load(name).expect)
]


@pytest.mark.parametrize(("name", "k"), ENTRIES)
def test_the_expected_points_are_found_and_no_others(name, k):
    model = load(name)
    report = verify(model, model.expect[k], ContinEngine())
    assert report.holds, report.text


@pytest.mark.parametrize("name", NAMES)
def test_every_model_says_where_it_comes_from_and_what_to_expect(name):
    model = load(name)
    assert model.title
    assert model.source
    assert model.expect


@pytest.mark.parametrize(
    ("at", "text"),
    [({"B": 2.1}, "missing .*unexpected"), ([{"B": 2}, {"B": 3}], "1 found, 2 expected; missing")],
)
def test_a_wrong_expectation_is_reported(at, text):
    model = contin.Model(
        "wrong",
        states={"x": 1.0, "y": 1.0},
        parameters={"A": 1, "B": 1},
        equations={"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"},
        expect=[{"label": "HB", "at": at, "run": {"parameter": "B", "range": [0, 4]}}],
    )
    report = verify(model, model.expect[0], ContinEngine())
    assert not report.holds
    import re

    assert re.search(text, report.text)
