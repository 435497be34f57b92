"""Results do not go through the C library's elementary functions, nor through numpy's: both choose by the processor."""

from __future__ import annotations

import ast
from pathlib import Path

import contin

PACKAGE = Path(contin.__file__).parent
DRAWING = {"plot", "cli", "limits.py"}  # pictures, reports, messages: their digits are nobody's result
ELEMENTARY = set(
    "exp exp2 expm1 log log1p log10 log2 logaddexp sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh"
    " arcsin arccos arctan arctan2 arcsinh arccosh arctanh hypot dist pow power float_power cbrt angle logspace"
    " geomspace".split()
)
LIBRARIES = {"np", "numpy", "math", "cmath"}
NUMERICAL = {"api", "continuation", "diagram", "normalforms", "problems", "simulate"}
SOURCES = sorted(p for p in PACKAGE.rglob("*.py") if p.relative_to(PACKAGE).parts[0] not in DRAWING | {"kernels"})


def calls_of_libraries(tree: ast.AST) -> list[str]:
    """`np.exp`, `math.log`, `from math import sin`."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.value.id in LIBRARIES and node.attr in ELEMENTARY:
                found.append(f"line {node.lineno}: {node.value.id}.{node.attr}")
        elif isinstance(node, ast.ImportFrom) and node.module in ("math", "cmath", "numpy"):
            found += [f"line {node.lineno}: {a.name}" for a in node.names if a.name in ELEMENTARY]
    return found


EXACT_BASES = {"-1.0", "2.0", "2", "3", "n", "self.n"}  # signs, powers of 2, and whole numbers: sizes
COMPLEX_BASES = {"w", "value", "self.values"}  # whole powers of complex numbers, which are products


def is_exact(base: str) -> bool:
    return base in EXACT_BASES | COMPLEX_BASES or base.startswith("len(")


def powers(tree: ast.AST) -> list[str]:
    """x**2 and the like: for a float this is the C library's pow."""
    return [
        f"line {node.lineno}: {ast.unparse(node)}"
        for node in ast.walk(tree)
        if isinstance(node, ast.BinOp | ast.AugAssign)
        and isinstance(node.op, ast.Pow)
        and not (isinstance(node, ast.BinOp) and is_exact(ast.unparse(node.left)))
    ]


def test_elementary_functions_are_our_own():
    functions, signs = [], []
    for path in SOURCES:
        inside = path.relative_to(PACKAGE)
        tree = ast.parse(path.read_text(encoding="utf-8"))
        functions += [f"{inside}, {found}" for found in calls_of_libraries(tree)]
        signs += [f"{inside}, {found}" for found in powers(tree)] if inside.parts[0] in NUMERICAL else []
    assert functions == [], "write elementary.exp(x) (contin.machine.elementary)"
    assert signs == [], "write elementary.square(x) or elementary.pow(x, y)"
