"""`CompiledSystem` as kernels, problems and normal forms use it."""

import copy
import ctypes
import gc
import pickle
import threading

import numpy as np
import pytest

from contin.abi import NO_FUNCTION
from contin.errors import InputError
from contin.lowering import compile_system
from contin.model.model import Model

from .systems import bits, compiled, oscillator_network

BRUSSELATOR = {"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"}
U, P = np.array([1.3, 2.1]), np.array([0.9, 2.5])


@pytest.fixture
def brusselator():
    return compiled(BRUSSELATOR, ["A", "B"], observables={"product": "x*y", "ratio": "x/y"})


def test_value_and_jacobian_of_the_brusselator(brusselator):
    x, y, a, b = *U, *P
    f, matrix = brusselator.jacobian(U, P)
    np.testing.assert_allclose(f, [a - (b + 1) * x + x * x * y, b * x - x * x * y], rtol=1e-15)
    np.testing.assert_allclose(
        matrix, [[-(b + 1) + 2 * x * y, x * x, 1, -x], [b - 2 * x * y, -x * x, 0, x]], rtol=1e-15
    )
    assert bits(brusselator.value(U, P)) == bits(f)
    assert (brusselator.n, brusselator.m, brusselator.p_size) == (2, 2, 2)


def test_many_points_in_one_call_are_the_single_points(brusselator):
    states, parameters = np.random.default_rng(1).normal(size=(2, 50, 2))
    singles = [brusselator.value(u, p) for u, p in zip(states, parameters, strict=True)]
    assert bits(brusselator.values(states, parameters)) == bits(singles)
    assert bits(brusselator.values(states[:, ::-1], P)) == bits([brusselator.value(u[::-1], P) for u in states])
    assert brusselator.values(np.empty((0, 2)), P).shape == (0, 2)
    np.testing.assert_allclose(
        brusselator.observables(states, P), np.stack([states.prod(1), states[:, 0] / states[:, 1]], 1)
    )
    np.testing.assert_allclose(brusselator.observables(U, P), [U[0] * U[1], U[0] / U[1]])


def test_addresses_follow_the_abi(brusselator):
    """Called as a kernel calls them: addresses of float64 arrays, nothing else."""

    def call(address, *arrays):
        ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * len(arrays))(address)(*[a.ctypes.data for a in arrays])

    rng = np.random.default_rng(2)
    f, matrix, out, observed = np.full(2, 7.0), np.full((2, 4), 7.0), np.full(2, 7.0), np.full(2, 7.0)
    v, w, s = rng.normal(size=(3, 4))
    call(brusselator.value_address, U, P, f)
    assert bits(f) == bits(brusselator.value(U, P))
    call(brusselator.jacobian_address, U, P, f, matrix)
    assert bits(matrix) == bits(brusselator.jacobian(U, P)[1])
    call(brusselator.form(2), U, P, v, w, out)
    assert bits(out) == bits(brusselator.derivative(U, P, v, w))
    call(brusselator.form(3), U, P, v, w, s, out)
    assert bits(out) == bits(brusselator.derivative(U, P, v, w, s))
    call(brusselator.observe_address, U, P, observed)
    assert bits(observed) == bits(brusselator.observables(U, P))
    assert brusselator.switches_address == NO_FUNCTION


def test_second_and_third_derivative_of_the_brusselator(brusselator):
    x, y = U
    v, w, s = np.random.default_rng(4).normal(size=(3, 4))
    quadratic = 2 * y * v[0] * w[0] + 2 * x * (v[0] * w[1] + v[1] * w[0])  # of x^2 y
    cubic = 2 * (v[0] * w[0] * s[1] + v[0] * w[1] * s[0] + v[1] * w[0] * s[0])
    bilinear = v[3] * w[0] + v[0] * w[3]  # of B x
    np.testing.assert_allclose(brusselator.derivative(U, P, v, w), [quadratic - bilinear, bilinear - quadratic])
    np.testing.assert_allclose(brusselator.derivative(U, P, v, w, s), [cubic, -cubic])
    np.testing.assert_allclose(brusselator.derivative(U, P, v, v, w, s), [0, 0])
    np.testing.assert_allclose(brusselator.gradient(U, P, v) @ w, brusselator.derivative(U, P, v, w), rtol=1e-13)


