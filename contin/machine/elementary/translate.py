"""Elementary functions from Python to LLVM text.

Read are functions whose arguments and results are annotated `float`, `int` (64 bits) or `bool`, or a tuple of such
results, made of assignments, `if`, `while`, `return`, arithmetic, comparisons, one another, and the operations of
`language`. Every float operation becomes exactly one IEEE operation, in the order written: nothing is contracted into
fused multiply-adds and nothing is reassociated, since the text carries no fast-math flags. Names of the module that
are numbers become constants, tuples of numbers become tables.
"""

from __future__ import annotations

import ast
import operator
import struct
import sys
from collections.abc import Callable, Collection, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final

from contin.machine.elementary import language
from contin.machine.elementary.names import symbol
from contin.records import Fields

DOUBLE, INTEGER, TRUTH = "double", "i64", "i1"
_TYPES: Final = {"float": DOUBLE, "int": INTEGER, "bool": TRUTH, "Pair": "{double, double}"}
_FLOAT: Final = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}
_INTEGER: Final = {
    ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.BitAnd: "and", ast.BitOr: "or", ast.BitXor: "xor",
    ast.LShift: "shl", ast.RShift: "ashr",
}  # fmt: skip
_COMPARE: Final = {
    ast.Lt: ("olt", "slt"), ast.LtE: ("ole", "sle"), ast.Gt: ("ogt", "sgt"), ast.GtE: ("oge", "sge"),
    ast.Eq: ("oeq", "eq"), ast.NotEq: ("une", "ne"),
}  # fmt: skip
_OPERATIONS: Final = {
    "bits": ("bitcast double {} to i64", INTEGER),
    "double": ("bitcast i64 {} to double", DOUBLE),
    "fabs": ("call double @llvm.fabs.f64(double {})", DOUBLE),
    "sqrt": ("call double @llvm.sqrt.f64(double {})", DOUBLE),
    "quotient": ("fdiv double {}, {}", DOUBLE),
    "copysign": ("call double @llvm.copysign.f64(double {}, double {})", DOUBLE),
    "to_float": ("sitofp i64 {} to double", DOUBLE),
    "shift_right": ("lshr i64 {}, {}", INTEGER),
    "shift_left": ("shl i64 {}, {}", INTEGER),
    "low_product": ("mul i64 {}, {}", INTEGER),
    "low_sum": ("add i64 {}, {}", INTEGER),
}
_INTRINSICS: Final = """declare double @llvm.fabs.f64(double)
declare double @llvm.sqrt.f64(double)
declare double @llvm.copysign.f64(double, double)
"""
_HIGH_PRODUCT: Final = """define internal i64 @high_product(i64 %a, i64 %b) #0 {
  %wa = zext i64 %a to i128
  %wb = zext i64 %b to i128
  %p = mul i128 %wa, %wb
  %h = lshr i128 %p, 64
  %r = trunc i128 %h to i64
  ret i64 %r
}
define internal i64 @carry(i64 %a, i64 %b) #0 {
  %s = add i64 %a, %b
  %c = icmp ult i64 %s, %a
  %r = zext i1 %c to i64
  ret i64 %r
}
"""
_ATTRIBUTES: Final = """attributes #0 = { alwaysinline nounwind willreturn memory(none) }
attributes #1 = { noinline cold nounwind willreturn memory(none) }
attributes #2 = { nounwind willreturn memory(none) }
attributes #3 = { nounwind }
"""

_FOLDED: Final[dict[type[ast.operator], Callable[[Any, Any], float]]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.LShift: operator.lshift,
}  # fmt: skip

Value = tuple[str, str]
"""(LLVM type, name or literal)"""


