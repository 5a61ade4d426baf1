"""The studies without noise: every term has its closed form, and ours has no error."""

import numpy as np
import pytest

from acutance.report.studies.study import study_figure
from acutance.studies import (
    AngleOptions,
    Execution,
    WidthCorrectionOptions,
    WidthOptions,
    study_angle,
    study_width,
    study_width_correction,
)
from acutance.studies.width_correction import TABLE_3_3

ALONE = Execution(seed=3, workers=1)


@pytest.fixture(scope="module")
def angle():
    return study_angle(AngleOptions(angles_deg=(4.3, 6.0, 10.0, 13.9)), ALONE)


def test_each_term_has_its_closed_form(angle):
    table = angle.table
    # Which pixels fall into the published windows changes the first by some tenths of a percent.
    for name, tolerance in (("window", 0.35), ("width", 0.15), ("row_distance", 0.2)):
        measured, predicted = table[f"{name}_percent"], table[f"{name}_predicted_percent"]
        assert measured == pytest.approx(predicted, abs=tolerance), name
    assert np.all(np.abs(table["rest_percent"]) < 0.3)


def test_the_terms_make_the_whole(angle):
    table = angle.tables["trials"]
    product = np.prod(
        [
            1 + table[f"{name}_percent"] / 100
            for name in ("window", "width", "row_distance", "rest")
        ],
        axis=0,
    )
    known = np.isfinite(product)
    assert known.sum() >= 15
    assert 100 * (product - 1)[known] == pytest.approx(table["published_percent"][known], abs=1e-9)


def test_the_paper_is_reproduced_and_its_question_answered(angle):
    assert angle.finding("published_at_6_deg_percent").value == pytest.approx(-4.1, abs=0.5)
    assert angle.finding("published_at_14_deg_percent").value == pytest.approx(-13.2, abs=1.0)
    # Without any angle the window's two percent are left.
    assert angle.finding("published_at_0_deg_percent").value == pytest.approx(-1.98, abs=0.35)
    assert np.all(np.abs(angle.table["ours_percent"]) < 0.1)


@pytest.fixture(scope="module")
def width():
    return study_width(WidthOptions(widths_px=(2.8, 3.0, 3.2)), ALONE)


def test_the_ratio_changes_as_the_closed_form_says(width):
    rows = width.table.where(error="measured")
    assert rows["stated_px"].tolist() == [2.8, 3.0, 3.2]
    assert rows["ratio_gain_0.3"].tolist() == pytest.approx([0.599, 1, 2.63], abs=5e-3)
    assert rows["ratio_gain_0.4"].tolist() == pytest.approx([1.49, 1, 0.81], abs=5e-3)
    assert rows["ratio_gain_0.5"].tolist() == pytest.approx([0.98, 1, 1.12], abs=5e-3)
    for freq in ("0.3", "0.4", "0.5"):
        value = rows[f"published_{freq}"]
        assert value / value[1] == pytest.approx(rows[f"ratio_gain_{freq}"], rel=0.08)


def test_the_joint_fit_finds_the_width_and_keeps_the_curve(width):
    table = width.table
    assert table["ours_width_px"] == pytest.approx(table["true_px"], abs=1e-3)
    curves = width.tables["curves"]
    for name in curves.columns:
        if name.startswith("ours_"):
            assert curves[name] == pytest.approx(curves["truth"], abs=1e-3), name


@pytest.fixture(scope="module")
def correction():
    return study_width_correction(WidthCorrectionOptions(draws=12), ALONE)


def test_table_3_3_to_the_printed_digit(correction):
    printed = correction.table["printed_percent"]
    assert np.round(correction.table["closed_form_percent"], 2).tolist() == printed.tolist()
    corrected = correction.table["closed_form_mtf_nyquist"]
    assert corrected == pytest.approx(correction.table["printed_corrected_mtf_nyquist"], abs=1e-4)


def test_both_corrections_find_the_tarp(correction):
    table = correction.table
    for name in ("published", "ours"):
        assert table[f"{name}_width_m"] == pytest.approx(table["true_m"], abs=0.025)
        assert table[f"{name}_mtf_nyquist"] == pytest.approx(
            table["printed_corrected_mtf_nyquist"], abs=0.01
        )
    assert table["ours_detected_share"][1] > 0.9


def test_the_simulated_error_is_the_printed_one(correction):
    table = correction.table
    assert table["stated_mtf_nyquist"] == pytest.approx(table["printed_mtf_nyquist"], abs=0.006)


def test_one_angle_is_told_once_and_shown_and_has_no_quadratic():
    result = study_angle(AngleOptions(angles_deg=(10.0,), places=1), ALONE)
    assert [one.name for one in result.findings] == [
        "published_at_6_deg_percent", "ours_worst_percent",
    ]  # fmt: skip
    found = result.findings[0]
    assert found.text.startswith("at 10 deg")
    assert found.published is None
    for axes in study_figure(result).axes:
        shown = [*axes.lines, *axes.get_legend().get_lines()]
        assert {(line.get_marker(), line.get_linestyle()) for line in shown} == {("o", "None")}


def test_changes_of_the_width_are_those_from_the_nominal_one():
    result = study_width(WidthOptions(widths_px=(3.2,)), ALONE)
    rows = result.table.where(error="measured")
    assert rows["stated_px"].tolist() == [3.0, 3.2]
    gain = 100 * (rows["ratio_gain_0.5"][1] - 1)
    changed = result.finding("published_measured_0.5_percent").value
    assert changed == pytest.approx(gain, abs=2.0)


def test_one_image_of_a_width_has_no_scatter():
    options = WidthCorrectionOptions(cases=TABLE_3_3[:1], draws=1)
    assert not any("nan" in one.text for one in study_width_correction(options, ALONE).findings)
