"""XPP's .ode files: what they mean, sampled or integrated against the equations written by hand."""

from pathlib import Path

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.exchange.imported import UnsupportedError
from contin.exchange.registry import model_of
from contin.exchange.xpp.read import read
from contin.model.evaluate import evaluate_all


def imported(text):
    return read(text, Path("sample.ode"))


def model(text):
    return model_of(imported(text), "sample.ode")


def values(text, **states):
    """Right-hand sides and auxiliary quantities of a file, at its own values but for `states`."""
    found = model(text)
    u, p = found.start_point(states or None)
    names = dict(zip((*found.parameter_names, *found.state_names), (*p, *u), strict=True))
    wanted = {**found.equation_map, **found.observables}
    return dict(zip(wanted, evaluate_all(wanted.values(), names), strict=True))


@pytest.mark.parametrize(
    ("formula", "value"),
    [  # with x = 3: as XPPAUT 6.11 prints them
        ("2^3^2", 64),
        ("-x^2", -9),
        ("-3^2", -9),
        ("2^(-1)", 0.5),
        ("8/4/2", 1),
        ("8/2*4", 16),
        ("1+2<2", 1),
        ("2<3*2", 2),
        ("2*3<4", 2),
        ("2^3<4", 0),
        ("3<2^2", 0),
        ("1-x<2", 1),
        ("-1<2", -1),
        ("1|0+1", 2),
        ("1|0*5", 1),
        ("3|0*5", 1),
        ("0&1*5", 0),
        ("1+1&1", 2),
        ("1==1+1", 2),
        ("2==x-1", -1),
        ("3>2>1", 0),
        (".5&1", 1),
        ("not(.5)", 0),
        ("not(0)+1", 2),
        ("x!=3", 0),
        ("(x>2)+(x<5)*10", 11),
        ("if(x>5)then(1/0)else(7)", 7),
        ("if(2)then(5)else(6)", 5),
        ("sign(0)", 0),
        ("heav(0)", 1),
        ("heav(-x)", 0),
        ("ln(x)-log(x)", 0),
        ("log10(100)", 2),
        ("max(1,2)+min(1,x)", 3),
        ("sum(1,3)of(i'*2)", 12),
        ("sum(0,2)of(i'^2)+1", 6),
        ("sum(0,1.9)of(x)", 6),
        ("2**x", 8),
        ("mod(-3.5,2)", 0.5),
        ("mod(-3.5,-2)", -3.5),
        ("mod(3.5,-2)", 1.5),
        ("mod(-4,x-5)", 0),
        ("mod(-x,x-1)", 1),
        ("flr(-1.5)", -2),
        ("ceil(-1.5)", -1),
    ],
)
def test_formulas_mean_what_they_mean_in_xpp(formula, value):
    assert values(f"x'=1\ninit x=3\naux q={formula}\ndone\n")["q"] == pytest.approx(value, abs=1e-15)


def test_a_comparison_inside_arithmetic_is_noted():
    notes = imported("x'=if(x>2*x)then(1)else(0)\ndone").notes
    assert any("XPP compares before it calculates" in note and "line 1" in note for note in notes)
    assert not imported("x'=if(x>(2*x))then(1)else(0)\ndone").notes


def test_declarations_in_all_their_forms():
    text = (
        "# a comment\npar a=2 b=3,c\nnumber k=4\n!d=a*b\n"
        "f(u,v)=u*v+K\ns = D + \\\n1\n"
        "X'=f(x,A)+s\ndy/dt=-y*D\nz' = -z\naux Tot.E=x+y\naux s=s\n"
        "init x=1, y=.5\nZ(0)=-2\n@ total=7,transient=2\ndone\nnonsense"
    )
    found = model(text)
    assert found.state_names == ("X", "y", "z")
    assert found.default_parameters() == {"a": 2, "b": 3, "c": 0}
    assert values(text) == {"X": 1 * 2 + 4 + 7, "y": -0.5 * 6, "z": 2, "Tot_E": 1.5, "s": 7}
    assert imported(text).run == {"simulate": [{"name": "simulation", "time": 7.0, "transient": 2.0}]}


def test_derived_parameters_follow_their_parameters():
    found = model("par a=2\n!b=a^2\nx'=b*x\ninit x=1\ndone")
    assert evaluate_all(found.equations, {"a": 3, "x": 1})[0] == 9


def test_arrays_blocks_sums_and_shifts_are_written_out():
    text = (
        "par c=.5\nx[0..3]'=-x[j]+c*sum(0,3)of(shift(x0,i'))+[j]\n"
        "%[3..1]\ny[j]'=x[j-1]-shift(x0,[j])\ninit y[j]=[j*2]\n%\ninit x[0..3]=2\nq[1..2]=x[j]+[j+1]\naux s=q2+q[1]\nd"
    )
    found = model(text)
    assert found.state_names == ("x0", "x1", "x2", "x3", "y3", "y2", "y1")
    assert found.start_point()[0].tolist() == [2, 2, 2, 2, 6, 4, 2]
    got = values(text, x0=1.0)
    assert [got[f"x{j}"] for j in range(4)] == [-1 + 3.5, 1.5 + 1, 1.5 + 2, 1.5 + 3]
    assert got["y1"] == -1
    assert got["y3"] == 0
    assert got["s"] == 4 + 5


