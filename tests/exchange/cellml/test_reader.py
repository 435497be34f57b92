"""CellML: components joined, units converted, time too."""

from math import tanh
from pathlib import Path

import pytest

from contin.errors import InputError
from contin.exchange.imported import UnsupportedError
from contin.exchange.registry import model_of
from contin.model.evaluate import evaluate_all

pytest.importorskip("contin.exchange.cellml.library")
from contin.exchange.cellml.reader import read

MATH = '<math xmlns="http://www.w3.org/1998/Math/MathML">'
TWO = f"""<?xml version="1.0" encoding="utf-8"?>
<model xmlns="http://www.cellml.org/cellml/1.0#" xmlns:cellml="http://www.cellml.org/cellml/1.0#" name="two">
  <units name="ms"><unit units="second" prefix="milli"/></units>
  <units name="mV"><unit units="volt" prefix="milli"/></units>
  <units name="per_ms"><unit units="second" prefix="milli" exponent="-1"/></units>
  <units name="mV_per_ms">
    <unit units="volt" prefix="milli"/>
    <unit units="second" prefix="milli" exponent="-1"/></units>
  <component name="environment">
    <variable name="time" units="ms" public_interface="out"/></component>
  <component name="membrane">
    <variable name="time" units="ms" public_interface="in"/>
    <variable name="V" units="mV" initial_value="-60" public_interface="out"/>
    <variable name="k" units="per_ms" initial_value="0.5"/>
    <variable name="E" units="mV" initial_value="-50"/>
    <variable name="i" units="mV_per_ms"/>
    {MATH}
      <apply><eq/><apply><diff/><bvar><ci>time</ci></bvar><ci>V</ci></apply><apply><minus/><ci>i</ci></apply></apply>
      <apply><eq/><ci>i</ci><apply><times/><ci>k</ci><apply><minus/><ci>V</ci><ci>E</ci></apply></apply></apply>
    </math>
  </component>
  <component name="gate">
    <variable name="time" units="second" public_interface="in"/>
    <variable name="V" units="volt" public_interface="in"/>
    <variable name="n" units="dimensionless" initial_value="0.1"/>
    <variable name="k" units="dimensionless" initial_value="2"/>
    <variable name="tau" units="second" initial_value="0.01"/>
    <variable name="ninf" units="dimensionless"/>
    <units name="per_volt"><unit units="volt" exponent="-1"/></units>
    {MATH}
      <apply><eq/><apply><diff/><bvar><ci>time</ci></bvar><ci>n</ci></apply>
        <apply><divide/><apply><minus/><ci>ninf</ci><ci>n</ci></apply><ci>tau</ci></apply></apply>
      <apply><eq/><ci>ninf</ci><piecewise>
        <piece><apply><tanh/><apply><times/><cn cellml:units="per_volt">10</cn><ci>V</ci></apply></apply>
        <apply><gt/><ci>V</ci>
        <cn cellml:units="volt">-0.055</cn></apply></piece>
        <otherwise><apply><times/><ci>k</ci>
        <cn cellml:units="dimensionless">0.25</cn></apply></otherwise></piecewise></apply>
    </math>
  </component>
  <connection>
    <map_components component_1="environment" component_2="membrane"/>
    <map_variables variable_1="time" variable_2="time"/>
  </connection>
  <connection>
    <map_components component_1="environment" component_2="gate"/>
    <map_variables variable_1="time" variable_2="time"/>
  </connection>
  <connection>
    <map_components component_1="membrane" component_2="gate"/>
    <map_variables variable_1="V" variable_2="V"/>
  </connection>
</model>
"""
SECOND = f"""<?xml version="1.0" encoding="utf-8"?>
<model xmlns="http://www.cellml.org/cellml/2.0#" xmlns:cellml="http://www.cellml.org/cellml/2.0#" name="m2">
  <units name="ms"><unit units="second" prefix="milli"/></units>
  <component name="env"><variable name="time" units="ms" interface="public"/></component>
  <component name="a">
    <variable name="t" units="second" interface="public"/>
    <variable name="x" units="dimensionless" initial_value="1"/>
    <variable name="k" units="dimensionless" initial_value="3"/>
    {MATH}
      <apply><eq/><apply><diff/><bvar><ci>t</ci></bvar><ci>x</ci></apply><apply><minus/><apply><times/><ci>k</ci><ci>x</ci></apply></apply></apply>
    </math>
  </component>
  <connection component_1="env" component_2="a"><map_variables variable_1="time" variable_2="t"/></connection>
</model>
"""


def model(text):
    return model_of(read(text, Path("sample.cellml")), "sample.cellml")


@pytest.mark.parametrize("version", ["1.0", "1.1"])
def test_components_with_units_of_their_own(version):
    found = model(TWO.replace("cellml/1.0", f"cellml/{version}"))
    assert found.state_names == ("V", "n")
    assert found.default_parameters() == {"membrane_k": 0.5, "E": -50, "gate_k": 2, "tau": 0.01}
    assert [s.unit for s in found.states] == ["mV", None]
    assert found.start_point()[0].tolist() == [-60, 0.1]
    for v, n in ((-60.0, 0.1), (-40.0, 0.3)):  # mV and ms outside, V and s in the gate
        ninf = tanh(10 * 1e-3 * v) if 1e-3 * v > -0.055 else 0.5
        wanted = [-0.5 * (v + 50), 1e-3 * (ninf - n) / 0.01]
        got = evaluate_all(found.equations, {**found.default_parameters(), "V": v, "n": n})
        assert got == pytest.approx(wanted, rel=1e-13)


def test_cellml_2():
    found = model(SECOND)
    assert evaluate_all(found.equations, {"x": 2.0, "k": 3.0}) == pytest.approx([-6e-3], rel=1e-15)


def test_units_that_do_not_fit_are_refused():
    wrong = TWO.replace('<variable name="V" units="volt"', '<variable name="V" units="second"')
    with pytest.raises(UnsupportedError):
        model(wrong)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<model/>", "is no CellML document"),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]><model/>", "document type declaration"),
        (TWO.replace("<ci>k</ci>", "<ci>q</ci>"), "q"),
        (TWO.replace("</math>", "</mat>"), "XML"),
    ],
)
def test_wrong_documents_are_told(text, message):
    with pytest.raises(InputError, match=message):
        model(text)
