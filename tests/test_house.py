"""The house: no circle of imports, annotations counted, and no long function outside the kernels."""

import ast
from collections.abc import Container, Iterator
from functools import cache
from pathlib import Path

import networkx as nx

import contin

ROOT = Path(contin.__file__).parent
LONGEST = 60  # lines of a function


@cache
def modules() -> dict[str, tuple[set[str], list[str]]]:
    """Every module of contin by its dotted name: names that may be modules it takes, and its long functions.

    The syntax trees of all, a quarter of a gigabyte, are not kept.
    """
    found = {}
    for path in sorted(ROOT.rglob("*.py")):
        parts = ("contin", *path.relative_to(ROOT).with_suffix("").parts)
        name = ".".join(parts).removesuffix(".__init__")
        tree = ast.parse(path.read_text(encoding="utf-8"))
        found[name] = imported(tree), [f"{name}.{one}" for one in long_functions(tree)]
    return found


def statements(tree: ast.AST) -> Iterator[ast.AST]:
    """All statements of a module, without the expressions in them: a tenth of its nodes."""
    for part in ("body", "orelse", "handlers", "finalbody", "cases"):
        for node in getattr(tree, part, ()):
            yield node
            yield from statements(node)


def imported(tree: ast.Module) -> set[str]:
    """Dotted names that a module takes, at run time or for annotations: of modules, or of what is in them."""
    names = set()
    for node in statements(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def long_functions(tree: ast.Module) -> list[str]:
    """Names and lengths of the functions that are too long."""
    return [
        f"{node.name}: {node.end_lineno - node.lineno + 1} lines"
        for node in statements(tree)
        if isinstance(node, ast.FunctionDef) and node.end_lineno - node.lineno + 1 > LONGEST
    ]


def taken(name: str, known: Container[str]) -> str:
    """The module that a dotted name is, or is in."""
    return name if name in known else name.rpartition(".")[0]


def test_no_circle_of_imports_where_annotations_count():
    known = modules()
    graph = nx.DiGraph(
        (name, other) for name, (names, _) in known.items() for other in {taken(n, known) for n in names} & set(known)
    )
    assert graph.number_of_edges() > len(known)
    circles = [sorted(part) for part in nx.strongly_connected_components(graph) if len(part) > 1]
    assert circles == [], "\n".join(" <-> ".join(part) for part in circles)


def test_functions_are_short_outside_the_kernels():
    long = [one for name, (_, ones) in modules().items() if not name.startswith("contin.kernels") for one in ones]
    assert long == []
