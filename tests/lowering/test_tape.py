"""The straight list of operations: what is shared, how a node is computed, what it costs."""

import numpy as np
import pytest

from contin.lowering import compile_system, llvm_text
from contin.lowering.tape import Tape
from contin.model.expression import symbol
from contin.model.parser import parse

from .systems import bits, compiled, equations, oscillator_network

SCOPE = {name: symbol(name) for name in "xyza"}


def operations(*texts):
    """Operations needed for formulas in x, y, z, a; loads and constants left out."""
    tape = Tape({name: (0, i) for i, name in enumerate(SCOPE)})
    statements, _ = tape.pruned([tape.evaluate(parse(text, SCOPE)) for text in texts])
    return [s[1] if s[0] == "call" else s[0] for s in statements if s[0] not in ("const", "load")]


@pytest.mark.parametrize(
    ("texts", "expected"),
    [
        (["x*y/(z*a^2)"], ["fmul", "fmul", "fmul", "fdiv"]),  # one division
        (["x^8"], ["fmul"] * 3),
        (["x^7"], ["fmul"] * 4),
        (["x^2 + x^3 + x^4"], ["fmul"] * 3 + ["fadd"] * 2),  # powers share lower powers
        (["x^0.5"], ["sqrt"]),
        (["x^2.5"], ["fmul", "sqrt", "fmul"]),
        (["x^(-1.5)"], ["sqrt", "fmul", "fdiv"]),
        (["x^y"], ["pow"]),
        (["x^0.3"], ["pow"]),
        (["x - y"], ["fsub"]),
        (["-x - y"], ["fadd", "fneg"]),
        (["x - 2*y*z"], ["fmul", "fmul", "fsub"]),
        (["-(x*y)", "x*y"], ["fmul", "fneg"]),
        (["sin(x - y)", "sin(y - x)"], ["fsub", "sin", "fneg"]),  # odd functions once
        (["cos(x - y)", "cos(y - x)"], ["fsub", "cos"]),
        (["sin(x)", "exp(y)", "cos(x)"], ["sin", "cos", "exp"]),  # side by side: one call computes both
        (["x + y if x > y else x + y + z"], ["fcmp ogt", "fadd", "fadd", "select"]),
    ],
)
def test_operations(texts, expected):
    assert sorted(operations(*texts)) == sorted(expected)
    if "sin" in expected and "cos" in expected:
        found = operations(*texts)
        assert abs(found.index("sin") - found.index("cos")) == 1


def test_long_sums_are_added_in_pairs():
    """1 + 2^-60 + ... + 2^-60 (1023 times): pairs keep the small terms, one after the other loses them all."""
    names = ["big", *(f"x{i}" for i in range(1023))]
    system = compiled({name: " + ".join(names) if name == "big" else "0" for name in names})
    u = np.full(1024, 2.0**-60)
    u[0] = 1.0
    assert abs(system.value(u, [])[0] - (1 + 1023 * 2.0**-60)) <= 2.0**-52
    depth = {}
    tape = Tape({name: (0, i) for i, name in enumerate(names)})
    statements, _ = tape.pruned([tape.evaluate(parse(" + ".join(names), {n: symbol(n) for n in names}))])
    for index, statement in enumerate(statements):
        depth[index] = 1 + max(depth[o] for o in statement[1:]) if statement[0] == "fadd" else 0
    assert max(depth.values()) == 10


def test_statements_of_a_ring_grow_linearly():
    """f and the full Jacobian of n phase oscillators with 4 neighbours: at most 30 statements a row."""
    counts = [compile_system(oscillator_network(n, 4)).statements("jacobian") for n in (20, 40, 80)]
    assert counts[2] - counts[1] == 2 * (counts[1] - counts[0])
    assert counts[0] <= 30 * 20  # measured 23 a row


def test_all_to_all_coupling_computes_each_sine_once():
    n = 30
    system = compile_system(oscillator_network(n, n - 1))
    assert system.statements("value") <= 2.5 * n * n  # n (n - 1)/2 differences and sines, n^2 additions; measured 2.1


@pytest.mark.parametrize("part", [3, 17, 60])
def test_split_bodies_give_the_same_bits(monkeypatch, part):
    """Nothing is reassociated or contracted, so cutting a body cannot change a result (NaN included)."""
    texts = {
        "x": "sin(x - y)*exp(-z) + (x^3 if x < y and not z > a else cos(x)/y)",
        "y": "min(x, y)*tanh(a*z) - abs(z)^1.5*sign(x)",
        "z": "atan2(x, y) + heaviside(x - a)*max(z, log(2 + cos(y)))",
    }
    whole, split = equations(texts, ["a"]), equations(texts, ["a"])
    expected = compile_system(whole)
    points = np.random.default_rng(3).normal(size=(20, 4))
    wanted = [expected.jacobian(z[:3], z[3:]) for z in points]
    monkeypatch.setattr(llvm_text, "PART", part)
    monkeypatch.setattr(llvm_text, "UNSPLIT", 10)
    for limit in (4096, 0):  # scratch on the stack, on the heap
        monkeypatch.setattr(llvm_text, "STACK_SCRATCH", limit)
        system = compile_system(split)
        assert system.statements("jacobian") == expected.statements("jacobian") > 3 * part / 2
        for z, (f, matrix) in zip(points, wanted, strict=True):
            got_f, got_matrix = system.jacobian(z[:3], z[3:])
            assert bits(got_f) == bits(f)
            assert bits(got_matrix) == bits(matrix)


def test_scratch_slots_are_used_again():
    """A chain of parts needs the values alive at once, not one slot for every value."""
    text = "x"
    for k in range(60):
        text = f"sin({text} + {k})*y"
    tape = Tape({name: (0, i) for i, name in enumerate(SCOPE)})
    statements, _ = tape.pruned([tape.evaluate(parse(text, SCOPE))])
    parts = [range(a, min(a + 5, len(statements))) for a in range(0, len(statements), 5)]
    slots, size = llvm_text._scratch_slots(statements, parts)
    assert len(slots) >= 30
    assert size <= 2


def test_same_system_gives_the_same_bits_again():
    model = oscillator_network(12, 3)
    u, p = np.linspace(-3, 3, 12), np.linspace(0.5, 2, 13)
    first, second = compile_system(model), compile_system(model)
    assert bits(first.jacobian(u, p)[1]) == bits(second.jacobian(u, p)[1])
