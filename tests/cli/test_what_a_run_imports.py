"""A run waits for the imports of what it uses, not of what other runs use."""

import subprocess
import sys

from contin.model.bundled import folder

UNUSED = (
    "scipy",  # .2 s: sparse matrices, integrators
    "matplotlib",
    "sympy",
    "numba",
    "contin.pde",
    "contin.simulate.run",
    "contin.search.large_equilibrium",
    "contin.bvp",
)

RUN = """
contin: 1
model: {path}
parameters: {{mu: 1}}
transform: [{{average: {{form: polar}}}}]
continuations: [{{name: rest, start: in-phase, parameter: mu, range: [0.05, 8]}}]
outputs: {{json: found.json}}
"""


def test_a_run_of_equilibria_imports_only_what_it_uses(tmp_path):
    (tmp_path / "run.yaml").write_text(RUN.format(path=folder() / "metronomes" / "pair.yaml"))
    code = (
        "import sys; from contin.cli.main import main; sys.argv = ['contin', 'run', 'run.yaml', '--quiet']\n"
        "try: main()\n"
        f"finally: print([m for m in {UNUSED} if m in sys.modules], file=sys.stderr)"
    )
    for _ in "first", "again":  # the first run may make machine code and averages, by other means
        done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    assert done.stderr.strip().splitlines()[-1] == "[]"
