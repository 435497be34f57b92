"""Notes as data until a branch is whole: one of each text, with the number of other places."""

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.sentence import Sentence, distinct


def test_sentences_of_one_text_are_one_note_whatever_their_words_are():
    """Words are not looked into: two texts that agree up to ' near ' are two notes."""
    lost, touching = "LP not verified", "two branches touch near there"
    said = [Sentence(lost, "p = 1"), Sentence(f"{touching}: a"), Sentence(lost, "p = 2"), Sentence(f"{touching}: b")]
    notes, defects = distinct([*said, Sentence(lost, "p = 1"), Sentence(lost, "p = 3")])
    assert notes == (f"{lost} near p = 1 and at 2 more places", f"{touching}: a", f"{touching}: b")
    assert defects == ()


def test_a_defect_is_known_by_its_kind():
    words = "an error inside contin, says a user's observable"
    notes, defects = distinct(
        [Sentence(words), Sentence("KeyError", "p = 1", defect=True), Sentence("KeyError", "p = 2")]
    )
    assert notes == (words, "KeyError near p = 1 and at 1 more place")
    assert defects == notes[1:]


def test_a_parent_has_the_type_of_its_point_whatever_its_label():
    point = SpecialPoint("HB", "own1", 0, np.zeros(2), np.zeros(2), {}, 0.0, 0.0, np.zeros(1), {}, {}, branch="line")
    found = Parent.of(point)
    assert (found.branch, found.label, found.type) == ("line", "own1", "HB")
