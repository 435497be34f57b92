"""Sphinx configuration. Every code cell is executed in the build, and a warning fails it."""

import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).resolve().parent
PAGES = [str(HERE / "metronomes"), str(HERE / "gallery")]  # modules that pages import; contin is the installed one
sys.path[:0] = [str(HERE)]
# The cells call `contin`: the one beside the Python that builds.
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
shared_runs = TemporaryDirectory()  # results that several pages look at: metronomes/elsewhere.py
os.environ["CONTIN_DOCS_RUNS"] = shared_runs.name
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [*PAGES, os.environ.get("PYTHONPATH")]))

from contin.machine import environment  # noqa: E402

environment.fix()  # before numpy is there: cells have the digits of the command

from docstrings import as_restructured_text  # noqa: E402
from myst_nb.core.execute import direct  # noqa: E402
from sphinx.errors import ExtensionError  # noqa: E402

FORKS = os.name == "posix"  # elsewhere a kernel is started for each page: dearer, and the same
if FORKS:
    from cells import execute, load

from contin._version import __version__  # noqa: E402

project = "contin"
author = "The contin developers"
release = version = __version__
extensions = ["myst_nb", "sphinx.ext.autodoc"]
exclude_patterns = ["_build", "gallery/*.py", "metronomes/*.py", "metronomes/paper.md"]  # the paper: build_paper.py
html_theme = "furo"
html_title = f"contin {__version__}"
nitpicky = False

nb_execution_mode = "force"
nb_execution_timeout = 1200  # the first cell on a machine compiles; one cell of the open questions carries out 13 runs
nb_execution_raise_on_error = True
nb_execution_in_temp = True  # what the cells write does not stay in the sources
nb_merge_streams = True
nb_render_markdown_format = "myst"  # tables of the labels
myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
if FORKS:
    direct.single_nb_execution = lambda nb, cwd, timeout, **_: execute(nb, cwd, timeout, PAGES)
suppress_warnings = ["mystnb.unknown_mime_type"]

autodoc_member_order = "bysource"
autodoc_typehints = "none"
autoclass_content = "class"


def setup(app):
    """Docstrings are plain text with `names` and lists "name : meaning"."""

    def convert(app, what, name, obj, options, lines):
        lines[:] = as_restructured_text("\n".join(lines)).split("\n")

    app.connect("autodoc-process-docstring", convert)
    app.connect("build-finished", count_pictures)
    if FORKS:
        load()
    app.set_html_assets_policy("always")  # models show typeset equations in outputs: MathJax on every page


PICTURES = {  # at least so many on a page: results show themselves, and no cell lost its picture
    "index": 1,
    "figures": 3,
    "first-diagram": 1,
    "tutorial-neuron": 5,
    "tutorial-mechanics": 4,
    "tutorial-metronomes": 2,
    "your-pde": 3,
    "gallery/chemistry": 7,
    "gallery/neurons": 6,
    "gallery/ecology": 4,
    "gallery/mechanics": 8,
    "gallery/fluids": 5,
    "gallery/maps": 4,
    "gallery/patterns": 4,
}


def count_pictures(app, failure):
    """Ends the build where a page has fewer pictures than it should."""
    if failure is not None or app.builder.name != "html":
        return
    for page, least in PICTURES.items():
        if page not in app.env.found_docs:  # a build of some pages
            continue
        shown = (Path(app.outdir) / f"{page}.html").read_text("utf-8").count("<img ")
        if shown < least:
            raise ExtensionError(f"{page}: {shown} pictures, expected {least}")
