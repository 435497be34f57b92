"""Calls of kernels from Python: one function in machine code that unpacks arguments after a plan.

A kernel's entry takes one pointer to 64-bit words: [status, results ..., arguments ...]. A scalar is one word; an array
is its address, its shape and its strides; a tuple is its items. The bridge is a builtin function of Python's C API
(stable calls alone) that fills the words from a tuple of arguments, lets go of the interpreter lock, calls the entry,
and makes the result. It reads an array's fields where numpy's C structure has them; `layout_is_known` looks whether
they are there, and where they are not (an interpreter without a global lock, say) `slow_call` does the same in Python.
"""

from __future__ import annotations

import ctypes
import operator
import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import numpy as np

from contin.abi import Address, Vector
from contin.machine.engine import ENGINE

INTEGER, REAL, TRUTH, ARRAY, TUPLE = range(1, 6)  # codes of a plan; axes and type follow an array, its length a tuple
HEAD: Final = 16  # bytes of PyObject_HEAD
RESULTS: Final = 4  # at most

_TEXT = """
declare i64 @PyLong_AsLongLong(ptr)
declare double @PyFloat_AsDouble(ptr)
declare i32 @PyObject_IsTrue(ptr)
declare ptr @PyErr_Occurred()
declare i64 @PyTuple_Size(ptr)
declare ptr @PyTuple_GetItem(ptr, i64)
declare ptr @PyTuple_New(i64)
declare i32 @PyTuple_SetItem(ptr, i64, ptr)
declare i32 @PyType_IsSubtype(ptr, ptr)
declare ptr @PyBytes_AsString(ptr)
declare ptr @PyLong_FromLongLong(i64)
declare ptr @PyFloat_FromDouble(double)
declare ptr @PyBool_FromLong(i64)
declare ptr @PyErr_NoMemory()
declare void @PyErr_SetString(ptr, ptr)
declare ptr @PyEval_SaveThread()
declare void @PyEval_RestoreThread(ptr)
declare void @Py_IncRef(ptr)

@message = private constant [44 x i8] c"an argument does not have the declared type\\00"

define i32 @contin_item(ptr %state, ptr %object) {{
entry:
  %plan = load ptr, ptr %state
  %slot = getelementptr i8, ptr %state, i64 8
  %word = load ptr, ptr %slot
  %code = load i64, ptr %plan
  %plan1 = getelementptr i64, ptr %plan, i64 1
  store ptr %plan1, ptr %state
  switch i64 %code, label %bad [ i64 1, label %integer
                                 i64 2, label %real
                                 i64 3, label %truth
                                 i64 4, label %array
                                 i64 5, label %tuple ]
integer:
  %i = call i64 @PyLong_AsLongLong(ptr %object)
  store i64 %i, ptr %word
  %i_failed = icmp eq i64 %i, -1
  br label %scalar
real:
  %x = call double @PyFloat_AsDouble(ptr %object)
  store double %x, ptr %word
  %x_failed = fcmp oeq double %x, -1.0
  br label %scalar
truth:
  %b = call i32 @PyObject_IsTrue(ptr %object)
  %b64 = sext i32 %b to i64
  store i64 %b64, ptr %word
  %b_failed = icmp slt i32 %b, 0
  br label %scalar
scalar:
  %suspect = phi i1 [ %i_failed, %integer ], [ %x_failed, %real ], [ %b_failed, %truth ]
  %after = getelementptr i64, ptr %word, i64 1
  store ptr %after, ptr %slot
  br i1 %suspect, label %check, label %good
check:
  %raised = call ptr @PyErr_Occurred()
  %fine = icmp eq ptr %raised, null
  br i1 %fine, label %good, label %error
array:
  %type_at = getelementptr i8, ptr %object, i64 {type}
  %type = load ptr, ptr %type_at
  %exact = icmp eq ptr %type, inttoptr (i64 {ndarray} to ptr)
  br i1 %exact, label %is_array, label %derived
derived:
  %below = call i32 @PyType_IsSubtype(ptr %type, ptr inttoptr (i64 {ndarray} to ptr))
  %is_below = icmp ne i32 %below, 0
  br i1 %is_below, label %is_array, label %bad
is_array:
  %axes = load i64, ptr %plan1
  %plan2 = getelementptr i64, ptr %plan, i64 2
  %wanted = load i64, ptr %plan2
  %plan3 = getelementptr i64, ptr %plan, i64 3
  store ptr %plan3, ptr %state
  %nd_at = getelementptr i8, ptr %object, i64 {nd}
  %nd32 = load i32, ptr %nd_at
  %nd = sext i32 %nd32 to i64
  %same_nd = icmp eq i64 %nd, %axes
  %descr_at = getelementptr i8, ptr %object, i64 {descr}
  %descr = load ptr, ptr %descr_at
  %number_at = getelementptr i8, ptr %descr, i64 {number}
  %number32 = load i32, ptr %number_at
  %number = sext i32 %number32 to i64
  %same_type = icmp eq i64 %number, %wanted
  %order_at = getelementptr i8, ptr %descr, i64 {order}
  %order = load i8, ptr %order_at
  %native = icmp ne i8 %order, {foreign}
  %flags_at = getelementptr i8, ptr %object, i64 {flags}
  %flags = load i32, ptr %flags_at
  %some = and i32 %flags, {needed}
  %all = icmp eq i32 %some, {needed}
  %fits1 = and i1 %same_nd, %same_type
  %fits2 = and i1 %native, %all
  %fits = and i1 %fits1, %fits2
  br i1 %fits, label %fill, label %bad
fill:
  %data_at = getelementptr i8, ptr %object, i64 {data}
  %data = load i64, ptr %data_at
  store i64 %data, ptr %word
  %shape_at = getelementptr i8, ptr %object, i64 {shape}
  %shape = load ptr, ptr %shape_at
  %strides_at = getelementptr i8, ptr %object, i64 {strides}
  %strides = load ptr, ptr %strides_at
  br label %axis
axis:
  %a = phi i64 [ 0, %fill ], [ %a1, %axis ]
  %length_at = getelementptr i64, ptr %shape, i64 %a
  %length = load i64, ptr %length_at
  %stride_at = getelementptr i64, ptr %strides, i64 %a
  %stride = load i64, ptr %stride_at
  %a1 = add i64 %a, 1
  %to_length = getelementptr i64, ptr %word, i64 %a1
  store i64 %length, ptr %to_length
  %past = add i64 %a1, %axes
  %to_stride = getelementptr i64, ptr %word, i64 %past
  store i64 %stride, ptr %to_stride
  %more_axes = icmp slt i64 %a1, %axes
  br i1 %more_axes, label %axis, label %filled
filled:
  %twice = shl i64 %axes, 1
  %size = add i64 %twice, 1
  %next = getelementptr i64, ptr %word, i64 %size
  store ptr %next, ptr %slot
  br label %good
tuple:
  %count = load i64, ptr %plan1
  %plan_t = getelementptr i64, ptr %plan, i64 2
  store ptr %plan_t, ptr %state
  %kind_at = getelementptr i8, ptr %object, i64 {type}
  %kind = load ptr, ptr %kind_at
  %is_tuple = call i32 @PyType_IsSubtype(ptr %kind, ptr inttoptr (i64 {tuple_type} to ptr))
  %no_tuple = icmp eq i32 %is_tuple, 0
  br i1 %no_tuple, label %bad, label %sized
sized:
  %items = call i64 @PyTuple_Size(ptr %object)
  %same = icmp eq i64 %items, %count
  br i1 %same, label %item, label %bad
item:
  %k = phi i64 [ 0, %sized ], [ %k1, %item_done ]
  %one = call ptr @PyTuple_GetItem(ptr %object, i64 %k)
  %status = call i32 @contin_item(ptr %state, ptr %one)
  %ok = icmp eq i32 %status, 0
  br i1 %ok, label %item_done, label %failed
item_done:
  %k1 = add i64 %k, 1
  %more_items = icmp slt i64 %k1, %count
  br i1 %more_items, label %item, label %good
failed:
  ret i32 %status
good:
  ret i32 0
error:
  ret i32 1
bad:
  call void @PyErr_SetString(ptr inttoptr (i64 {type_error} to ptr), ptr @message)
  ret i32 1
}}

define ptr @contin_result(i64 %code, ptr %word) {{
entry:
  switch i64 %code, label %nothing [ i64 1, label %integer
                                     i64 2, label %real
                                     i64 3, label %truth ]
integer:
  %i = load i64, ptr %word
  %int = call ptr @PyLong_FromLongLong(i64 %i)
  ret ptr %int
real:
  %x = load double, ptr %word
  %float = call ptr @PyFloat_FromDouble(double %x)
  ret ptr %float
truth:
  %b = load i64, ptr %word
  %bool = call ptr @PyBool_FromLong(i64 %b)
  ret ptr %bool
nothing:
  call void @Py_IncRef(ptr inttoptr (i64 {none} to ptr))
  ret ptr inttoptr (i64 {none} to ptr)
}}

define ptr @contin_call(ptr %self, ptr %args) {{
entry:
  %state = alloca [2 x ptr]
  %d = call ptr @PyBytes_AsString(ptr %self)
  %target = load ptr, ptr %d
  %size_at = getelementptr i64, ptr %d, i64 1
  %size = load i64, ptr %size_at
  %results_at = getelementptr i64, ptr %d, i64 2
  %results = load i64, ptr %results_at
  %codes = getelementptr i64, ptr %d, i64 3
  %plan = getelementptr i64, ptr %d, i64 7
  %words = alloca i64, i64 %size, align 16
  %count = call i64 @llvm.smax.i64(i64 %results, i64 1)
  %begin = add i64 %count, 1
  %first = getelementptr i64, ptr %words, i64 %begin
  store ptr %plan, ptr %state
  %second = getelementptr i8, ptr %state, i64 8
  store ptr %first, ptr %second
  %status = call i32 @contin_item(ptr %state, ptr %args)
  %unpacked = icmp eq i32 %status, 0
  br i1 %unpacked, label %run, label %null
run:
  %thread = call ptr @PyEval_SaveThread()
  call void %target(ptr %words)
  call void @PyEval_RestoreThread(ptr %thread)
  %returned = load i64, ptr %words
  %fine = icmp eq i64 %returned, 0
  br i1 %fine, label %make, label %memory
memory:
  %failed = call ptr @PyErr_NoMemory()
  ret ptr null
make:
  %single = icmp slt i64 %results, 2
  br i1 %single, label %one, label %several
one:
  %code = load i64, ptr %codes
  %at = getelementptr i64, ptr %words, i64 1
  %value = call ptr @contin_result(i64 %code, ptr %at)
  ret ptr %value
several:
  %tuple = call ptr @PyTuple_New(i64 %results)
  %no_tuple = icmp eq ptr %tuple, null
  br i1 %no_tuple, label %null, label %next
next:
  %k = phi i64 [ 0, %several ], [ %k1, %next ]
  %code_at = getelementptr i64, ptr %codes, i64 %k
  %kind = load i64, ptr %code_at
  %k1 = add i64 %k, 1
  %from = getelementptr i64, ptr %words, i64 %k1
  %made = call ptr @contin_result(i64 %kind, ptr %from)
  %set = call i32 @PyTuple_SetItem(ptr %tuple, i64 %k, ptr %made)
  %more = icmp slt i64 %k1, %results
  br i1 %more, label %next, label %done
done:
  ret ptr %tuple
null:
  ret ptr null
}}
declare i64 @llvm.smax.i64(i64, i64)
"""

