"""How a kernel counts the references to arrays that it makes: numba's functions for it, in LLVM's assembly.

numba's own, which it has compiled for this machine by then, count atomically; arrays of kernels never leave their
thread. Memory itself: `contin.machine.memory`.
"""

from typing import Final

TEXT: Final = """
declare void @NRT_MemInfo_call_dtor(ptr)

define ptr @NRT_MemInfo_data_fast(ptr %memory) {
entry:
  %at = getelementptr i8, ptr %memory, i64 24
  %data = load ptr, ptr %at
  ret ptr %data
}

define void @NRT_incref(ptr %memory) {
entry:
  %none = icmp eq ptr %memory, null
  br i1 %none, label %done, label %count
count:
  %before = load i64, ptr %memory
  %after = add i64 %before, 1
  store i64 %after, ptr %memory
  br label %done
done:
  ret void
}

define void @NRT_decref(ptr %memory) {
entry:
  %none = icmp eq ptr %memory, null
  br i1 %none, label %done, label %count
count:
  %before = load i64, ptr %memory
  %after = sub i64 %before, 1
  store i64 %after, ptr %memory
  %last = icmp eq i64 %after, 0
  br i1 %last, label %end, label %done
end:
  call void @NRT_MemInfo_call_dtor(ptr %memory)
  br label %done
done:
  ret void
}
"""
