"""Large models are read by short cuts that change nothing: the same document, the identical nodes, exact dependence."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contin.errors import InputError
from contin.model import yaml_lines
from contin.model.expression import depends_on, number, symbol
from contin.model.parser import parse
from contin.model.symbol_masks import CROWD, crowd
from contin.model.yaml_loader import load_model_text
from contin.model.yaml_reader import _read, _Reader, read_text

VALUES = st.sampled_from(["0", "1e-3", "x + 2*y", "true", "-z"])
PLAIN = st.builds("  {}: {}\n".format, st.sampled_from("abcdefgh"), VALUES)
ODD = st.sampled_from(
    ["top:\n", "other: |\n", "other: >-\n", "x: {\n", "}\n", "- a: 1\n", "\n", "# c\n", "    more\n", "  q: 'r'\n",
     "  k: [1,\n", "]\n", '  "s": "\n', "  a: b c: d\n", "z: word\n", "&a  b: 1\n", "  e: *a\n", "--- \n", "\t\n"]
)  # fmt: skip


def outcome(read):
    """What a reading comes to: the data with the place of every value, or the message."""
    try:
        document = read()
    except InputError as error:
        return str(error)
    return document.data, document.source.marks


@settings(max_examples=100, deadline=None)
@given(st.lists(st.one_of(PLAIN, PLAIN, PLAIN, ODD), min_size=1, max_size=25))
def test_a_text_with_long_runs_of_lines_is_read_as_it_would_be_line_by_line(lines):
    text = "".join(lines)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(yaml_lines, "FEWEST", 3)
        short = outcome(lambda: read_text(text, "f"))
    assert short == outcome(lambda: _read(_Reader("f", text)))


def test_long_runs_are_held_back():
    text = "states:\n" + "".join(f"  x{k}: {k}\n" for k in range(1000)) + "name: m\n"
    short = yaml_lines.shorten(text)
    assert len(short.text) < 100
    assert read_text(text).data["states"]["x998"] == 998


def chain(n: int) -> str:
    rows = [f"  u{k}: k*(u{max(k - 1, 0)} - 2*u{k} + u{min(k + 1, n - 1)}) + g(u{k})*2.5e-1 + d" for k in range(n)]
    head = "contin: 1\nname: chain\nparameters: {k: 1, p: 0}\nfunctions: {g(v): p*exp(v) if v > 0 else v}\n"
    states = "".join(f"  u{k}: 0\n" for k in range(n))
    return head + "definitions: {d: u0*p}\nstates:\n" + states + "equations:\n" + "\n".join(rows)


def test_formulas_made_from_templates_are_the_identical_nodes():
    n = 150
    model = load_model_text(chain(n))
    scope = {**{s: symbol(s) for s in (*model.state_names, "k", "p")}, **model.definitions}
    for k in (0, 1, 2, 77, n - 2, n - 1):
        text = chain(n).splitlines()[-n + k].split(": ", 1)[1]
        assert model.equations[k] is parse(text, scope, model.functions)


def test_mistakes_in_one_of_many_formulas_are_found_at_their_place():
    text = chain(200).replace("u120 +", "u999 +")
    with pytest.raises(InputError, match=r"unknown name 'u999'"):
        load_model_text(text)


def test_dependence_is_exact_where_many_symbols_share_bits():
    names = [f"crowded{k}" for k in range(CROWD + 1)]
    crowd(names)
    first, last = symbol(names[0]), symbol(names[1024])
    assert first.mask == last.mask  # they share a bit
    assert depends_on(first, [names[0]])
    assert not depends_on(first, [names[1024]])
    assert not depends_on(first * 2 + 1, [names[1024], "elsewhere"])


def test_derivatives_are_exact_where_symbols_share_bits():
    from contin.symbolic.calculus.derivatives import sparse_jacobian

    names = [f"crowded{k}" for k in range(CROWD + 1)]
    crowd(names)
    a, b = names[3], names[3 + 1024]
    x, y = symbol(a), symbol(b)
    entries = sparse_jacobian([x * y, x**2, y * 3], [a, b])
    assert entries == {(0, 0): y, (0, 1): x, (1, 0): 2 * x, (2, 1): number(3)}


def test_a_large_model_survives_its_own_text():
    model = load_model_text(chain(120))
    assert load_model_text(model.text()).equations == model.equations