def module_text(exported: Sequence[Callable[..., object]], loops: Sequence[Callable[..., object]] = ()) -> str:
    """A module that exports `contin_NAME` for each function, and for each of `loops` `contin_NAME_many` over arrays.

    contin_NAME_many(n, x, out) sets out[i] = NAME(x[i]) for i < n, contin_NAME_many(n, x, y, out) likewise.
    """
    written: dict[str, str] = {}
    tables: dict[str, str] = {}
    waiting = [*exported, *loops]
    public = {f.__name__ for f in waiting}
    while waiting:
        function = waiting.pop()
        if function.__name__ not in written:
            writer = _Function(function, public)
            written[function.__name__] = writer.text()
            tables |= writer.tables
            waiting += writer.called
    over_arrays = [_loop(f.__name__, len(_tree(f).args.args)) for f in loops]
    head = [_INTRINSICS, _HIGH_PRODUCT, _ATTRIBUTES]
    return "\n".join([*head, *tables.values(), *reversed(written.values()), *over_arrays])


def literal(value: float) -> str:
    """A float as LLVM reads it exactly."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"


@cache
def _functions_of(module: str) -> dict[str, ast.FunctionDef]:
    path = sys.modules[module].__file__
    assert path is not None
    body = ast.parse(Path(path).read_text(encoding="utf-8")).body
    return {node.name: node for node in body if isinstance(node, ast.FunctionDef)}


def _tree(function: Callable[..., object]) -> ast.FunctionDef:
    return _functions_of(function.__module__)[function.__name__]


def _type_of(annotation: ast.expr | None) -> str:
    if isinstance(annotation, ast.Name) and annotation.id in _TYPES:
        return _TYPES[annotation.id]
    if isinstance(annotation, ast.Subscript) and isinstance(annotation.slice, ast.Tuple):
        return "{" + ", ".join(_type_of(e) for e in annotation.slice.elts) + "}"
    raise TypeError(f"no type: {ast.unparse(annotation) if annotation else 'an argument without annotation'}")


def _elements(structure: str) -> list[str]:
    return structure.strip("{}").split(", ")


class _Function:
    """One function's text; `called` and `tables` are what it needs from the module."""

    def __init__(self, function: Callable[..., object], public: Collection[str]) -> None:
        self.function, self.public = function, public
        self.globals: Fields = vars(sys.modules[function.__module__])
        self.tree = _tree(function)
        self.tables: dict[str, str] = {}
        self.called: list[Callable[..., object]] = []
        self.lines: list[str] = []
        self.variables: dict[str, str] = {}
        self.count = 0
        self.open = True  # whether the block being written still lacks its last instruction

    def text(self) -> str:
        name, public = self.function.__name__, self.function.__name__ in self.public
        self.result = _type_of(self.tree.returns)
        given = [(a.arg, _type_of(a.annotation)) for a in self.tree.args.args]
        for argument, kind in given:
            self._assign(argument, (kind, f"%{argument}"))
        self._block(self.tree.body)
        if self.open:
            self._emit("unreachable")
        places = "".join(f"  %{v}.at = alloca {kind}\n" for v, kind in self.variables.items())
        arguments = ", ".join(f"{kind} %{argument}" for argument, kind in given)
        attributes = 2 if public else 1 if name in language.RARE else 0
        head = f"define {'' if public else 'internal '}{self.result} @{self._symbol(name)}({arguments})"
        return f"{head} #{attributes} {{\n{places}{''.join(self.lines)}}}\n"

    def _symbol(self, name: str) -> str:
        return symbol(name) if name in self.public else name

    # statements

    def _block(self, body: Sequence[ast.stmt]) -> None:
        for statement in body:
            self._statement(statement)

    def _statement(self, node: ast.stmt) -> None:
        match node:
            case ast.Expr(value=ast.Constant()):
                return
            case ast.Return(value=value) if value is not None:
                kind, name = self._value(value)
                if kind != self.result:
                    raise TypeError(f"{self.function.__name__} returns {kind}, not {self.result}")
                self._end(f"ret {kind} {name}")
            case ast.Assign(targets=[target], value=value):
                self._unpack(target, self._value(value))
            case ast.AugAssign(target=ast.Name(id=name), op=op, value=value):
                self._assign(name, self._binary(type(op), self._read(name), self._value(value)))
            case ast.If(test=test, body=body, orelse=otherwise):
                self._if(test, body, otherwise)
            case ast.While(test=test, body=body):
                begin, inside, after = self._labels("while", "do", "done")
                self._end(f"br label %{begin}")
                self._label(begin)
                self._end(f"br i1 {self._value(test)[1]}, label %{inside}, label %{after}")
                self._label(inside)
                self._block(body)
                self._end(f"br label %{begin}")
                self._label(after)
            case _:
                raise SyntaxError(f"{self.function.__name__}: cannot translate {ast.unparse(node)}")

    def _if(self, test: ast.expr, body: Sequence[ast.stmt], otherwise: Sequence[ast.stmt]) -> None:
        yes, no, after = self._labels("then", "else", "after")
        self._end(f"br i1 {self._value(test)[1]}, label %{yes}, label %{no}")
        reached = False
        for label, part in ((yes, body), (no, otherwise)):
            self._label(label)
            self._block(part)
            reached |= self.open
            self._end(f"br label %{after}")
        if reached:
            self._label(after)

    def _unpack(self, target: ast.expr, value: Value) -> None:
        if isinstance(target, ast.Name):
            self._assign(target.id, value)
        elif isinstance(target, ast.Tuple):
            for index, (part, kind) in enumerate(zip(target.elts, _elements(value[0]), strict=True)):
                self._unpack(part, (kind, self._line(f"extractvalue {value[0]} {value[1]}, {index}")))
        else:
            raise SyntaxError(ast.unparse(target))

    def _assign(self, name: str, value: Value) -> None:
        if self.variables.setdefault(name, value[0]) != value[0]:
            raise TypeError(f"{self.function.__name__}: {name} is {self.variables[name]}, then {value[0]}")
        self._emit(f"store {value[0]} {value[1]}, ptr %{name}.at")

    def _read(self, name: str) -> Value:
        kind = self.variables[name]
        return kind, self._line(f"load {kind}, ptr %{name}.at")

    # expressions

    def _value(self, node: ast.expr) -> Value:
        folded = _folded(node)
        if folded is not None:
            return _constant(folded)
        match node:
            case ast.Name(id=name):
                return self._read(name) if name in self.variables else _constant(self.globals[name])
            case ast.UnaryOp(op=op, operand=operand):
                return self._unary(op, self._value(operand))
            case ast.BinOp(left=left, op=op, right=right):
                return self._binary(type(op), self._value(left), self._value(right))
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                (kind, a), (_, b) = _alike(self._value(left), self._value(right))
                word = _COMPARE[type(op)][kind != DOUBLE]
                return TRUTH, self._line(f"{'fcmp' if kind == DOUBLE else 'icmp'} {word} {kind} {a}, {b}")
            case ast.BoolOp(op=op, values=values):
                word = "and" if isinstance(op, ast.And) else "or"
                result = self._value(values[0])[1]
                for value in values[1:]:
                    result = self._line(f"{word} i1 {result}, {self._value(value)[1]}")
                return TRUTH, result
            case ast.IfExp(test=test, body=yes, orelse=no):
                condition = self._value(test)[1]
                (kind, a), (_, b) = _alike(self._value(yes), self._value(no))
                return kind, self._line(f"select i1 {condition}, {kind} {a}, {kind} {b}")
            case ast.Tuple(elts=elements):
                return self._tuple([self._value(e) for e in elements])
            case ast.Subscript(value=ast.Name(id=name), slice=index):
                return self._element(name, self._value(index)[1])
            case ast.Call(func=ast.Name(id=name), args=arguments):
                return self._call(name, [self._value(a) for a in arguments])
        raise SyntaxError(f"{self.function.__name__}: cannot translate {ast.unparse(node)}")

    def _unary(self, op: ast.unaryop, value: Value) -> Value:
        kind, name = value
        if isinstance(op, ast.Not):
            return TRUTH, self._line(f"xor i1 {name}, true")
        if isinstance(op, ast.Invert):
            return INTEGER, self._line(f"xor i64 {name}, -1")
        return kind, self._line(f"fneg double {name}" if kind == DOUBLE else f"sub i64 0, {name}")

    def _binary(self, op: type[ast.operator], left: Value, right: Value) -> Value:
        (kind, a), (_, b) = _alike(left, right)
        word = (_FLOAT if kind == DOUBLE else _INTEGER)[op]
        return kind, self._line(f"{word} {kind} {a}, {b}")

    def _tuple(self, values: Sequence[Value]) -> Value:
        kind = "{" + ", ".join(k for k, _ in values) + "}"
        result = "undef"
        for index, (k, value) in enumerate(values):
            result = self._line(f"insertvalue {kind} {result}, {k} {value}, {index}")
        return kind, result

    def _element(self, name: str, index: str) -> Value:
        entries = self.globals[name]
        kind = _constant(entries[0])[0]
        whole = f"[{len(entries)} x {kind}]"
        content = ", ".join(f"{kind} {_constant(entry)[1]}" for entry in entries)
        self.tables[name] = f"@{name} = internal unnamed_addr constant {whole} [{content}], align 64"
        place = self._line(f"getelementptr inbounds {whole}, ptr @{name}, i64 0, i64 {index}")
        return kind, self._line(f"load {kind}, ptr {place}")

    def _call(self, name: str, arguments: Sequence[Value]) -> Value:
        if name in _OPERATIONS:
            form, kind = _OPERATIONS[name]
            return kind, self._line(form.format(*(a for _, a in arguments)))
        given = ", ".join(f"{kind} {value}" for kind, value in arguments)
        if name in ("high_product", "carry"):
            return INTEGER, self._line(f"call i64 @{name}({given})")
        function = self.globals[name]
        self.called.append(function)
        kind = _type_of(_tree(function).returns)
        return kind, self._line(f"call {kind} @{self._symbol(name)}({given})")

    # lines

    def _line(self, text: str) -> str:
        self.count += 1
        self.lines.append(f"  %.{self.count} = {text}\n")
        return f"%.{self.count}"

    def _emit(self, text: str) -> None:
        self.lines.append(f"  {text}\n")

    def _end(self, text: str) -> None:
        if self.open:
            self._emit(text)
        self.open = False

    def _labels(self, *names: str) -> list[str]:
        self.count += 1
        return [f"{name}.{self.count}" for name in names]

    def _label(self, name: str) -> None:
        self.lines.append(f"{name}:\n")
        self.open = True


