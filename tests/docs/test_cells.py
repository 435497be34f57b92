"""What a cell of the documentation shows is what a kernel would send, in its order, from a fork of this process."""

import os
import sys

import pytest

from contin._version import __version__
from tests.docs.test_pages import DOCS

pytest.importorskip("myst_nb")  # of the extra `docs`; the build counts the pictures
v4 = pytest.importorskip("nbformat.v4")
sys.path.insert(0, str(DOCS))
cells = pytest.importorskip("cells")


def page(*sources, tags=()):
    return v4.new_notebook(cells=[v4.new_code_cell(source, metadata={"tags": list(tags)}) for source in sources])


def shown(folder, *sources, **options):
    notebook = page(*sources, **options)
    done = cells.execute(notebook, str(folder), 60.0, [])
    assert done.err is None, done.err
    return [cell.outputs for cell in notebook.cells]


def test_text_values_and_pictures_come_in_the_order_in_which_they_are_made(tmp_path):
    [one, two] = shown(
        tmp_path,
        "import os, sys\nprint('a')\ndisplay(1)\nos.system('echo b')\nprint('c', file=sys.stderr)\n6 * 7",
        "import matplotlib.pyplot as plt\nplt.plot([0, 1]);\nprint(_, os.getcwd(), 'contin' in sys.modules)",
    )
    assert [output.output_type for output in one] == ["stream", "display_data", "stream", "stream", "execute_result"]
    assert [one[k].text for k in (0, 2, 3)] == ["a\n", "b\n", "c\n"]
    assert one[4].data["text/plain"] == "42"
    assert two[0].text == f"42 {tmp_path} True\n"
    assert two[1].data["image/png"].startswith("iVBORw0KGgo")  # base 64 of the signature of a PNG file


def test_the_command_in_a_fork_prints_what_it_prints_from_the_shell_and_has_its_exit_code(tmp_path):
    [one] = shown(tmp_path, "!contin --version\nprint(_exit_code)\n!contin check nothing.yaml\nprint(_exit_code)")
    lines = "".join(output.text for output in one).splitlines()
    assert lines[:2] == [f"contin {__version__}", "0"]
    assert "nothing.yaml" in lines[2]
    assert lines[-1] == "2"


def test_pages_have_nothing_from_each_other_and_leave_nothing_here(tmp_path):
    before = os.getcwd(), sys.stdout, dict(os.environ)
    shown(tmp_path, "value = 1\nimport os\nos.environ['CONTIN_OF_A_PAGE'] = '1'")
    [one] = shown(tmp_path, "print('value' in globals(), 'CONTIN_OF_A_PAGE' in os.environ if 'os' in globals() else 0)")
    assert one[0].text == "False 0\n"
    assert (os.getcwd(), sys.stdout, dict(os.environ)) == before


@pytest.mark.parametrize(
    ("source", "said", "limit"),
    [("1 / 0", "ZeroDivisionError", 300.0), ("1 +", "SyntaxError", 300.0), ("import os; os._exit(1)", "ended", 300.0),
     ("import time; time.sleep(600)", "too long", 1.0)],
)  # fmt: skip
def test_an_error_ends_the_page_and_is_told(source, said, limit, tmp_path):
    notebook = page(source, "print('reached')")
    done = cells.execute(notebook, str(tmp_path), limit, [])
    assert said in str(done.err)
    assert not notebook.cells[1].outputs


def test_an_error_that_the_page_wants_is_shown_and_the_next_cell_carried_out(tmp_path):
    [one, two] = shown(tmp_path, "1 / 0", "print('reached')", tags=["raises-exception"])
    assert one[0].ename == "ZeroDivisionError"
    assert two[0].text == "reached\n"
