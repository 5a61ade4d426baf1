"""The plan of a layout of mirrors in words."""

from dataclasses import replace

import pytest

from acutance import optics
from acutance.errors import OptionError
from acutance.report import mirror_plan_text
from acutance.studies import MirrorPlanOptions, plan_mirrors

SENSOR = optics.Sensor([optics.Gaussian(0.45), optics.Detector()], gsd_m=0.7)


def test_deviations_that_are_too_small_are_named_where_the_draws_can_tell():
    plan = plan_mirrors(MirrorPlanOptions(SENSOR, draws=2))
    wide = {name: 2.0 * std for name, std in plan.std.items() if name.startswith("fwhm_px")}
    few = replace(plan, scatter={**plan.std, **wide})
    many = replace(few, options=replace(plan.options, draws=40))
    assert "states too little" not in mirror_plan_text(few)
    assert "states too little for FWHM [px] across, FWHM [px] along" in mirror_plan_text(many)
    assert "states too little" not in mirror_plan_text(replace(many, scatter=plan.std))


def test_a_bias_is_named_where_it_is_more_than_chance():
    plan = plan_mirrors(MirrorPlanOptions(SENSOR, draws=2))
    name = "fwhm_px across"
    many = replace(
        plan, options=replace(plan.options, draws=40), scatter={**plan.std, name: 0.06},
        bias=dict.fromkeys(plan.bias, 0.0) | {name: 0.058},
    )  # fmt: skip
    assert "do not average out: FWHM [px] across 0.058;" in mirror_plan_text(many)
    by_chance = replace(many, bias=plan.bias | {name: 0.3 * plan.std[name]})
    assert "average out" not in mirror_plan_text(replace(by_chance, scatter=plan.std))
    assert "40 simulated images, 3 of them refused" in mirror_plan_text(replace(many, refused=3))


def test_mirrors_too_large_for_a_field_are_told():
    plan = plan_mirrors(MirrorPlanOptions(optics.Sensor(SENSOR.blocks, gsd_m=70.0), draws=0))
    assert "note: caps 61.9 m across" in mirror_plan_text(plan)
    assert "note" not in mirror_plan_text(replace(plan, diameter_m=1.0))


@pytest.mark.parametrize(
    ("gsd_m", "steps"), [(0.01, "0.0125 by 0.102 m"), (0.03, "0.0375 by 0.306 m")]
)
def test_lengths_of_a_drone_s_mirrors_have_three_digits(gsd_m, steps):
    plan = plan_mirrors(MirrorPlanOptions(optics.Sensor(SENSOR.blocks, gsd_m=gsd_m), draws=0))
    text = mirror_plan_text(plan)
    assert steps in text
    assert f"radius of curvature {plan.radius_m:.4f} m" in text


def test_a_single_mirror_stands_in_one_column():
    plan = plan_mirrors(MirrorPlanOptions(SENSOR, count=1, draws=0))
    assert "1 mirror in 1 column\n  largest gap" in mirror_plan_text(plan)
    assert len(plan.layout.places_px) == 1


def test_without_a_measured_image_there_is_no_number_and_it_is_said():
    plan = plan_mirrors(MirrorPlanOptions(SENSOR, snr=2.0, draws=2))
    assert plan.refused == 2
    assert "none of 2 simulated images could be measured; raise the SNR" in mirror_plan_text(plan)
    alone = plan_mirrors(MirrorPlanOptions(SENSOR, draws=0))
    assert "to expect" not in mirror_plan_text(alone)


def test_a_single_mirror_has_no_place_beside_others():
    plan = plan_mirrors(MirrorPlanOptions(SENSOR, count=1, draws=2))
    (place,) = (line for line in mirror_plan_text(plan).splitlines() if line.startswith("place ["))
    assert place.split()[2:4] == ["–", "–"]
    assert plan.std["position_px across"] > 0


def test_a_single_simulated_image_has_no_scatter():
    with pytest.raises(OptionError, match="a single simulated image has no scatter"):
        MirrorPlanOptions(SENSOR, draws=1)
