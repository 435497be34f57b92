"""Equations files of AUTO-07p as people write them."""

import math

import pytest

from contin.errors import InputError
from contin.exchange import registry
from contin.exchange.imported import UnsupportedError
from contin.model.evaluate import evaluate_all

FILE = """
! a comment
      SUBROUTINE FUNC(NDIM,U,ICP,PAR,IJAC,F,DFDU,DFDP)
      IMPLICIT DOUBLE PRECISION (A-H,O-Z)
      DIMENSION U(NDIM), PAR(*), F(NDIM)
      DOUBLE PRECISION, PARAMETER :: HALF = 1.D0/2, TWO=2
      CUBE(Z) = Z*(Z - A)*(1 - Z)      ! a statement function
      A = PAR(1)
      V=U(1); W=U(2)
      S = DEXP(-V)*3/2 + 7/2*HALF
      S = S**2**TWO
      F(1) = CUBE(V + W) - S &
       & - SIGN(W, -V) + MERGE(MOD(-7.5D0, TWO), 9D0, V < 10)
      F(2) = F(1)*PAR(3) - V**(-2)
      IF (IJAC.EQ.0) RETURN
      DFDU(1,1) = WHATEVER(1)
      END SUBROUTINE FUNC

      SUBROUTINE STPNT(NDIM,U,PAR,T)
      PI = 4*ATAN(1.0D0)
      PAR(1:3) = (/ 0.25, 1.0, 2.0D-1 /)
      PAR(11) = 2*PI
      U = 0.5D0
      U(2) = SIN(PI*T) + PAR(1)
      END SUBROUTINE STPNT
"""
CONSTANTS = """NDIM= 2, IPS = {ips}, IRS = 0
unames = {{1: 'volt', 2: 'w'}}
parnames = {{1: 'a', 11: 'T'}}
ICP = ['a', 11]
NTST= 25, NMX= 100, RL0= 0.0, RL1= 1.0, DSMAX= 0.06 # a comment
"""


def files(folder, text=FILE, ips=1):
    (folder / "c.sample").write_text(CONSTANTS.format(ips=ips))
    (folder / "sample.f90").write_text(text)
    return folder / "sample.f90"


def test_equations_and_starting_values(tmp_path):
    found = registry.read(files(tmp_path))
    model = registry.model_of(found, "sample.f90")
    assert model.state_names == ("volt", "w")
    assert found.model["parameters"] == {"a": 0.25, "par3": 0.2, "T": 2 * math.pi}
    assert model.start_point()[0].tolist() == [0.5, 0.25]
    for v, w, a in ((0.3, 0.4, 0.1), (-0.6, 0.2, 0.7)):
        s = (math.exp(-v) * 1.5 + 3 * 0.5) ** 4
        z = v + w
        first = z * (z - a) * (1 - z) - s - math.copysign(w, -v) - 1.5
        wanted = [first, 0.2 * first - v**-2]
        assert evaluate_all(model.equations, {"volt": v, "w": w, "a": a, "par3": 0.2}) == pytest.approx(wanted, 1e-13)


def test_constants_ask_for_a_run(tmp_path):
    found = registry.read(files(tmp_path))
    settings = {"max_step": 0.06, "steps": 100, "intervals": 25}
    run = {"name": "auto", "parameter": "a", "range": [0, 1], "settings": settings}
    assert found.run == {"continuations": [run]}


@pytest.mark.parametrize(("ips", "kind"), [(1, "flow"), (-1, "map"), (0, "algebraic"), (2, "flow")])
def test_kinds(tmp_path, ips, kind):
    assert registry.read(files(tmp_path, ips=ips)).model["kind"] == kind


@pytest.mark.parametrize("ips", [4, 9, 14])
def test_other_problems_are_refused(tmp_path, ips):
    with pytest.raises(UnsupportedError, match=f"IPS = {ips}"):
        registry.read(files(tmp_path, ips=ips))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("IF (V > 0) S = 1", "line 15: 'IF': only assignments"),
        ("DO I = 1, 2", "line 15: 'DO'"),
        ("CALL HELP(V)", "line 15: 'CALL'"),
        ("Q = BESSEL_J0(V)", "line 15: the function bessel_j0"),
        ("Q = UNSET + 1", "line 15: unset has no value yet"),
        ("Q = 1/0", "line 15: a division of integers by 0"),
        ("F(I) = 2", "line 15: .*the index is not a number"),
        ("Q = U(NDIM)", "line 15: an element of u"),
    ],
)
def test_what_is_not_read_is_named_with_its_line(tmp_path, line, message):
    text = FILE.replace("      IF (IJAC.EQ.0) RETURN", f"      {line}\n      IF (IJAC.EQ.0) RETURN")
    with pytest.raises(UnsupportedError, match=message):
        registry.read(files(tmp_path, text))


def test_other_files_are_told_apart(tmp_path):
    with pytest.raises(InputError, match="no SUBROUTINE FUNC"):
        registry.read(files(tmp_path, "PROGRAM X\nEND"))


def test_single_precision_is_noted(tmp_path):
    found = registry.read(files(tmp_path, FILE.replace("0.25, 1.0", "0.3, 1.0")))
    assert any("without D0" in note and "0.3 on line 21" in note for note in found.notes)
