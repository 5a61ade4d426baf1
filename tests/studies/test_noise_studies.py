"""The studies of noise: what the paper found, and what our estimator makes of it."""

import math

import numpy as np
import pytest

from acutance import OptionError
from acutance.report.studies.study import study_figure
from acutance.studies import (
    Execution,
    GroundNoiseOptions,
    SnrOptions,
    ground_noise,
    run_study,
    study_ground_noise,
    study_snr,
)
from acutance.studies.table import Table

ALONE = Execution(seed=3, workers=1)


@pytest.fixture(scope="module")
def snr():
    levels = (2.0, 5.0, 10.0, 14.0, 20.0, 28.0, 40.0, 60.0)
    return study_snr(SnrOptions(noise_dn=levels, draws=12), ALONE)


def test_snr_has_a_row_for_each_level_and_target(snr):
    assert len(snr.table) == 16
    assert len(snr.tables["trials"]) == 192
    edge = snr.table.where(target="edge", noise_dn=10.0)
    assert edge["snr"][0] == pytest.approx(100.0)
    assert edge["truth"][0] == pytest.approx(0.267, abs=5e-4)


def test_a_pulse_needs_about_half_the_snr_of_an_edge_the_published_way(snr):
    need = {t: snr.finding(f"minimum_snr_scatter_{t}_published").value for t in ("edge", "pulse")}
    assert 50 <= need["edge"] <= 100
    assert 0.3 <= need["pulse"] / need["edge"] <= 0.75


def test_ours_needs_less_and_has_no_bias(snr):
    for target in ("edge", "pulse"):
        quiet = snr.table.where(target=target, noise_dn=5.0)
        assert quiet["ours_rms_percent"][0] < 0.6 * quiet["published_rms_percent"][0]
        assert abs(snr.finding(f"bias_{target}_ours_percent").value) < 0.8
    ours = snr.finding("minimum_snr_edge_ours").value
    assert ours < 0.7 * snr.finding("minimum_snr_edge_published").value
    assert snr.finding("bias_pulse_published_percent").value == pytest.approx(-4.0, abs=1.0)


def test_ours_states_its_scatter(snr):
    loud = snr.table.where(target="edge")
    ratio = loud["ours_std_percent"] / loud["ours_stated_percent"]
    assert 0.75 < float(np.exp(np.mean(np.log(ratio)))) < 1.25


def test_the_limit_decides(snr):
    strict = SnrOptions(noise_dn=(10.0, 20.0), draws=2, limit_percent=0.01)
    assert math.isnan(study_snr(strict, ALONE).finding("minimum_snr_edge_ours").value)


def test_what_was_refused_everywhere_has_no_answers_but_the_reason():
    steep = SnrOptions(noise_dn=(10.0,), draws=1, angle_deg=45.0)
    result = study_snr(steep, ALONE)
    for target in ("edge", "pulse"):
        found = result.finding(f"refused_{target}_published")
        assert found.value == 1
        assert "refused 1 of 1 images" in found.text
        trials = result.tables["trials"].where(target=target)
        assert found.text.endswith(trials.columns["published_refusal"][0])
    assert not any("nan" in found.text for found in result.findings)
    assert {found.name.split("_")[0] for found in result.findings} == {"refused"}
    study_figure(result)


def test_a_single_draw_has_no_scatter_to_tell():
    names = {
        found.name for found in study_snr(SnrOptions(noise_dn=(5.0,), draws=1), ALONE).findings
    }
    assert "minimum_snr_edge_ours" in names
    assert "bias_edge_ours_percent" in names
    assert not any("scatter" in name for name in names)


def test_uneven_ground_that_no_estimator_accepts_says_why():
    steep = GroundNoiseOptions(levels_dn=((1100.0, 400.0),), runs=1, angle_deg=45.0)
    result = study_ground_noise(steep, ALONE)
    assert [found.name for found in result.findings] == [
        "highest_snr", "refused_published", "refused_ours",
    ]  # fmt: skip
    study_figure(result)


@pytest.fixture(scope="module")
def ground():
    options = GroundNoiseOptions(levels_dn=((1100.0, 400.0), (900.0, 600.0)), runs=8)
    return study_ground_noise(options, ALONE)


