"""Requirements: met, not met, or it cannot be told yet, with true probabilities."""

import math

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate
from acutance.curves.metric_words import METRIC_WORDS
from acutance.targets import ToleranceLimit
from acutance.targets.conformity import conformity_word, written_probability
from acutance.targets.uncertainty_budget import systematic_share

SENSOR = ac.Sensor([optics.Gaussian(0.45), optics.Detector(0.95)])


@pytest.fixture(scope="module")
def edge():
    image, _ = simulate.edge(SENSOR, angle_deg=6, snr=100, rng=np.random.default_rng(3))
    return ac.measure_edge(image)


def test_a_number_far_from_its_limit_is_told(edge):
    number = edge.mtf_nyquist
    met, missed, above = edge.conformity(
        f"mtf_nyquist >= {number.value - 4 * number.std}",
        f"mtf_nyquist>={number.value + 4 * number.std}",
        "fwhm_px <= 3",
    )
    assert [one.word for one in (met, missed, above)] == ["met", "not met", "met"]
    assert met.probability == pytest.approx(0.99997, abs=2e-5)
    assert "across: mtf_nyquist >= " in met.summary
    assert "> 0.999" in met.summary


def test_one_near_its_limit_is_not_and_says_how_many_would_tell(edge):
    number = edge.mtf_nyquist
    (answer,) = edge.conformity(f"mtf_nyquist >= {number.value - 0.9 * number.std:.6f}")
    assert answer.word == "cannot be told yet"
    assert answer.probability == pytest.approx(0.816, abs=0.002)
    # A single one is told at 1.645 deviations. What the prior adds, a mean of all has in full.
    share = systematic_share(edge.budget, "across", "mtf_nyquist")
    needed = (0.9 / 1.6449) ** 2
    assert 0.01 < share < 0.9 * needed
    assert f"about {math.ceil((1 - share) / (needed - share))} measurements" in answer.summary


def test_what_is_left_to_the_prior_is_not_told_by_more_measurements(edge):
    """49 edges were said to tell, and of sixty the mean was no better than of ten."""
    number = edge.mtf_nyquist
    share = systematic_share(edge.budget, "across", "mtf_nyquist")
    needed = 0.9 * math.sqrt(share) * number.std
    (answer,) = edge.conformity(f"mtf_nyquist >= {number.value - 1.6449 * needed:.8f}")
    assert "would not tell: shape left to the prior leaves" in answer.summary
    assert "a longer target, or one of more contrast" in answer.summary


@pytest.mark.parametrize("several", [False, True])
def test_what_was_stated_is_not_told_by_more_of_the_same_target(several):
    options = ac.EdgeOptions(level_uncertainty=0.2)
    image, _ = simulate.edge(SENSOR, angle_deg=6, snr=100, rng=np.random.default_rng(3))
    found = (
        ac.measure_edges(image, options=options)
        if several
        else ac.measure_edge(image, options=options)
    )
    number = found.groups["across"].metrics["mtf_nyquist"] if several else found.mtf_nyquist
    near, far = found.conformity(
        *(f"mtf_nyquist >= {number.value - n * number.std:.6f}" for n in (0.5, 1.2))
    )
    assert near.word == far.word == "cannot be told yet"
    assert "more measurements of this target would not tell: levels of the target" in near.summary
    assert "more measurements of this target would not tell" in far.summary
    assert "about" not in near.summary


def test_what_was_stated_takes_more_measurements():
    options = ac.EdgeOptions(level_uncertainty=0.005)
    image, _ = simulate.edge(SENSOR, angle_deg=6, snr=100, rng=np.random.default_rng(3))
    found = ac.measure_edge(image, options=options)
    number = found.mtf_nyquist
    stated = next(r.share["mtf_nyquist"] for r in found.budget if r.name == "level_uncertainty")
    share = systematic_share(found.budget, "across", "mtf_nyquist")
    needed = 0.5 * number.std
    (answer,) = found.conformity(f"mtf_nyquist >= {number.value - 1.6449 * needed:.8f}")
    assert 0.05 < stated < 0.2
    assert stated < share < 0.25
    count = math.ceil((1 - share) / (0.25 - share))
    assert count > 4
    assert f"about {count} measurements" in answer.summary


