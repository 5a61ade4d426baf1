"""Targets that come again: their effects by the closed form, and what trends make of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acutance.archive.mean_of_images import mean_of_images
from acutance.archive.specification import Requirement
from acutance.archive.specification_check import check_requirement
from acutance.archive.trends import Series, Trend, fit_trend
from acutance.archive.trends.target_effects import TargetEffects, effects_and_images

LEVEL = 0.16
STD, SCATTER, ERROR = 0.04, 0.02, 0.01


def steady(order: str, seed: int, targets: int = 4, std: float = STD, images: int = 40) -> Series:
    """A steady sensor; all targets in every image, one by chance, or one after the other."""
    rng = np.random.default_rng(seed)
    years, own = np.sort(rng.uniform(0, 3, images)), rng.normal(0, std, targets)
    image = np.arange(images)
    target = {
        "all": np.tile(np.arange(targets), images),
        "random": rng.integers(0, targets, images),
        "blocks": image * targets // images,
    }[order]
    image = np.repeat(image, targets) if order == "all" else image
    value = 1 + SCATTER * rng.normal(size=images)[image] + own[target]
    value += ERROR * rng.normal(size=image.size)
    return Series(
        metric="mtf_nyquist", when=2021 + years[image], value=LEVEL * value,
        std=np.full(image.size, LEVEL * ERROR), image=image, target=target.astype(np.int64),
    )  # fmt: skip


def dense(series: Series, std: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Effects beside free images by generalised least squares: mean, covariance, log evidence."""
    assert series.target is not None
    member = (series.target[:, None] == np.unique(series.target)).astype(float)
    images = (series.image[:, None] == np.unique(series.image)).astype(float)
    weight = np.diag(1 / series.std**2)
    columns = np.hstack([images, member])
    precision = np.diag([*np.zeros(images.shape[1]), *np.full(member.shape[1], 1 / std**2)])
    normal = columns.T @ weight @ columns + precision
    covariance = np.linalg.inv(normal)
    beta = covariance @ columns.T @ weight @ series.value
    first = images.shape[1]
    total = np.diag(series.std**2) + std**2 * member @ member.T
    inverse = np.linalg.inv(total)
    seen = images.T @ inverse @ images
    free = np.linalg.solve(seen, images.T @ inverse @ series.value)
    off = series.value - images @ free
    evidence = -0.5 * (np.linalg.slogdet(total)[1] + np.linalg.slogdet(seen)[1]
                       + off @ inverse @ off)  # fmt: skip
    return beta[first:], covariance[first:, first:], float(evidence)


def test_effects_are_those_of_generalised_least_squares_beside_free_images() -> None:
    series = steady("all", 1, images=12)
    effects, images = effects_and_images(series)
    # The scatter within images, without the targets, is that of the stated errors.
    assert images.within_std < 0.5 * LEVEL * ERROR
    variance = series.std**2 + images.within_std**2
    stated = replace(series, std=np.sqrt(variance))
    given, evidences = [], []
    for std in (0.1 * LEVEL * STD, LEVEL * STD, 5 * LEVEL * STD):
        found = effects.given(std)
        mean, covariance, evidence = dense(stated, std)
        share = effects.share
        assert found.shift == pytest.approx(share @ (mean - effects.taken), abs=1e-4 * LEVEL)
        assert found.columns @ found.columns.T == pytest.approx(
            share @ covariance @ share.T, rel=0.02
        )
        given.append(found.log_evidence)
        evidences.append(evidence)
    assert np.diff(given) == pytest.approx(np.diff(evidences), abs=0.05)
    assert np.argmax(given) == 1


def test_one_target_or_none_that_comes_again_changes_nothing() -> None:
    series = steady("random", 2)
    alone = fit_trend(replace(series, target=None))
    for target in (np.zeros(40, np.int64), np.full(40, -1), np.arange(40)):
        found = fit_trend(replace(series, target=target))
        assert found.level == alone.level
        assert found.notes == ()
    effects, _ = effects_and_images(replace(series, target=None))
    assert not effects.are_known
    assert TargetEffects.none(3).given(1.0).columns.shape == (3, 0)