def test_time_starts_at_t0():
    found = model("x'=t\n@ t0=1.5\ndone")
    assert evaluate_all(found.equations, {"t": 2.0, "x": 0.0}) == [3.5]


@pytest.mark.parametrize("equation", ["x(t+1)=r*x*(1-x)", "x'=r*x*(1-x)\n@ meth=discrete"])
def test_maps(equation):
    found = model(f"par r=3\ninit x=.25\n{equation}\ndone")
    assert found.kind == "map"
    assert values(f"par r=3\ninit x=.25\n{equation}\ndone")["x"] == 0.5625


def test_a_map_that_knows_its_step_counts_it():
    found = model("x'=x+t\n@ meth=disc,t0=1\ndone")
    u, rows = found.start_point()[0], []
    for _ in range(4):
        u = np.array([float(v) for v in evaluate_all(found.equations, dict(zip(found.state_names, u, strict=True)))])
        rows.append(u[0])
    assert rows == [1, 3, 6, 10]


def test_values_are_the_numbers_they_begin_with_as_in_xpp():
    found = imported("par a=1/2\nx'=-a*x\ninit x=a\ndone")
    assert found.model["parameters"] == {"a": 1.0}
    assert found.model["states"] == {"x": 0.0}
    assert sum("XPP reads" in note for note in found.notes) == 2


def test_auto_and_range_options_become_ranges_and_a_diagram():
    found = imported(
        "par i=0,b=1\nx'=i-b*x\n@ parmin=-1 parmax=2,dsmax=.1,ntst=40\n@ range=1,rangeover=b,rangelow=1,rangehigh=3\nd"
    )
    assert found.model["parameters"] == {"i": {"value": 0.0, "range": [-1, 2]}, "b": {"value": 1.0, "range": [1, 3]}}
    assert found.run["diagram"] == {
        "parameter": "i", "range": [-1, 2], "settings": {"max_step": 0.1, "intervals": 40}
    }  # fmt: skip


def test_a_flow_that_knows_the_time_asks_for_no_diagram():
    assert list(imported("par i=0\nx'=i-x+sin(t)\n@ parmin=-1 parmax=2\nd").run) == ["simulate"]


def test_sets_are_starts_and_folded_variables_are_angles():
    found = model(
        "par w=1\nx'=w\ny'=-y\nset fast run {w=3,y=2,total=50}\nset fast {w=3,y=2,total=50}\n@ tor_per=6.25,fold=x\nd"
    )
    assert found.periods().tolist() == [6.25, 0]
    u, p = found.start_point("fast")
    assert (u.tolist(), p.tolist()) == ([0, 2], [3])


def test_names_are_told_apart_by_ten_characters_without_case():
    text = "par conductances=3\nx'=-CONDUCTANC*x\ninit x=1\ndone"
    assert values(text) == {"x": -3}
    two = "par conductanceA=3,conductanceB=4\nx'=-conductancea*x+conductanceb\ninit x=1\ndone"
    assert values(two) == {"x": 1}
    assert any("cannot tell" in note for note in imported(two).notes)


def test_global_resets_are_events_that_take_the_values_before():
    """v' = I - v fires at 1; k counts by its own value and w takes v's before the jump; x falls downwards through 0."""
    text = (
        "par i=1.5\nv'=i-v\nk'=0\nw'=0\nx'=-1\ninit x=0.25\n"
        "global 1 v-1 {v=0;k=k+1;w=v}\nglobal -1 x {x=x+1}\ndone"
    )
    found = contin.simulate(model(text), time=5.0)
    period = np.log(3.0)
    spikes = [j for j in found.jumps if j.events == (0,)]
    np.testing.assert_allclose([j.time for j in spikes], period * np.arange(1, 5), rtol=1e-8)
    np.testing.assert_allclose([j.time for j in found.jumps if j.events == (1,)], 0.25 + np.arange(5), rtol=1e-8)
    assert found.columns["k"][-1] == 4.0
    assert found.columns["w"][-1] == pytest.approx(1.0, abs=1e-10)


def test_words_of_the_grammar_are_renamed():
    text = "par period=2\nlog1p(u)=u*period\nor'=log1p(or)\ninit or=3\ndone"
    assert values(text) == {"or_": 6}
    assert "period is called period_" in imported(text).notes


