"""User functions: the engine in plain Python gives what the compiled march gives, whatever derivatives are given."""

import re

import numpy as np
import pytest

import contin
from contin import api
from contin.errors import InputError, NoSolutionError, NotFiniteError, UserFunctionError

HELD = {"rtol": 1e-9, "atol": 1e-9}


def stirred_tank():
    """Two folds and two Hopf points: x' = -x + D (1 - x) e^y, y' = -y + B D (1 - x) e^y - c y (Uppal 1974)."""
    return contin.Model(
        "tank", states={"x": 0.0, "y": 0.0}, parameters={"D": 0.0, "B": 14.0, "c": 2.0},
        equations={"x": "-x + D*(1 - x)*exp(y)", "y": "-y + B*D*(1 - x)*exp(y) - c*y"},
    )  # fmt: skip


def tank_residual(u, p):
    x, y = u
    rate = p["D"] * (1 - x) * np.exp(y)
    return np.array([-x + rate, -y + p["B"] * rate - p["c"] * y])


def tank_jacobian(u, p):
    x, y = u
    e = np.exp(y)
    by_x, by_y = -p["D"] * e, p["D"] * (1 - x) * e
    return np.array([[-1 + by_x, by_y], [p["B"] * by_x, -1 + p["B"] * by_y - p["c"]]])


def real_tank_residual(u, p):
    """Refuses complex arguments, as most programs do."""
    return np.array([float(v) for v in tank_residual([float(x) for x in u], p)])


TANK = {"D": 0.0, "B": 14.0, "c": 2.0}
WAYS = {
    "complex steps": {"residual": tank_residual},
    "differences": {"residual": real_tank_residual},
    "jacobian": {"residual": tank_residual, "jacobian": tank_jacobian},
    "jacobian of a real function": {"residual": real_tank_residual, "jacobian": tank_jacobian},
}


def assert_same_labels(ours, reference):
    assert [p.label for p in ours.points] == [p.label for p in reference.points]
    for p, q in zip(ours.points, reference.points, strict=True):
        for key in q.values:
            np.testing.assert_allclose(p.values[key], q.values[key], **HELD, err_msg=f"{p.label}.{key}")
        assert p.normal_form.keys() == q.normal_form.keys()
        for key, value in q.normal_form.items():
            if key == "errors":
                continue
            if isinstance(value, str):
                assert p.normal_form[key] == value
            else:
                np.testing.assert_allclose(p.normal_form[key], value, rtol=1e-6, atol=1e-8, err_msg=f"{p.label}.{key}")


@pytest.fixture(scope="module")
def compiled_tank():
    return api.continuation(api.equilibrium(stirred_tank()), "D", (0.0, 0.5))


def test_the_comparison_has_folds_and_hopf_points_to_compare(compiled_tank):
    assert sorted({p.type for p in compiled_tank.points}) == ["HB", "LP"]


@pytest.mark.parametrize("way", WAYS)
def test_function_gives_the_labels_of_the_compiled_model_to_1e_9(way, compiled_tank):
    problem = contin.FunctionProblem(u0=[0.0, 0.0], parameters=TANK, states=["x", "y"], **WAYS[way])
    ours = api.continuation(problem, "D", (0.0, 0.5))
    assert_same_labels(ours, compiled_tank)
    assert ours.steps == pytest.approx(compiled_tank.steps, abs=2)
    assert [e.reason for e in ours.ends] == [e.reason for e in compiled_tank.ends]


@pytest.mark.seldom
def test_branch_points_and_switched_branches_agree_on_the_metronome_pair():
    model = contin.load("metronomes/pair-averaged")
    at = {"mu": 8.0, "beta": 0.8}
    start = api.equilibrium(model, "in-phase", at)
    line = api.continuation(start, "mu", (0.5, 10.0))
    fork = api.continuation(line["BP1"].switch(), "mu", (0.5, 10.0))
    system = api.compiled(model)

    def observed(u, p):
        values = system.observables(u, np.array(list(p.values())))
        return dict(zip(system.observable_names, values, strict=True))

    problem = contin.FunctionProblem(
        lambda u, p: system.value(u, np.array(list(p.values()))), start.u, model.default_parameters(at),
        states=model.state_names, symmetries={"exchange": lambda u: u[[1, 0, 2]] * [1, 1, -1]},
        record=observed,
    )  # fmt: skip
    our_line = api.continuation(problem, "mu", (0.5, 10.0))
    our_fork = api.continuation(our_line["BP1"].switch(), "mu", (0.5, 10.0))
    assert_same_labels(our_line, line)
    assert our_line["BP1"].values["mu"] == pytest.approx(4.756461743521, abs=1e-9)
    assert [p.label for p in our_fork.points] == [p.label for p in fork.points]
    hopf = our_fork["HB1"].values
    assert hopf["mu"] == pytest.approx(4.531618983307, abs=1e-9)


