"""What is written in another language and read again has the same equations: sampled at random points."""

import numpy as np
import pytest

from contin.exchange import registry
from contin.exchange.imported import UnsupportedError
from contin.model.evaluate import evaluate_all
from contin.model.registry import load

ODE, AUTO, MATCONT, SBML = ".ode", ".f90", ".m", ".xml"

BRUSSELATOR = {
    "name": "brusselator",
    "states": {"x": 1, "y": 2.5},
    "parameters": {"A": 1, "B": {"value": 2.5, "range": [0, 4]}},
    "equations": {"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"},
    "observables": {"total": "x + y"},
    "starts": {"rest": {"x": "A", "y": "B/A", "parameters": {"B": 1.5}}},
}
GRAMMAR = {
    "name": "every-function",
    "states": {"V": 0.3, "v": -0.2, "averylongstatename": 0.1, "μ": 0.5},
    "parameters": {"period2": 0.7, "if_": 0.2, "d": 1e-7, "Averylongstatename2": 2, "k": "1/3"},
    "functions": {"g(u, w)": "u^3 - w if u*w > 0 and not u > 2 else -u^2/(1 + w^2)"},
    "definitions": {"q1": "exp(-V^2)*g(V, v) + k", "unused": "V + 1", "r2": "V^2 + v^2"},
    "equations": {
        "V": "q1*sin(v) - q1^2/7 + 2^-V - r2^1.5 + (V - 2*(v - 3))^2/(3*k*r2) - 1e-7*d",
        "v": "(1 if V < v or v >= 0.1 else 0) + heaviside(V) - sign(v)*abs(V)^(1/3) - (-V)^3 - 0.1*(k - (v - d))",
        "averylongstatename": "min(V, v, k) + max(V, -v) + tanh(V)/cosh(v) + atan2(V, v) + log(2 + V) - log1p(v^2)",
        "μ": "expm1(V) + asin(V/4) + acos(v/4) + atan(V) + tan(v) + sinh(μ) + sqrt(r2) + log10(2 + v) + cos(pi*V)",
    },
    "observables": {"r2": "r2", "q": "V*q1"},
}
STEPS = {
    "name": "steps",
    "states": {"x": 0.5, "y": 1.5},
    "parameters": {"a": 0.7},
    "equations": {
        "x": "mod(3*x, a) + mod(5*y, -a) + floor(4*x) - ceil(3*y)*a",
        "y": "asinh(x) + acosh(2 + y) + atanh(x/2) - floor(x - y) + abs(y)^a",
    },
}
HENON = {
    "name": "henon",
    "kind": "map",
    "states": {"x": 0.1, "y": 0},
    "parameters": {"a": 1.4, "b": 0.3},
    "equations": {"x": "1 - a*x^2 + y", "y": "b*x"},
}
NETWORK = {
    "name": "network",
    "states": {f"x{i}": 0.1 * i for i in range(14)},
    "parameters": {"k": 0.5},
    "equations": {
        f"x{i}": " + ".join(f"k*sin(x{j} - x{i} - 0.125*k)*{1 + (i * j) % 7}" for j in range(14)) for i in range(14)
    },
}


def sampled(model, other, seed=1, points=20):
    """Largest difference of the equations of two models at random points, relative to their size."""
    rng = np.random.default_rng(seed)
    assert len(model.states) == len(other.states)
    worst = 0.0
    _, p = model.start_point()
    _, q = other.start_point()
    np.testing.assert_array_equal(q, p)
    for _ in range(points):
        u = rng.uniform(-1, 1, len(model.states))
        factors = rng.uniform(0.5, 1.5, len(p))
        values = []
        for one, parameters in ((model, p * factors), (other, q * factors)):
            names = dict(
                zip(
                    (*one.state_names, *one.parameter_names, "t"),
                    (*map(float, u), *map(float, parameters), 0.7),
                    strict=True,
                )
            )
            values.append(np.array(evaluate_all(one.equations, names), dtype=float))
        assert np.all(np.isfinite(values[0]) == np.isfinite(values[1]))
        finite = np.isfinite(values[0])
        scale = 1 + np.abs(values[0][finite])
        worst = max(worst, float(np.max(np.abs(values[0] - values[1])[finite] / scale, initial=0.0)))
    return worst


def there_and_back(model, ending, folder):
    written = registry.write(model, f"{model.name}{ending}")
    file = folder / f"sample{ending}"
    file.write_text(written.text)
    for name, text in written.beside.items():
        (folder / name.format(stem="sample")).write_text(text)
    found = registry.read(file)
    return registry.model_of(found, file), written, found


