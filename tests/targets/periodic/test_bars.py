"""Bars measured against the truth of their simulation, and what is refused."""

import math

import numpy as np
import pytest

import acutance as ac
from acutance.errors import NoBarsError, OptionError
from acutance.geometry.bar_group import Bars
from acutance.simulate import bars, reference_systems
from acutance.targets.periodic import BarsOptions, measure_bars
from acutance.targets.periodic.bars_find import find_bars
from acutance.targets.periodic.bars_readings import coltman_mtf
from acutance.targets.periodic.clipped_and_outlying import clipped_share

FREQ = np.arange(10, 51, 4) / 100


def _bars(name="gaussian", seed=1, **given):
    given = {"snr": 100.0, "angle_deg": 6.0, "periods_px": (8, 4, 2.3), **given}
    return bars(reference_systems()[name], rng=np.random.default_rng(seed), **given)


def _stated(truth):
    return tuple(
        Bars(g.row, g.col, g.normal_deg, g.period_px, g.count, g.length_px) for g in truth.groups
    )


def _errors(found, truth):
    curve = truth.response.mtf
    pairs = [(found.mtf(f), curve(f).value) for f in FREQ]
    return np.array([e.value - true for e, true in pairs]), np.array([e.std for e, _ in pairs])


@pytest.mark.parametrize("name", ["gaussian", "sharpened", "smeared"])
def test_curve_along_the_normal(name):
    image, truth = _bars(name)
    found = measure_bars(image, options=BarsOptions(dark=200.0, bright=1200.0, level_std=1.0))
    error, std = _errors(found, truth)
    assert np.sqrt(np.mean(error**2)) < 0.005
    assert np.max(np.abs(error / std)) < 4.0
    assert np.all(std < 0.01)
    assert found.trusted
    assert found.directions_deg[0] == pytest.approx(6.0, abs=0.1)


def test_contrast_is_fitted_without_levels():
    image, truth = _bars(periods_px=(12, 8, 5, 3.2, 2.2))
    found = measure_bars(image)
    error, std = _errors(found, truth)
    assert np.max(np.abs(error / std)) < 4.0
    assert abs(found.contrast.value - 1000) < 4 * found.contrast.std < 40


def test_groups_one_by_one():
    image, truth = _bars()
    found = measure_bars(image)
    for one, group, true in zip(found.groups, truth.groups, truth.mtf, strict=True):
        assert one.period_px.value == pytest.approx(group.period_px, abs=0.01)
        assert one.bars.count == group.count
        assert abs(one.mtf.value - true) < 4 * one.mtf.std
        # A finite group does not show one frequency: the plain reading is near, not exact.
        assert one.reading.modulation == pytest.approx(true, abs=0.02)


def test_bars_beyond_nyquist_are_measured():
    image, truth = _bars(periods_px=(8, 4, 1.6, 1.3))
    found = measure_bars(image)
    assert [one.bars.count for one in found.groups] == [5, 5, 5, 5]
    beyond = found.groups[2]
    assert beyond.freq_cpp > 0.6
    assert abs(beyond.mtf.value - truth.mtf[2]) < 4 * beyond.mtf.std < 0.02


def test_aligned_bars_and_wide_bars():
    image, truth = _bars(angle_deg=0.0, periods_px=(16, 8, 5, 2.6), count=3, orientation="along")
    found = measure_bars(image)
    error, std = _errors(found, truth)
    assert np.max(np.abs(error / std)) < 4.0
    assert [one.bars.count for one in found.groups] == [3, 3, 3, 3]
    # Measured along the columns: the rows' direction is not.
    assert found.along.mtf(0.4).std < 0.2 * found.across.mtf(0.4).std


def test_two_directions():
    first, truth = _bars(angle_deg=3.0)
    second, _ = _bars(angle_deg=3.0, orientation="along", seed=2)
    height = max(first.shape[0], second.shape[0])
    image = np.full((height, first.shape[1] + second.shape[1]), 200.0)
    image += 10 * np.random.default_rng(3).standard_normal(image.shape)
    image[: first.shape[0], : first.shape[1]] = first
    image[: second.shape[0], first.shape[1] :] = second
    found = measure_bars(image)
    assert len(found.directions_deg) == 2
    for curve in (found.across.mtf, found.along.mtf):
        assert abs(curve(0.4).value - truth.response.mtf(0.4).value) < 4 * curve(0.4).std
        assert curve(0.4).std < 0.03


def test_dark_bars_gain_region_and_missing_pixels():
    image, truth = _bars()
    one = measure_bars(image)
    wide = np.full((image.shape[0] + 20, image.shape[1] + 30), 5000.0)
    wide[10:-10, 20:-10] = 4 * (1400 - image)
    dark = measure_bars(wide, (10, 20, *image.shape))
    assert dark.contrast.value < 0
    assert dark.mtf(0.4).value == pytest.approx(one.mtf(0.4).value, abs=1e-4)
    assert dark.groups[0].bars.row == pytest.approx(one.groups[0].bars.row + 10, abs=1e-3)
    image[20:24, 20:30] = math.nan
    error, std = _errors(measure_bars(image), truth)
    assert np.max(np.abs(error / std)) < 4.0


