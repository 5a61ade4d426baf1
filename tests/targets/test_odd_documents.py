"""Documents and bytes that hold nothing of acutance are refused in words, by whoever reads them."""

import lzma
import math

import numpy as np
import pytest

import acutance as ac
from acutance.archive.trends import Trend
from acutance.errors import OptionError
from acutance.targets.uncertainty_budget import BudgetTerm

CHECK = ac.Check("rows", 12.0, ">=", 5.0, True, "12 rows", "note")
IMAGE = ac.ImageInfo("a.tif", 1, (0, 0, 5, 5))
NOTHING = [None, "x", b"x", 3, [], ["a"], {}, {"a": 1}, object(), np.zeros((3, 3))]


@pytest.mark.parametrize("wrong", NOTHING)
@pytest.mark.parametrize(
    "read",
    [
        ac.Check.from_dict,
        ac.ImageInfo.from_dict,
        BudgetTerm.from_dict,
        ac.Record,
        ac.Record.from_dict,
        ac.RestorationFilter,
        ac.RestorationFilter.from_dict,
        Trend.from_dict,
        lambda x: Trend.from_dict({**dict.fromkeys(_OF_A_TREND, x), "schema": _TREND}),
    ],
)
def test_what_is_no_document_is_refused(read, wrong):
    with pytest.raises(OptionError, match=r"give|write|read it first"):
        read(wrong)


_TREND = "acutance/trend/1"
_OF_A_TREND = ("metric", "name", "measurements", "images", "posterior", "bad_days", "notes")


@pytest.mark.parametrize(
    ("stored", "words"),
    [
        (b"garbage", "7 bytes are no stored record .*: give what to_bytes"),
        (b"", "0 bytes are no stored record"),
        (lzma.compress(b"{"), "bytes are no stored record"),
        (lzma.compress(b"\xff\xfe"), "bytes are no stored record"),
        (lzma.compress(b"{}")[:-5], "bytes are no stored record"),
        (lzma.compress(b"[]"), "this is no document"),
        ("text", "the contents of 'text' are no stored record"),
        (None, "the contents of None are no stored record"),
    ],
)
def test_bytes_of_no_record_are_refused(stored, words):
    with pytest.raises(OptionError, match=words):
        ac.Record.from_bytes(stored)


@pytest.mark.parametrize("name", ["name", "value", "limit", "passed", "message"])
def test_a_check_without_a_field_is_refused_by_its_name(name):
    document = CHECK.to_dict()
    del document[name]
    with pytest.raises(OptionError, match=f"a check cannot be read .*'{name}'.*: give"):
        ac.Check.from_dict(document)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [("value", "x"), ("value", []), ("limit_value", {}), ("severity", "x"), ("severity", None)],
)
def test_a_check_with_odd_values_is_refused(name, wrong):
    with pytest.raises(OptionError, match=r"a check cannot be read .*: give what to_dict"):
        ac.Check.from_dict({**CHECK.to_dict(), name: wrong})


def test_what_was_written_is_read():
    assert ac.Check.from_dict(CHECK.to_dict()) == CHECK
    bare = {name: CHECK.to_dict()[name] for name in ("name", "value", "limit", "passed", "message")}
    older = ac.Check.from_dict({**bare, "value": None})
    assert (older.limit, older.severity, math.isnan(older.value)) == (5.0, "caution", True)
    assert ac.ImageInfo.from_dict(IMAGE.to_dict()) == IMAGE
