"""Signatures and memory layouts that the lowering (which makes machine code) and the kernels (which call it) share.

Every function that the lowering makes returns nothing and takes pointers to contiguous float64 arrays:

    value      (u, p, F)                 F[i] = f_i(u, p)
    jacobian   (u, p, F, J)              J[i, j] = df_i/dz_j, row-major (n, n + m), z = (u, p)
    second     (u, p, v, w, out)         out = D^2 f(z)[v, w],       v, w in R^(n + m)
    third      (u, p, v, w, s, out)      out = D^3 f(z)[v, w, s]     (and so on for higher orders)
    observe    (u, p, out)               out[k] = k-th observable
    switches   (u, p, out)               out[k] = k-th switching function: where it vanishes, a piecewise equation
                                         changes formula

u : (n,) states in the model's order.  p : (m,) parameters in the model's order.  A periodically forced model appends
the time t to p, so p is (m + 1,) and J has a last column df/dt.  Nothing is checked on the far side: the caller owns
shapes and lifetimes.  An address must not outlive the `CompiledSystem` it came from: calling it then is a segmentation
fault, so problems and branches hold the compiled system, and processes and pickles carry the model's text and lower
again.
"""

from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Vector: TypeAlias = NDArray[Any]  # real or complex: numpy's types have no arithmetic for "one of the two"
Address: TypeAlias = int

NO_FUNCTION: Final[Address] = 0  # an optional function that this system does not have
