"""The noise of the high image: stated or estimated, and how uncertain it is."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from pair_scenes import REFERENCE, SYSTEMS

import acutance as ac
from acutance.curves.grid import Floats
from acutance.simulate import Noise
from acutance.targets.pair import BIRESOLUTION_METHODS
from acutance.targets.pair.noise import HighNoise


@cache
def noisy(ratio: float) -> tuple[Floats, Floats]:
    """A pair with noise in the high image of 8 % of the contrast, in the low one of 1 %."""
    low, high, _ = ac.simulate.pair(
        SYSTEMS["smeared"], REFERENCE, ratio=ratio, shape=(60, 60), shift_px=(0.3, -0.2),
        noise_low=Noise(10.0), noise_high=Noise(80.0), rng=np.random.default_rng(4),
    )  # fmt: skip
    return low, high


def measured(
    ratio: float, stated: float | None = None, method: str = "kernel-fit"
) -> ac.BiresolutionMeasurement:
    options = ac.BiresolutionOptions(noise_high=stated)
    return ac.measure_biresolution(
        *noisy(ratio), ratio=ratio, reference_mtf=REFERENCE, method=method, options=options
    )


@pytest.mark.parametrize("ratio", [2.0, 2.5, 5.0])
def test_stating_what_was_estimated_changes_nothing(ratio: float) -> None:
    """Both are of the high image's pixels, whether the kernel acts on these or on others."""
    estimated = measured(ratio)
    assert estimated.high_noise == pytest.approx(80.0, rel=0.2)
    stated = measured(ratio, estimated.high_noise)
    assert stated.high_noise == pytest.approx(estimated.high_noise)
    for name in ("across", "along"):
        one, other = getattr(estimated, name).mtf_nyquist, getattr(stated, name).mtf_nyquist
        assert other.value == pytest.approx(one.value, abs=0.02 * one.std)


@pytest.mark.parametrize("method", BIRESOLUTION_METHODS)
def test_the_budget_has_what_another_noise_would_do(method: str) -> None:
    """Its power is known to 30 %: what more or less of it moves is in the deviation."""
    low, middle, high = (
        measured(2.0, 50.0 * share**0.5, method).across.mtf_nyquist.value
        for share in (0.7, 1.0, 1.3)
    )
    assert low < middle < high
    m = measured(2.0, 50.0, method)
    row = next(r for r in m.budget if (r.name, r.direction) == ("reference_noise", "across"))
    assert row.std["mtf_nyquist"] == pytest.approx(0.5 * (high - low), rel=0.25)


def test_noise_that_leaves_no_number_is_named() -> None:
    m = measured(2.0, 110.0)
    shares = [one.std / one.value for one in (m.across.mtf_nyquist, m.along.mtf_nyquist)]
    check = next(one for one in m.checks if one.name == "high_noise")
    assert max(shares) > 0.4
    assert check.value == pytest.approx(max(shares), rel=0.1)
    assert not check.passed
    assert check.severity == "caution"
    assert m.verdict.word == "doubtful"


def test_noise_that_is_known_well_enough_is_not_named() -> None:
    m = measured(2.0, 20.0)
    assert "high_noise" not in {check.name for check in m.failed_checks}


def test_more_noise_than_there_is_is_named_in_the_refusal() -> None:
    with pytest.raises(ac.TargetError, match=r"noise of 240 was stated .* estimated as [78]\d"):
        measured(2.0, 240.0)


def test_white_noise_is_no_texture() -> None:
    """Half of what is taken for texture is taken off the noise, and makes it uncertain."""
    rng = np.random.default_rng(2)
    found = HighNoise.of_samples(1000 + 10 * rng.standard_normal((600, 600)))
    assert found.power > 85.5
    assert found.power_std < 0.31 * found.power
