"""Figures and texts of studies: both estimators and the truth, nothing over anything else."""

from dataclasses import replace

import numpy as np
import pytest
from test_figures import outside, overlaps, texts

from acutance.optics import preset
from acutance.report import plan_text, study_figure, study_text
from acutance.report.studies.study import STUDY_FIGURES
from acutance.studies import (
    STUDIES,
    AngleOptions,
    Execution,
    GroundNoiseOptions,
    PlanOptions,
    SnrOptions,
    WidthCorrectionOptions,
    WidthOptions,
    plan_target,
    run_study,
)

ALONE = Execution(seed=3, workers=1)
SMALL = {
    "snr": SnrOptions(noise_dn=(5.0, 20.0, 80.0), draws=3),
    "ground-noise": GroundNoiseOptions(levels_dn=((1100.0, 400.0), (800.0, 700.0)), runs=3),
    "angle": AngleOptions(angles_deg=(4.3, 6.0, 10.0, 13.9), places=2),
    "width": WidthOptions(widths_px=(2.8, 3.0, 3.2)),
    "width-correction": WidthCorrectionOptions(draws=3),
}


@pytest.fixture(scope="module")
def results():
    found = {name: run_study(name, options, ALONE) for name, options in SMALL.items()}
    found["plan"] = plan_target(
        PlanOptions(target="pulse", rows=(30, 40), angles_deg=(6.0, 9.0), draws=3), ALONE
    )
    return found


def test_every_study_has_a_figure():
    assert set(STUDY_FIGURES) == {*STUDIES, "plan"} == {*SMALL, "plan"}


@pytest.mark.parametrize("name", [*SMALL, "plan"])
def test_labels_stay_apart_and_on_the_page(results, name):
    figure = study_figure(results[name])
    assert not overlaps(figure)
    assert not outside(figure)


@pytest.mark.parametrize("name", ["snr", "ground-noise", "angle", "width"])
def test_both_estimators_and_the_truth_are_in_the_figure(results, name):
    shown = texts(study_figure(results[name]))
    for words in ("published (sdsu-2005)", "ours (spline)", "truth"):
        assert words in shown, words


def test_the_noise_figure_marks_the_minimum_snr(results):
    result = results["snr"]
    shown = texts(study_figure(result))
    least = result.finding("minimum_snr_edge_ours").value
    assert f"ours (spline) below 5 %: SNR {least:.0f}" in shown


@pytest.mark.parametrize("name", ["snr", "ground-noise"])
def test_no_curve_passes_an_answer(results, name):
    figure = study_figure(results[name])
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    for axes in figure.axes:
        boxes = [one.get_window_extent(renderer) for one in axes.texts if "below" in one.get_text()]
        curves = [line for line in axes.lines if len(line.get_xdata()) > 2]
        for box in boxes:
            for line in curves:
                points = axes.transData.transform(line.get_xydata())
                known = points[np.isfinite(points).all(axis=1)]
                inside = (known > (box.x0, box.y0)) & (known < (box.x1, box.y1))
                assert not inside.all(axis=1).any()


def test_a_limit_that_is_never_reached_is_said(results):
    result = results["ground-noise"]
    lost = tuple(
        replace(one, value=np.nan) if one.name.startswith("minimum") else one
        for one in result.findings
    )
    assert "not reached" in texts(study_figure(replace(result, findings=lost)))


def test_the_angle_figure_draws_each_term_with_its_closed_form(results):
    axes = study_figure(results["angle"]).axes[1]
    lines = {line.get_label(): line for line in axes.lines}
    table = results["angle"].table
    assert lines["distance along the row"].get_ydata() == pytest.approx(
        table["row_distance_percent"], nan_ok=True
    )
    assert "closed form of each" in lines


def test_the_width_correction_shows_both_corrections(results):
    shown = texts(study_figure(results["width-correction"]))
    for words in ("published, smoothest ratio", "ours, joint fit", "stated 8.83 m, true 8.95 m"):
        assert words in shown, words


def test_the_plan_of_an_edge_has_no_width():
    plan = plan_target(PlanOptions(draws=0), ALONE)
    figure = study_figure(plan)
    assert "width of the pulse [px]" not in texts(figure)
    assert not overlaps(figure)
    text = plan_text(plan)
    assert "width" not in text
    assert "simulated" not in text


def test_texts_set_answers_beside_the_printed_ones(results):
    text = study_text(results["width-correction"])
    assert "+3.30 % (paper: 3.3)" in text
    plan = plan_text(results["plan"])
    assert "3 simulated images" in plan
    widths = {len(line) for line in plan.splitlines() if line.strip().startswith("width ")}
    assert len(widths) == 1


def test_the_angle_figure_shows_an_estimate_that_is_too_high():
    """The report's sensor is under-estimated; others are not."""
    options = AngleOptions(angles_deg=(3.0, 5.0, 8.0), places=2, sensor=preset("ikonos-like"))
    result = run_study("angle", options, ALONE)
    assert result.table["published_percent"].max() > 0
    figure = study_figure(result)
    assert "Where the over-estimate comes from" in texts(figure)
    for axes in figure.axes:
        low, high = axes.get_ylim()
        for line in axes.lines:
            values = np.asarray(line.get_ydata(), dtype=float)
            known = values[np.isfinite(values)]
            assert ((known >= low) & (known <= high)).all(), line.get_label()


def test_a_width_at_a_zero_of_the_spectrum_leaves_the_others_readable():
    """A pulse of 4 px has none of Nyquist's frequency: the published ratio divides by nothing."""
    result = run_study("width", WidthOptions(widths_px=(2.8, 3.0, 4.0)), ALONE)
    figure = study_figure(result)
    assert max(axes.get_ylim()[1] for axes in figure.axes[:3]) < 5
    assert "published: 1 beyond the frame" in texts(figure)
    assert not overlaps(figure)
    assert "to more than +1000 %" in study_text(result)
