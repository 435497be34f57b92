"""What is followed from a stored point is what is followed from it in memory, digit by digit."""

import json
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contin
from contin.errors import ContinError, InputError
from contin.model.source import CallSource
from contin.runs.engine import ContinEngine
from contin.runs.execute import execute
from contin.runs.load import read_run
from contin.runs.plan import make_plan
from contin.store.points import Reader
from contin.store.results import save_branches
from contin.store.solutions import solutions_of

RADIAL = "mu + b*(x^2 + y^2) - c*(x^2 + y^2)^2"
BAUTIN = {
    "name": "bautin", "states": {"x": 0, "y": 0}, "parameters": {"mu": -1.5, "b": 2, "c": 1, "om": 1},
    "equations": {"x": f"x*({RADIAL}) - om*y*(1 + x^2 + y^2)", "y": f"om*x*(1 + x^2 + y^2) + y*({RADIAL})"},
}  # fmt: skip
TABLE = {
    "name": "table", "states": {"x": 0, "v": 0.5}, "parameters": {"A": 0.03, "r": 0.5},
    "equations": {"x": "v", "v": "-1"}, "forcing": {"period": "1"},
    "events": [{"when": "x - A*sin(2*pi*t)", "direction": "down",
                "set": {"v": "-r*v + (1 + r)*2*pi*A*cos(2*pi*t)"}}],
}  # fmt: skip
COLUMN = {
    "name": "column", "kind": "bvp", "time": {"name": "t", "from": 0, "to": 1}, "states": {"u": 0, "v": 0},
    "parameters": {"lam": 5, "k": 1}, "equations": {"u": "v", "v": "-lam*k*sin(u)"},
    "conditions": ["u(start) = 0", "u(end) = 0"],
}  # fmt: skip
CASES = {
    "flow": (BAUTIN, [
        {"name": "line", "parameter": "mu", "range": [-2, 1], "values": {"mu": [0.5]}},
        {"name": "cycles", "from": "line.HB1", "parameter": "mu", "range": [-2, 1], "values": {"mu": [-0.5]}},
        {"name": "hopf", "from": "line.HB1", "parameter": ["mu", "b"], "range": {"mu": [-2, 1], "b": [-1, 3]}},
        {"name": "held", "from": "cycles.UZ1", "as": "orbit", "parameter": "mu", "range": [-2, 1], "free": ["om"],
         "values": {"mu": [-0.4]}, "conditions": ["period = 6"], "settings": {"steps": 8, "max_step": 0.5}},
    ], ("mu", "b")),
    "bogdanov-takens": ({
        "name": "bt", "states": {"x": -0.7, "y": 0}, "parameters": {"p": -0.25, "q": -0.1},
        "equations": {"x": "y", "y": "p + q*x + x^2 + x*y"},
    }, [
        {"name": "line", "parameter": "p", "range": [-1, 1]},
        {"name": "cycles", "from": "line.HB1", "parameter": "p", "range": [-1, 1], "settings": {"steps": 60}},
        {"name": "folds", "from": "line.LP1", "parameter": ["p", "q"], "range": {"p": [-1, 1], "q": [-1, 1]}},
    ], ("p", "q")),
    "map": ("classics/henon", [
        {"name": "line", "parameter": "a", "range": [-1, 1]},
        {"name": "two", "from": "line.PD1", "parameter": "a", "range": [-1, 1]},
        {"name": "doubling", "from": "line.PD1", "parameter": ["a", "b"], "range": {"a": [-1, 4], "b": [-1.5, 1.5]}},
    ], ("a", "b")),
    "forced": ("classics/duffing", [
        {"name": "response", "parameter": "omega", "values": {"omega": [1.0]}},
    ], ("omega", "gamma")),
    "doubling": ("classics/roessler", [
        {"name": "cycles", "start": {"x": 3, "y": 1, "z": 1}, "as": "orbit", "parameter": "c", "range": [2, 4],
         "settings": {"steps": 50}},
    ], ("c", "a")),
    "averaged": ("metronomes/pair", [
        {"name": "line", "start": "in-phase", "parameter": "mu", "range": [0.05, 8]},
        {"name": "fork", "from": "line.BP1", "parameter": "mu", "range": [0.05, 8]},
    ], ("mu", "beta")),
    "shooting": ("metronomes/pair", [
        {"name": "orbits", "start": "in-phase", "as": "orbit", "parameter": "mu", "range": [0.05, 8],
         "settings": {"steps": 12}},
    ], ("mu", "beta")),
    "jumps": (TABLE, [
        {"name": "orbits", "start": {"x": 0.01, "v": 0.5}, "as": "orbit", "parameter": "A", "range": [0, 0.07]},
    ], ("A", "r")),
    "bvp": (COLUMN, [
        {"name": "line", "parameter": "lam", "range": [5, 12]},
    ], ("lam", "k")),
    "algebraic": ({
        "name": "circle", "kind": "algebraic", "states": {"x": 1}, "parameters": {"p": 0, "q": 1},
        "equations": {"x": "x^2 + p^2 - q"},
    }, [
        {"name": "line", "parameter": "p", "range": [-2, 2], "extrema": ["x"]},
    ], ("p", "q")),
}  # fmt: skip
GIVEN = {
    "jumps": {"A": 0.0278}, "doubling": {"a": 0.2, "b": 0.2, "c": 2.5}, "averaged": {"beta": 0.8},
    "shooting": {"beta": 0.8, "eps": 0.02},
}  # fmt: skip
LONG = ("jumps",)


