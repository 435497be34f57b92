"""Formulas of another language -> trees, by operator precedence from the tables of a dialect."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Final

from contin.errors import InputError
from contin.exchange.formulas.tree import Node

MAX_DEPTH: Final = 100  # open brackets and signs at one place
MAX_LENGTH: Final = 1_000_000  # characters of one formula


class FormulaError(InputError):
    """A foreign formula cannot be understood."""


@dataclass(frozen=True)
class Binary:
    """A binary operator: how strongly it binds, the node it makes, and whether a^b^c is a^(b^c)."""

    strength: int
    kind: str
    right: bool = False


@dataclass(frozen=True)
class Prefix:
    """A sign: everything of at least `strength` after it belongs to it."""

    strength: int
    kind: str  # empty: it changes nothing


@dataclass(frozen=True)
class Dialect:
    """The tables of one language.

    tokens : groups `space`, `number`, `name`, `op`.  special : words with a grammar of their own, read by a function
    that gets the parser behind the word.  fold : names are not told apart by case.
    """

    tokens: re.Pattern[str]
    binary: Mapping[str, Binary]
    prefix: Mapping[str, Prefix]
    special: Mapping[str, Callable[[Parser], Node]] = field(default_factory=dict)
    fold: bool = True


def parse(text: str, dialect: Dialect) -> Node:
    """The tree of a formula; FormulaError where it is none."""
    parser = Parser(text, dialect)
    node = parser.expression(0)
    if parser.kind != "end":
        raise parser.error(f"an operator is missing before {parser.text!r}")
    return node


class Parser:
    """Reads one formula: `kind` and `text` are those of the token that comes next."""

    def __init__(self, text: str, dialect: Dialect) -> None:
        if len(text) > MAX_LENGTH:
            raise FormulaError(f"a formula of {len(text)} characters; {MAX_LENGTH} are allowed")
        self.source, self.dialect = text, dialect
        self.depth = self.position = 0
        self.kind = self.text = ""
        self.advance()

    def error(self, message: str) -> FormulaError:
        """The error with this message, and the formula."""
        shown = self.source if len(self.source) <= 80 else self.source[:77] + "..."
        return FormulaError(f"{message} in {shown!r}")

    def advance(self) -> None:
        """The next token."""
        while True:
            if self.position == len(self.source):
                self.kind = self.text = "end"
                return
            match = self.dialect.tokens.match(self.source, self.position)
            if match is None:
                raise self.error(f"unexpected character {self.source[self.position]!r}")
            self.position = match.end()
            self.kind = str(match.lastgroup)
            if self.kind != "space":
                break
        text = match.group()
        self.text = text.lower() if self.dialect.fold else text

    def expect(self, text: str) -> None:
        """The next token must be this one."""
        if self.text != text:
            found = "the formula ends" if self.kind == "end" else f"there is {self.text!r}"
            raise self.error(f"expected {text!r}, but {found}")
        self.advance()

    def bracketed(self) -> Node:
        """( expression )."""
        self.expect("(")
        node = self.expression(0)
        self.expect(")")
        return node

    def expression(self, strength: int) -> Node:
        """An operand and the operators behind it that bind at least as strongly."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.error(f"nested deeper than {MAX_DEPTH} levels")
        left = self.operand()
        while (found := self.dialect.binary.get(self.text)) is not None and found.strength >= strength:
            self.advance()
            right = self.expression(found.strength if found.right else found.strength + 1)
            left = Node(found.kind, (left, right))
        self.depth -= 1
        return left

    def operand(self) -> Node:
        """A number, a name, a call, or something in parentheses or behind a sign."""
        text, kind = self.text, self.kind
        sign = self.dialect.prefix.get(text)
        if sign is not None:
            self.advance()
            inner = self.expression(sign.strength)
            return Node(sign.kind, (inner,)) if sign.kind else inner
        if text == "(":
            return replace(self.bracketed(), bracketed=True)
        if kind == "number":
            self.advance()
            return Node("number", text=text)
        if kind != "name":
            raise self.error("the formula ends too early" if kind == "end" else f"unexpected {text!r}")
        self.advance()
        special = self.dialect.special.get(text)
        if special is not None:
            return special(self)
        return Node("call", self.arguments(), text) if self.text == "(" else Node("name", text=text)

    def arguments(self) -> tuple[Node, ...]:
        """( expression, ... ), at least one."""
        self.expect("(")
        found = [self.expression(0)]
        while self.text == ",":
            self.advance()
            found.append(self.expression(0))
        self.expect(")")
        return tuple(found)