def test_ground_noise_falls_with_contrast(ground):
    assert ground.table["difference_dn"].tolist() == [700.0, 300.0]
    assert ground.table["snr"][0] == pytest.approx(52.2, abs=0.5)
    strong, weak = ground.table["ours_rms_percent"]
    assert strong < 2 < weak < 3


def test_ground_noise_shows_the_published_bias(ground):
    assert ground.finding("bias_published_percent").value == pytest.approx(-4.3, abs=1.5)
    assert abs(ground.finding("bias_ours_percent").value) < 2.0


def test_impossible_options_are_refused():
    with pytest.raises(OptionError, match="there has to be a draw"):
        SnrOptions(draws=0)
    with pytest.raises(OptionError, match="contrast and a run"):
        GroundNoiseOptions(runs=0)
    with pytest.raises(OptionError, match="the studies are"):
        run_study("snow")
    with pytest.raises(OptionError, match="takes SnrOptions"):
        run_study("snr", GroundNoiseOptions())


def test_dark_pulses_have_an_snr_as_bright_ones():
    dark = SnrOptions(noise_dn=(10.0,), draws=1, pulse_dn=(1200.0, 100.0))
    bright = SnrOptions(noise_dn=(10.0,), draws=1)
    snr = [study_snr(one, ALONE).table.where(target="pulse")["snr"][0] for one in (dark, bright)]
    assert snr[0] == pytest.approx(snr[1])
    ground = GroundNoiseOptions(levels_dn=((400.0, 1100.0),), runs=1)
    assert study_ground_noise(ground, ALONE).finding("highest_snr").value > 0


@pytest.mark.parametrize("kind", [SnrOptions, GroundNoiseOptions])
@pytest.mark.parametrize("limit", [0.0, -1.0])
def test_a_limit_that_no_error_meets_is_refused(kind, limit):
    with pytest.raises(OptionError, match="it has to be above 0"):
        kind(limit_percent=limit)


@pytest.mark.parametrize("changed", [{}, {"draws": 2}, {"limit_percent": 3.0}, {"angle_deg": 8.0}])
def test_the_paper_s_numbers_stand_beside_its_own_settings_alone(changed):
    options = SnrOptions(noise_dn=(5.0,), **({"draws": 1} | changed))
    printed = study_snr(options, ALONE).finding("minimum_snr_edge_published").published
    assert printed == (100.0 if {*changed} <= {"draws"} else None)


def test_high_snr_is_no_word_for_the_highest_of_low_ones():
    low = study_snr(SnrOptions(noise_dn=(20.0,), draws=1), ALONE)
    assert low.finding("bias_edge_ours_percent").text.endswith(
        "at the highest SNR that was tried, 50"
    )
    high = study_snr(SnrOptions(noise_dn=(5.0,), draws=1), ALONE)
    assert high.finding("bias_edge_ours_percent").text.endswith("at high SNR")


@pytest.mark.parametrize(
    "noise_dn", [(20.0,), (20.0, 30.0), (10.0, 20.0), (5.0, 30.0), (2.0, 99.0)]
)
def test_the_axis_of_the_snr_has_several_ticks(noise_dn):
    figure = study_figure(study_snr(SnrOptions(noise_dn=noise_dn, draws=1), ALONE))
    figure.canvas.draw()
    for axes in figure.axes:
        low, high = axes.get_xlim()
        assert 3 <= sum(low <= tick <= high for tick in axes.get_xticks()) <= 12


def test_the_bias_on_uneven_ground_is_known_by_the_images_that_were_measured():
    """Of eight images four were refused: the others tell of the mean."""
    options = GroundNoiseOptions(levels_dn=((1100.0, 400.0),), runs=8)
    numbers = {"mean": 0.25, "bias_percent": -6.0, "std_percent": 4.0, "refused": 4}
    table = Table.of_rows([{"snr": 50.0} | {f"ours_{name}": one for name, one in numbers.items()}])
    (bias,) = ground_noise._bias(options, "ours", table)
    assert "-6.0 ± 2.0 %" in bias.text
