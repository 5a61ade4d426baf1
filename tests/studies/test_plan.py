"""Plans: bounds below simulations, and the questions of a team answered."""

import math
from dataclasses import replace

import numpy as np
import pytest

from acutance import OptionError, Sensor
from acutance.optics import Detector, Gaussian
from acutance.report import plan_text
from acutance.studies import Execution, PlanOptions, plan_target

ALONE = Execution(seed=3, workers=1)


@pytest.fixture(scope="module")
def pulse():
    options = PlanOptions(
        target="pulse", rows=(30, 60), angles_deg=(6.0,), widths_px=(3.0, 1.5), draws=40,
        accuracy=0.005,
    )  # fmt: skip
    return plan_target(options, ALONE)


def test_simulation_lies_between_the_bounds(pulse):
    rows = pulse.table.where(varied="rows")
    assert np.all(rows["mtf_nyquist_rms"] > 0.85 * rows["mtf_nyquist_bound"])
    assert np.all(rows["mtf_nyquist_rms"] < rows["mtf_nyquist_free"])
    assert rows["mtf_nyquist_stated"] == pytest.approx(rows["mtf_nyquist_rms"], rel=0.4)
    assert rows["width_px_rms"] == pytest.approx(rows["width_px_bound"], rel=0.5)


def test_the_plan_names_what_a_measurement_will_state(pulse):
    stated = pulse.table["mtf_nyquist_stated"][0]
    assert f"our estimator, which states ± {stated:.4f}) from" in pulse.findings[0].text


def test_the_plan_is_the_same_in_every_list(pulse):
    plans = [row for row in pulse.table.rows() if row["rows"] == 30 and row["angle_deg"] == 6.0]
    three = [row["mtf_nyquist_rms"] for row in plans if row["target_width_px"] == 3.0]
    assert len(three) == 4
    assert len(set(three)) == 1


def test_the_questions_are_answered(pulse):
    assert pulse.finding("best_target_width_px").value == 3.0
    expected = pulse.finding("expected_mtf_nyquist").value
    rows = pulse.finding("rows_needed").value
    assert rows == math.ceil(30 * (expected / 0.005) ** 2)


@pytest.mark.parametrize(
    ("accuracy", "rows", "said"),
    [
        (0.2, 20, "no more than 20 of them, the fewest that can be measured"),
        (1e-9, math.inf, "more than the 2000 of them that are planned"),
        (1e-300, math.inf, "more than the 2000"),
    ],
)
def test_rows_that_are_needed_can_be_planned(accuracy, rows, said):
    plan = plan_target(PlanOptions(accuracy=accuracy, draws=0), ALONE)
    assert plan.finding("rows_needed").value == rows
    assert said in plan.finding("rows_needed").text


def test_of_several_widths_the_best_is_planned_and_named():
    options = PlanOptions(target="pulse", widths_px=(1.0, 3.0, 1.5), draws=0)
    plan = plan_target(options, ALONE)
    assert plan.table["target_width_px"][0] == 3.0
    assert sorted(plan.table.where(varied="width")["target_width_px"]) == [1.0, 1.5, 3.0]
    found = plan.finding("planned_width_px")
    assert found.value == 3.0
    assert "of the widths 1, 3, 1.5 px, 3 px has the least bound" in found.text
    assert "3 px wide" in plan.finding("expected_mtf_nyquist").text
    single = plan_target(PlanOptions(target="pulse", widths_px=(1.5,), draws=0), ALONE)
    assert "planned_width_px" not in [found.name for found in single.findings]


def test_where_another_design_errs_less_the_plan_is_told_beside_it():
    narrow = PlanOptions(target="pulse", widths_px=(1.5,), angles_deg=(2.0,), draws=0)
    plan = plan_target(narrow, ALONE)
    widths = plan.table.where(varied="width")["mtf_nyquist_free"]
    excess = plan.finding("expected_mtf_nyquist").value / widths.min() - 1
    said = plan.finding("best_target_width_px").text
    assert excess > 0.1
    assert said.endswith(f"; that of the plan is {100 * excess:.0f} % larger")
    assert (
        "the plan"
        not in plan_target(replace(narrow, widths_px=(3.0,)), ALONE)
        .finding("best_target_width_px")
        .text
    )


def test_a_width_in_metres_over_the_gsd_is_no_second_width():
    width_px = 2.1 / 0.7
    assert width_px != 3.0
    plan = plan_target(PlanOptions(target="pulse", widths_px=(width_px,), draws=0), ALONE)
    widths = plan.table.where(varied="width")["target_width_px"]
    assert widths.tolist() == [1.5, 2.0, 2.5, width_px, 3.5, 4.0]
    assert "within 10 % of it: 3 px" in plan.finding("best_target_width_px").text