CONTIGUOUS_ALIGNED_WRITEABLE: Final = 0x1 | 0x100 | 0x400  # NPY_ARRAY_C_CONTIGUOUS, _ALIGNED, _WRITEABLE
_FIELDS = {"data": 0, "nd": 8, "shape": 16, "strides": 24, "descr": 40, "flags": 48}  # PyArrayObject, beyond the head


@dataclass(frozen=True)
class Plan:
    """How a call's words are made and read: `arguments` in the codes above, `results` in those of scalars."""

    arguments: tuple[int, ...]
    """Codes of one tuple: (TUPLE, number of arguments, ...)."""
    words: int
    """Words that the arguments take."""
    results: tuple[int, ...]

    @property
    def size(self) -> int:
        return 1 + max(len(self.results), 1) + self.words


Number = float | int | bool
Words = ctypes.Array[ctypes.c_int64]
Call = Callable[..., Any]  # of a kernel: what it returns is as its signature says


class _MethodDef(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        ("function", ctypes.c_void_p),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


_alive: list[_MethodDef] = []  # method definitions must outlive the functions made of them


def make_call(name: str, entry: Address, plan: Plan) -> Call:
    """A Python function that calls the entry. It refuses arguments of other types with a TypeError."""
    if len(plan.results) > RESULTS:
        raise ValueError(f"{name}: at most {RESULTS} results; got {len(plan.results)}")
    if not layout_is_known():
        return slow_call(entry, plan)
    codes = (*plan.results, *([0] * (RESULTS - len(plan.results))))
    head = struct.pack(f"{3 + RESULTS}q", entry, plan.size, len(plan.results), *codes)
    data = head + struct.pack(f"{len(plan.arguments)}q", *plan.arguments)
    definition = _MethodDef(name.encode(), _address("contin_call"), 1, None)  # METH_VARARGS
    new = ctypes.pythonapi.PyCFunction_NewEx
    new.restype, new.argtypes = ctypes.py_object, (ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p)
    _alive.append(definition)
    made: Call = new(ctypes.addressof(definition), data, None)
    return made


def array_codes(dtype: Any, axes: int) -> tuple[int, int, int]:
    """The codes of an array argument."""
    return ARRAY, axes, np.dtype(dtype).num


@cache
def _address(name: str) -> Address:
    fields = {field: HEAD + offset for field, offset in _FIELDS.items()}
    descr = {"order": HEAD + 10, "number": HEAD + 12}  # PyArray_Descr: after the type, kind, type, byteorder, flags
    foreign = ord(">" if np.little_endian else "<")
    text = _TEXT.format(
        type=HEAD - 8, ndarray=id(np.ndarray), type_error=id(TypeError), tuple_type=id(tuple), none=id(None),
        foreign=foreign, needed=CONTIGUOUS_ALIGNED_WRITEABLE, **fields, **descr,
    )  # fmt: skip
    names = [line.split("@")[1].split("(")[0] for line in text.splitlines() if line.startswith("declare")]
    for symbol in names:
        if symbol.startswith("Py"):
            ENGINE.define(symbol, ctypes.cast(getattr(ctypes.pythonapi, symbol), ctypes.c_void_p).value or 0)
    ENGINE.add_text(text, optimise=True)
    return ENGINE.address(name)


@cache
def layout_is_known() -> bool:
    """Whether arrays and objects have the layout in memory that the bridge reads."""
    if object.__basicsize__ != HEAD or ctypes.sizeof(ctypes.c_void_p) != 8:
        return False
    probe = np.arange(6.0).reshape(2, 3)
    at = id(probe) + HEAD

    def word(offset: int, kind: type[ctypes.c_int64 | ctypes.c_int32] = ctypes.c_int64) -> int:
        return kind.from_address(at + offset).value

    descr = id(probe.dtype) + HEAD
    return bool(
        word(0) == probe.ctypes.data
        and word(8, ctypes.c_int32) == 2
        and [ctypes.c_int64.from_address(word(16) + 8 * k).value for k in (0, 1)] == [2, 3]
        and [ctypes.c_int64.from_address(word(24) + 8 * k).value for k in (0, 1)] == [24, 8]
        and word(40) == id(probe.dtype)
        and word(48, ctypes.c_int32) & CONTIGUOUS_ALIGNED_WRITEABLE == CONTIGUOUS_ALIGNED_WRITEABLE
        and ctypes.c_int32.from_address(descr + 12).value == probe.dtype.num
        and ctypes.c_char.from_address(descr + 10).value == b"="
    )


def slow_call(entry: Address, plan: Plan) -> Call:
    """What `make_call` does, in Python, for interpreters whose objects the bridge cannot read."""
    function = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(entry)
    begin = 1 + max(len(plan.results), 1)

    def call(*arguments: object) -> Number | tuple[Number, ...] | None:
        words = (ctypes.c_int64 * plan.size)()
        codes = iter(plan.arguments)
        _pack(words, begin, codes, arguments)
        function(ctypes.addressof(words))
        if words[0]:
            raise MemoryError
        made = [_result(words, 1 + k, code) for k, code in enumerate(plan.results)]
        return made[0] if len(made) == 1 else tuple(made) if made else None

    return call


def _pack(words: Words, at: int, codes: Iterator[int], value: Any) -> int:
    code = next(codes)
    if code == TUPLE:
        count = next(codes)
        if not isinstance(value, tuple) or len(value) != count:
            raise TypeError("an argument does not have the declared type")
        for item in value:
            at = _pack(words, at, codes, item)
        return at
    if code == ARRAY:
        axes, number = next(codes), next(codes)
        if not isinstance(value, np.ndarray) or not _fits(value, axes, number):
            raise TypeError("an argument does not have the declared type")
        for k, word in enumerate((value.ctypes.data, *value.shape, *value.strides)):
            words[at + k] = word
        return at + 1 + 2 * int(axes)
    if code == REAL:
        ctypes.c_double.from_buffer(words, 8 * at).value = ctypes.c_double(value).value
    else:
        words[at] = bool(value) if code == TRUTH else operator.index(value)
    return at + 1


def _fits(array: Vector, axes: int, number: int) -> bool:
    flags, dtype = array.flags, array.dtype
    declared = (array.ndim, dtype.num, dtype.isnative) == (axes, number, True)
    return bool(declared and flags.c_contiguous and flags.aligned and flags.writeable)


def _result(words: Words, at: int, code: int) -> Number:
    if code == REAL:
        return ctypes.c_double.from_buffer(words, 8 * at).value
    return bool(words[at]) if code == TRUTH else words[at]


def codes_of(items: Sequence[tuple[int, ...]]) -> tuple[int, ...]:
    """The codes of a tuple of these items."""
    return (TUPLE, len(items), *(code for item in items for code in item))
