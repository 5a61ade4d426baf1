"""What a bi-resolution measurement holds: directions, pixel sizes, checks, and its stored forms."""

from __future__ import annotations

import json
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from pair_scenes import REFERENCE, SMALL, both, measured, rendered

import acutance as ac
from acutance.numerics.normal_equations import Normal
from acutance.raster import Gsd
from acutance.targets import QUESTIONS, Record
from acutance.targets.pair import PAIR_CHECKS, BiresolutionOptions
from acutance.targets.pair.kernel_fit import without_noise
from acutance.targets.pair.noise import whitening_of


class TestDirections:
    def test_transposed_pair_flown_along_its_rows(self) -> None:
        """The ground is the same, and so are the numbers across and along track."""
        low, high, _ = rendered("trail")
        image = ac.Image.from_array(low.T, along_track="x")
        m = ac.measure_biresolution(image, high.T, reference_mtf=REFERENCE)
        expected = measured("trail")
        assert m.image.along_track == "x"
        assert both(m)[0] == pytest.approx(both(expected)[0], abs=2.5e-3)
        for direction in ("across", "along"):
            found, known = m.coherence_of(direction), expected.coherence_of(direction)
            assert found is not None
            assert known is not None
            assert found[1] == pytest.approx(known[1], abs=0.04)
            maps = [one.local_mtf_nyquist(direction)[0] for one in (m, expected)]
            assert pytest.approx(maps[1], abs=0.02) == maps[0].T
        document = m.to_dict()
        assert document["coherence"]["across"]["value"] == pytest.approx(
            expected.to_dict()["coherence"]["across"]["value"], abs=0.04
        )

    def test_axes_are_swapped_where_the_track_is_not_declared(self) -> None:
        low, high, _ = rendered("trail", shape=SMALL)
        m = ac.measure_biresolution(low.T, high.T, reference_mtf=REFERENCE)
        assert both(m)[0][::-1] == pytest.approx(both(measured("trail", shape=SMALL))[0], abs=8e-3)

    def test_pixels_that_are_not_square(self) -> None:
        low, high, _ = rendered("trail", shape=SMALL)
        m = ac.measure_biresolution(
            ac.Image.from_array(low, Gsd(30.0, 20.0)), ac.Image.from_array(high, Gsd(15.0, 10.0)),
            reference_mtf=REFERENCE,
        )  # fmt: skip
        assert (m.across.gsd_m, m.along.gsd_m) == pytest.approx((20.0, 30.0))
        assert m.image.pixel_gsd_m == (30.0, 20.0)
        assert m.high.pixel_gsd_m == (15.0, 10.0)
        assert m.image.gsd_m is None
        assert m.across.fwhm_m is not None
        assert m.across.fwhm_m.value == pytest.approx(20.0 * m.across.fwhm_px.value)


class TestStoredForms:
    def test_a_copy_is_equal(self) -> None:
        m = measured("trail", shape=SMALL)
        assert pickle.loads(pickle.dumps(m)) == m
        assert Record.from_dict(m.to_dict()) == m.record

    @pytest.mark.parametrize(("system", "ratio"), [("trail", 2.0), ("halo", 3.0)])
    def test_without_details(self, system: str, ratio: float) -> None:
        m = measured(system, ratio)
        light = m.without_details()
        stored = pickle.dumps(light)
        assert len(stored) <= 60 * 1024
        assert len(pickle.dumps(m.record)) <= 15_360
        copy = pickle.loads(stored)
        assert copy.details is None
        assert copy == light == m
        assert copy.to_dict() == m.to_dict()

    def test_rounded_covariance_keeps_the_deviations(self) -> None:
        m = measured("trail", shape=SMALL)
        copy = pickle.loads(pickle.dumps(m.without_details()))
        for angle_deg in (0.0, 33.0, 90.0):
            exact, rounded = m.mtf_at(angle_deg), copy.mtf_at(angle_deg)
            inside = (exact.freq_cpp > 0.05) & (exact.freq_cpp <= 0.6)
            assert rounded.otf == pytest.approx(exact.otf, abs=1e-12)
            away = np.abs(rounded.std[inside] / exact.std[inside] - 1)
            assert np.median(away) < 0.01
            assert away.max() < 0.06
        assert copy.without_details() == copy


class TestChecks:
    def test_every_check_is_asked_and_nothing_else(self) -> None:
        asked = {check.name for check in measured().checks}
        assert asked == set(PAIR_CHECKS) - {"reference_directions"}

    def test_every_limit_decides(self) -> None:
        low, high, _ = rendered(shape=SMALL)
        absurd = {name: math.inf if QUESTIONS[name].sense == ">=" else -math.inf
                  for name in PAIR_CHECKS}  # fmt: skip
        m = ac.measure_biresolution(
            low, high, reference_mtf=REFERENCE.mtf(), options=BiresolutionOptions(limits=absurd)
        )
        assert {check.name for check in m.failed_checks} == set(PAIR_CHECKS)
        assert m.options["limits"] == absurd

    def test_the_band_is_that_of_the_samples_the_kernel_acts_on(self) -> None:
        """Of which a low pixel has four at most: the curves end at 2 c/px, whatever the ratio."""
        low, high, _ = rendered(ratio=5.0, shape=(40, 40), shift=(0.0, 0.0))
        m = ac.measure_biresolution(low, high, ratio=5)
        message = next(check.message for check in m.checks if check.name == "ratio")
        assert "5 times finer, and nothing is measured beyond 2 cycles per low pixel" in message

    def test_a_limit_that_no_pair_has(self) -> None:
        with pytest.raises(ac.OptionError, match="no check 'peak_snr' to limit"):
            BiresolutionOptions(limits={"peak_snr": 3.0})

    def test_white_residuals_have_no_correlation(self) -> None:
        rng = np.random.default_rng(5)
        white = [rng.normal(size=(60, 60)) for _ in range(3)]
        assert whitening_of(white).correlation.significant == 0
        assert not whitening_of(white).needed
        red = [one[:, 1:] + 0.5 * one[:, :-1] for one in white]
        whitening = whitening_of(red)
        assert whitening.correlation.strongest == pytest.approx(0.4, abs=0.03)
        left = np.concatenate([whitening(one).ravel() for one in red])
        assert np.std(left) == pytest.approx(1.0, abs=0.03)


def test_a_part_without_data_has_no_numbers_in_the_map() -> None:
    low, high, _ = rendered()
    low = low.copy()
    low[:40, :44] = np.nan
    document = ac.measure_biresolution(low, high, reference_mtf=REFERENCE).to_dict()
    assert document["map"]["gain"][0][0] is None
    assert document["map"]["gain"][2][2] == pytest.approx(1.0, abs=0.05)
    json.dumps(document, allow_nan=False)


def test_noise_that_cannot_be_taken_off() -> None:
    indefinite = np.array([[1.0, 0.0], [0.0, -1.0]])
    with pytest.raises(ac.TargetError, match="noise of the high image cannot be taken off"):
        without_noise(Normal(np.eye(2), np.zeros(2), 1.0, 9.0), indefinite, np.zeros(2))


def test_a_pair_without_reference_is_a_ratio() -> None:
    m = measured("trail", shape=SMALL)
    assert not m.is_ratio
    assert replace(m, reference_known=False).is_ratio
