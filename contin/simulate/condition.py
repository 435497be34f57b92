"""Conditions typed by the user: the grammar of model files, with True or False as its value."""

from __future__ import annotations

from typing import Any

from contin.errors import ExpressionError, InputError
from contin.model.parser import parse_operand
from contin.model.scope import Scope
from contin.records import Record


def condition(text: str, names: Record, functions: Record, where: str) -> Any:
    """The condition that `text` spells, over these names; `where` begins the message of an error.

    Raises ExpressionError for what is no formula over the names, InputError for a number.
    """
    try:
        operand = parse_operand(text, Scope(names, functions))
    except ExpressionError as error:
        raise ExpressionError(f"{where}: {error}") from None
    if not operand.condition:
        raise InputError(f"{where}: {text!r} is a number, not a condition; compare it with something")
    return operand.node
