"""Coverage-guided fuzzing of the formula parser and of the model loader, by atheris (libFuzzer).

    pip install atheris; python tests/faults/coverage_guided.py formula|model [-max_total_time=600] [-seed=1] [FOLDER]

Any other outcome than a result or an error of contin ends the run with the input that led to it; the last line says
how many inputs were tried. Arguments are libFuzzer's; a folder keeps the inputs that reached new code.
"""

from __future__ import annotations

import json
import sys
import warnings

import atheris

with atheris.instrument_imports(include=["contin.model", "contin.runs"]):
    from contin.errors import ContinError, ExpressionError
    from contin.model.expression import postorder
    from contin.model.parser import parse
    from contin.model.yaml_loader import model_from_document
    from contin.model.yaml_reader import read_text

NAMES = ["x", "y", "a_b"]
TOKENS = """x y a_b 1 2.5e-3 pi + - * / ^ ** ( ) , if else not and or < <= == != > >= sin( exp( log( sqrt( abs( min(
max( heaviside( atan2( log1p( tanh( ] é ²""".split()
KEYS = """contin: 1|name: m|states: |parameters: |equations: |functions: |definitions: |observables: |symmetries: |
starts: |expect: |kind: map|x: 1|value: 1|range: [0, 1]|unit: V|f(u): u^2|{|}|[|]|- |&a |*a |<<: |!!|>-|\"|' |# |0x1f|
.inf|? """
MODEL = b"contin: 1\nname: m\nstates: {x: 1}\nparameters: {a: {value: 1, range: [-1, 2]}}\nequations: {x: a - x^2}\n"


def formula(data: bytes) -> None:
    """The parser gives a graph, or an error whose place is inside the text."""
    text = data.decode("utf-8", "surrogateescape")
    try:
        postorder([parse(text, NAMES)])
    except ExpressionError as error:
        if not 0 <= error.position <= len(text):
            raise AssertionError((text, error.position)) from error


def model(data: bytes) -> None:
    """The loader gives a model, or an error of contin with words."""
    text = data.decode("utf-8", "replace")
    try:
        model_from_document(read_text(text, "f.yaml"))
    except ContinError as error:
        if not str(error).strip() or len(str(error)) > 40_000:
            raise AssertionError(text) from error


def main() -> None:
    """Fuzz what the first argument names."""
    import tempfile
    from pathlib import Path

    what, target = sys.argv[1], {"formula": formula, "model": model}[sys.argv[1]]
    words, seeds = {
        "formula": (TOKENS, [b"x^2 - sin(a_b*y) if x > 0 and not y < 1 else min(x, 2.5e-3)"]),
        "model": (KEYS.replace("\n", "").split("|"), [MODEL]),
    }[what]
    folder = Path(tempfile.mkdtemp())
    quoted = [json.dumps(w.encode("utf-8").decode("latin-1"), ensure_ascii=True).replace("\\u00", "\\x") for w in words]
    (folder / "words").write_text("".join(f"{word}\n" for word in quoted if word != '""'), encoding="ascii")
    (folder / "seeds").mkdir()
    for k, seed in enumerate(seeds):
        (folder / "seeds" / str(k)).write_bytes(seed)
    warnings.simplefilter("ignore")
    arguments = [sys.argv[0], f"-dict={folder / 'words'}", "-timeout=20", "-rss_limit_mb=2048", *sys.argv[2:]]
    atheris.Setup([*arguments, str(folder / "seeds")], target)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
