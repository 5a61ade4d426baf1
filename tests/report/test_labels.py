"""Numbers, verdicts and messages as text."""

import math
from dataclasses import replace

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.curves import METRICS, Estimate
from acutance.curves.metric_words import METRIC_WORDS, metric_words
from acutance.report import page, text
from acutance.report.labels import (
    describe_image,
    describe_target,
    flatten_options,
    format_number,
    shorten_name,
    title_of,
    word_estimate,
    write_fixed,
)


def test_an_estimate_gets_two_digits_of_its_standard_deviation():
    words = word_estimate(Estimate(0.15111, 0.00321))
    assert words.value_and_std == "0.1511 ± 0.0032"
    assert words.interval == "0.1448 … 0.1574"


def test_a_standard_deviation_too_small_for_decimals_is_told():
    words = word_estimate(Estimate(0.28911, 8.2e-9))
    assert words.value_and_std == "0.289110 ± 8e−09"
    assert words.interval == "0.289110 … 0.289110"
    assert word_estimate(Estimate(3e-8, 8e-7)).value_and_std == "0"
    assert word_estimate(Estimate(110998.4, 3578.2)).value_and_std == "111000 ± 3600"
    assert "cut off" in word_estimate(Estimate(0.8, 0.47, 0.0, 1.0)).interval


def test_long_names_are_shortened_in_the_middle():
    assert shorten_name("scene.tif", 9) == "scene.tif"
    assert shorten_name("/data/campaigns/2026/brookings/scene.tif", 20) == "/data/…ngs/scene.tif"


def test_a_truth_has_no_interval_and_an_undefined_number_says_so():
    assert word_estimate(Estimate(0.28911)).value_and_std == "0.2891"
    assert word_estimate(Estimate(0.28911)).interval == "–"
    assert word_estimate(Estimate(math.nan, math.nan)).value_and_std == "undefined"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (104.2, "104.2"),
        (0.0, "0"),
        (40.0, "40"),
        (1200.0, "1200"),
        (math.nan, "–"),
        (1e9, "1.000e+09"),
    ],
)
def test_plain_numbers_have_four_digits_and_no_trailing_zeros(value, text):
    assert format_number(value) == text


def test_a_rounded_zero_has_no_sign():
    assert write_fixed(-0.00001) == "0.0000"
    assert write_fixed(-0.25, 2) == "−0.25"


def test_every_metric_has_words():
    of_a_pulse = {"width_px", "width_m", "prf_fwhm_px", "prf_fwhm_m"}
    assert set(METRIC_WORDS) == {*METRICS, *of_a_pulse}
    assert metric_words("fwhm_px").label_with_unit == "FWHM [px]"
    assert metric_words("ground_tilt").label == "ground tilt"


def test_kinds_and_methods_have_natural_names(measurement, both):
    assert title_of(measurement) == "Edge, method spline"
    star = replace(both, kind="star", method="joint")
    assert title_of(star) == "Siemens star, one fit of all pixels"
    assert title_of(star.record) == title_of(star)
    assert title_of(replace(both, method="new")) == "Lamps, method new"


def test_a_rounding_error_is_no_standard_deviation():
    assert word_estimate(Estimate(0.0, 7e-14)).value_and_std == "0"
    assert word_estimate(Estimate(3e-15, 7e-14, 0.0)).value_and_std == "0"
    assert word_estimate(Estimate(0.2891, 7e-14)).value_and_std == "0.2891"


def test_an_interval_that_is_cut_off_has_a_word_for_it():
    words = word_estimate(Estimate(0.001, 0.002, 0.0))
    assert words.interval == "0 … 0.0049 (cut off)"
    assert words.short_interval == "0 … 0.0049"
    assert word_estimate(Estimate(0.01, 0.002, 0.0)).interval == "0.0061 … 0.0139"
    assert word_estimate(Estimate(0.001, 0.002)).interval == "−0.0029 … 0.0049"


def test_nested_options_become_dotted_names():
    options = {"robust": False, "seed": None, "limits": {"snr": 50.0}}
    shown = {"robust": "no", "seed": "–", "limits.snr": "50"}
    assert dict(flatten_options(options)) == shown


@pytest.mark.usefixtures("undrawn")
def test_what_was_stated_and_another_centre_stand_in_the_header(measurement):
    assert "stated" not in describe_image(measurement)
    assert "RER centre" not in describe_image(measurement)
    stated = replace(
        measurement, options={**measurement.options, "level_uncertainty": 0.2, "rer_centre": "peak"}
    )
    for shown in (describe_image(stated), text(stated), page(stated)):
        assert "20 %" in shown
        assert "the LSF's peak" in shown.replace("&#39;", "'").replace("&#x27;", "'")


def test_a_centre_that_nobody_stated_is_that_of_the_method():
    image, _ = simulate.edge(
        simulate.reference_systems()["gaussian"],
        angle_deg=6, snr=100, rng=np.random.default_rng(0),
    )  # fmt: skip
    plain = ac.measure_edge(image)
    assert plain.options["rer_centre"] is None
    draft = ac.measure_edge(image, method="kompsat-2014")
    for shown in (describe_image, text):
        for one in (plain, plain.record):
            assert "RER centre" not in shown(one)
        for one in (draft, draft.record):
            assert "RER centre the LSF's peak" in shown(one)


def test_one_source_is_no_sources():
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
    noise = np.random.default_rng(3)
    image, truth = simulate.points(sensor, snr=100, rng=noise)
    one = ac.measure_points(image, positions=truth.positions[:1])
    assert describe_target(one).startswith("1 source, SNR")
    assert describe_target(ac.measure_points(image)).startswith("20 sources, SNR")