def test_start_at_a_fold_and_on_a_branch_whose_state_does_not_move():
    fold = contin.FunctionProblem(lambda u, p: np.array([p["mu"] - u[0] ** 2]), [0.0], {"mu": 0.0})
    branch = api.continuation(fold, "mu", (-1.0, 1.0))
    assert [p.label for p in branch.points] == ["LP1"]
    assert abs(branch["LP1"].values["mu"]) < 1e-14
    np.testing.assert_allclose(branch.columns["u0"] ** 2, branch.columns["mu"], atol=1e-9)
    rest = contin.FunctionProblem(lambda u, p: p["mu"] * u - u**3, [0.0], {"mu": -1.0})
    line = api.continuation(rest, "mu", (-1.0, 1.0))
    assert [p.type for p in line.points] == ["BP"]
    assert abs(line["BP1"].values["mu"]) < 1e-12
    assert line["BP1"].normal_form["kind"] == "pitchfork"
    np.testing.assert_allclose(line.columns["u0"], 0.0, atol=1e-30)


def test_closed_loop_is_recognised_and_counts_two_folds():
    circle = contin.FunctionProblem(lambda u, p: np.array([u[0] ** 2 + p["mu"] ** 2 - 1.0]), [1.0], {"mu": 0.0})
    branch = api.continuation(circle, "mu", (-2.0, 2.0))
    assert {e.reason for e in branch.ends} == {"closed"}
    np.testing.assert_allclose(sorted(p.values["mu"] for p in branch.points), [-1.0, 1.0], atol=1e-12)


def test_effort_is_counted_and_small():
    calls = 0

    def residual(u, p):
        nonlocal calls
        calls += 1
        return tank_residual(u, p)

    problem = contin.FunctionProblem(residual, [0.0, 0.0], TANK, jacobian=tank_jacobian)
    branch = api.continuation(problem, "D", (0.0, 0.5))
    assert branch.effort["evaluations"] <= 4 * branch.steps
    assert calls < 60 * len(branch)


def test_bound_value_and_user_value_are_hit_exactly():
    problem = contin.FunctionProblem(tank_residual, [0.0, 0.0], TANK, record=lambda u, p: {"sum": u[0] + u[1]})
    branch = api.continuation(problem, "D", (0.0, 0.05), values={"sum": [0.3], "D": [0.04]})
    assert branch.columns["D"][-1] == 0.05
    hit = {p.label: p.values for p in branch.points if p.type == "UZ"}
    assert hit["UZ2"]["D"] == 0.04 or hit["UZ1"]["D"] == 0.04
    assert min(abs(v["sum"] - 0.3) for v in hit.values()) < 1e-12


def test_messages_say_what_to_write():
    with pytest.raises(InputError, match=r"residual must return 2 numbers.*\(3,\)"):
        api.continuation(contin.FunctionProblem(lambda u, p: np.zeros(3), [0.0, 0.0], {"a": 1.0}), "a", (0, 1))
    with pytest.raises(InputError, match=r"no parameter 'b': the model has a"):
        api.continuation(contin.FunctionProblem(lambda u, p: u - p["a"], [0.0], {"a": 1.0}), "b", (0, 1))
    with pytest.raises(InputError, match="jacobian must return"):
        api.equilibrium(contin.FunctionProblem(lambda u, p: u, [0.0, 1.0], {"a": 1.0}, lambda u, p: np.eye(3)))
    with pytest.raises(NotFiniteError, match=r"component 0 of the residual is nan, at u = \(-1\), a = 1"):
        api.equilibrium(contin.FunctionProblem(lambda u, p: np.log(u), [-1.0], {"a": 1.0}))
    with pytest.raises(NoSolutionError, match="no equilibrium found from the start"):
        api.equilibrium(contin.FunctionProblem(lambda u, p: u**2 + p["a"], [1.0], {"a": 1.0}))


