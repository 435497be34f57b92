"""A tape as LLVM assembly text: one exported function, its body split where it is long.

Text is written directly, because building it through llvmlite's IR objects takes longer than compiling it. A long body
becomes functions of `PART` statements that hand values on through a scratch array; compile time stays linear in the
length. The scratch array belongs to the call (stack, or heap where large), so calls may overlap between threads.
"""

from __future__ import annotations

import itertools
import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Final

from contin.lowering.tape import Statement, operands
from contin.machine.elementary import symbol

PART: Final = 500  # statements in one function of a split body
UNSPLIT: Final = 1000  # bodies up to this length stay in one function
STACK_SCRATCH: Final = 4096  # scratch values kept on the stack (32 KB); more go to the heap

EXACT: Final = {
    "abs": "llvm.fabs.f64", "sqrt": "llvm.sqrt.f64", "floor": "llvm.floor.f64", "ceil": "llvm.ceil.f64",
    "min": "llvm.minimum.f64", "max": "llvm.maximum.f64",
}  # fmt: skip
"""Functions that are one instruction, correctly rounded; the others are elementary functions of ours."""
_BINARY: Final = ("pow", "min", "max", "atan2")
_BOTH: Final = "{double, double}"  # what `sincos` returns


def declarations(llvm_version: int, called: Iterable[str]) -> str:
    """What every module declares: memset, malloc, free, instructions, and the elementary functions in `called`."""
    pure = "memory(none)" if llvm_version >= 16 else "readnone"
    lines = [
        f"declare {_BOTH if name == 'sincos' else 'double'} @{_symbol(name)}"
        f"({'double, double' if name in _BINARY else 'double'}) #0"
        for name in [*EXACT, *called]
    ]
    lines += [
        "declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)",
        "declare ptr @malloc(i64)",
        "declare void @free(ptr)",
        f"attributes #0 = {{ nounwind willreturn {pure} }}",
        "attributes #1 = { nounwind }",
        "attributes #2 = { noinline nounwind }",
    ]
    return "\n".join(lines) + "\n"


def elementary_functions(statements: Sequence[Statement]) -> set[str]:
    """The elementary functions that these statements call, and `sincos`, which stands for a sine beside its cosine."""
    called = {str(s[1]) for s in statements if s[0] == "call"} - set(EXACT)
    return called | {"sincos"} if {"sin", "cos"} <= called else called


def _symbol(name: str) -> str:
    return EXACT.get(name) or symbol(name)


@dataclass(frozen=True)
class Store:
    """Element `index` of the `array`-th argument receives the value of `statement`."""

    array: int
    index: int
    statement: int


@dataclass(frozen=True)
class Routine:
    """One exported function: its arguments are `arrays` pointers, of which those in `cleared` start as zeros."""

    name: str
    arrays: int
    statements: Sequence[Statement]
    stores: Sequence[Store]
    cleared: Sequence[tuple[int, int]] = ()
    """(array, number of elements) to fill with zeros first."""

    @property
    def is_long(self) -> bool:
        return len(self.statements) > UNSPLIT


def routine_text(routine: Routine) -> str:
    """Definition of the exported function and of its parts."""
    arguments = ", ".join(f"ptr %a{k}" for k in range(routine.arrays))
    clear = "".join(
        f"  call void @llvm.memset.p0.i64(ptr %a{array}, i8 0, i64 {8 * count}, i1 false)\n"
        for array, count in routine.cleared
    )
    after: dict[int, list[Store]] = {}
    for store in routine.stores:
        after.setdefault(store.statement, []).append(store)
    if not routine.is_long:
        body = _Part({})
        body.write(routine.statements, range(len(routine.statements)), after)
        lines = "".join(body.lines)
        return f"define void @{routine.name}({arguments}) #1 {{\n{clear}{lines}  ret void\n}}\n"
    return _split_text(routine, arguments, clear, after)


def _split_text(routine: Routine, arguments: str, clear: str, after: dict[int, list[Store]]) -> str:
    parts = _cut(routine.statements)
    slots, size = _scratch_slots(routine.statements, parts)
    definitions, calls = [], []
    for number, part in enumerate(parts):
        writer = _Part(slots)
        writer.write(routine.statements, part, after)
        name = f"{routine.name}.{number}"
        lines = "".join(writer.lines)
        definitions.append(f"define internal void @{name}({arguments}, ptr %scratch) #2 {{\n{lines}  ret void\n}}\n")
        calls.append(f"  call void @{name}({arguments}, ptr %scratch)\n")
    if size <= STACK_SCRATCH:
        begin, end = f"  %scratch = alloca [{max(size, 1)} x double], align 16\n", ""
    else:
        begin, end = f"  %scratch = call ptr @malloc(i64 {8 * size})\n", "  call void @free(ptr %scratch)\n"
    main = f"define void @{routine.name}({arguments}) #1 {{\n{begin}{clear}{''.join(calls)}{end}  ret void\n}}\n"
    return "".join(definitions) + main


