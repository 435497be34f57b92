"""The house: no circle of imports, annotations counted, and no long function outside the kernels."""

import ast
from functools import cache
from pathlib import Path

import networkx as nx

import contin

ROOT = Path(contin.__file__).parent
LONGEST = 60  # lines of a function


@cache
def modules() -> dict[str, ast.Module]:
    """Every module of contin by its dotted name, as a syntax tree."""
    found = {}
    for path in sorted(ROOT.rglob("*.py")):
        parts = ("contin", *path.relative_to(ROOT).with_suffix("").parts)
        name = ".".join(parts).removesuffix(".__init__")
        found[name] = ast.parse(path.read_text(encoding="utf-8"))
    return found


def imported(tree: ast.Module, known: set[str]) -> set[str]:
    """The modules whose names a module takes, at run time or for annotations."""
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            inside = {f"{node.module}.{alias.name}" for alias in node.names}
            names |= {name if name in known else node.module for name in inside}
    return names & known


def test_no_circle_of_imports_where_annotations_count():
    trees = modules()
    graph = nx.DiGraph((name, other) for name, tree in trees.items() for other in imported(tree, set(trees)))
    circles = [sorted(part) for part in nx.strongly_connected_components(graph) if len(part) > 1]
    assert circles == [], "\n".join(" <-> ".join(part) for part in circles)


def test_functions_are_short_outside_the_kernels():
    long = [
        f"{name}.{node.name}: {node.end_lineno - node.lineno + 1} lines"
        for name, tree in modules().items()
        if not name.startswith("contin.kernels")
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and node.end_lineno - node.lineno + 1 > LONGEST
    ]
    assert long == []
