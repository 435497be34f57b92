"""Numbers, texts and expressions given to a pass as options -> expressions."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from contin.errors import ExpressionError, InputError
from contin.model.expression import Expression, as_expression, symbols_in
from contin.model.parser import parse


def read(value: Any, names: Iterable[str], where: str) -> Expression:
    """The formula `value` in these names; `where` begins the message about a mistake."""
    allowed = list(names)
    if isinstance(value, str):
        try:
            return parse(value, allowed)
        except ExpressionError as error:
            raise InputError(f"{where} = {value!r}: {error}") from None
    if isinstance(value, bool) or value is None or isinstance(value, (list, dict)):
        raise InputError(f"{where}: expected a number or a formula, got {value!r}")
    formula = as_expression(value)
    unknown = [n for n in symbols_in([formula]) if n not in allowed]
    if unknown:
        raise InputError(f"{where}: unknown name {unknown[0]!r}")
    return formula