def test_the_causes_and_the_advice_are_those_of_the_number_that_is_asked_for():
    """Of FWHM what the prior is left with is more than the border, of the MTF the border is all."""
    options = ac.EdgeOptions(target_softness_px=ac.Estimate(0.3, 0.01))
    image, _ = simulate.edge(
        SENSOR, angle_deg=8, shape=(40, 30), snr=400, rng=np.random.default_rng(1)
    )
    found = ac.measure_edge(image, options=options)
    said = {}
    for name, deviations in (("mtf_nyquist", 0.9), ("fwhm_px", 0.7)):
        number = getattr(found, name)
        (answer,) = found.conformity(f"{name} >= {number.value - deviations * number.std:.8f}")
        said[name] = answer.summary
    assert "would not tell: softness of the target's border leaves" in said["mtf_nyquist"]
    assert said["mtf_nyquist"].endswith("state it with less uncertainty, or measure another target")
    assert "would not tell: shape left to the prior and softness of the" in said["fwhm_px"]
    assert said["fwhm_px"].endswith("a longer target, or one of more contrast, has less of it")


def test_a_share_that_is_small_is_named_all_the_same(edge):
    number = edge.rer
    share = systematic_share(edge.budget, "across", "rer")
    assert share < 0.1
    limit = number.value - 1.6449 * 0.9 * math.sqrt(share) * number.std
    (answer,) = edge.conformity(f"rer >= {limit:.8f}")
    assert "shape left to the prior leaves" in answer.summary
    assert "a longer target" in answer.summary


def test_who_is_content_with_less_confidence_is_told(edge):
    number = edge.mtf_nyquist
    limit = ToleranceLimit("mtf_nyquist", ">=", number.value - 0.5 * number.std, confidence=0.65)
    (answer,) = edge.conformity(limit)
    assert answer.word == "met"


def test_a_direction_that_was_not_measured_is_not_told(edge):
    (answer,) = edge.conformity("along.mtf_nyquist >= 0.01")
    assert (answer.orientation, answer.word, answer.probability) == (
        "along", "cannot be told yet", None,
    )  # fmt: skip
    assert "across track only" in answer.summary


def test_a_doubtful_measurement_tells_nothing():
    image, _ = simulate.edge(SENSOR, angle_deg=6, snr=100, rng=np.random.default_rng(3))
    doubtful = ac.measure_edge(np.minimum(image, np.quantile(image, 0.6)))
    assert doubtful.verdict.warns
    (answer,) = doubtful.conformity("mtf_nyquist >= 0.01")
    assert (answer.word, answer.probability) == ("cannot be told yet", None)
    assert f"the measurement is {doubtful.verdict.word}" in answer.summary


def test_metres_need_a_gsd(edge):
    (answer,) = edge.conformity("fwhm_m <= 1")
    assert answer.word == "cannot be told yet"
    assert "GSD" in answer.summary


def test_a_curve_that_does_not_fall_so_far_has_no_number():
    sharp = ac.Sensor([optics.Gaussian(0.2), optics.Detector(0.6)])
    image, _ = simulate.edge(sharp, angle_deg=6, snr=200, rng=np.random.default_rng(4))
    found = ac.measure_edge(image, options=ac.EdgeOptions(limits={"full_pixel": 9}))
    number = found.mtf30_cpp
    (answer,) = found.conformity("mtf30_cpp >= 0.4")
    assert (answer.probability is None) == math.isnan(number.value)


def test_the_record_answers_as_the_measurement(edge):
    asked = ("mtf_nyquist >= 0.2", "rer >= 0.5")
    assert edge.record.conformity(*asked) == edge.conformity(*asked)


def test_of_all_edges_of_a_target_the_means_are_asked():
    image = simulate.checkerboard(SENSOR, snr=100, rng=np.random.default_rng(5)).image
    found = ac.measure_edges(image)
    answers = found.conformity("mtf_nyquist >= 0.1", "along.fwhm_px <= 9")
    assert [one.orientation for one in answers] == ["across", "along", "along"]
    assert all(one.word == "met" for one in answers)
    assert answers[0].number == found.groups["across"].metrics["mtf_nyquist"]


