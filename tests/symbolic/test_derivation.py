import pytest

import contin
from contin.cli.main import main
from contin.symbolic.averaging.derivation import derive


def test_the_document_has_every_step_of_a_piecewise_average():
    text = derive(contin.load("metronomes/one-constant")).text()
    for part in (
        "Equations of motion",
        "r' = eps*(E*cos(phi) - F*sin(phi))",
        "For x1 < r < x2:",
        "for phi from -acos(x1/r) + 2*pi to 2*pi",
        "This presumes 0 < x1 < x2.",
        "Averaged equations",
    ):
        assert part in text


@pytest.mark.parametrize("form", ["polar", "cartesian", "stokes"])
def test_latex_and_markdown_are_balanced(form):
    derivation = derive(contin.load("metronomes/pair"), form=form)
    latex, markdown = derivation.latex(), derivation.markdown()
    assert latex.count(r"\begin{") == latex.count(r"\end{")
    assert latex.count(r"\left") == latex.count(r"\right")
    assert latex.count("{") == latex.count("}")
    assert markdown.count("$$") % 2 == 0
    assert "@" not in latex + markdown


def test_the_command_writes_files_and_the_saved_model_is_the_derived_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for arguments in (
        ["derive", "metronomes/pair", "--form", "stokes", "--latex", "a.tex", "--markdown", "a.md", "--save", "a.yaml"],
        ["show", "a.yaml", "--latex"],
    ):
        with pytest.raises(SystemExit) as ended:
            main(arguments)
        assert ended.value.code == 0
    assert r"\dot{S_{1}}" in capsys.readouterr().out
    assert contin.load("a.yaml").equations == contin.average(contin.load("metronomes/pair"), form="stokes").equations
    with pytest.raises(SystemExit) as ended:
        main(["derive", "metronomes/pair", "--latex", "../outside.tex"])
    assert ended.value.code == 2
    assert "working folder" in capsys.readouterr().err


def test_derivations_show_kicks_friction_forcing_and_what_follows():
    seen = {
        "oscillators/clocks-on-a-beam": ["Kicks", "Where x1 - c crosses zero upwards", "V = C/(C^2 + 1)*x1"],
        "oscillators/coulomb-platform": ["Dry friction", "The level is mu"],
        "oscillators/autoparametric": ["F*cos(2*t)", "Oscillator 2 has the frequency 2 omega", "conj(A1) A2"],
    }
    for name, words in seen.items():
        text = derive(contin.load(name)).text()
        assert [w for w in words if w not in text] == []
