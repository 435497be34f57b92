"""The file of a run that is not finished has the text, and the checksum, of a document that is written as a whole."""

import contin
from contin.store.digest import signed
from contin.store.json_format import FORMAT_VERSION, branch_document, dumps, model_of, read
from contin.store.partial import NOTE, PartialJson

MODEL = {"name": "fork", "states": {"x": 0.0}, "parameters": {"a": -1.0}, "equations": {"x": "a*x - x^3"}}


def test_what_is_written_after_each_branch_is_what_a_whole_document_would_be(tmp_path):
    line = contin.continuation(contin.equilibrium(contin.load(MODEL)), "a", (-1, 1), name="über")
    branches = [line, contin.continuation(line["BP1"].switch(), "a", (-1, 1), name="fork")]
    path = tmp_path / "fork.json"
    keeper = PartialJson(path, model_of(branches))
    for count, branch in enumerate(branches, 1):
        keeper.finished(branch)
        documents = [branch_document(one) for one in branches[:count]]
        whole = {
            "contin": FORMAT_VERSION, "model": model_of(branches), "branches": documents,
            "notes": [NOTE], "timing": {"total": float(sum(d["seconds"] for d in documents))},
        }  # fmt: skip
        assert path.read_text(encoding="utf-8") == dumps(signed(whole))
        assert len(read(path)["branches"]) == count  # (a wrong checksum would be a warning)
