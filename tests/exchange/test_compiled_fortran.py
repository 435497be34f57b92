"""AUTO's equations files, compiled, calculate what the model does."""

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

from contin.exchange import registry
from contin.model.evaluate import evaluate_all
from contin.model.registry import load

pytestmark = pytest.mark.skipif(shutil.which("gfortran") is None, reason="needs gfortran")

MODEL = {
    "name": "mixed",
    "states": {"V": 0.3, "v": -0.2},
    "parameters": {f"p{i}": i / 8 for i in range(1, 14)},
    "definitions": {"c": "exp(-V^2)*p3/3 if V*v > 0 and not V > 2 else -V^2/(1 + v^2)"},
    "equations": {
        "V": "c*sin(v) - c^2/7 + 2^-V + " + " + ".join(f"p{i}*v^{i}" for i in range(1, 14)),
        "v": "sign(V)*abs(V)^(1/3) + heaviside(v) + min(V, v, p1) + max(V, v) + atan2(V, v) + log1p(v^2) + expm1(V)",
    },
}


def compiled(model, folder):
    """The subroutine FUNC of a model's file as a function of u and PAR."""
    (folder / "model.f90").write_text(registry.write(model, "model.f90").text)
    library = folder / "model.so"
    command = ["gfortran", "-O1", "-shared", "-fPIC", "model.f90", "-o", str(library)]
    subprocess.run(command, cwd=folder, check=True, timeout=60, capture_output=True)
    code = ctypes.CDLL(str(library))

    def point(values):
        return values.ctypes.data_as(ctypes.c_void_p)

    def func(u, par):
        n, unused, f = np.array([len(u)], np.int32), np.zeros(1, np.int32), np.zeros(len(u))
        derivatives = np.zeros(len(u) * 40)
        arrays = (n, u, unused, par, unused, f, derivatives, derivatives)
        code.func_(*(point(a) for a in arrays))
        return f

    def stpnt(n):
        u, par = np.zeros(n), np.zeros(40)
        code.stpnt_(point(np.array([n], np.int32)), point(u), point(par), point(np.zeros(1)))
        return u, par

    return func, stpnt


def test_compiled_equations_agree(tmp_path):
    model = load(MODEL)
    func, stpnt = compiled(model, tmp_path)
    u, par = stpnt(2)
    places = [*range(10), *range(11, 14)]  # PAR(11) is AUTO's period
    np.testing.assert_array_equal(u, [0.3, -0.2])
    np.testing.assert_array_equal(par[places], [i / 8 for i in range(1, 14)])
    assert par[10] == 0
    rng = np.random.default_rng(3)
    for _ in range(20):
        u = rng.uniform(-2, 2, 2)
        names = dict(zip((*model.parameter_names, *model.state_names), map(float, (*par[places], *u)), strict=True))
        np.testing.assert_allclose(func(u, par), evaluate_all(model.equations, names), rtol=1e-12)
