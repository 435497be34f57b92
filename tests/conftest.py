"""Property tests: the same examples in every run; the first call of a kernel may compile for seconds.

Linear algebra keeps to one thread: the tests run side by side, and their matrices are small.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # read when numpy is imported, here and in processes that tests start

from hypothesis import settings

settings.register_profile("contin", deadline=None, derandomize=True)
settings.load_profile("contin")
