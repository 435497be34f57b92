"""New arrays that begin with huge numbers: what reads memory before it is written fails, whatever lay there before."""

import numpy as np

HUGE = 1.7e306  # its square overflows


def fill_new_arrays():
    """Let `numpy.empty` and `numpy.empty_like` fill what they make, here and in everything that is imported later."""
    for name in ("empty", "empty_like"):
        setattr(np, name, _filled(getattr(np, name)))


def _filled(make):
    def made(*arguments, **options):
        array = make(*arguments, **options)
        if array.dtype.kind in "fc":
            array.fill(HUGE)
        elif array.dtype.kind in "iu":
            array.fill(np.iinfo(array.dtype).max // 3)
        elif array.dtype.kind == "b":
            array.fill(True)
        return array

    return made
