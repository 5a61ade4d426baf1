"""Records in reports: what needs no pixels is shown, what does is refused in words."""

import pytest

from acutance import OptionError
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