def test_derivative_converges_to_differences_of_the_jacobian(brusselator):
    """(J(z + h v) - J(z - h v))/(2 h) w = D^2 f[v, w] + O(h^2)."""
    system = compiled({"x": "sin(x*y) + exp(a*x)/y", "y": "tanh(x - a)*y^3"}, ["a"])
    z, (v, w) = np.array([0.4, 0.8, -0.3]), np.random.default_rng(6).normal(size=(2, 3))

    def jacobian(at):
        return system.jacobian(at[:2], at[2:])[1]

    exact = system.derivative(z[:2], z[2:], v, w)
    steps = 0.02 / 2.0 ** np.arange(4)
    errors = [np.abs((jacobian(z + h * v) - jacobian(z - h * v)) @ w / (2 * h) - exact).max() for h in steps]
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.05)


def test_complex_directions_are_multilinear_and_share_evaluations(brusselator, monkeypatch):
    rng = np.random.default_rng(7)
    q = rng.normal(size=4) + 1j * rng.normal(size=4)
    a, b = q.real, q.imag

    def form(*v):
        return brusselator.derivative(U, P, *v)

    calls = []
    inner = brusselator._calls.form
    monkeypatch.setattr(brusselator._calls, "form", lambda *args: calls.append(1) or inner(*args))
    got = form(q, q, q.conj())
    assert len(calls) == 4  # aaa, aab, abb, bbb instead of 8
    monkeypatch.undo()
    want = form(a, a, a) + form(a, b, b) + 1j * (form(a, a, b) + form(b, b, b))
    np.testing.assert_allclose(got, want, rtol=1e-12)
    np.testing.assert_allclose(form(q, q), form(a, a) - form(b, b) + 2j * form(a, b), rtol=1e-12)
    np.testing.assert_allclose(form(q, 1j * q), 1j * form(q, q), rtol=1e-12)


def test_branch_not_taken_does_not_leak_nan():
    system = compiled({"x": "sqrt(x) if x > 0 else x^2", "y": "log(y)/y if y > 0 else 0", "z": "x/z if z != 0 else 1"})
    u = [-2.0, 0.0, 0.0]
    assert bits(system.value(u, [])) == bits([4.0, 0.0, 1.0])
    matrix = system.jacobian(u, [])[1]
    np.testing.assert_array_equal(matrix, [[-4.0, 0, 0], [0, 0, 0], [0, 0, 0]])
    v = np.ones(3)
    np.testing.assert_array_equal(system.derivative(u, [], v, v), [2.0, 0, 0])
    np.testing.assert_array_equal(system.derivative(u, [], v, v, v), [0.0, 0, 0])


@pytest.mark.parametrize("text", ["min(x, y)", "max(x, y)", "sign(x)", "heaviside(x)", "abs(x)", "x*0.5"])
def test_nan_that_is_used_is_not_hidden(text):
    assert np.isnan(compiled({"x": text, "y": "0"}).value([np.nan, 1.0], [])[0])


def test_explain_names_the_equation_and_the_reason():
    system = compiled({"x": "x", "y": "log(x - a)/2"}, ["a"])
    assert system.why_not_finite([2.0, 0.0], [1.0]) is None
    text = system.why_not_finite([0.5, 0.0], [1.0])
    assert text.startswith("not finite at this point: equation y: 'log(x - a)'")
    assert "logarithm of a negative number" in text
    assert system.why_not_finite([np.nan, np.nan], [1.0]).startswith("no state is a number any more")


def test_explain_names_the_entry_of_the_jacobian_where_the_equations_are_finite():
    text = compiled({"x": "y", "y": "sqrt(x) - y"}).why_not_finite([0.0, 1.0], [])
    assert text.startswith("not finite at this point: equation d(y)/d(x): ")
    assert "division by zero" in text


def test_forced_system_takes_the_time_after_the_parameters():
    system = compiled({"x": "v", "v": "-x + F*cos(w*t)"}, ["F", "w"], forcing="2*pi/w")
    u, (force, w, t) = [0.3, -0.2], (0.7, 1.9, 4.2)
    f, matrix = system.jacobian(u, [force, w, t])
    np.testing.assert_allclose(f, [-0.2, -0.3 + force * np.cos(w * t)], rtol=1e-15)
    np.testing.assert_allclose(
        matrix[1], [-1, 0, np.cos(w * t), -force * t * np.sin(w * t), -force * w * np.sin(w * t)], rtol=1e-14
    )
    np.testing.assert_allclose(system.derivative(u, [force, w, t], [0, 0, 0, 1.0]), f * 0 + matrix[:, 3])
    assert (system.m, system.p_size, system.is_forced) == (2, 3, True)


