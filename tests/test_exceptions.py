"""Every `except` names what it catches; in numerics, one that goes on without a word has a comment that says why."""

import ast
from collections.abc import Iterator
from pathlib import Path

import contin

ROOT = Path(contin.__file__).parent
BROAD = {"Exception", "BaseException"}
NUMERIC = {
    "api",
    "continuation",
    "diagram",
    "homoclinic",
    "loci",
    "normalforms",
    "problems",
    "search",
    "simulate",
    "systems",
    "transitions",
}
NOTHING = (None, False, 0, 0.0, "")


def names(expression: ast.expr | None) -> list[str]:
    """Last parts of the exceptions' names."""
    if expression is None:
        return []
    parts = expression.elts if isinstance(expression, ast.Tuple) else [expression]
    return [part.attr if isinstance(part, ast.Attribute) else getattr(part, "id", "?") for part in parts]


def is_nothing(value: ast.expr | None) -> bool:
    """None, False, 0, "", an empty list, tuple, set or mapping, nan."""
    if value is None:
        return True
    if isinstance(value, ast.Constant):
        return value.value in NOTHING
    if isinstance(value, ast.Tuple):
        return all(is_nothing(part) for part in value.elts)
    if isinstance(value, ast.List | ast.Set):
        return not value.elts
    if isinstance(value, ast.Dict):
        return not value.keys
    return "nan" in ast.unparse(value) and not isinstance(value, ast.Name)


def swallows(handler: ast.ExceptHandler) -> bool:
    """True where all that the handler does is to go on, or to answer with nothing."""
    (first, *more) = handler.body
    if more:
        return False
    if isinstance(first, ast.Return | ast.Assign):
        return is_nothing(first.value)
    return isinstance(first, ast.Pass | ast.Continue | ast.Break)


def complaints(path: Path) -> Iterator[str]:
    text = path.read_text(encoding="utf-8")
    if "except" not in text and "suppress" not in text:
        return
    lines = text.splitlines()
    name = path.relative_to(ROOT)
    numeric = name.parts[0] in NUMERIC

    def has_reason(first: int, last: int) -> bool:
        parts = [line.split("#", 1)[1] for line in lines[first - 1 : last] if "#" in line]
        return any(part.strip() and not part.strip().startswith(("noqa", "type:")) for part in parts)

    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.ExceptHandler | ast.With):
            continue
        place = f"{name}:{getattr(node, 'lineno', 0)}"
        if isinstance(node, ast.ExceptHandler):
            broad = not names(node.type) or BROAD & set(names(node.type))
            raises = any(isinstance(part, ast.Raise) for part in ast.walk(node))
            reason = has_reason(node.lineno, node.body[-1].end_lineno or node.lineno)
            if broad and not (raises or reason or "noqa: BLE001 " in lines[node.lineno - 1]):
                yield f"{place}: catches {names(node.type) or 'everything'} and does not say why"
            if numeric and swallows(node) and not reason:
                yield f"{place}: swallows {', '.join(names(node.type))} and does not say why nothing is lost"
        if isinstance(node, ast.With) and numeric:
            for item in node.items:
                call, first = item.context_expr, node.lineno
                if isinstance(call, ast.Call) and "suppress" in names(call.func) and not has_reason(first, first):
                    yield f"{place}: suppresses {', '.join(ast.unparse(a) for a in call.args)} without a reason"


def test_what_is_caught_is_named_and_what_is_swallowed_is_explained():
    found = [text for path in sorted(ROOT.rglob("*.py")) for text in complaints(path)]
    assert found == [], "\n".join(found)