@pytest.mark.parametrize(
    ("lines", "line", "missing"),
    [
        ("x'=-x\nwiener w\ny'=-y+w", 3, "noise"),
        ("x'=-delay(x,1)", 1, "delays"),
        ("table w % 3 0 2 t\nx'=w(x)", 2, "tables have no equal but at numbers"),
        ("x'=-x\ntable w file.tab", 2, "tables from files"),
        ("x'=-x\nspecial k=conv(even,3,1,w,x)", 2, "networks by table"),
        ("x'=-x\nmarkov z 2", 2, "Markov"),
        ("x(t+1)=y\n0=x+y\nsolv y=1", 2, "algebraic equations"),
        ("x(t+1)=-x\nglobal 1 x-1 {x=0}", 2, "in a map"),
        ("par a=1\nx'=-x\nglobal 1 x-1 {a=0}", 3, "sets a, which is no variable"),
        ("x'=-x\nglobal 0 x-1 {x=0}", 2, "sign 0"),
        ("x'=-x\nglobal 1 x-1 {x=ran(1)}", 2, "random"),
        ("x'=1\nglobal x-1", 2, "global is read as"),
        ("x'=-x+int{exp(-t)#x}", 1, "Volterra"),
        ("u(t)=sin(t)+int{exp(-t)#u}\nx'=-u", 1, "Volterra"),
        ("x'=ran(1)-x", 1, "random"),
        ("x'=erf(x)", 1, "error function"),
        ("f(u)=besselj(0,u)\nx'=f(x)", 1, "Bessel"),
        ("x'=-x\nexport {x} {y}", 2, "library"),
        ("par n=3\nx0'=sum(0,n)of(i')", 2, "limits of a sum"),
        ("f(n)=if(n<1)then(1)else(n*f(n-1))\nx'=f(x)", 1, "depends on itself"),
        ("x'=-k*x", 1, "k is not declared"),
        ("x'=-x\nx'=x", 2, "a second equation"),
        ("x[1..2]'=y[j-2]", 1, "index"),
        ("x'=2*", 1, "ends too early"),
    ],
)
def test_what_is_missing_is_named_with_its_line(lines, line, missing):
    with pytest.raises((UnsupportedError, InputError), match=rf"line {line}: .*{missing}"):
        model(f"{lines}\ndone\n")


def test_algebraic_equations_are_states_without_mass():
    found = imported("x'=-x+y\n0= y+z\n0=x-z^3\nsolv y=-1,z=1\ninit x=1\naux s=y+z\ndone")
    assert found.model["mass"] == {"y": 0, "z": 0}
    assert found.model["states"] == {"x": 1, "y": -1, "z": 1}
    assert model_of(found, "a").equation_map.keys() == {"x", "y", "z"}
    with pytest.raises(UnsupportedError, match="1 equations 0=, but 2 variables"):
        imported("x'=y\n0=x+y\nsolve y=1,z=1\ndone")


def test_tables_of_formulas_are_read_at_numbers_as_xpp_interpolates_them():
    text = "par a=2\ntable w % 5 0 8 a*t*t\nx[0..2]'=w([j])+sum(0,2)of(w(i'*2))\naux q=w(3)\naux r=w(-1)\naux s=w(9)\nd"
    got = values(text)
    assert (got["q"], got["r"], got["s"]) == (20, -4, 156)
    assert [got[f"x{j}"] - 40 for j in range(3)] == [0, 4, 8]


def test_lines_that_xpp_passes_over_are_noted():
    found = imported("x'=1\nfoo x=3\njust some words\ndone")
    assert [note.split(":")[0] for note in found.notes] == ["line 2", "line 3"]


def test_noise_whose_factor_is_zero_is_left_out():
    text = "par s=0\nwiener w\nx'=-x+s*w\nn=s*w+x\naux q=n\naux r=w\ninit x=1\ndone"
    assert values(text) == {"x": -1, "q": 1}
    assert any("noise w is left out" in note for note in imported(text).notes)
    with pytest.raises(UnsupportedError, match="driven by noise"):
        model(text.replace("s=0", "s=.1"))


def test_quantities_that_nothing_uses_may_be_unreadable():
    found = imported("f(n)=if(n<1)then(1)else(n*f(n-1))\nq=ran(1)\nx'=-x\naux z=erf(x)\ndone")
    assert sorted(found.model) == ["equations", "kind", "name", "source", "states"]
    assert len([note for note in found.notes if "left out" in note]) == 3


def test_a_quantity_used_before_it_is_declared_is_noted():
    text = "g=h+1\nh=x\nx'=-g\ninit x=2\ndone"
    assert values(text) == {"x": -3}
    assert any("the step before" in note for note in imported(text).notes)


def test_boundary_conditions_are_left_out_with_a_note():
    found = imported("x'=y\ny'=-x\nb x-1\nbndry x'\ndone")
    assert any("lines 3, 4" in note for note in found.notes)


def test_endless_expansions_are_refused():
    with pytest.raises(InputError, match="line 1: an array of"):
        imported("x[0..999999999]'=-x[j]\ndone")
    with pytest.raises(UnsupportedError, match="a sum of"):
        imported("x'=sum(0,999999999)of(i')\ndone")
    with pytest.raises(UnsupportedError, match="nested deeper"):
        imported("x'=" + "(" * 5000 + "x" + ")" * 5000 + "\ndone")