def parabola(**more):
    """x^2 = p: a fold at 0, followed over [-1, 2]."""
    given = {"residual": lambda u, p: p["p"] - u**2, **more}
    problem = contin.FunctionProblem(u0=[1.0], parameters={"p": 1.0}, states=["x"], **given)
    return api.continuation(problem, "p", (-1.0, 2.0))


def beyond(limit, act, otherwise):
    return lambda u, p: act() if np.real(p["p"]) > limit else otherwise(u, p)


def fails():
    raise RuntimeError("no data")


FAILURES = {
    "raises": (fails, r"the residual raised RuntimeError: no data \(test_functions.py, line \d+\), at u = .*, p = 1.5"),
    "wrong length": (lambda: np.zeros(2), r"must return 1 numbers, one for each state; got shape \(2,\)"),
    "nothing": (lambda: None, "must return 1 numbers, one for each state; got NoneType"),
    "NaN": (lambda: np.array([np.nan]), "component 0 of the residual is nan"),
}


@pytest.mark.parametrize("how", FAILURES)
def test_a_function_that_fails_ends_the_branch_with_its_reason_and_keeps_what_was_computed(how):
    act, reason = FAILURES[how]
    branch = parabola(residual=beyond(1.5, act, lambda u, p: p["p"] - u**2))
    assert [point.type for point in branch.points] == ["LP"]
    assert branch.columns["p"].max() == pytest.approx(1.5, rel=2e-2)  # differences in p reach beyond
    for end in branch.ends:
        assert end.reason == "corrector"
        assert re.search(reason, end.text), end.text


def test_a_jacobian_that_fails_ends_the_branch_with_its_reason():
    branch = parabola(jacobian=beyond(1.5, fails, lambda u, p: np.array([-2 * u])))
    assert [point.type for point in branch.points] == ["LP"]
    assert len(branch.ends) == 2
    assert all("the Jacobian raised RuntimeError: no data" in end.text for end in branch.ends)


def test_a_record_that_fails_leaves_gaps_and_a_note_and_the_branch_goes_on():
    whole = parabola()
    branch = parabola(record=beyond(1.5, fails, lambda u, p: {"twice": 2 * u[0]}))
    assert branch.columns["x"].tobytes() == whole.columns["x"].tobytes()
    gaps = np.isnan(branch.columns["twice"])
    np.testing.assert_array_equal(gaps, branch.columns["p"] > 1.5)
    np.testing.assert_array_equal(branch.columns["twice"][~gaps], 2 * branch.columns["x"][~gaps])
    [note] = branch.notes
    assert re.match(
        rf"twice has no value in {gaps.sum()} of {len(gaps)} rows, first at p = 2: the function `record`", note
    )


def test_an_observable_without_a_value_is_noted_with_its_reason():
    model = contin.Model(
        "fold", states={"x": 1.0}, parameters={"p": 1.0}, equations={"x": "p - x^2"}, observables={"level": "log(x)"}
    )
    branch = api.continuation(api.equilibrium(model), "p", (-1.0, 2.0))
    [note] = branch.notes
    assert re.match(
        r"level has no value in \d+ of \d+ rows, first at p = .*'log\(x\)' is not a number: logarithm", note
    )
    assert [point.type for point in branch.points] == ["LP"]


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (
            {"residual": lambda u, p: fails()},
            r"the residual raised RuntimeError: no data \(test_functions.py, line \d+\)",
        ),
        ({"residual": lambda u, p: p["q"] - u}, "the residual raised KeyError: 'q'"),
        ({"residual": lambda u, p: ["a"]}, "the residual must return numbers; got <U1 entries"),
        ({"jacobian": lambda u, p: fails()}, "the Jacobian raised RuntimeError: no data"),
        ({"record": lambda u, p: fails()}, "the function `record` raised RuntimeError: no data"),
        ({"record": lambda u, p: {"a": u * np.ones(3)}}, r"a mapping of names to numbers; 'a' has shape \(3,\)"),
        ({"record": lambda u, p: 3.0}, "record must return a mapping of names to numbers; got float"),
    ],
)
def test_a_function_that_fails_at_the_start_is_an_error_that_says_where(given, text):
    with pytest.raises(UserFunctionError, match=text):
        parabola(**given)
    with pytest.raises(InputError, match="at least one is needed"):
        contin.FunctionProblem(lambda u, p: u, [1.0], {})