def test_sites_of_one_target_each_are_counted_once() -> None:
    series = steady("random", 3)
    both = replace(series, site=series.target)
    assert effects_and_images(both)[0].share.shape == (40, 4)
    halves = replace(series, site=np.where(series.target < 2, 0, 1))
    assert effects_and_images(halves)[0].share.shape == (40, 6)


@pytest.mark.parametrize("order", ["all", "random", "blocks"])
def test_the_level_is_that_of_so_many_targets(order: str) -> None:
    off, stds = [], []
    for seed in range(3):
        series = steady(order, 100 + seed)
        trend = fit_trend(series)
        assert trend.changes == ()
        off.append((trend.level.value - LEVEL) / trend.level.std)
        stds.append(trend.level.std / LEVEL)
        nameless = fit_trend(replace(series, target=None))
        assert trend.level.std > 1.5 * nameless.level.std
    # Four targets that differ by 4 % have means that differ by 2 %.
    assert 0.012 < np.median(stds) < 0.05
    assert np.max(np.abs(off)) < 3


def test_a_target_that_takes_over_is_no_step_of_the_sensor() -> None:
    series = steady("blocks", 5, targets=2, std=0.0)
    step = 0.1 * LEVEL * (series.target == 1)
    followed = replace(series, value=series.value + step)
    assert fit_trend(replace(followed, target=None)).changes
    trend = fit_trend(followed)
    assert trend.changes == ()
    assert any("One follows another" in note for note in trend.notes)
    # Where both are in all images, the same step is the sensor's.
    both = steady("all", 5, targets=2)
    real = replace(both, value=both.value + 0.1 * LEVEL * (both.image >= 20))
    (change,) = fit_trend(real).changes
    assert change.relative_size.value == pytest.approx(0.1, abs=0.03)


def test_images_are_those_that_the_mean_of_all_targets_would_have() -> None:
    series = steady("random", 6)
    spread = np.std(fit_trend(replace(series, target=None)).images.value)
    trend = fit_trend(series)
    assert np.std(trend.images.value) < 0.75 * spread
    assert trend.notes == (
        "The images show 4 targets, which differ by about "
        f"{100 * trend.posterior.target_std / trend.posterior.unit:.2g} % (standard deviation): "
        "the level is the mean of these, with an interval that allows for how few they are, and "
        "what is peculiar to a target is taken out of its images.",
    )
    again = Trend.from_dict(trend.to_dict())
    assert again.level == trend.level
    assert again.posterior.target_std == trend.posterior.target_std
    earlier = trend.to_dict()
    for name in ("target_std", "targets"):
        del earlier["posterior"][name]
    assert Trend.from_dict(earlier).posterior.target_std == 0


def test_more_images_of_the_same_targets_do_not_answer_a_requirement() -> None:
    series = steady("random", 8)
    requirement = Requirement(metric="mtf_nyquist", minimum=0.99 * LEVEL)
    found = check_requirement(requirement, series)
    assert found.word == "cannot be told yet"
    assert found.more_images is None
    nameless = check_requirement(requirement, replace(series, target=None))
    assert nameless.more_images is not None


def test_very_many_images_are_joined_with_their_targets() -> None:
    trend = fit_trend(steady("random", 7, images=450))
    assert trend.images.are_joined
    assert trend.level.std > 0.01 * LEVEL


@pytest.mark.parametrize("order", ["all", "random", "blocks"])
def test_the_deviation_of_a_mean_is_that_of_so_many_targets(order: str) -> None:
    off, held = [], []
    for seed in range(60):
        series = steady(order, 300 + seed)
        found, nameless = mean_of_images(series), mean_of_images(replace(series, target=None))
        assert found.mean.value == pytest.approx(nameless.mean.value, rel=1e-9)
        off.append((found.mean.value - LEVEL) / found.mean.std)
        low, high = nameless.mean.interval()
        held.append(low <= LEVEL <= high)
    assert 0.6 < np.sqrt(np.mean(np.square(off))) < 1.25
    assert np.mean(held) < 0.75