def _constant(value: object) -> Value:
    if isinstance(value, bool):
        return TRUTH, "true" if value else "false"
    if isinstance(value, int):
        return INTEGER, str(value - (1 << 64) if value >> 63 == 1 else value)
    if isinstance(value, float):
        return DOUBLE, literal(value)
    raise TypeError(f"no constant: {value!r}")


def _folded(node: ast.expr) -> float | None:
    """The number that an expression without names stands for."""
    match node:
        case ast.Constant(value=bool() | int() | float() as value):
            return value
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            inner = _folded(operand)
            return None if inner is None else -inner
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _FOLDED:
            a, b = _folded(left), _folded(right)
            return None if a is None or b is None else _FOLDED[type(op)](a, b)
    return None


def _alike(left: Value, right: Value) -> tuple[Value, Value]:
    if left[0] != right[0]:
        raise TypeError(f"{left[0]} beside {right[0]}: {left[1]}, {right[1]}")
    return left, right


def _loop(name: str, arguments: int) -> str:
    inputs = [f"%x{k}" for k in range(arguments)]
    pointers = ", ".join(f"ptr {x}" for x in inputs)
    loads = "".join(
        f"  {x}.at = getelementptr double, ptr {x}, i64 %i\n  {x}.i = load double, ptr {x}.at\n" for x in inputs
    )
    values = ", ".join(f"double {x}.i" for x in inputs)
    return f"""define void @{symbol(name)}_many(i64 %n, {pointers}, ptr %out) #3 {{
entry:
  %some = icmp sgt i64 %n, 0
  br i1 %some, label %next, label %done
next:
  %i = phi i64 [ 0, %entry ], [ %j, %next ]
{loads}  %value = call double @{symbol(name)}({values})
  %out.at = getelementptr double, ptr %out, i64 %i
  store double %value, ptr %out.at
  %j = add i64 %i, 1
  %more = icmp slt i64 %j, %n
  br i1 %more, label %next, label %done
done:
  ret void
}}
"""
