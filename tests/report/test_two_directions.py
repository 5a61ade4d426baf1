"""Results in two directions: figure, tables, text, CSV, JSON and page."""

from __future__ import annotations

import csv as csv_format
import html
import io
import json
from dataclasses import replace

import numpy as np
import pytest
from jsonschema import ValidationError
from matplotlib.text import Text
from test_figures import outside, overlaps, texts

from acutance.errors import OptionError
from acutance.report import (
    compare,
    csv,
    document,
    draw,
    json_text,
    page,
    tables,
    text,
)
from acutance.report.tables.measurement import headline_table, numbers_of
from acutance.targets import ImageInfo, Measurement


class OneMeasured(Measurement):
    """Of bars that show one direction."""

    measured_directions = ("across",)


class Ratio(Measurement):
    """Of a pair of images without a reference."""

    is_ratio = True


def of_class(made, both, **changes):
    fields = {name: getattr(both, name) for name in both.__dataclass_fields__}
    return made(**{**fields, **changes})


def test_the_document_keeps_to_the_schema(both, schema_validator):
    content = json.loads(json_text(document(both, covariance=True)))
    schema_validator.validate(content)
    factor = np.array(content["along"]["lsf"]["factor"])
    assert np.linalg.norm(factor, axis=1) == pytest.approx(content["along"]["lsf"]["std"], rel=5e-3)
    assert content["verdict"]["word"] == "doubtful"
    assert content["measured_directions"] == ["across", "along"]
    del content["along"]
    with pytest.raises(ValidationError):
        schema_validator.validate(content)


def test_the_headline_is_one_table_of_two_rows(both):
    table = headline_table(numbers_of(both), both)
    assert [row[0] for row in table.rows] == ["across", "along"]
    assert table.columns == ("", "MTF at Nyquist", "RER", "FWHM [px]", "FWHM [m]")
    value, std, interval = table.rows[1][1].split("\n")
    assert (value, std) == tuple(str(both.along.mtf_nyquist).replace(" ±", "|±").split("|"))
    assert "…" in interval


def test_all_numbers_stand_in_one_table(both):
    (numbers,) = (one for one in tables(both) if one.title == "Numbers")
    row = next(row for row in numbers.rows if row[0] == "RER")
    assert row[1] == str(both.across.rer)
    assert row[3] == str(both.along.rer)


def test_the_csv_holds_both_directions(both):
    rows = list(csv_format.DictReader(io.StringIO(csv(both))))
    counts = [sum(row["direction"] == name for row in rows) for name in ("across", "along")]
    assert counts == [51, 51]
    nyquist = {row["direction"]: row for row in rows if row["freq_cpp"] == "0.50"}
    for name, response in both.directions.items():
        found = nyquist[name]
        assert float(found["mtf"]) == pytest.approx(response.mtf_nyquist.value, abs=1e-6)
        assert float(found["freq_cpm"]) == pytest.approx(0.5 / response.gsd_m, abs=1e-6)


@pytest.mark.usefixtures("undrawn")
def test_text_and_page_hold_numbers_of_both_directions_and_complaints(both):
    shown, whole = text(both), page(both, command="acutance points scene.tif")
    for number in (both.across.mtf_nyquist, both.along.mtf_nyquist):
        assert str(number) in shown
    assert "sources stand 3.2 px apart: their wings overlap" in shown
    assert "doubtful: 1 of 2 checks failed." in shown
    assert "GSD 0.7 m across, 0.72 m along" in shown
    assert "Doubtful: sources stand 3.2 px apart" in whole
    assert "acutance points scene.tif" in whole


def test_the_figure_keeps_its_labels_apart(both):
    figure = draw(both)
    assert not overlaps(figure)
    assert not outside(figure)
    assert "Point" not in texts(figure)
    assert "Checks: doubtful" in texts(figure)


def test_directions_change_places_when_along_track_is_the_x_axis(both):
    turned = replace(both, image=ImageInfo(along_track="x", pixel_gsd_m=(0.72, 0.7)))
    assert turned.across.mtf_nyquist.value == both.along.mtf_nyquist.value
    assert turned.along.gsd_m == both.across.gsd_m
    assert "GSD 0.72 m across, 0.7 m along" in text(turned)
    labels = {axes.get_xlabel() for axes in draw(turned).axes}
    assert "along [c/px]" in labels
    assert "across [c/px]" not in labels


@pytest.mark.usefixtures("undrawn")
def test_a_direction_that_was_not_measured_is_in_no_headline(both):
    one = of_class(OneMeasured, both)
    assert [row[0] for row in headline_table(numbers_of(one), one).rows] == ["across"]
    along = str(both.along.mtf_nyquist)
    assert along not in text(one)
    assert along not in page(one)
    assert "The target shows nothing along track" in page(one)
    shown = texts(draw(one))
    assert "along: not measured" in shown
    assert along not in shown
    assert json.loads(json_text(document(one)))["measured_directions"] == ["across"]


@pytest.mark.usefixtures("undrawn")
def test_a_ratio_of_two_sensors_is_called_one_everywhere(both):
    ratio = of_class(Ratio, both, kind="biresolution-like", method="kernel-fit")
    shown, whole = text(ratio), page(ratio)
    for output in (shown, whole):
        assert "MTF ratio low/high at Nyquist" in output
        assert "RER of the ratio" in output
        assert "not the low sensor's own MTF" in html.unescape(output)
        assert "MTF at Nyquist" not in output
    assert "Modulation transfer function" not in whole
    assert "MTF ratio low/high in steps of" in whole
    words = {one.get_text() for one in draw(ratio).findobj(Text)}
    assert {"MTF ratio low/high", "Line spread function of the ratio low/high"} <= words
    assert not [one for one in words if one.startswith(("Modulation", "MTF;", "MTF at", "PSF,"))]
    assert csv(ratio).startswith("direction,freq_cpp,mtf_low_over_mtf_high,std,")
    assert csv(both).startswith("direction,freq_cpp,mtf,std,")


@pytest.mark.usefixtures("undrawn")
def test_methods_are_compared_in_both_directions_in_one_table(both):
    other = replace(both, method="gaussian-2003", snr=70.0)
    comparison = compare([both, other], truth={"across": both.across, "along": both.along})
    (numbers,) = tables(comparison)
    assert numbers.columns == ("Metric", "Direction", "truth", "psf-fit", "gaussian-2003")
    assert [row[1] for row in numbers.rows[:2]] == ["across", "along"]
    assert str(both.along.mtf_nyquist) in numbers.rows[1]
    figure = draw(comparison)
    assert {"MTF across track", "MTF along track", "MTF − truth"} <= set(texts(figure).split("\n"))
    assert not overlaps(figure)
    assert "Verdict" in page(comparison)
    assert "across and along track" in text(comparison)
    assert csv(comparison).count("gaussian-2003,along") == 51


@pytest.mark.parametrize("wrong", [[], "edge.json", 3, [1.0]])
def test_what_is_no_result_is_refused(wrong):
    with pytest.raises(OptionError, match=r"give|holds"):
        text(wrong)


def test_measurements_that_share_no_direction_are_not_compared(target):
    across, along = (target.groups[name].measurements[0] for name in ("across", "along"))
    with pytest.raises(OptionError, match="share no direction"):
        compare([across, along])
