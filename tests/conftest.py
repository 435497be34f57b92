"""Property tests: the same examples in every run; the first call of a kernel may compile for seconds."""

from hypothesis import settings

settings.register_profile("contin", deadline=None, derandomize=True)
settings.load_profile("contin")
