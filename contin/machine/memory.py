"""Memory for arrays that kernels make: the part of numba's runtime that they call, in LLVM's assembly.

numba counts references in a head before the data (the count, what to call at its end, the address and size of the
data); its code raises and lowers the count itself and calls these two functions at the beginning and the end.
"""

from typing import Final

TEXT: Final = """
%head = type { i64, ptr, ptr, ptr, i64, ptr }
declare ptr @malloc(i64)
declare void @free(ptr)

define ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %align) {
entry:
  %alignment = zext i32 %align to i64
  %some = add i64 %size, 48
  %all = add i64 %some, %alignment
  %memory = call ptr @malloc(i64 %all)
  %none = icmp eq ptr %memory, null
  br i1 %none, label %failed, label %made
made:
  %address = ptrtoint ptr %memory to i64
  %least = add i64 %address, 47
  %past = add i64 %least, %alignment
  %mask = sub i64 0, %alignment
  %aligned = and i64 %past, %mask
  %data = inttoptr i64 %aligned to ptr
  store i64 1, ptr %memory
  %at1 = getelementptr %head, ptr %memory, i64 0, i32 1
  store ptr null, ptr %at1
  %at2 = getelementptr %head, ptr %memory, i64 0, i32 2
  store ptr null, ptr %at2
  %at3 = getelementptr %head, ptr %memory, i64 0, i32 3
  store ptr %data, ptr %at3
  %at4 = getelementptr %head, ptr %memory, i64 0, i32 4
  store i64 %size, ptr %at4
  %at5 = getelementptr %head, ptr %memory, i64 0, i32 5
  store ptr null, ptr %at5
  ret ptr %memory
failed:
  ret ptr null
}

define void @NRT_MemInfo_call_dtor(ptr %memory) {
entry:
  call void @free(ptr %memory)
  ret void
}
"""