def carried_out(case, folder):
    model, runs, pair = CASES[case]
    transform = [{"average": {"form": "stokes"}}] if case == "averaged" else []
    written = {"model": model, "continuations": runs, "transform": transform, "parameters": GIVEN.get(case, {})}
    source = CallSource("run")
    entry = read_run(written, source, version_required=False)
    found = execute(make_plan(entry, source, folder / "run.yaml"), ContinEngine())
    return list(found.branches.values()), pair


def followed(point, names):
    """The branches that start at a point with one name free, or the curve through it in two; words where none does."""
    problem = point.values
    ranges = {n: (min(-5.0, problem[n] - 1.0), max(5.0, problem[n] + 1.0)) for n in names}
    try:
        seeds = point.switch(names[0]) if len(names) == 1 else point.locus(names)
        return [
            contin.continuation(seed, names if len(names) > 1 else names[0], ranges, settings={"steps": 2})
            for seed in seeds[:2]
        ]
    except ContinError as error:
        return str(error).replace(point.branch, "").split(":", 1)[-1]


@pytest.mark.parametrize("case", [pytest.param(c, marks=pytest.mark.long) if c in LONG else c for c in CASES])
@pytest.mark.seldom
def test_branches_from_a_file_are_those_from_memory(case, tmp_path):
    branches, pair = carried_out(case, tmp_path)
    save_branches(branches, tmp_path / "a.contin")
    stored = contin.read(tmp_path / "a.contin")
    compared = set()
    for branch in branches:
        for point in branch.points:
            again = stored[branch.name][point.label]
            for names in (branch.parameters[:1], pair):
                if (branch.kind, branch.locus, point.type, names) in compared or (branch.locus and names != pair):
                    continue
                compared.add((branch.kind, branch.locus, point.type, names))
                ours, theirs = followed(point, names), followed(again, names)
                if isinstance(ours, str) or isinstance(theirs, str):
                    assert ours == theirs
                    continue
                assert len(ours) == len(theirs) > 0
                for one, other in zip(ours, theirs, strict=True):
                    assert one.columns.keys() == other.columns.keys()
                    for name, column in one.columns.items():
                        np.testing.assert_array_equal(column, other.columns[name], err_msg=f"{point}: {name}")
                    assert [p.label for p in one.points] == [p.label for p in other.points]
                    assert [e.text for e in one.ends] == [e.text for e in other.ends]
    assert compared


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    branches, _ = carried_out("bogdanov-takens", tmp_path_factory.mktemp("kept"))
    return solutions_of(branches)


def places(data, path=()):
    """The places of all that is in nested data."""
    yield path
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, item in items:
        yield from places(item, (*path, key))


@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_a_changed_solution_is_refused_in_words_or_fits_its_equations(kept, data):
    """Sizes, places and shapes that do not belong together never reach the kernels."""
    key = data.draw(st.sampled_from(sorted(kept.points)))
    document = json.loads(kept.points[key])
    path = data.draw(st.sampled_from(sorted(filter(None, places(document)), key=str)))
    inside = document
    for part in path[:-1]:
        inside = inside[part]
    changes = [-1, 0, 1, 2, 3, 7, 10**6, 2**70, 0.5, None, "", "x", [], {}, [1], {"part": "Popen"}, {"system": 1}]
    inside[path[-1]] = data.draw(st.sampled_from(changes))
    with suppress(InputError, ArithmeticError, ValueError, TypeError):  # numbers of normal forms may be anything
        found = Reader(kept.equations).point(json.dumps(document), "there")
        followed(found, found.problem.parameters)


def test_no_part_is_looked_up_outside_the_table(kept):
    names = json.loads(next(iter(kept.points.values())))
    text = json.dumps(names | {"problem": {"part": "os.system", "fields": {}}})
    with pytest.raises(InputError, match="damaged"):
        Reader(kept.equations).point(text, "there")