def test_the_length_is_along_the_line_where_the_gsd_differs_between_rows_and_columns():
    sensor = Sensor([Gaussian(0.4), Detector()], gsd_m=1.0, gsd_along_m=2.0)
    plan = plan_target(PlanOptions(sensor=sensor, rows=(40,), draws=0), ALONE)
    across = 40 * math.tan(math.radians(6.0))
    assert plan.table["length_m"][0] == pytest.approx(math.hypot(80.0, across))
    square = plan_target(PlanOptions(rows=(40,), draws=0), ALONE)
    one_m = square.table["length_m"][0] / PlanOptions().sensor.gsd_m
    assert one_m == pytest.approx(math.hypot(40.0, across))


def test_an_edge_without_simulation_has_bounds_alone():
    plan = plan_target(PlanOptions(draws=0), ALONE)
    assert set(plan.table.columns["varied"]) == {"plan", "rows", "angle"}
    assert np.all(np.isnan(plan.table["mtf_nyquist_rms"]))
    assert plan.finding("expected_mtf_nyquist").value == pytest.approx(0.0111, abs=1e-4)


def test_bounds_are_no_errors_and_the_sensor_is_named():
    plan = plan_target(PlanOptions(rows=(40,), draws=0, sensor_name="generic-2005"), ALONE)
    said = plan_text(plan)
    assert "has the smallest bound" in said
    assert "chance" not in said
    assert "sensor generic-2005: MTF at Nyquist 0.267, GSD 1 m" in said


def test_the_simulation_can_refuse():
    plan = plan_target(PlanOptions(rows=(20,), angles_deg=(6.0,), snr=1.0, draws=2), ALONE)
    assert plan.table["refused"][0] == 2
    assert math.isnan(plan.finding("expected_mtf_nyquist").value)
    names = ["expected_mtf_nyquist", "refused", "room_px"]
    assert [found.name for found in plan.findings] == names
    assert "refused: 2 of 2 simulated images" in plan_text(plan)
    assert "errors are those" not in plan_text(plan)


def test_errors_of_the_images_that_are_left_say_how_many_were_refused():
    options = PlanOptions(rows=(20, 30), angles_deg=(6.0, 7.0), snr=3.0, draws=6)
    plan = plan_target(options, ALONE)
    refused = int(plan.table["refused"][0])
    assert 0 < refused < 6
    said = plan_text(plan)
    assert f"refused: {refused} of 6 simulated images of the plan could not be measured; " in said
    assert "in 6 simulated images, without those refused." in said
    (head, row) = (line.split() for line in said.splitlines() if line[:6] in ("varied", "  plan"))
    assert (head[-1], row[-1]) == ("refused", str(refused))


def test_a_plan_without_a_number_is_not_infinitely_worse():
    plan = plan_target(PlanOptions(target="pulse", widths_px=(4.0,), draws=0), ALONE)
    said = plan.finding("best_target_width_px").text
    assert said.endswith("within 10 % of it: 3 px; the plan has none")
    assert "refused" not in plan_text(plan)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"rows": (5,)}, "at least 20"),
        ({"rows": (100_000,)}, "2000 are the most"),
        ({"angles_deg": (0.0,)}, "no sub-pixel phases"),
        ({"widths_px": (80.0,)}, "check the width and the GSD"),
        ({"snr": 0.0}, "snr is 0: give 1 to 1e[+]06"),
        ({"snr": 1e-300}, "snr is 1e-300: give 1"),
        ({"snr": math.inf}, "snr is inf: give 1"),
        ({"window_px": math.inf}, "window_px is inf: give 0.1 to 1000"),
        ({"accuracy": math.inf}, "accuracy is inf: it has to be finite"),
        ({"target": "star"}, "edge"),
    ],
)
def test_impossible_plans_are_refused(wrong, words):
    with pytest.raises(OptionError, match=words):
        PlanOptions(**wrong)


@pytest.mark.parametrize(("target", "beyond"), [("edge", "of the edge"), ("pulse", "of the pulse")])
def test_a_plan_says_how_far_the_ground_has_to_be_level(target, beyond):
    wide = Sensor([Gaussian(1.8), Detector()], gsd_m=0.5)
    plan = plan_target(PlanOptions(target=target, sensor=wide, draws=0))
    room = plan.finding("room_px")
    fwhm_px = wide.response(6.0).fwhm_px.value
    assert room.value == pytest.approx(3 * fwhm_px)
    assert f"{room.value:.3g} px ({0.5 * room.value:.3g} m) of level ground" in room.text
    assert beyond in room.text


def test_of_widths_whose_spectrum_is_zero_at_nyquist_the_better_one_is_planned():
    result = plan_target(
        PlanOptions(target="pulse", widths_px=(2.0, 4.0, 2.0), rows=(20,), draws=0)
    )
    assert result.table["target_width_px"][0] == 4.0
    expected, _, planned = (one.text for one in result.findings[:3])
    assert expected.endswith("the spectrum of such a pulse is zero there; choose another width")
    assert "of the widths 2, 4 px, 4 px has the least bound of a known shape (none has" in planned
