"""Layouts of mirrors: those of the reports, and their phases."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import acutance as ac
from acutance import optics
from acutance.report import mirror_plan_text
from acutance.studies import MirrorPlanOptions, lay_out_mirrors, plan_mirrors
from acutance.studies.mirrors import place_errors_px

PIXEL_M = (0.7, 0.7)
SENSOR = optics.Sensor([optics.Gaussian(0.45), optics.Detector()], gsd_m=0.7)


def test_twenty_mirrors_stand_as_in_brookings():
    layout = lay_out_mirrors(20, pixel_m=PIXEL_M)
    assert layout.step_px == pytest.approx((10.2, 1.25))
    assert layout.angle_deg == pytest.approx(7.0, abs=0.05)
    assert layout.apart_px * 0.7 == pytest.approx(8.0, abs=0.1)
    phases = {(round(row, 3), round(col, 3)) for row, col in layout.phases.tolist()}
    assert phases == {(i / 5, j / 4) for i in range(5) for j in range(4)}
    assert layout.spacing_px >= 5


def test_sixteen_diffusers_stand_as_li_draws_them():
    layout = lay_out_mirrors(16, pixel_m=PIXEL_M, arrangement="square", spacing_px=5.0)
    assert layout.step_px[0] == 5.25
    phases = {(round(row, 3), round(col, 3)) for row, col in layout.phases.tolist()}
    assert len(phases) == 16


@pytest.mark.parametrize("count", [1, 2, 6, 12, 15, 20, 30])
def test_columns_use_every_phase_once(count):
    layout = lay_out_mirrors(count, pixel_m=PIXEL_M, columns=1)
    assert len({(round(r, 4), round(c, 4)) for r, c in layout.phases.tolist()}) == count


@pytest.mark.parametrize("view_deg", [0.0, 10.0, 35.0])
def test_a_mirror_is_as_bright_as_asked(view_deg):
    """The intensity of a convex mirror against Lambertian ground that fills a pixel."""
    options = MirrorPlanOptions(
        SENSOR, draws=0, level=0.6, ground=0.1, mirror=0.9, view_zenith_deg=view_deg
    )
    plan = plan_mirrors(options)
    intensity = 0.9 * plan.radius_m**2 / 4
    seen_m2 = 0.7 * 0.7 * math.cos(math.radians(view_deg))
    ground = seen_m2 * math.cos(math.radians(40.0)) / math.pi
    assert plan.peak_share * intensity / ground == pytest.approx(0.5)
    half = math.radians(0.5 * (40.0 + view_deg))
    assert plan.diameter_m == pytest.approx(2 * plan.radius_m * math.sin(half))


def test_a_brighter_mirror_is_larger():
    plan = plan_mirrors(MirrorPlanOptions(SENSOR, draws=0, level=0.6, ground=0.1, mirror=0.9))
    brighter = plan_mirrors(MirrorPlanOptions(SENSOR, draws=0, level=1.1, ground=0.1, mirror=0.9))
    assert brighter.radius_m == pytest.approx(math.sqrt(2) * plan.radius_m)


@pytest.mark.parametrize(("gsd_m", "is_noted"), [(0.7, False), (2.8, False), (70.0, True)])
def test_mirrors_too_large_for_a_field_are_noted(gsd_m, is_noted):
    plan = plan_mirrors(MirrorPlanOptions(optics.Sensor(SENSOR.blocks, gsd_m=gsd_m), draws=0))
    assert bool(plan.notes) is is_noted
    assert plan.to_dict()["notes"] == list(plan.notes)
    assert all(f"{plan.diameter_m:.3g} m across" in note for note in plan.notes)


def test_the_expected_deviations_are_those_of_measurements():
    plan = plan_mirrors(MirrorPlanOptions(SENSOR, draws=3, snr=60.0))
    assert plan.std["mtf_nyquist across"] == pytest.approx(0.008, rel=0.6)
    assert np.isfinite(list(plan.scatter.values())).all()
    assert plan.position_std_px == pytest.approx(0.8 / 60)


def test_a_plan_tells_scatter_bias_and_deviation_of_a_resampled_product():
    """The prior knows products of cubic convolution: errors are as large as stated."""
    blocks = [optics.Gaussian(0.35), optics.Detector(), optics.Resampling("cubic")]
    plan = plan_mirrors(MirrorPlanOptions(optics.Sensor(blocks, gsd_m=0.7), count=20, draws=6))
    for name in ("fwhm_px across", "mtf_nyquist across"):
        assert 0.3 < plan.scatter[name] / plan.std[name] < 1.6
        assert 0 < abs(plan.bias[name]) <= plan.scatter[name]
    document = plan.to_dict()
    assert document["bias"][name] == plan.bias[name]
    assert document["refused"] == 0


def planned(accuracy, scatter, bias, draws=20):
    """A plan whose simulated errors are given."""
    options = MirrorPlanOptions(SENSOR, draws=0)
    names = ("mtf_nyquist across", "mtf_nyquist along")
    return replace(
        plan_mirrors(options), options=replace(options, accuracy=accuracy, draws=draws),
        scatter=dict(zip(names, scatter, strict=True)), bias=dict(zip(names, bias, strict=True)),
    )  # fmt: skip


def test_a_wanted_accuracy_takes_so_many_images():
    assert planned(0.02, (0.01, 0.015), (0.0, 0.0)).images_needed == 1
    # Twice the error in the worse direction: four times the images, and the freedom of a mean.
    assert planned(0.005, (0.004, 0.01), (0.0, 0.0), draws=1000).images_needed == 5
    # A mean of 20 draws is not 0, where nothing is biased.
    assert planned(0.0012, (0.01, 0.01), (0.002, 0.0)).images_needed == 74
    assert planned(0.005, (0.01, 0.01), (0.008, 0.0)).images_needed == math.inf
    assert planned(0.005, (0.01, 0.01), (0.008, 0.0)).to_dict()["images_needed"] is None
    assert plan_mirrors(MirrorPlanOptions(SENSOR, draws=0)).images_needed is None


def test_an_accuracy_without_simulated_images_is_refused():
    with pytest.raises(ac.OptionError, match="draws \\(--draws\\) is 0: give 2 or more"):
        MirrorPlanOptions(SENSOR, draws=0, accuracy=0.01)
    with pytest.raises(ac.OptionError, match="accuracy is -1"):
        MirrorPlanOptions(SENSOR, accuracy=-1.0)


def test_a_mirror_left_out_of_the_fit_leaves_the_others_in_place():
    places = np.array([[20.0, 20.0], [20.3, 31.0], [30.2, 20.4], [30.5, 31.4]])
    moved = places + 0.1
    moved[3] += [0.03, 0.0]
    assert place_errors_px(moved[[0, 3]], places) == pytest.approx(
        np.array([[-0.015, 0.0], [0.015, 0.0]])
    )


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"arrangement": "square", "columns": 3}, "columns is 3, and the arrangement is a square"),
        ({"count": 9, "columns": 4}, "9 mirrors in equal columns of 3 fill 3 of them"),
    ],
)
def test_columns_that_are_not_laid_out_are_refused(asked, message):
    with pytest.raises(ac.OptionError, match=message):
        MirrorPlanOptions(sensor=SENSOR, **asked)
    assert MirrorPlanOptions(sensor=SENSOR, count=10, columns=4).column_count == 4


def test_a_bound_of_places_has_digits_at_any_snr():
    plan = plan_mirrors(MirrorPlanOptions(sensor=SENSOR, snr=1e5, draws=0))
    assert "no better than ± 8.0e-06 px" in mirror_plan_text(plan)
