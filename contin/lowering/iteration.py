"""Machine code of the k-th iterate of a map and its Jacobian, as a loop around the map's own code.

Substituting a map into itself makes formulas that grow without bound (and their derivatives faster: the Jacobian of the
8th iterate of the logistic map has 400 statements, that of the map 29). The loop costs k calls and k small products:

    A_0 = [I 0],   A_j = f_u(x_{j-1}) A_{j-1} + [0 f_p],   x_j = f(x_{j-1}),   A = [dx/du dx/dp].
"""

from __future__ import annotations

from typing import Any, Final

from contin.abi import Address
from contin.lowering.machine import MachineCode, compile_assembly

NAME: Final = "iterated"

_TEXT: Final = """
declare ptr @malloc(i64)
declare void @free(ptr)
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)
declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)

define void @iterated(ptr %u, ptr %p, ptr %F, ptr %J) {{
entry:
  %base = inttoptr i64 {address} to ptr
  %x = call ptr @malloc(i64 {work})
  %b = getelementptr double, ptr %x, i64 {n}
  %a = getelementptr double, ptr %b, i64 {size}
  call void @llvm.memcpy.p0.p0.i64(ptr %F, ptr %u, i64 {n_bytes}, i1 false)
  call void @llvm.memset.p0.i64(ptr %J, i8 0, i64 {bytes}, i1 false)
  br label %diagonal
diagonal:
  %d = phi i64 [ 0, %entry ], [ %d.next, %diagonal ]
  %d.offset = mul i64 %d, {step}
  %d.at = getelementptr double, ptr %J, i64 %d.offset
  store double 1.0, ptr %d.at
  %d.next = add i64 %d, 1
  %d.more = icmp slt i64 %d.next, {n}
  br i1 %d.more, label %diagonal, label %iterate
iterate:
  %k = phi i64 [ 0, %diagonal ], [ %k.next, %iterated ]
  call void @llvm.memcpy.p0.p0.i64(ptr %x, ptr %F, i64 {n_bytes}, i1 false)
  call void @llvm.memcpy.p0.p0.i64(ptr %a, ptr %J, i64 {bytes}, i1 false)
  call void %base(ptr %x, ptr %p, ptr %F, ptr %b)
  br label %row
row:
  %i = phi i64 [ 0, %iterate ], [ %i.next, %row.end ]
  %i.offset = mul i64 %i, {w}
  br label %column
column:
  %j = phi i64 [ 0, %row ], [ %j.next, %column.end ]
  %ij = add i64 %i.offset, %j
  %own.at = getelementptr double, ptr %b, i64 %ij
  %own = load double, ptr %own.at
  %direct = icmp sge i64 %j, {n}
  %first = select i1 %direct, double %own, double 0.0
  br label %inner
inner:
  %l = phi i64 [ 0, %column ], [ %l.next, %inner ]
  %sum = phi double [ %first, %column ], [ %sum.next, %inner ]
  %il = add i64 %i.offset, %l
  %lj.row = mul i64 %l, {w}
  %lj = add i64 %lj.row, %j
  %b.at = getelementptr double, ptr %b, i64 %il
  %a.at = getelementptr double, ptr %a, i64 %lj
  %b.value = load double, ptr %b.at
  %a.value = load double, ptr %a.at
  %product = fmul double %b.value, %a.value
  %sum.next = fadd double %sum, %product
  %l.next = add i64 %l, 1
  %l.more = icmp slt i64 %l.next, {n}
  br i1 %l.more, label %inner, label %column.end
column.end:
  %out.at = getelementptr double, ptr %J, i64 %ij
  store double %sum.next, ptr %out.at
  %j.next = add i64 %j, 1
  %j.more = icmp slt i64 %j.next, {w}
  br i1 %j.more, label %column, label %row.end
row.end:
  %i.next = add i64 %i, 1
  %i.more = icmp slt i64 %i.next, {n}
  br i1 %i.more, label %row, label %iterated
iterated:
  %k.next = add i64 %k, 1
  %k.more = icmp slt i64 %k.next, {times}
  br i1 %k.more, label %iterate, label %done
done:
  call void @free(ptr %x)
  ret void
}}
"""


def iterated_jacobian(address: Address, n: int, p_size: int, times: int) -> MachineCode:
    """Code `iterated` (u, p, F, J) of the `times`-th iterate of the map whose Jacobian routine is at `address`.

    The caller keeps the owner of `address` alive as long as the result.
    """
    w = n + p_size
    sizes: dict[str, Any] = {
        "address": address, "n": n, "w": w, "step": w + 1, "size": n * w, "times": times,
        "n_bytes": 8 * n, "bytes": 8 * n * w, "work": 8 * (n + 2 * n * w),
    }  # fmt: skip
    return compile_assembly(_TEXT.format(**sizes), (NAME,))
