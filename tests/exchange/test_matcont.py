"""System files of MatCont as it writes them."""

from pathlib import Path

import pytest

from contin.errors import InputError
from contin.exchange.imported import UnsupportedError
from contin.exchange.matcont.read import read
from contin.exchange.registry import model_of
from contin.model.evaluate import evaluate_all

FILE = """function out = sample
out{1} = @init;
out{2} = @fun_eval;
out{3} = @jacobian;

% --------------------------------------------------------------------------
function dydt = fun_eval(t,kmrgd,par_a, ...
    par_b)
% par_b = 2.5
v = kmrgd(1);
r=v.^2+kmrgd(2)^2;   % the radius
r = -r^2;
dydt=[v-r*kmrgd(2)+par_a;
par_b*kmrgd(2) - 2^-v*(v>0 & ~(v==1)) + max(v,...
  sech(v));];

% --------------------------------------------------------------------------
function [tspan,y0,options] = init
handles = feval(sample);
y0=[0.5,0];
options = odeset('Jacobian',handles(3));
tspan = [0 10];

function jac = jacobian(t,kmrgd,par_a,par_b)
jac=[ 0 , 1 ; 2*kmrgd(1) - 1 , -par_b ];
"""


def test_equations_names_and_values():
    found = read(FILE, Path("sample.m"))
    model = model_of(found, "sample.m")
    assert model.state_names == ("v", "x2")
    assert found.model["parameters"] == {"a": 0, "b": 2.5}
    assert any("no values of parameters: a" in note for note in found.notes)
    assert model.start_point()[0].tolist() == [0.5, 0]
    v, x, a, b = 0.5, -0.3, 0.2, 2.5
    wanted = [v + (v**2 + x**2) ** 2 * x + a, b * x - 2**-v + max(v, 1 / 1.1276259652063807)]
    assert evaluate_all(model.equations, {"v": v, "x2": x, "a": a, "b": b}) == pytest.approx(wanted, 1e-14)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("if v > 0, r = 1; end", "'if': fun_eval is read only where it is assignments"),
        ("r(2) = 3;", "arrays are not read"),
        ("r = besselj(0, v);", "the function besselj"),
        ("r = unset + 1;", "unset has no value yet"),
    ],
)
def test_what_is_not_read_is_named(line, message):
    with pytest.raises(UnsupportedError, match=message):
        read(FILE.replace("r = -r^2;", line), Path("sample.m"))


def test_other_files_are_told_apart():
    with pytest.raises(InputError, match="not a MatCont system file"):
        read("x = 1;\n", Path("sample.m"))
