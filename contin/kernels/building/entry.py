"""The function by which Python calls a kernel, in LLVM's assembly.

void entry(words): words -> values, the call, status and results -> words (`contin.machine.bridge`). Values are handed
over as numba's calling convention has them: where the result goes, where an exception would, and every argument in its
members, an array in [owner, parent, count, bytes of a number, address, lengths, strides].

It is written, not built from values, and neither optimised nor scheduled: a block of 1,000 loads takes LLVM seconds.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from contin.kernels.signature import Array, Scalar, Tuple, Type, words

if TYPE_CHECKING:
    from contin.kernels.signature import Signature

BYTES: Final = {"i": 8, "u": 8, "f": 8, "b": 1}
HELD: Final = {"i": "i64", "u": "i64", "f": "double", "b": "i8"}
"""How numba holds a number in memory, and hands it over."""


def entry(name: str, callee: str, signature: Signature, result: str) -> str:
    """The text of function `name`, which calls `callee`.  result : LLVM's type of what that returns."""
    kinds = _results(signature.result)
    writer = _Writer()
    arguments = ["ptr %result", "ptr %exception"]
    at = 1 + max(len(kinds), 1)
    for kind in signature.arguments:
        arguments += writer.handed_over(kind, at)
        at += words(kind)
    call = f"%status = call i32 @{callee}({', '.join(arguments)})"
    return "\n".join([
        f'define void @"{name}"(ptr %words) noinline optnone {{',
        f"%result = alloca {result}",
        "%exception = alloca ptr",
        f"store {result} zeroinitializer, ptr %result",
        *writer.lines, call, *_after(kinds, result if isinstance(signature.result, Tuple) else None), "ret void", "}\n",
    ])  # fmt: skip


class _Writer:
    """Lines that load words."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def handed_over(self, kind: Type, at: int) -> Iterator[str]:
        """The arguments, with their types, that hold the value which starts at a word."""
        if isinstance(kind, Tuple):
            for item in kind.items:
                yield from self.handed_over(item, at)
                at += words(item)
        elif isinstance(kind, Scalar):
            yield f"{HELD[kind.code]} {self._number(kind.code, at)}"
        else:
            assert isinstance(kind, Array)
            lengths, strides = ([self._load("i64", at + 1 + k + first) for k in range(kind.axes)]
                                for first in (0, kind.axes))  # fmt: skip
            yield from ("ptr null", "ptr null", f"i64 {self._product(lengths)}", f"i64 {BYTES[kind.code]}")
            yield f"ptr {self._load('ptr', at)}"
            yield from (f"i64 {word}" for word in (*lengths, *strides))

    def _number(self, code: str, at: int) -> str:
        if code != "b":
            return self._load(HELD[code], at)
        is_true = self._named(f"icmp ne i64 {self._load('i64', at)}, 0")
        return self._named(f"zext i1 {is_true} to i8")

    def _product(self, factors: list[str]) -> str:
        found = factors[0]
        for factor in factors[1:]:
            found = self._named(f"mul i64 {found}, {factor}")
        return found

    def _load(self, kind: str, at: int) -> str:
        return self._named(f"load {kind}, ptr {self._named(f'getelementptr i64, ptr %words, i64 {at}')}")

    def _named(self, operation: str) -> str:
        name = f"%v{len(self.lines)}"
        self.lines.append(f"{name} = {operation}")
        return name


def _after(kinds: list[Scalar], members_of: str | None) -> Iterator[str]:
    """The status is word 0, results follow.  members_of : the type of a result that has several."""
    yield from ("%code = sext i32 %status to i64", "store i64 %code, ptr %words")
    for k, kind in enumerate(kinds):
        place, held = "%result", HELD[kind.code]
        if members_of is not None:
            place = f"%member{k}"
            yield f"{place} = getelementptr {members_of}, ptr %result, i32 0, i32 {k}"
        yield f"%word{k} = getelementptr i64, ptr %words, i64 {1 + k}"
        yield f"%is{k} = load {held}, ptr {place}"
        if kind.code == "b":
            yield f"%wide{k} = zext i8 %is{k} to i64"
            yield f"store i64 %wide{k}, ptr %word{k}"
        else:
            yield f"store {held} %is{k}, ptr %word{k}"


def _results(kind: Type | None) -> list[Scalar]:
    if kind is None:
        return []
    items = kind.items if isinstance(kind, Tuple) else (kind,)
    scalars = [item for item in items if isinstance(item, Scalar)]
    if len(scalars) != len(items):
        raise TypeError("a kernel returns numbers, one or several")
    return scalars
