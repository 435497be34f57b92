"""Property tests: the same examples in every run; the first call of a kernel may compile for seconds.

numpy and BLAS compute as the command has them do, with the level of machine code and one thread, so that the same
digits are tested on every processor. `CONTIN_TARGET=x86-64-v2` tests those of another level, and
`CONTIN_TEST_LIBRARIES=processor` what numpy and BLAS choose by themselves: the tests must pass with each.
"""

import os

if os.environ.get("CONTIN_TEST_LIBRARIES") == "processor":
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # read when numpy is imported, here and in processes that tests start
else:
    from contin.machine import environment

    environment.fix()

from hypothesis import settings

settings.register_profile("contin", deadline=None, derandomize=True)
settings.load_profile("contin")
