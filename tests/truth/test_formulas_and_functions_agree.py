"""The gallery's models as formulas, as functions that give values alone, and with sparse Jacobians: the same labels.

Formulas have exact derivatives of every order; functions of values have differences, and sparse ones the methods of
large systems. Labels, places, words and coefficients must be those of the formulas to the errors that both state.
"""

from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp

import contin
from contin.api.seeds import as_seed

MODELS = Path(contin.__file__).parents[1] / "models"
SHORT = (
    ("footbridge", "load"), ("lorenz", "rho"), ("ricker", "r"), ("bazykin", "alpha"),
    ("pair-averaged", "beta"),  # a fold and a Hopf point at one place
)  # fmt: skip
ROUNDING = 1e-13  # of a coefficient, relative


def with_equilibria():
    """(stem, parameter with a range) of the models that have equilibria or fixed points and no jumps."""
    for path in sorted(p for p in MODELS.glob("*/*.yaml") if p.parent.name != "pde"):
        model = contin.load(path)
        if model.kind in ("flow", "map") and not (model.events or model.forcing or model.constraints):
            for name in model.parameter_names:
                if model.parameter_range(name) is not None:
                    yield path.stem, name


def functions_of(model, start, name):
    """The model's equations as a function of values alone, and with a sparse Jacobian."""
    system = as_seed(start, name).problem.system
    names = list(model.parameter_names)

    def value(u, p):
        return system.value(np.array([float(x) for x in u]), np.array([p[k] for k in names]))

    def jacobian(u, p):
        return sp.csr_matrix(system.jacobian(np.asarray(u), np.array([p[k] for k in names]))[1][:, : system.n])

    values = dict(zip(names, map(float, start.p), strict=True))
    angles = {k: float(v) for k, v in zip(model.state_names, model.periods(), strict=True) if v > 0.0}
    typical = np.maximum(np.abs(start.u), 1e-3)
    for given in ({}, {"jacobian": jacobian}):
        yield contin.FunctionProblem(
            value, start.u, values, kind=model.kind, typical=typical, states=model.state_names, periods=angles, **given
        )


def assert_alike(ours, theirs, name):
    assert [p.type for p in ours.points] == [p.type for p in theirs.points], theirs.notes
    for a, b in zip(ours.points, theirs.points, strict=True):
        assert abs(a.values[name] - b.values[name]) <= a.error + b.error, (a.label, a.error, b.error)
        errors = [point.normal_form.get("errors", {}) for point in (a, b)]
        for key in set(a.normal_form) | set(b.normal_form):
            one, other = a.normal_form.get(key), b.normal_form.get(key)
            if isinstance(one, str | bool | int):
                assert one == other, (a.label, key)
            elif key in errors[0] and key in errors[1]:
                one, other = (complex(*v) if isinstance(v, list) else v for v in (one, other))
                slack = errors[0][key] + errors[1][key] + ROUNDING * abs(one)
                assert abs(one - other) <= slack, (a.label, key, one, other, slack)


def along(stem, name):
    model = contin.load(next(MODELS.glob(f"*/{stem}.yaml")))
    try:
        start = contin.equilibrium(model)
    except contin.ContinError as reason:
        pytest.skip(str(reason))
    if as_seed(start, name).problem.system.n_switches:
        pytest.skip("formulas know where they switch, functions do not")
    bounds = model.parameter_range(name)
    expected = contin.continuation(start, name, bounds)
    for function in functions_of(model, start, name):
        assert_alike(expected, contin.continuation(contin.equilibrium(function), name, bounds), name)
    return expected.points


@pytest.mark.parametrize(("stem", "name"), SHORT)
@pytest.mark.seldom
def test_functions_have_the_labels_of_formulas(stem, name):
    assert along(stem, name)


@pytest.mark.long
def test_functions_have_the_labels_of_all_formulas():
    complaints = []
    for stem, name in with_equilibria():
        try:
            along(stem, name)
        except AssertionError as reason:
            complaints.append((stem, name, str(reason)[:300]))
        except pytest.skip.Exception:
            continue
    assert not complaints, "\n".join(map(str, complaints))


def test_the_quadratic_coefficient_of_a_pitchfork_vanishes_though_null_vectors_come_from_iteration():
    """b20 = 0 by symmetry; the eigenvector's tolerance, 1e-10, made 3e-8 of it beside an error of 1.5e-8."""
    model = contin.load(MODELS / "metronomes" / "pair-averaged.yaml")
    start = contin.equilibrium(model)
    _, sparse = functions_of(model, start, "beta")
    branch = contin.continuation(contin.equilibrium(sparse), "beta", model.parameter_range("beta"))
    (crossing,) = [p for p in branch.points if p.type == "BP"]
    assert abs(crossing.normal_form["b20"]) < 1e-10 * abs(crossing.normal_form["b30"])
    assert (crossing.normal_form["kind"], crossing.normal_form["criticality"]) == ("pitchfork", "supercritical")
