"""Pairs: both images exact, whatever the ratio and the shift."""

from __future__ import annotations

import json

import numpy as np
import pytest

from acutance import ModelError, optics
from acutance.report import json_text
from acutance.simulate import NativeGrid, Noise, PairGround, pair, pair_ground, reference_systems

SENSORS = reference_systems()


def test_the_low_image_is_the_blurred_high_one_sampled() -> None:
    """A detector of four by four detectors, without other blur, is their mean."""
    wide = optics.Sensor([optics.Detector(1.0)])
    fine = optics.Sensor([optics.Detector(1.0)])
    low, high, _ = pair(wide, fine, ratio=4, shape=(24, 20), rng=np.random.default_rng(1))
    mean = high.reshape(24, 4, 20, 4).mean(axis=(1, 3))
    # The ground is band-limited at four of the fine pixels: a mean of four of them is exact up to
    # what the fold leaves beyond.
    assert np.abs(low - mean).max() < 0.02 * np.ptp(high)


def test_shift_moves_the_content() -> None:
    sensor = SENSORS["wide"]
    low, _, _ = pair(sensor, sensor, ratio=2, shape=(30, 30), rng=np.random.default_rng(2))
    moved, _, truth = pair(
        sensor, sensor, ratio=2, shape=(30, 30), shift_px=(3.0, -2.0), rng=np.random.default_rng(2)
    )
    assert moved[3:, :-2] == pytest.approx(low[:-3, 2:], abs=1e-6)
    assert truth.shift_px == (3.0, -2.0)


def test_gain_offset_and_noise() -> None:
    sensor = SENSORS["gaussian"]
    clean, high, _ = pair(sensor, sensor, rng=np.random.default_rng(3))
    low, same, truth = pair(
        sensor, sensor, gain=2.0, offset=10.0, noise_low=Noise(read=4.0),
        rng=np.random.default_rng(3),
    )  # fmt: skip
    assert same == pytest.approx(high)
    assert np.std(low - 2 * clean - 10) == pytest.approx(4.0, rel=0.05)
    assert truth.noise_high is None


@pytest.mark.parametrize(("ratio", "rows"), [(2.0, 40), (2.75, 55), (3.0, 60), (4.0, 80)])
def test_shapes(ratio: float, rows: int) -> None:
    sensor = SENSORS["gaussian"]
    low, high, _ = pair(sensor, sensor, ratio=ratio, shape=(20, 24), rng=np.random.default_rng(4))
    assert low.shape == (20, 24)
    assert high.shape == (rows, round(24 * ratio))


def test_truth() -> None:
    low, reference = SENSORS["smeared"], SENSORS["gaussian"]
    _, _, truth = pair(low, reference, ratio=3, shape=(20, 20), rng=np.random.default_rng(5))
    half, nothing = np.array([0.5]), np.zeros(1)
    expected = low.otf(half, nothing) / reference.otf(half / 3, nothing)
    assert truth.ratio_otf(half, nothing) == pytest.approx(expected)
    document = json.loads(json_text(truth.to_dict()))
    assert document["across"]["mtf_nyquist"] == pytest.approx(low.mtf()(0.5).value)
    curve = document["along"]["mtf_over_reference"]
    assert max(curve["freq_cpp"]) <= 1.5


def test_landscape_has_the_slope_it_was_asked() -> None:
    field = pair_ground((512, 512), 8, PairGround(fields=0, texture=1.0), np.random.default_rng(6))
    power = np.abs(np.fft.fft2(field)) ** 2
    radius = np.hypot(np.fft.fftfreq(512)[:, None], np.fft.fftfreq(512))
    inner, outer = (
        power[(radius > a) & (radius < b)].mean() for a, b in ((0.04, 0.05), (0.16, 0.2))
    )
    assert np.log(inner / outer) / np.log(4) == pytest.approx(2.4, abs=0.2)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ratio": 2.1}, "quarter"),
        ({"ratio": 1.0}, "quarter"),
        ({"shape": (4000, 4000)}, "smaller"),
    ],
)
def test_refusals(changes: dict[str, object], message: str) -> None:
    sensor = SENSORS["gaussian"]
    with pytest.raises(ModelError, match=message):
        pair(sensor, sensor, **{"rng": np.random.default_rng(0), **changes})  # type: ignore[arg-type]


class TestProducts:
    def test_transfer(self) -> None:
        """A half at the native Nyquist frequency, nothing lost well below it."""
        grid = NativeGrid(turn_deg=0.0, pitch_row_px=1.0, pitch_col_px=1.0)
        half, nothing = np.array([0.5]), np.zeros(1)
        assert grid.otf(half, nothing)[0] == pytest.approx(0.493, abs=0.001)
        assert grid.otf(0.4 * half, nothing)[0] > 0.99
        assert grid.otf(nothing, nothing)[0] == 1.0

    def test_same_grid_changes_nothing(self) -> None:
        """Native pixels on those of the product, but for the phase: a shift of the same image."""
        wide = optics.Sensor([optics.Gaussian(0.9), optics.Detector(1.0)])
        grid = NativeGrid(turn_deg=0.0, pitch_row_px=1.0, pitch_col_px=1.0)
        sampled, _, _ = pair(wide, wide, shape=(30, 26), rng=np.random.default_rng(6))
        product, _, truth = pair(
            wide, wide, shape=(30, 26), native=grid, rng=np.random.default_rng(6)
        )
        assert np.abs(product - sampled).max() < 3e-3 * np.ptp(sampled)
        assert truth.sensor.blocks[-1] == grid

    def test_turned_grid(self) -> None:
        wide = optics.Sensor([optics.Gaussian(0.9), optics.Detector(1.0)])
        sampled, fine, _ = pair(wide, wide, shape=(30, 26), rng=np.random.default_rng(6))
        product, other, _ = pair(
            wide, wide, shape=(30, 26), native=NativeGrid(), rng=np.random.default_rng(6)
        )
        assert np.abs(product - sampled).max() < 6e-3 * np.ptp(sampled)
        assert other.shape == fine.shape

    def test_noise_is_interpolated(self) -> None:
        """Its power is what the spline leaves of it: less than was added, and correlated."""
        wide = optics.Sensor([optics.Gaussian(0.9), optics.Detector(1.0)])
        clean, _, _ = pair(wide, wide, native=NativeGrid(), rng=np.random.default_rng(7))
        noisy, _, _ = pair(
            wide, wide, native=NativeGrid(), noise_low=Noise(read=10.0),
            rng=np.random.default_rng(7),
        )  # fmt: skip
        assert 7.0 < np.std(noisy - clean) < 9.0