def test_intervals_hold_the_truth_over_random_bars():
    hits, z = [], []
    for seed, name in enumerate(("gaussian", "wide", "diffraction", "asymmetric", "defocused")):
        rng = np.random.default_rng([7, seed])
        image, truth = _bars(name, seed, angle_deg=float(rng.uniform(-12, 12)))
        error, std = _errors(measure_bars(image, options=BarsOptions(_stated(truth))), truth)
        hits.append(np.abs(error) < 1.96 * std)
        z.append(error / std)
    assert np.mean(hits) > 0.8
    assert 0.4 < np.sqrt(np.mean(np.square(z))) < 1.7


@pytest.mark.parametrize("count", [2, 3, 7])
@pytest.mark.parametrize("periods", [(12, 6, 2.5), (4, 3, 2.2)])
def test_groups_are_found_and_counted(count, periods):
    image, truth = _bars("smeared", count, count=count, periods_px=periods, angle_deg=-11.0)
    found = find_bars(image)
    assert [one.count for one in found.groups] == [count] * 3
    for one, group in zip(found.groups, truth.groups, strict=True):
        assert math.hypot(one.row - group.row, one.col - group.col) < 2
        assert one.period_px == pytest.approx(group.period_px, rel=0.25 / count)


def test_nothing_that_is_not_bars():
    rng = np.random.default_rng(0)
    system = reference_systems()["gaussian"]
    with pytest.raises(NoBarsError, match="uniform"):
        measure_bars(np.full((60, 60), 7.0))
    edge, _ = ac.simulate.edge(system, snr=100, rng=rng)
    star, _ = ac.simulate.star(system, snr=100, rng=rng)
    one_bar, _ = _bars(periods_px=(12,), count=1)
    for image in (rng.standard_normal((80, 80)), edge, star, one_bar):
        with pytest.raises(NoBarsError, match="no whole group"):
            measure_bars(image)


def test_a_cut_off_group_is_none():
    image, _ = _bars()
    found = measure_bars(image[:, : image.shape[1] // 2 + 4])
    assert len(found.groups) < 3


def test_stated_groups_that_are_elsewhere():
    image, truth = _bars()
    groups = _stated(truth)
    away = tuple(Bars(-50.0, -50.0, 6.0, 8.0, 5, 24.0) for _ in groups)
    with pytest.raises(NoBarsError, match="outside the region"):
        measure_bars(image, options=BarsOptions(away))
    slow = tuple(
        Bars(g.row, g.col, g.normal_deg, 1.3 * g.period_px, 5, g.length_px) for g in groups
    )
    with pytest.raises(NoBarsError, match=r"period of 10\.40 px"):
        measure_bars(image, options=BarsOptions(slow))
    few = tuple(Bars(g.row, g.col, g.normal_deg, g.period_px, 3, g.length_px) for g in groups)
    failed = {check.name for check in measure_bars(image, options=BarsOptions(few)).failed_checks}
    assert {"contrast_snr", "correlated_noise"} <= failed


def test_clipped_bars_and_wrong_levels_fail_by_name():
    image, _ = _bars()
    failed = [check.name for check in measure_bars(np.clip(image, 0, 1000)).failed_checks]
    assert "saturation" in failed
    wrong = BarsOptions(dark=200.0, bright=900.0, level_std=1.0)
    assert "correlated_noise" in [c.name for c in measure_bars(image, options=wrong).failed_checks]


def test_zero_noise():
    image, truth = _bars(snr=None)
    found = measure_bars(image)
    error, std = _errors(found, truth)
    assert np.max(np.abs(error)) < 0.002
    assert np.all(np.abs(error) < 4 * std)
    assert found.trusted


def test_uniform_ground_without_noise_is_not_clipped():
    image, _ = _bars(snr=None, periods_px=(8.0, 4.0, 3.0, 2.0))
    assert "saturation" not in [check.name for check in measure_bars(image).failed_checks]


def test_values_pile_up_where_noise_should_have_spread_them():
    ground = np.full(100, 200.0)
    assert clipped_share(ground, None, snr=1000.0) == 0.0
    assert clipped_share(ground, None, snr=100.0) == 1.0
    assert clipped_share(ground, 200.0, snr=1000.0) == 1.0


def test_options_are_refused_by_name():
    with pytest.raises(OptionError, match="1 bars in a group"):
        BarsOptions(count=1)
    with pytest.raises(OptionError, match=r"period of 0\.5 px"):
        BarsOptions((Bars(5, 5, 0, 0.5, 4, 20),))
    with pytest.raises(OptionError, match="dark and bright, or neither"):
        BarsOptions(bright=3.0)
    with pytest.raises(OptionError, match="method"):
        measure_bars(np.zeros((40, 40)), method="eye")


def test_coltman_series_of_a_known_system():
    system = reference_systems()["gaussian"]
    freq = np.arange(1, 120) / 100
    odd = 2 * np.arange(30) + 1
    otf = system.otf(np.outer(freq, odd).ravel(), np.zeros(freq.size * 30)).reshape(-1, 30)
    ctf = 4 / math.pi * otf.real @ ((-1.0) ** np.arange(30) / odd)
    inverse = coltman_mtf(freq, ctf)
    assert np.max(np.abs(inverse - otf[:, 0].real)[9:]) < 0.005


def test_document():
    image, _ = _bars()
    document = measure_bars(image, gsd_m=0.5).to_dict()
    assert document["kind"] == "bars"
    assert len(document["groups"]) == 3
    assert document["groups"][0]["mtf"]["std"] > 0
    assert document["normal"]["fwhm_m"]["value"] == pytest.approx(
        0.5 * document["normal"]["fwhm_px"]["value"]
    )
