"""How strongly operators bind, weakest first: one table for the parser and for all that writes formulas.

A part stands in parentheses where it binds more weakly than its place asks for; an operator that groups to the left
asks `level + 1` of its right operand.
"""

from __future__ import annotations

TERNARY, OR, AND, NOT, COMPARE, SUM, PRODUCT, SIGN, POWER, ATOM = range(10)
