"""Unstable eigenvalues beyond those nearest to zero: each of them once, those of which nothing was known included."""

import numpy as np
import scipy.sparse as sp

from contin.linalg.eigen import Spectrum
from contin.linalg.factor import Factoriser
from contin.linalg.grown import with_grown_ones
from contin.linalg.linear import DirectLinear
from contin.linalg.pencil import inverse_of


def test_an_eigenvalue_that_is_new_at_the_edge_of_what_was_looked_at_stays():
    values = np.array([140.0, 3.0, -0.5, -1.0, -2.0, *(-4.0 - np.arange(95.0))])
    linear = DirectLinear(sp.diags(values, format="csc"), Factoriser())
    unit = np.eye(len(values), dtype=complex)
    nearest = [2, 3, 4, 1]  # 3 is the farthest of those nearest to zero
    found = Spectrum(values[nearest].astype(complex), unit[:, nearest], True)
    for known in ([0, 2, 3, 4], [0, 1, 2, 3, 4]):  # without 3, and with it
        vectors = unit[:, known] + 0.02 * np.roll(unit, 7, axis=0)[:, known]
        whole, reach = with_grown_ones(found, linear, inverse_of(linear), vectors, None)
        assert reach > 100.0
        assert np.sort(whole.values.real[whole.values.real > 0.0]).round(2).tolist() == [3.0, 140.0]
