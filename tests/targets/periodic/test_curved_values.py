"""Values of bars and stars that are not proportional to light, and those that are."""

from functools import cache

import numpy as np
import pytest
from periodic_scenes import CYCLES, SENSORS, STATED, bars_scene, errors_of, star_scene

from acutance.geometry.bar_group import Bars
from acutance.simulate import bars
from acutance.targets.periodic import BarsOptions, StarOptions, measure_bars, measure_star

FULL_SCALE = 1350.0
PATCH_STD = 1.0


def through_gamma(values, gamma):
    """What a power law with a black of 0 makes of values."""
    return FULL_SCALE * np.clip(np.asarray(values) / FULL_SCALE, 0.0, None) ** (1 / gamma)


def departure(gamma):
    """Of that law from a straight line, half way between the levels 200 and 1200."""
    dark, middle, bright = through_gamma([200.0, 700.0, 1200.0], gamma)
    return (middle - dark) / (bright - dark) - 0.5


def levels(gamma):
    dark, bright = through_gamma([200.0, 1200.0], gamma).tolist()
    return {"dark": dark, "bright": bright, "level_std": PATCH_STD}


@cache
def star_of(name, gamma, wave="sine", seed=1):
    image, truth = star_scene(name, seed, wave=wave)
    options = StarOptions(wave=wave, **levels(gamma))
    return measure_star(through_gamma(image, gamma), cycles=CYCLES, options=options), truth


@cache
def bars_of(name, gamma, seed=1):
    image, _ = bars_scene(name, seed)
    return measure_bars(through_gamma(image, gamma), options=BarsOptions(**levels(gamma)))


def nonlinearity(found):
    return next(check for check in found.checks if check.name == "nonlinearity")


@pytest.mark.parametrize("wave", ["sine", "square"])
@pytest.mark.parametrize("gamma", [1.15, 1.3])
def test_star_shows_how_far_its_values_curve(wave, gamma):
    check = nonlinearity(star_of("gaussian", gamma, wave)[0])
    assert not check.passed
    assert check.value == pytest.approx(departure(gamma), rel=0.15)
    assert "above" in check.message


def test_values_that_bend_the_other_way_lie_below():
    assert "below" in nonlinearity(star_of("gaussian", 0.8)[0]).message


def test_the_curve_it_names_makes_the_mtf_wrong():
    found, truth = star_of("halo", 1.3)
    error, std = errors_of(
        found.mean_mtf,
        truth.mtf_mean(np.arange(10, 51, 5) / 100, found.directions_deg),
    )
    assert np.abs(error / std).max() > 4
    assert found.verdict.warns


@pytest.mark.parametrize("name", ["gaussian", "sharpened", "asymmetric", "long kernel"])
@pytest.mark.parametrize("wave", ["sine", "square"])
def test_linear_stars_pass(name, wave):
    check = nonlinearity(star_of(name, 1.0, wave)[0])
    assert check.passed
    assert check.value < 0.005


@pytest.mark.parametrize("name", ["gaussian", "diffraction"])
def test_bars_show_how_far_their_values_curve(name):
    check = nonlinearity(bars_of(name, 1.3))
    assert not check.passed
    assert check.value == pytest.approx(departure(1.3), rel=0.35)
    assert "above" in check.message


def test_dark_bars_curve_the_same_way():
    image, truth = bars(
        SENSORS["gaussian"], periods_px=(8, 4, 2.3), angle_deg=6.0, snr=100.0,
        dark=1200.0, bright=200.0, rng=np.random.default_rng(3),
    )  # fmt: skip
    groups = tuple(
        Bars(g.row, g.col, g.normal_deg, g.period_px, g.count, g.length_px) for g in truth.groups
    )
    options = BarsOptions(groups=groups, **levels(1.3))
    check = nonlinearity(measure_bars(through_gamma(image, 1.3), options=options))
    assert not check.passed
    assert "above" in check.message


@pytest.mark.parametrize("name", ["gaussian", "sharpened", "asymmetric"])
def test_linear_bars_pass(name):
    assert nonlinearity(bars_of(name, 1.0)).passed


def test_deviations_are_those_of_the_curvature():
    """Over twelve linear stars the curvature scatters as its deviation says."""
    from acutance.targets.periodic.fit_star import solve_star
    from acutance.targets.periodic.star_find import find_star

    found = []
    for seed in range(12):
        image, truth = star_scene("smeared", seed)
        star = find_star(image, CYCLES, (truth.star.row, truth.star.col))
        curvature = solve_star(image, star, levels=STATED.levels).curvature
        found.append(curvature.value / curvature.std)
    assert 0.5 < np.sqrt(np.mean(np.square(found))) < 1.6
