"""Models with many states take the sparse path by themselves: labels and normal forms are those of the dense one."""

import numpy as np
import pytest
from scipy.optimize import brentq

import contin
from contin.continuation.branch import Branch
from contin.model.model import Model
from contin.problems.sparse import from_model
from contin.problems.sparse.large_equilibrium import LargeProblem


def brusselator(cells: int) -> Model:
    """In one dimension, between walls at the homogeneous state: modes become unstable one after the other."""
    states, rights = {}, {}
    ends = {"x": "A", "y": "B/A"}
    for k in range(cells):
        states |= {f"x{k}": 2, f"y{k}": "B/A"}
        left = {s: f"{s}{k - 1}" if k else ends[s] for s in "xy"}
        right = {s: f"{s}{k + 1}" if k < cells - 1 else ends[s] for s in "xy"}
        diffusion = {s: f"D{s}*{(cells + 1) ** 2}/L^2*({left[s]} - 2*{s}{k} + {right[s]})" for s in "xy"}
        rights[f"x{k}"] = f"{diffusion['x']} + x{k}^2*y{k} - (B + 1)*x{k} + A"
        rights[f"y{k}"] = f"{diffusion['y']} + B*x{k} - x{k}^2*y{k}"
    parameters = {"A": 2, "B": {"value": 5.45, "range": [4.5, 6]}, "L": {"value": 0.3, "range": [0.3, 0.8]}}
    return Model(
        "brusselator", states=states, parameters={**parameters, "Dx": 0.008, "Dy": 0.004}, equations=rights,
        observables={"product": "x0*y0"}, symmetries={"mirror": _mirror(cells)},
    )  # fmt: skip


def _mirror(cells: int) -> dict[str, str]:
    return {f"{s}{k}": f"{s}{cells - 1 - k}" for s in "xy" for k in range(cells)}


def chain(n: int) -> Model:
    """Bratu's problem by second differences."""
    names = [*(f"u{k}" for k in range(n)), "0", "0"]  # the last serve the ends
    rights = {
        f"u{k}": f"{(n + 1) ** 2}*({names[k - 1]} - 2*u{k} + {names[k + 1]}) + p*exp(u{k})" for k in range(n)
    }  # fmt: skip
    return Model(
        "chain", states=dict.fromkeys(rights, 0), parameters={"p": {"value": 0, "range": [0, 4]}}, equations=rights
    )


def both_ways(model: Model, parameter: str, monkeypatch) -> list[Branch]:
    branches = []
    monkeypatch.setattr(from_model, "SPARSE", 10.0)
    for large in (1, 10**9):
        monkeypatch.setattr(from_model, "LARGE", large)
        start = contin.equilibrium(model)
        branches.append(contin.continuation(start, parameter, direction="up"))
    assert isinstance(branches[0].problem, LargeProblem)
    assert not isinstance(branches[1].problem, LargeProblem)
    return branches


@pytest.mark.parametrize(("model", "parameter"), [(brusselator(8), "L"), (chain(15), "p")])
def test_sparse_and_dense_agree_on_labels_and_normal_forms(model, parameter, monkeypatch):
    sparse, dense = both_ways(model, parameter, monkeypatch)
    assert [p.label for p in sparse.points] == [p.label for p in dense.points] != []
    for a, b in zip(sparse.points, dense.points, strict=True):
        assert a.values == pytest.approx(b.values, rel=1e-9, abs=1e-9)
        for key, value in b.normal_form.items():
            if isinstance(value, str):
                assert a.normal_form[key] == value
            elif isinstance(value, float) and key in a.normal_form:
                assert a.normal_form[key] == pytest.approx(value, rel=1e-6, abs=1e-8)
    assert set(sparse.columns) == set(dense.columns)
    assert [end.reason for end in sparse.ends] == [end.reason for end in dense.ends]


def test_orbits_from_a_hopf_point_of_a_large_model_are_those_of_the_dense_one(monkeypatch):
    model = brusselator(5)
    families = []
    for branch in both_ways(model, "L", monkeypatch):
        near = branch["HB1"].values["L"] + 1e-4
        settings = {"steps": 20, "intervals": 10}
        born, wanted = branch["HB1"].switch(), {"L": [near - 5e-5]}
        families.append(contin.continuation(born, "L", (0.3, near), values=wanted, settings=settings))
    periods = [family["UZ1"].values["period"] for family in families]
    assert periods[0] == pytest.approx(periods[1], rel=1e-8)


def test_the_fold_of_a_long_chain_converges_with_second_order_to_that_of_bratus_problem():
    s = brentq(lambda s: s * np.tanh(s) - 1.0, 1.0, 2.0)
    exact = 8.0 * (s / np.cosh(s)) ** 2
    errors = []
    for n in (199, 249):
        start = contin.equilibrium(chain(n))
        branch = contin.continuation(start, "p", direction="up", settings={"stop_at": ("LP",)})
        assert isinstance(branch.problem, LargeProblem)
        errors.append(exact - branch["LP1"].values["p"])
    assert np.log(errors[0] / errors[1]) / np.log(250 / 200) == pytest.approx(2.0, abs=0.02)


@pytest.mark.parametrize(
    "change",
    [
        {"equations": {"x0": "abs(x0) - a"}}, {"kind": "map"}, {"forcing": {"period": 1}},
        {"states": {"x0": {"value": 0, "minimum": -1}}}, {"symmetries": {"s": {"x0": "a*x0"}}},
        {"equations": {f"x{k}": "+".join(f"x{j}" for j in range(200)) for k in range(200)}},
    ],
)  # fmt: skip
def test_what_the_sparse_path_has_no_method_for_stays_dense(change):
    entries = {
        "states": {f"x{k}": 0 for k in range(200)}, "parameters": {"a": 1},
        "equations": {f"x{k}": f"-a*x{k}" for k in range(200)},
    }  # fmt: skip
    assert from_model.is_large(Model("m", **entries))
    for section, value in change.items():
        entries[section] = {**entries.get(section, {}), **value} if isinstance(value, dict) else value
    assert not from_model.is_large(Model("m", **entries))


def test_an_equation_that_is_not_finite_is_named():
    names = [f"x{k}" for k in range(200)]
    rights = {name: f"-{name}" for name in names} | {"x7": "a/x7 - x7"}
    model = Model("m", states=dict.fromkeys(names, 0), parameters={"a": 1}, equations=rights)
    with pytest.raises(contin.ContinError, match="x7"):
        contin.equilibrium(model)
