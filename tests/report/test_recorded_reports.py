"""Records in reports: what needs no pixels is shown, what does is refused in words."""

import pytest

from acutance import OptionError, Record, combine
from acutance.archive.published import published_entries
from acutance.report import draw, page, tables, text


def test_a_record_is_reported_without_its_pixels(measurement):
    record = measurement.record
    shown, drawn = text(record, required=("rer >= 0.1",)), page(record, required=("rer >= 0.1",))
    titles = [one.title for one in tables(record)]
    assert titles[0] == "Numbers"
    assert tables(record)[0].rows == tables(measurement)[0].rows
    for words in (shown, drawn):
        assert "blur_uniformity" in words
        assert "MTF at Nyquist" in words
        assert "rer" in words
    assert "scene.tif" in shown
    assert "data:image/svg" in drawn


def test_a_record_cannot_be_drawn(measurement):
    with pytest.raises(OptionError, match="a record has no pixels"):
        draw(measurement.record)


@pytest.mark.usefixtures("undrawn")
def test_a_printed_record_is_reported_without_the_numbers_that_it_lacks():
    """The QuickBird tables print no RER and no curve, and none of their numbers has a deviation."""
    record = published_entries("quickbird-2003")[0].record
    assert "mtf_nyquist 0.1599, fwhm_px 1.4560, 0 of 0" in repr(record)
    assert str(record.across.rer) == "undefined"
    near, missing = record.conformity("mtf_nyquist >= 0.09", "rer >= 0.4")
    assert "mtf_nyquist has no standard deviation" in near.summary
    assert "rer was not measured" in missing.summary
    for shown in (record._repr_html_(), page(record), text(record)):
        assert "MTF at Nyquist" in shown
        assert "RER" not in shown
    with pytest.raises(OptionError, match="has no MTF"):
        record.across.curve("mtf")
    with pytest.raises(OptionError, match="no MTF across track"):
        combine([record, record])


@pytest.mark.usefixtures("undrawn")
def test_a_number_that_one_direction_lacks_is_undefined_there(measurement):
    document = measurement.record.to_dict()
    numbers = {name: document[name] for name in ("mtf_nyquist", "rer", "mtf")}
    shared = {name: one for name, one in document.items() if name != "orientation"}
    both = {"across": numbers, "along": {**numbers, "rer": None}}
    record = Record.from_dict({**shared, **both, "measured_directions": ["across", "along"]})
    (row,) = [one for one in tables(record)[0].rows if one[0] == "RER"]
    assert row[3] == "undefined"
    assert "undefined" in page(record)
