"""Julia files: their formulas, read back by the tables of that language."""

import re

import numpy as np
import pytest

from contin.exchange import registry
from contin.exchange.formulas.contin_text import Writer
from contin.exchange.formulas.parser import Binary, Dialect, Prefix, parse
from contin.exchange.formulas.tree import Node, own
from contin.model.evaluate import evaluate_all
from contin.model.registry import load

JULIA = Dialect(
    tokens=re.compile(
        r"(?P<space>\s+)|(?P<number>\d+(?:\.\d*)?(?:e[-+]?\d+)?)|(?P<name>[A-Za-z_π]\w*)"
        r"|(?P<op><=|>=|==|!=|&&|\|\||[-+*/^<>!(),?:])"
    ),
    binary={
        ":": Binary(0, "else", right=True),
        "?": Binary(1, "then"),
        "||": Binary(2, "or"),
        "&&": Binary(3, "and"),
        **{op: Binary(4, op) for op in ("<", "<=", ">", ">=", "==", "!=")},
        **{op: Binary(5, op) for op in "+-"},
        **{op: Binary(6, op) for op in "*/"},
        "^": Binary(8, "^", right=True),
    },
    prefix={"-": Prefix(7, "neg"), "!": Prefix(9, "not")},
    fold=False,
)
MODEL = {
    "name": "mixed",
    "states": {"V": 0.3, "w": -0.2},
    "parameters": {"a": 0.5, "end": 1.5},
    "definitions": {"c": "exp(-V^2)*a/3 if V*w > 0 and not (V > 2 or w == 1) else -V^2/(1 + w^2)"},
    "equations": {
        "V": "c*sin(w) - c^2/7 + 2^-V - (-V)^2 + end*w^3",
        "w": "sign(V)*abs(V)^a + heaviside(w) + min(V, w, a) + atan2(V, w) + mod(V, a) + floor(w) - (w - (V - a))",
    },
}


def condition(node: Node) -> Node:
    """a ? b : c as this test's tables read it."""
    args = tuple(condition(arg) for arg in node.args)
    if node.kind == "else":
        return Node("if", (*args[0].args, args[1]))
    if node.kind == "call":
        return own({"atan": "atan2"}.get(node.text, node.text) if len(args) == 2 else node.text, *args)
    return Node(node.kind, args, node.text)


def test_formulas_of_a_julia_file():
    model = load(MODEL)
    text = registry.write(model, "x.jl").text
    assert "u0 = [0.3, -0.2]" in text
    body = text.partition("function f!")[2].partition("return du")[0]
    assert re.search(r"V, w = u\n +\(; a, end2\) = p", body)
    known: dict[str, str] = {"π": "pi"}
    rows = []
    for name, formula in re.findall(r"^ +(\w+|du\[\d\]) = (?!u\n|p\n)(.*)$", body, re.MULTILINE):
        written = Writer(lambda key: known.get(key, key), {}, lambda writer, node: pytest.fail(node.text)).number(
            condition(parse(formula, JULIA))
        )
        if name.startswith("du"):
            rows.append(written)
        else:
            known[name] = f"({written})"
    again = load(
        {
            **MODEL,
            "parameters": {"a": 0.5, "end2": 1.5},
            "definitions": {},
            "equations": dict(zip("Vw", rows, strict=True)),
        }
    )
    rng = np.random.default_rng(1)
    for _ in range(20):
        values = dict(zip(("V", "w", "a"), map(float, rng.uniform(-1, 1, 3)), strict=True))
        values["a"] = abs(values["a"])
        left = evaluate_all(model.equations, {**values, "end": 1.5})
        assert evaluate_all(again.equations, {**values, "end2": 1.5}) == pytest.approx(left, rel=1e-14)