def test_the_jacobian_of_a_ring_has_its_neighbours_and_nothing_else():
    rng = np.random.default_rng(8)
    matrix = compile_system(oscillator_network(12, 2)).jacobian(rng.normal(size=12), rng.normal(size=13))[1]
    assert np.count_nonzero(matrix) == 12 * (3 + 2)  # itself and two neighbours, K and its own frequency


def test_large_jacobian_is_cleared_before_it_is_filled():
    system = compile_system(oscillator_network(40, 1))
    address, n = system.jacobian_address, 40
    matrix, f = np.full((n, n + n + 1), np.nan), np.empty(n)
    u, p = np.linspace(0, 1, n), np.ones(n + 1)
    ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 4)(address)(*[a.ctypes.data for a in (u, p, f, matrix)])
    assert np.count_nonzero(matrix) == 40 * (3 + 1)
    assert np.isfinite(matrix).all()


def test_model_travels_through_pickle_and_copy():
    model = Model(
        "brusselator",
        states={"x": 1, "y": 2},
        parameters={"A": 1, "B": 2},
        equations=BRUSSELATOR,
        observables={"late": "x/(1 - exp(-x))"},
    )
    system = compile_system(model)
    value, seen = system.value(U, P), system.observables([0.0, 1.0], P)
    for other in (pickle.loads(pickle.dumps(system)), copy.copy(system), copy.deepcopy(system)):  # noqa: S301
        assert other is not system
        assert bits(other.value(U, P)) == bits(value)
        assert bits(other.observables([0.0, 1.0], P)) == bits(seen)
    assert seen[0] == 1.0


def test_code_lives_as_long_as_something_can_call_it():
    functions = [compiled({"x": f"{k}*x + a"}, ["a"]).value for k in range(20)]
    gc.collect()
    assert [value([2.0], [0.5])[0] for value in functions] == [2.0 * k + 0.5 for k in range(20)]


def test_threads_do_not_disturb_each_other(monkeypatch):
    """Split bodies with scratch, first compiled by whichever thread comes first, called by four at the same time."""
    from contin.lowering import llvm_text

    monkeypatch.setattr(llvm_text, "UNSPLIT", 50)
    monkeypatch.setattr(llvm_text, "PART", 40)
    model = oscillator_network(20, 4)
    points = np.random.default_rng(9).normal(size=(4, 50, 20))
    p = np.ones(21)
    reference = compile_system(model)
    want = [
        [bits(reference.jacobian(u, p)[1]) + bits(reference.values(points[k], p)) for u in points[k]] for k in range(4)
    ]
    system = compile_system(model)
    wrong: list[int] = []
    barrier = threading.Barrier(4)

    def work(k):
        barrier.wait()
        for _ in range(5):
            for u, expected in zip(points[k], want[k], strict=True):
                if bits(system.jacobian(u, p)[1]) + bits(system.values(points[k], p)) != expected:
                    wrong.append(k)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: s.value([1.0], P), r"u must have shape \(2,\); got \(1,\)"),
        (lambda s: s.jacobian(U, [1.0, 2.0, 3.0]), r"p must have shape \(2,\); got \(3,\)"),
        (lambda s: s.values(np.zeros((3, 5)), P), r"u must have shape \(N, 2\); got \(3, 5\)"),
        (lambda s: s.values(np.zeros((3, 2)), np.zeros((2, 2))), r"p must have shape \(2,\) or \(3, 2\); got \(2, 2\)"),
        (lambda s: s.derivative(U, P, U), r"a direction must have shape \(4,\) for \(u, p\); got \(2,\)"),
        (lambda s: s.form(0), "order must be 1 or more; got 0"),
    ],
)
def test_wrong_shapes_are_refused_before_the_machine_code_sees_them(brusselator, call, message):
    with pytest.raises(ValueError, match=message):
        call(brusselator)


def test_unknown_symbol_is_named():
    model = compiled({"x": "x"}).model
    from contin.model.expression import symbol

    broken = type(model)(("x",), (), (symbol("x") + symbol("lost"),))
    with pytest.raises(InputError, match="x: 'lost' is neither a state nor a parameter"):
        compile_system(broken)


