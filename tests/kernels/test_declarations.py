"""Signatures: read as they are written, one for each kernel, and as many types as arguments."""

import inspect
import re
from collections import namedtuple

import pytest

from contin.kernels import sources
from contin.kernels.callees import called_by
from contin.kernels.catalogue import every
from contin.kernels.signature import Array, Scalar, Tuple, parse, structure, words


def test_signatures_are_read_as_they_are_written():
    read = parse("i, f2, b -> (i, f)")
    assert read.arguments == (Scalar("i"), Array("f", 2), Scalar("b"))
    assert read.result == Tuple((Scalar("i"), Scalar("f")))
    assert parse("").arguments == ()
    assert parse("f1").result is None
    assert [words(kind) for kind in parse("i, f1, f3, c").arguments] == [1, 3, 7, 2]


def test_a_structure_is_its_fields_and_its_name_is_its_own():
    pair = namedtuple("PairForThisTest", ["a", "b"])
    structure(pair, "f1, i")
    assert parse("PairForThisTest").arguments == (Tuple((Array("f", 1), Scalar("i")), pair),)
    with pytest.raises(TypeError, match="two structures"):
        structure(pair, "f1, i")
    with pytest.raises(TypeError, match="2 fields and 1 types"):
        structure(namedtuple("OtherForThisTest", ["a", "b"]), "f1")


def test_an_unknown_type_is_named():
    with pytest.raises(TypeError, match="type 'Nothing'; structures: "):
        parse("i, Nothing")


def test_every_kernel_has_as_many_types_as_arguments():
    declarations = every()
    assert len(declarations) > 100
    for name, declaration in declarations.items():
        assert len(parse(declaration.signature).arguments) == len(inspect.signature(declaration.function).parameters), (
            name
        )


def test_what_a_kernel_calls_is_found_through_the_parts_that_are_put_in_place_in_it():
    march = every()["algebraic.march"]
    assert {"algebraic.correct", "dense.lu_solve", "eigen.eigenvalues", "steering.is_dip"} <= set(called_by(march))


def test_every_file_that_makes_machine_code_is_part_of_its_key():
    found, left = set(), ["building/emit.py"]
    while left:
        name = left.pop()
        if name not in found:
            found.add(name)
            text = (sources.HERE / name).read_text()
            named = re.findall(r"^from contin\.kernels\.building import (.+)$", text, re.M)
            direct = re.findall(r"^from contin\.kernels\.building\.(\w+) import", text, re.M)
            left += [f"building/{one}.py" for one in (*direct, *", ".join(named).split(", ")) if one]
    assert len(found) > 5
    assert found <= set(sources.COMPILER)