@pytest.mark.parametrize("ending", [ODE, AUTO, MATCONT, SBML, ".yaml"])
@pytest.mark.parametrize("document", [BRUSSELATOR, GRAMMAR, STEPS, HENON, NETWORK], ids=lambda d: d["name"])
def test_equations_survive(document, ending, tmp_path):
    model = load(document)
    if ending == ".yaml":
        (tmp_path / "sample.yaml").write_text(registry.write(model, "sample.yaml").text)
        assert load(str(tmp_path / "sample.yaml")).equations == model.equations
        return
    if ending == SBML and model.kind == "map":
        with pytest.raises(UnsupportedError, match="kind map"):
            registry.write(model, "x.xml")
        return
    other, _, _ = there_and_back(model, ending, tmp_path)
    assert other.kind == model.kind
    np.testing.assert_allclose(other.start_point()[0], model.start_point()[0], rtol=1e-15)
    assert sampled(model, other) < 1e-13


@pytest.mark.parametrize("name", ["metronomes/pair", "classics/hodgkin-huxley", "classics/brusselator"])
@pytest.mark.parametrize("ending", [ODE, AUTO, MATCONT, SBML])
def test_bundled_models_survive(name, ending, tmp_path):
    model = load(name)
    assert sampled(model, there_and_back(model, ending, tmp_path)[0]) < 1e-12


def test_names_and_starts_survive_where_they_can(tmp_path):
    model = load(BRUSSELATOR)
    for ending in (ODE, AUTO, MATCONT):
        other, _, _ = there_and_back(model, ending, tmp_path)
        assert [n.lower() for n in other.state_names] == ["x", "y"]
        assert [n.lower() for n in other.parameter_names] == ["a", "b"]
    other, _, found = there_and_back(model, ODE, tmp_path)
    assert other.start_point("rest")[0].tolist() == [1, 1.5]
    assert found.run["diagram"]["range"] == [0, 4] if "diagram" in found.run else True
    assert list(other.observables) == ["total"]


def test_names_that_a_language_does_not_take_are_changed_and_told(tmp_path):
    _, written, _ = there_and_back(load(GRAMMAR), ODE, tmp_path)
    assert any(note.startswith("averylongstatename is called averylong") for note in written.notes)
    assert any("μ is called mu" in note for note in written.notes)
    parameters = [line for line in written.text.splitlines() if line.startswith("par ")]
    assert parameters
    assert all(len(line.split("=")[0]) <= 13 for line in parameters)


def test_a_definition_that_is_observed_keeps_its_name(tmp_path):
    model = load({**BRUSSELATOR, "definitions": {"total": "x + y"}, "observables": {"total": "total"}})
    other, _, _ = there_and_back(model, SBML, tmp_path)
    assert "total" in other.observables
    assert list(other.definitions) == ["total"]
    assert "        total = " in registry.write(model, "x.jl").text
    assert "aux total=" in registry.write(model, "x.ode").text


def test_lines_are_as_short_as_the_languages_want(tmp_path):
    for ending, longest in ((ODE, 1_000), (AUTO, 132)):
        _, written, _ = there_and_back(load(NETWORK), ending, tmp_path)
        assert max(len(line) for line in written.text.splitlines()) <= longest


@pytest.mark.parametrize("ending", [ODE, AUTO, MATCONT, ".jl"])
def test_what_a_format_cannot_hold_is_refused(ending):
    algebraic = load({**BRUSSELATOR, "name": "still", "kind": "algebraic"})
    with pytest.raises(UnsupportedError, match="kind algebraic"):
        registry.write(algebraic, f"x{ending}")


def test_a_forced_flow_has_no_auto_file(tmp_path):
    forced = load(
        {
            "name": "forced",
            "states": {"x": 0},
            "parameters": {"w": 1},
            "forcing": {"period": "2*pi/w"},
            "equations": {"x": "-x + sin(w*t)"},
        }
    )
    with pytest.raises(UnsupportedError, match="time t"):
        registry.write(forced, "x.f90")
    assert "not written: forcing" in registry.write(forced, "x.ode").notes


def test_masses(tmp_path):
    heavy = load(
        {
            "name": "heavy",
            "states": {"x": 1, "y": 0.5, "z": 0.25},
            "parameters": {"m": 2},
            "mass": {"x": "1 + m", "z": 0},
            "equations": {"x": "-x*z", "y": "x - y", "z": "x - m*z - z^3"},
        }
    )
    other, written, _ = there_and_back(heavy, ODE, tmp_path)
    assert "solve z=0.25" in written.text
    assert list(other.mass) == ["z"]
    values = {"x": 0.3, "y": -0.2, "z": 0.7, "m": 1.5}
    got = evaluate_all(other.equations, values)
    assert got == pytest.approx([-0.3 * 0.7 / 2.5, 0.5, 0.3 - 1.05 - 0.343], rel=1e-14)
    for ending in (AUTO, MATCONT, ".jl", SBML):
        with pytest.raises(UnsupportedError, match="algebraic state z"):
            registry.write(heavy, f"x{ending}")
    light = load({**BRUSSELATOR, "name": "light", "mass": {"y": "A + 1"}})
    assert "(A + 1" in registry.write(light, "x.m").text.replace("par_", "")
    coupled = load({**BRUSSELATOR, "name": "coupled", "mass": {"y": {"x": 1, "y": 1}}})
    with pytest.raises(UnsupportedError, match="couples derivatives"):
        registry.write(coupled, "x.ode")