def test_system_without_parameters_and_with_constant_equations():
    system = compiled({"x": "0", "y": "1/3"})
    f, matrix = system.jacobian([1.0, 2.0], [])
    np.testing.assert_array_equal(f, [0.0, 1 / 3])
    np.testing.assert_array_equal(matrix, np.zeros((2, 2)))
    assert system.why_not_finite([1.0, 2.0], []) is None


@pytest.mark.parametrize("offset", [0.0, 1e-9, -1e-6, 1e-3, 2.6])
def test_removable_singularities_are_removed_before_differentiation(offset):
    """(V + 40)/(1 - exp(-(V + 40)/10)) = 10 + u/2 + u^2/120 - u^4/720000 + u^6/302400000 - ..., u = V + 40."""
    system = compiled({"V": "0.1*(V + 40)/(1 - exp(-(V + 40)/10)) - V"})
    V, one = -40.0 + offset, np.ones(1)
    u = V + 40.0
    value = system.value([V], [])[0] + V
    assert value == pytest.approx(1 + u / 20 + u**2 / 1200 - u**4 / 7.2e6, abs=1e-7)
    second = system.derivative([V], [], one, one)[0]
    third = system.derivative([V], [], one, one, one)[0]
    assert second == pytest.approx(1 / 600 - u**2 / 6e5 + u**4 / 1.008e9, abs=1e-9)
    assert third == pytest.approx(-u / 3e5 + u**3 / 2.52e8, abs=2e-9)
    assert system.n_switches == 0


def test_gradients_at_many_points_are_those_at_each():
    generator = np.random.default_rng(3)
    system = compile_system(
        Model("two", states={"x": 1, "y": 1}, parameters={"a": 2}, equations={"x": "x^2*y*a", "y": "sin(x*y) - a^2*x"})
    )
    u, p = generator.normal(size=(5, 2)), generator.normal(size=(5, 1))
    v = generator.normal(size=(5, 3)) + 1j * generator.normal(size=(5, 3))
    expected = np.array([system.gradient(*row) for row in zip(u, p, v, strict=True)])
    np.testing.assert_allclose(system.gradients(u, p, v), expected, rtol=1e-14)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivatives_at_many_points_are_those_at_each(order):
    generator = np.random.default_rng(4)
    system = compile_system(
        Model("two", states={"x": 1, "y": 1}, parameters={"a": 2}, equations={"x": "x^2*y*a", "y": "sin(x*y) - a^2*x"})
    )
    u, p = generator.normal(size=(5, 2)), generator.normal(size=(5, 1))
    v = generator.normal(size=(5, 3)) + 1j * generator.normal(size=(5, 3))
    directions = [v, v.conj(), generator.normal(size=(5, 3))][:order]
    expected = np.array([system.derivative(*row) for row in zip(u, p, *directions, strict=True)])
    np.testing.assert_allclose(system.derivatives(u, p, *directions), expected, rtol=1e-13, atol=1e-13)


def test_long_forms_along_states_alone_are_those_of_all_directions():
    """By linearity: D^5[.., v + w] - D^5[.., w] with w along a parameter, for one and for many points."""
    equations = {"x": "a*sin(x*y)*exp(-b*y) + x^6*b", "y": "x*y^4/(1 + a*x^2)"}
    model = Model("m", states={"x": 0.3, "y": 0.7}, parameters={"a": 0.4, "b": 1.2}, equations=equations)
    system, u, p = compile_system(model), np.array([0.3, 0.7]), np.array([0.4, 1.2])
    along = np.zeros((5, 4))
    along[:, :2] = np.random.default_rng(2).normal(size=(5, 2))
    other = np.array([0.0, 0.0, 0.6, -0.3])
    alone = system.derivative(u, p, *along)
    both, rest = (system.derivative(u, p, *along[:4], last) for last in (along[4] + other, other))
    assert alone == pytest.approx(both - rest, rel=1e-12)
    rows = system.derivatives(np.tile(u, (3, 1)), np.tile(p, (3, 1)), *[np.tile(v, (3, 1)) for v in along])
    assert rows == pytest.approx(np.tile(alone, (3, 1)), rel=1e-14)
    routines = {name: system.statements(name) for name in ("form5", "form5s")}
    assert routines["form5s"] < 0.5 * routines["form5"]