def _cut(statements: Sequence[Statement]) -> list[range]:
    """Consecutive ranges of about `PART` statements that compute something (constants and loads are free)."""
    cuts, count = [0], 0
    for index, statement in enumerate(statements):
        count += statement[0] not in ("const", "load")
        if count == PART:
            cuts.append(index + 1)
            count = 0
    if cuts[-1] != len(statements):
        cuts.append(len(statements))
    return [range(a, b) for a, b in itertools.pairwise(cuts)]


def _scratch_slots(statements: Sequence[Statement], parts: Sequence[range]) -> tuple[dict[int, int], int]:
    """Scratch slot of each value that a later part reads; a slot is free again after its last reader's part."""
    part_of = [number for number, part in enumerate(parts) for _ in part]
    last: dict[int, int] = {}
    for index, statement in enumerate(statements):
        for operand in operands(statement):
            if part_of[operand] != part_of[index] and statements[operand][0] not in ("const", "load"):
                last[operand] = part_of[index]
    released: list[list[int]] = [[] for _ in parts]
    slots: dict[int, int] = {}
    free: list[int] = []
    size = 0
    for number, part in enumerate(parts):
        for value in part:
            if value in last:
                if free:
                    slots[value] = free.pop()
                else:
                    slots[value], size = size, size + 1
                released[last[value]].append(slots[value])
        free.extend(released[number])
    return slots, size


@dataclass
class _Part:
    """Text of one straight run of statements; values from outside are loaded on first use."""

    slots: dict[int, int]
    lines: list[str] = field(default_factory=list)
    names: dict[int, str] = field(default_factory=dict)
    truths: set[int] = field(default_factory=set)  # values held as i1
    temporaries: int = 0

    def write(self, statements: Sequence[Statement], part: range, after: dict[int, list[Store]]) -> None:
        self.statements, self.part = statements, part
        for index in part:
            if index not in self.names:
                self._define(index)
            for store in after.get(index, ()):
                self._store(f"%a{store.array}", store.index, self._double(index))
            if index in self.slots:
                self._store("%scratch", self.slots[index], self._double(index))

    def _define(self, index: int) -> None:
        statement = self.statements[index]
        operation = str(statement[0])
        if operation == "const":
            self.names[index] = _literal(float.fromhex(str(statement[1])))
            return
        if operation == "load":
            self.names[index] = self._load(f"%a{statement[1]}", int(str(statement[2])))
            return
        name = self.names[index] = f"%v{index}"
        args = operands(statement)
        if operation == "call":
            function = str(statement[1])
            given = ", ".join(f"double {self._double(a)}" for a in args)
            if function in ("sin", "cos") and self._sine_and_cosine(index, given):
                return
            text = f"call double @{_symbol(function)}({given})"
        elif operation == "fneg":
            text = f"fneg double {self._double(args[0])}"
        elif operation == "select":
            test, yes, no = self._truth(args[0]), self._double(args[1]), self._double(args[2])
            text = f"select i1 {test}, double {yes}, double {no}"
        elif operation == "not":
            text = f"xor i1 {self._truth(args[0])}, true"
            self.truths.add(index)
        elif operation in ("and", "or"):
            text = f"{operation} i1 {self._truth(args[0])}, {self._truth(args[1])}"
            self.truths.add(index)
        else:  # fadd, fsub, fmul, fdiv, fcmp with its predicate
            text = f"{operation} double {self._double(args[0])}, {self._double(args[1])}"
            if operation.startswith("fcmp"):
                self.truths.add(index)
        self.lines.append(f"  {name} = {text}\n")

    def _sine_and_cosine(self, index: int, given: str) -> bool:
        """Both in one call where the next statement of this part is the other one of the same angle."""
        name, angle = self.statements[index][1:]
        other = ("call", "cos" if name == "sin" else "sin", angle)
        if index + 1 not in self.part or self.statements[index + 1] != other:
            return False
        both = self._line(f"call {_BOTH} @{_symbol('sincos')}({given})")
        for place, wanted in enumerate(("sin", "cos")):
            value = self._line(f"extractvalue {_BOTH} {both}, {place}")
            self.names[index if wanted == name else index + 1] = value
        return True

    def _value(self, index: int) -> str:
        name = self.names.get(index)
        if name is None:
            if self.statements[index][0] in ("const", "load"):
                self._define(index)
                return self.names[index]
            name = self.names[index] = self._load("%scratch", self.slots[index])
        return name

    def _double(self, index: int) -> str:
        value = self._value(index)
        if index not in self.truths:
            return value
        return self._line(f"uitofp i1 {value} to double")

    def _truth(self, index: int) -> str:
        value = self._value(index)
        if index in self.truths:
            return value
        return self._line(f"fcmp une double {value}, {_literal(0.0)}")

    def _line(self, text: str) -> str:
        self.temporaries += 1
        name = f"%t{self.temporaries}"
        self.lines.append(f"  {name} = {text}\n")
        return name

    def _load(self, array: str, index: int) -> str:
        return self._line(f"load double, ptr {self._element(array, index)}, align 8")

    def _store(self, array: str, index: int, value: str) -> None:
        element = self._element(array, index)
        self.lines.append(f"  store double {value}, ptr {element}, align 8\n")

    def _element(self, array: str, index: int) -> str:
        return array if index == 0 else self._line(f"getelementptr double, ptr {array}, i64 {index}")


def _literal(value: float) -> str:
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"
