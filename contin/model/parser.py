"""Formulas as text -> expressions, by operator precedence with an explicit stack (depth is a budget, never a crash).

From weakest to strongest binding:

    u if c else v    right-associative        + -    left        ^ **    right-associative, its exponent may have a sign
    or  and  not                              * /    left        function calls, parentheses
    < <= > >= == !=  (chained: a < b < c)     + -    signs: -x^2 = -(x^2), 2^-1 = 0.5

Operands of + and of * are collected first and built once, so a sum of n terms costs O(n).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final

from contin.errors import ExpressionError
from contin.model import advice, binding, features
from contin.model.expression import (
    COMPARISONS,
    MINUS_ONE,
    PI,
    Expression,
    add,
    call,
    compare,
    if_,
    logical,
    mul,
    neg,
    power,
    symbol,
)
from contin.model.lexer import RESERVED, Token, tokenize
from contin.model.scope import Function, Scope
from contin.model.vocabulary import BINARY_FUNCTIONS, FUNCTIONS, VARIADIC_FUNCTIONS

MAX_DEPTH: Final = 1000  # open brackets and operators at one place

_LEVELS: Final = {
    "bracket": binding.TERNARY - 1,
    "if": binding.TERNARY,
    "else": binding.TERNARY,
    "or": binding.OR,
    "and": binding.AND,
    "not": binding.NOT,
    "compare": binding.COMPARE,
    "sum": binding.SUM,
    "product": binding.PRODUCT,
    "sign": binding.SIGN,
    "power": binding.POWER,
}
_BINARY: Final = {
    "or": "or",
    "and": "and",
    "+": "sum",
    "-": "sum",
    "*": "product",
    "/": "product",
    "^": "power",
    **dict.fromkeys(COMPARISONS, "compare"),
}


@dataclass(frozen=True, slots=True)
class Operand:
    """A finished part: its node, whether it is a condition (and not a number), and where it starts."""

    node: Expression
    condition: bool
    position: int


@dataclass(slots=True)
class _Waiting:
    """An operator, or bracket, that waits for its last operand."""

    kind: str
    position: int
    items: list[Operand] = field(default_factory=list)
    ops: list[str] = field(default_factory=list)
    name: str | None = None  # of the function, for the bracket of a call


def parse(
    text: str,
    names: Mapping[str, Expression] | Iterable[str] | None = None,
    functions: Mapping[str, Function] | None = None,
) -> Expression:
    """The expression that `text` spells.

    Parameters
    ----------
    names : declared names, or a mapping from names to what they stand for; without it every name is a symbol.
    functions : declared functions; they are inserted, all arguments at once.

    Raises
    ------
    ExpressionError
        The text is not a formula, or is a condition and not a number; `position` says where.
    """
    table = names if names is None or isinstance(names, Mapping) else {name: symbol(name) for name in names}
    operand = parse_operand(text, Scope(table, functions or {}))
    if operand.condition:
        raise ExpressionError("a condition is not a number; write, for example, 1 if x > 0 else 0", operand.position)
    return operand.node


def parse_operand(text: str, scope: Scope) -> Operand:
    """Like `parse`, for numbers and conditions alike."""
    return _Parser(tokenize(text), scope).run()


class _Parser:
    def __init__(self, tokens: list[Token], scope: Scope) -> None:
        self.tokens = tokens
        self.scope = scope
        self.stack = [_Waiting("bracket", 0)]

    def run(self) -> Operand:
        value: Operand | None = None  # None while an operand is expected
        i = 0
        while True:
            token = self.tokens[i]
            following = self.tokens[i + 1] if token.kind != "end" else token
            if value is None:
                value, used = self.operand(token, following)
                i += used
            elif token.kind == "end":
                return self.finish(value)
            else:
                value = self.operator(token, value)
                i += 1

    def push(self, waiting: _Waiting) -> None:
        if len(self.stack) >= MAX_DEPTH:
            message = f"nested deeper than {MAX_DEPTH} levels: split the formula with definitions"
            raise ExpressionError(message, waiting.position)
        self.stack.append(waiting)

    # Where an operand may start ---------------------------------------------------------------------------------------

    def operand(self, token: Token, following: Token) -> tuple[Operand | None, int]:
        """One step where an operand is expected: the operand if it is complete, and the number of tokens used."""
        position, text = token.position, token.text
        if token.kind == "number" and token.value is not None:
            return Operand(token.value, False, position), 1
        if token.kind == "name" and text not in RESERVED:
            if following.text == "(":
                return self.open_call(token)
            return self.name(token), 1
        if text == "pi":
            return Operand(PI, False, position), 1
        if text == "(":
            self.push(_Waiting("bracket", position))
        elif text in ("+", "-"):
            self.push(_Waiting("sign", position, ops=[text]))
        elif text == "not":
            if _LEVELS[self.stack[-1].kind] > _LEVELS["not"]:
                raise ExpressionError("put 'not ...' in parentheses here", position)
            self.push(_Waiting("not", position))
        else:
            raise self.missing_operand(token)
        return None, 1

    def open_call(self, token: Token) -> tuple[None, int]:
        name = token.text
        if name not in self.scope.functions and name not in FUNCTIONS and name not in self.scope.calls:
            if self.scope.names is not None and name in self.scope.names:
                raise ExpressionError(
                    f"{name} is not a function; for a product write {name}*(...). "
                    f"If this is {name} at another time: {features.DELAY}",
                    token.position,
                )
            raise ExpressionError(
                advice.unknown_function(name, [*self.scope.functions, *self.scope.calls]), token.position
            )
        self.push(_Waiting("bracket", token.position, name=name))
        return None, 2

    def name(self, token: Token) -> Operand:
        name, scope = token.text, self.scope
        if scope.names is None:
            return Operand(symbol(name), False, token.position)
        node = scope.names.get(name)
        if node is not None:
            return Operand(node, name in scope.conditions, token.position)
        if name in scope.unavailable:
            raise ExpressionError(scope.unavailable[name], token.position)
        if name in scope.functions:
            raise ExpressionError(f"{name} is a function: write {scope.functions[name].heading}", token.position)
        raise ExpressionError(advice.unknown_name(name, scope.names, scope.calls), token.position)

    def missing_operand(self, token: Token) -> ExpressionError:
        if token.text == ")" and self.stack[-1].name is not None and not self.stack[-1].items:
            return ExpressionError(f"{self.stack[-1].name} needs an argument", token.position)
        if token.kind == "end":
            empty = len(self.tokens) == 1
            return ExpressionError("the formula is empty" if empty else "the formula ends too early", token.position)
        return ExpressionError(f"expected a number, a name or '(' before {token.text!r}", token.position)

    # Where an operand has just ended ----------------------------------------------------------------------------------

    def operator(self, token: Token, value: Operand) -> Operand | None:
        """One step after an operand: the operand that stands now, or None where another one must follow."""
        text = token.text
        if text in _BINARY:
            kind = _BINARY[text]
            value = self.close_above(_LEVELS[kind], value)
            top = self.stack[-1]
            if top.kind != kind or kind == "power":
                top = _Waiting(kind, value.position)
                self.push(top)
            top.items.append(value)
            top.ops.append(text)
            return None
        if text == "if":
            value = self.close_above(_LEVELS["if"], value)
            if self.stack[-1].kind == "if":
                raise ExpressionError("put the inner 'u if c else v' in parentheses", token.position)
            self.push(_Waiting("if", token.position, [value]))
            return None
        if text == "else":
            value = self.close_above(_LEVELS["if"], value)
            top = self.stack[-1]
            if top.kind != "if":
                raise ExpressionError("'else' without 'if': write u if c else v", token.position)
            top.kind = "else"
            top.items.append(value)
            return None
        if text == ",":
            value = self.close_above(_LEVELS["bracket"], value)
            if self.stack[-1].name is None:
                raise ExpressionError("a comma stands only between the arguments of a function", token.position)
            self.stack[-1].items.append(value)
            return None
        if text == ")":
            value = self.close_above(_LEVELS["bracket"], value)
            if len(self.stack) == 1:
                raise ExpressionError("')' without '('", token.position)
            return self.close_bracket(self.stack.pop(), value)
        what = "'('" if text == "(" else f"{text!r}"
        raise ExpressionError(f"an operator is missing before {what}; for a product write '*'", token.position)

    def finish(self, value: Operand) -> Operand:
        value = self.close_above(_LEVELS["bracket"], value)
        top = self.stack[-1]
        if len(self.stack) > 1:
            cut = top.name in ("max", "min", "atan2", "mod")  # these have a comma inside
            quoted = "; between { and } a comma ends a formula in YAML: put this one in quotes" if cut else ""
            raise ExpressionError(f"'(' is never closed{quoted}", top.position + len(top.name or ""))
        return value

    # Putting finished parts together ----------------------------------------------------------------------------------

    def close_above(self, level: int, value: Operand) -> Operand:
        """Finish every waiting operator that binds tighter than `level`."""
        while _LEVELS[self.stack[-1].kind] > level:
            value = self.close(self.stack.pop(), value)
        return value

    def close(self, waiting: _Waiting, last: Operand) -> Operand:
        kind = waiting.kind
        operands = [*waiting.items, last]
        if kind == "if":
            raise ExpressionError("'if' without 'else': write u if c else v", waiting.position)
        if kind == "else":
            then, condition, otherwise = operands
            _need(condition, condition=True, where="between 'if' and 'else'")
            for branch in (then, otherwise):
                _need(branch, condition=False, where="as a value of 'if ... else'")
            return Operand(if_(condition.node, then.node, otherwise.node), False, then.position)
        logic = kind in ("and", "or", "not")
        for operand in operands:
            _need(operand, condition=logic, where=f"as an operand of '{kind if logic else waiting.ops[0]}'")
        nodes = [operand.node for operand in operands]
        start = waiting.position if kind in ("not", "sign") else operands[0].position
        return Operand(self.build(waiting, nodes), logic or kind == "compare", start)

    def build(self, waiting: _Waiting, nodes: list[Expression]) -> Expression:
        kind, ops = waiting.kind, waiting.ops
        if kind == "sum":
            return add(nodes[0], *(neg(n) if op == "-" else n for op, n in zip(ops, nodes[1:], strict=True)))
        if kind == "product":
            self.scope.budget.spend(sum(len(n.args) for n in nodes if n.op == "mul"), waiting.position)
            later = zip(ops, nodes[1:], strict=True)
            return mul(nodes[0], *(power(n, MINUS_ONE) if op == "/" else n for op, n in later))
        if kind == "power":
            return power(*nodes)
        if kind == "sign":
            return neg(nodes[0]) if ops[0] == "-" else nodes[0]
        if kind == "compare":
            pairs = [compare(op, a, b) for op, a, b in zip(ops, nodes, nodes[1:], strict=False)]
            return pairs[0] if len(pairs) == 1 else logical("and", *pairs)
        return logical(kind, *nodes)

    def close_bracket(self, waiting: _Waiting, last: Operand) -> Operand:
        if waiting.name is None:
            return Operand(last.node, last.condition, waiting.position)
        operands = [*waiting.items, last]
        for operand in operands:
            _need(operand, condition=False, where=f"as an argument of {waiting.name}")
        arguments = [operand.node for operand in operands]
        own = self.scope.calls.get(waiting.name)
        found = None if own is None else own(arguments, waiting.position)
        if found is not None:
            return Operand(found, False, waiting.position)
        function = self.scope.functions.get(waiting.name)
        if function is not None:
            if len(arguments) != len(function.parameters):
                wanted = len(function.parameters)
                message = f"{function.heading} takes {wanted} argument{'s' * (wanted != 1)}, got {len(arguments)}"
                raise ExpressionError(message, waiting.position)
            self.scope.budget.spend(function.size, waiting.position)
            return Operand(function(*arguments), function.condition, waiting.position)
        variadic = waiting.name in VARIADIC_FUNCTIONS
        wanted = 2 if variadic or waiting.name in BINARY_FUNCTIONS else 1
        if (len(arguments) < wanted) if variadic else (len(arguments) != wanted):
            count = f"{wanted} or more arguments" if variadic else f"{wanted} argument{'s' * (wanted != 1)}"
            raise ExpressionError(f"{waiting.name} takes {count}, got {len(arguments)}", waiting.position)
        return Operand(call(waiting.name, *arguments), False, waiting.position)


def _need(operand: Operand, *, condition: bool, where: str) -> None:
    if operand.condition and not condition:
        raise ExpressionError(f"a condition cannot stand {where}; write (1 if ... else 0)", operand.position)
    if condition and not operand.condition:
        raise ExpressionError(f"a number cannot stand {where}; write a comparison such as x > 0", operand.position)
