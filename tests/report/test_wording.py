"""Numbers, verdicts and messages as text."""

import math

import pytest

from acutance.curves import METRICS, Estimate
from acutance.report.wording import (
    METRIC_WORDS,
    flatten_options,
    format_number,
    metric_words,
    shorten_name,
    split_message,
    verdict,
    word_estimate,
    write_fixed,
)
from acutance.targets.measurement import Check


def test_an_estimate_gets_two_digits_of_its_standard_deviation():
    words = word_estimate(Estimate(0.15111, 0.00321))
    assert words.value_and_std == "0.1511 ± 0.0032"
    assert words.interval == "0.1448 … 0.1574"


def test_a_standard_deviation_too_small_for_decimals_is_told():
    words = word_estimate(Estimate(0.28911, 8.2e-10))
    assert words.value_and_std == "0.289110 ± 8e−10"
    assert words.interval == "0.289110 … 0.289110"
    assert word_estimate(Estimate(0.0, 8e-10)).interval == "0.000000 … 0.000000"


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


def test_the_verdict_names_what_failed(measurement, vague_measurement, target):
    assert verdict([measurement]).startswith("1 of 6 checks failed (plateau_px)")
    assert verdict([vague_measurement]) == "No checks were made."
    assert verdict(target.measurements).startswith("4 of 24 checks failed")


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        ("Too low (KOMPSAT-3 draft, step 2).", ("Too low", "KOMPSAT-3 draft, step 2")),
        ("Too low [Kohm 2004]", ("Too low", "Kohm 2004")),
        ("Use a wider region.", ("Use a wider region.", "")),
        ("(all)", ("(all)", "")),
    ],
)
def test_the_source_of_a_limit_is_found_in_brackets(message, expected):
    assert split_message(Check("x", 1.0, ">= 2", False, message)) == expected


def test_nested_options_become_dotted_names():
    options = {"robust": False, "limits": {"snr": 50.0}}
    assert list(flatten_options(options)) == [("robust", "False"), ("limits.snr", "50")]
