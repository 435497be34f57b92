"""Names of the grammar's functions, comparisons and logical operations."""

from typing import Final

UNARY_FUNCTIONS: Final = frozenset(
    "sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp expm1 log log1p log10 sqrt abs sign heaviside "
    "floor ceil factorial".split()
)
BINARY_FUNCTIONS: Final = frozenset({"atan2", "mod"})
STEPWISE: Final = frozenset({"floor", "ceil", "mod", "factorial"})  # they jump at infinitely many places
VARIADIC_FUNCTIONS: Final = frozenset({"min", "max"})  # two or more arguments; stored with exactly two
FUNCTIONS: Final = UNARY_FUNCTIONS | BINARY_FUNCTIONS | VARIADIC_FUNCTIONS
COMPARISONS: Final = frozenset({"<", "<=", ">", ">=", "==", "!="})
PIECEWISE: Final = COMPARISONS | STEPWISE | {"abs", "sign", "heaviside", "min", "max"}  # other formulas beyond surfaces
LOGICAL: Final = frozenset({"and", "or", "not"})