def test_probabilities_are_true():
    """Of many edges whose limits lie around the truth as many are met as was said."""
    rng, said, met = np.random.default_rng(11), [], []
    for _ in range(150):
        image, truth = simulate.edge(SENSOR, angle_deg=rng.uniform(3, 12), snr=60, rng=rng)
        number = ac.measure_edge(image).mtf_nyquist
        limit = truth.mtf_nyquist.value + rng.normal(0.0, 1.5) * number.std
        said.append(ToleranceLimit("mtf_nyquist", ">=", limit).probability(number))
        met.append(truth.mtf_nyquist.value >= limit)
    chance = np.array(said)
    scatter = math.sqrt(float(np.sum(chance * (1 - chance))))
    assert abs(chance.sum() - sum(met)) < 3 * scatter
    told = (chance > 0.95) | (chance < 0.05)
    wrong = np.where(chance > 0.5, ~np.array(met), np.array(met))
    assert told.sum() > 30
    assert wrong[told].mean() < 0.06


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("mtf_nyquist > 0.1", "not of the form"),
        ("mtf_nyquist >= x", "not of the form"),
        ("mtf_nyquist >= nan", "has no limit"),
        ("0.1 <= mtf_nyquist", "not of the form"),
        ("contrast >= 0.1", "no number of a measurement"),
        ("up.rer >= 0.1", "not of the form"),
        ("overshoot <= 0", "overshoot is never below 0; state a limit above"),
        ("along.mtf_nyquist >= 0", "mtf_nyquist is never below 0"),
        ("fwhm_m <= -1", "fwhm_m is never below 0"),
        ("", "not of the form"),
        ("rer > 0.4", r"rer > 0.4.*of a number with a deviation > asks the same as >="),
        ("mtf50 >= 0.2", "asks for 'mtf50'.*did you mean mtf50_cpp"),
        ("mtf at nyquist >= 0.2", "asks for 'mtf at nyquist'.*did you mean mtf_nyquist"),
        ("mtf_niquist >= 0.2", "did you mean mtf_nyquist"),
        ("MTF at  Nyquist >= x", "'MTF at  Nyquist >= x' is not of the form"),
    ],
)
def test_texts_that_state_no_limit_are_refused(text, said):
    with pytest.raises(ac.OptionError, match=said):
        ToleranceLimit.of(text)


@pytest.mark.parametrize("name", ac.curves.METRICS)
def test_every_number_may_be_named_as_reports_print_it(name):
    words = METRIC_WORDS[name]
    for label in (words.label, words.label_with_unit):
        assert ToleranceLimit.of(f"{label} >= 0.2") == ToleranceLimit(name, ">=", 0.2)
    said = ToleranceLimit.of(f" along . {words.label}  < = 0.2 ")
    assert said == ToleranceLimit(name, "<=", 0.2, "along")


@pytest.mark.parametrize("name", ["contrast", "mtf"])
def test_a_name_that_resembles_none_or_several_is_not_guessed(name):
    with pytest.raises(ac.OptionError) as caught:
        ToleranceLimit.of(f"{name} >= 0.1")
    assert "did you mean" not in str(caught.value)


def test_a_number_that_may_be_negative_has_a_limit_of_zero():
    assert ToleranceLimit.of("giqe_h >= 0").limit == 0.0


@pytest.mark.parametrize("confidence", [0.5, 1.0, 2.0])
def test_a_confidence_tells_more_than_a_coin(confidence):
    with pytest.raises(ac.OptionError, match="confidence"):
        ToleranceLimit("rer", ">=", 0.5, confidence=confidence)


def test_an_unknown_direction_is_refused():
    with pytest.raises(ac.OptionError, match="across or along"):
        ToleranceLimit("rer", ">=", 0.5, orientation="up")


def test_words_and_probabilities_at_their_ends():
    assert [conformity_word(p, 0.95) for p in (0.95, 0.05, 0.5)] == [
        "met", "not met", "cannot be told yet",
    ]  # fmt: skip
    assert [written_probability(p) for p in (0.9995, 0.0005, 0.25)] == [
        "> 0.999", "< 0.001", "0.250",
    ]  # fmt: skip
