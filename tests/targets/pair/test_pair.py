"""The bi-resolution method: truth, invariances, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import acutance as ac
from acutance.curves.grid import Floats
from acutance.raster.geolocation import Geolocation
from acutance.simulate import Landscape, NativeGrid, PairTruth
from acutance.targets.pair import BiresolutionLimits, MeasuredCurves, measured_reference

SYSTEMS = ac.simulate.reference_systems()
REFERENCE = SYSTEMS["gaussian"]
NYQUIST = 0.01
"""What the MTF at Nyquist may be wrong by at SNR 100."""


@cache
def rendered(
    system: str = "smeared",
    ratio: float = 2.0,
    seed: int = 1,
    shape: tuple[int, int] = (96, 104),
    shift: tuple[float, float] = (1.3, -0.6),
    snr: float | None = 100.0,
) -> tuple[Floats, Floats, PairTruth]:
    return ac.simulate.pair(
        SYSTEMS[system],
        REFERENCE,
        ratio=ratio,
        shape=shape,
        shift_px=shift,
        gain=1.2,
        offset=30.0,
        snr=snr,
        rng=np.random.default_rng(seed),
    )


@cache
def measured(
    system: str = "smeared", ratio: float = 2.0, seed: int = 1, method: str = "kernel-fit"
) -> ac.BiresolutionMeasurement:
    low, high, _ = rendered(system, ratio, seed)
    return ac.measure_biresolution(low, high, reference_mtf=REFERENCE, method=method)


def both(measurement: ac.BiresolutionMeasurement) -> tuple[Floats, Floats]:
    """MTF at Nyquist across and along: values and standard deviations."""
    found = [one.mtf_nyquist for one in (measurement.across, measurement.along)]
    return np.array([one.value for one in found]), np.array([one.std for one in found])


class TestTruth:
    @pytest.mark.parametrize(
        ("system", "ratio"),
        [("gaussian", 2.0), ("smeared", 2.0), ("halo", 3.0), ("asymmetric", 2.5),
         ("sharpened", 3.0), ("diffraction", 4.0)],
    )  # fmt: skip
    def test_mtf_at_nyquist(self, system: str, ratio: float) -> None:
        m = measured(system, ratio)
        _, _, truth = rendered(system, ratio)
        true = np.array([truth.response(axis).mtf_nyquist.value for axis in ("across", "along")])
        value, std = both(m)
        assert np.abs(value - true).max() < (2 if system == "sharpened" else 1.2) * NYQUIST
        assert np.all(np.abs(value - true) < 3.5 * std)
        assert np.all(std < 1.2 * NYQUIST)

    def test_whole_curve_and_metrics(self) -> None:
        m = measured("halo", 3.0)
        _, _, truth = rendered("halo", 3.0)
        for axis in ("across", "along"):
            found, true = getattr(m, axis), truth.response(axis)
            inside = found.mtf.freq_cpp <= 0.5
            assert np.abs(found.mtf.value - true.mtf(0.0).value * true.mtf.value)[inside].max() < (
                0.015
            )
            assert abs(found.rer.value - true.rer.value) < 3.5 * found.rer.std + 0.002
            assert abs(found.fwhm_px.value - true.fwhm_px.value) < 3.5 * found.fwhm_px.std

    def test_shift_gain_and_offset(self) -> None:
        m = measured()
        for found, true in zip(m.shift_px, (1.3, -0.6), strict=True):
            assert abs(found.value - true) < 4 * found.std
            assert found.std < 0.02
        assert m.gain == pytest.approx(1.2, rel=0.01)
        assert m.offset == pytest.approx(30.0, abs=10.0)
        assert m.trusted, m.failed_checks

    def test_without_reference_it_is_the_quotient(self) -> None:
        low, high, truth = rendered()
        m = ac.measure_biresolution(low, high)
        half, nothing = np.array([0.5]), np.zeros(1)
        true = float(np.abs(truth.ratio_otf(half, nothing))[0])
        assert abs(m.across.mtf_nyquist.value - true) < 3.5 * m.across.mtf_nyquist.std
        assert not m.reference_known
        assert "reference_mtf" in {check.name for check in m.failed_checks}
        assert m.to_dict()["quantity"] == "mtf_low_over_mtf_high"

    def test_asymmetry_shows_in_the_phase(self) -> None:
        m = measured("asymmetric", 2.5)
        _, _, truth = rendered("asymmetric", 2.5)
        true = truth.response("across").mtf
        at = np.searchsorted(true.freq_cpp, 0.4)
        assert abs(true.phase_rad[at]) > 0.1
        assert m.across.mtf.phase_rad[at] == pytest.approx(true.phase_rad[at], abs=0.06)

    @pytest.mark.parametrize("shift", [(2.0, 2.0), (-5.4, 3.7)])
    def test_large_errors_of_registration(self, shift: tuple[float, float]) -> None:
        low, high, truth = rendered("gaussian", 2.0, 3, (80, 80), shift)
        m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE)
        assert [one.value for one in m.shift_px] == pytest.approx(shift, abs=0.03)
        assert m.along.mtf_nyquist.value == pytest.approx(
            truth.response("along").mtf_nyquist.value, abs=0.015
        )

    def test_shift_beyond_what_was_looked_at(self) -> None:
        low, high, _ = rendered("gaussian", 2.0, 3, (96, 96), (9.5, 3.0))
        with pytest.raises(ac.TargetError, match="at the end of the 8 low pixels"):
            ac.measure_biresolution(low, high)
        options = ac.BiresolutionOptions(max_shift_px=16)
        m = ac.measure_biresolution(low, high, options=options)
        assert [one.value for one in m.shift_px] == pytest.approx((9.5, 3.0), abs=0.03)

    def test_spectral_ratio_agrees(self) -> None:
        m = measured(method="spectral-ratio")
        _, _, truth = rendered()
        value, std = both(m)
        assert np.all(np.abs(value - truth.response().mtf_nyquist.value) < 3.5 * std)
        fitted = both(measured())
        assert np.all(std > fitted[1] * 0.8), "the pixels say more than the spectra"

    def test_spectral_ratio_is_not_high(self) -> None:
        """The mean over systems: frequencies chosen by their own coherence made it 0.02 high."""
        errors = []
        for seed, system in enumerate(("gaussian", "smeared", "sharpened", "wide") * 2):
            low, high, truth = rendered(system, 2.0, seed + 400, (96, 96))
            m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE, method="spectral-ratio")
            true = [truth.response(axis).mtf_nyquist.value for axis in ("across", "along")]
            errors.append(both(m)[0] - true)
        assert abs(np.mean(errors)) < 0.012

    def test_aliasing_does_no_harm(self) -> None:
        """A low sensor sharp enough to alias strongly: the spectrum of its image is no help."""
        sharp = ac.Sensor([ac.optics.Gaussian(0.15), ac.optics.Detector(0.8)])
        low, high, truth = ac.simulate.pair(
            sharp, REFERENCE, ratio=4, shape=(80, 80), snr=200, rng=np.random.default_rng(8)
        )
        m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE)
        assert truth.response().mtf_nyquist.value > 0.6
        value, std = both(m)
        assert np.all(
            np.abs(value - truth.response().mtf_nyquist.value) < np.maximum(3.5 * std, 0.02)
        )


class TestProducts:
    """Both images interpolated onto a map from native grids turned by 18 degrees."""

    @pytest.mark.parametrize("sigma_px", [0.25, 0.4])
    def test_mean_transfer_of_the_product(self, sigma_px: float) -> None:
        sensor = ac.Sensor([ac.optics.Gaussian(sigma_px), ac.optics.Detector(1.0)])
        low, high, truth = ac.simulate.pair(
            sensor, REFERENCE, shape=(140, 140), shift_px=(0.6, -0.3), gain=1.2, snr=100,
            native=NativeGrid(), rng=np.random.default_rng(50),
        )  # fmt: skip
        m = ac.measure_biresolution(low, high, reference_mtf=truth.reference)
        true = [truth.response(axis).mtf_nyquist.value for axis in ("across", "along")]
        assert max(true) < 0.65 * sensor.response().mtf_nyquist.value
        # Without functions for the interpolation the kernel is too smooth: 0.010 to 0.016 here.
        assert np.abs(both(m)[0] - true).max() < 0.008


class TestCoverage:
    def test_intervals_hold_the_truth(self) -> None:
        """Three systems and ratios: 95 % intervals miss seldom, and are not far too wide."""
        z = []
        for system, ratio, seeds in (("gaussian", 2.0, 6), ("smeared", 2.0, 6), ("halo", 3.0, 4)):
            for seed in range(10, 10 + seeds):
                low, high, truth = rendered(system, ratio, seed, (72, 72), (0.4, -1.7))
                m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE)
                for axis in ("across", "along"):
                    found, true = getattr(m, axis), truth.response(axis)
                    for freq in (0.25, 0.5):
                        one = found.mtf(freq)
                        z.append((one.value - true.mtf(freq).value) / one.std)
        assert np.mean(np.abs(z) < 1.96) >= 0.88
        assert 0.6 < np.sqrt(np.mean(np.square(z))) < 1.3


class TestInvariances:
    def test_gain_and_offset(self) -> None:
        low, high, _ = rendered()
        m = ac.measure_biresolution(0.01 * low - 5, 3 * high + 1000, reference_mtf=REFERENCE)
        assert m.across.mtf_nyquist.value == pytest.approx(
            measured().across.mtf_nyquist.value, abs=1e-5
        )

    def test_flip(self) -> None:
        low, high, _ = rendered()
        m = ac.measure_biresolution(low[:, ::-1], high[:, ::-1], reference_mtf=REFERENCE)
        expected = measured()
        assert m.shift_px[1].value == pytest.approx(-expected.shift_px[1].value, abs=2e-3)
        assert both(m)[0] == pytest.approx(both(expected)[0], abs=2.5e-3)

    def test_transposition(self) -> None:
        low, high, _ = rendered()
        m = ac.measure_biresolution(low.T, high.T, reference_mtf=REFERENCE)
        assert both(m)[0][::-1] == pytest.approx(both(measured())[0], abs=2.5e-3)


class TestRealTrouble:
    def test_clouds_are_left_out(self) -> None:
        low, high, truth = rendered()
        rows, cols = np.indices(low.shape)
        cloudy = np.where(np.hypot(rows - 30, cols - 70) < 12, 2500.0, low)
        m = ac.measure_biresolution(cloudy, high, reference_mtf=REFERENCE)
        value, std = both(m)
        assert m.pixel_fit.left_out > 350
        assert np.all(
            np.abs(value - truth.response().mtf_nyquist.value) < np.maximum(3.5 * std, 0.01)
        )
        shown = m.residual[30 - m.image.roi[0], 70 - m.image.roi[1]]
        assert np.isnan(shown)

    @pytest.mark.parametrize("texture", [0.0, 1.0])
    def test_cloud_over_half_the_scene(self, texture: float) -> None:
        """As much of the scene as there is ground: no median can tell which is which."""
        low, high, truth = rendered("smeared", 2.0, 4, (128, 128))
        other, _, _ = rendered("smeared", 2.0, 79, (128, 128))
        noisy = 3000 + 10 * noise(low.shape) + texture * other
        cloudy = np.where(np.arange(128) < 64, noisy, low)
        m = ac.measure_biresolution(cloudy, high, reference_mtf=REFERENCE)
        value, std = both(m)
        assert m.pixel_fit.left_out > (0.35 if texture else 0.15) * low.size
        assert np.all(np.abs(value - truth.response().mtf_nyquist.value) < 2.5 * std)
        assert np.all(std < 0.03)
        assert {"left_out", "residual_correlation"} & {check.name for check in m.failed_checks}

    def test_clipped_below_the_end_of_the_scale(self) -> None:
        low, high, _ = rendered()
        m = ac.measure_biresolution(np.minimum(low, 900.0), high, reference_mtf=REFERENCE)
        assert "saturation" in {check.name for check in m.failed_checks}

    def test_nodata_in_both_images(self) -> None:
        low, high, truth = rendered()
        low, high = low.copy(), high.copy()
        low[20:30, 40:60] = np.nan
        high[100:120, 20:40] = np.nan
        high[:, 200] = np.nan
        m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE)
        value, std = both(m)
        assert m.pixel_fit.used < 0.95 * measured().pixel_fit.used
        assert np.all(
            np.abs(value - truth.response().mtf_nyquist.value) < np.maximum(3.5 * std, 0.01)
        )

    def test_another_band_widens_the_intervals(self) -> None:
        low, high, _ = rendered()
        other, _, _ = rendered("smeared", 2.0, 77)
        m = ac.measure_biresolution(low + 0.15 * other, high, reference_mtf=REFERENCE)
        value, std = both(m)
        assert np.all(std > 1.3 * both(measured())[1])
        assert np.all(np.abs(value - rendered()[2].response().mtf_nyquist.value) < 3.5 * std)
        failed = {check.name for check in m.failed_checks}
        assert {"residual_correlation", "correlation"} & failed

    def test_region(self) -> None:
        low, high, truth = rendered()
        m = ac.measure_biresolution(low, high, roi=(10, 20, 70, 60), reference_mtf=REFERENCE)
        row, col, height, width = m.image.roi
        assert row >= 10
        assert col >= 20
        assert row + height <= 80
        assert col + width <= 80
        assert m.across.mtf_nyquist.value == pytest.approx(
            truth.response().mtf_nyquist.value, abs=0.03
        )

    def test_scene_too_large_to_be_read_whole(self) -> None:
        low, high, _ = rendered("smeared", 2.0, 5, (220, 200))
        options = ac.BiresolutionOptions(max_pixels=3 * 4096)
        m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE, options=options)
        assert m.share_read < 0.5
        assert m.pixel_fit.used <= 3 * 4096
        assert np.isnan(m.local.residual).any()

    def test_reference_uncertainty_enters(self) -> None:
        low, high, _ = rendered()
        freq = np.linspace(0, 1, 101)
        curve = ac.Mtf(
            freq,
            np.abs(REFERENCE.otf(freq, 0.0)).astype(complex),
            np.full((101, 1), 0.03 + 0j) * (freq > 0)[:, None],
        )
        m = ac.measure_biresolution(low, high, reference_mtf=MeasuredCurves(curve, curve))
        expected = measured().across.mtf_nyquist
        assert m.across.mtf_nyquist.value == pytest.approx(expected.value, rel=0.01)
        assert m.across.mtf_nyquist.std > expected.std
        number = ac.measure_biresolution(low, high, reference_mtf=0.2891)
        assert number.across.mtf_nyquist.value == pytest.approx(expected.value, rel=1e-3)


class TestGeometry:
    def georeferenced(self, shift_m: float = 0.0, turn: float = 0.0) -> tuple[ac.Image, ac.Image]:
        low, high, _ = rendered()
        coarse, fine = ac.Image.from_array(low[5:, 3:]), ac.Image.from_array(high)
        place = (20.0, 0.0, 60.0 + shift_m, 0.0, -20.0, -100.0)
        return (
            replace(coarse, geolocation=Geolocation(place, "EPSG:32633")),
            replace(
                fine, geolocation=Geolocation((10.0, turn, 0.0, -turn, -10.0, 0.0), "EPSG:32633")
            ),
        )

    def test_geotransforms_tell_ratio_and_place(self) -> None:
        m = ac.measure_biresolution(*self.georeferenced(), reference_mtf=REFERENCE)
        assert m.ratio == pytest.approx((2.0, 2.0))
        assert m.grid.source == "geotransform"
        assert [one.value for one in m.shift_px] == pytest.approx((1.3, -0.6), abs=0.02)
        assert m.otf.gsd_m == pytest.approx((20.0, 20.0))

    def test_fraction_of_a_pixel_in_the_geotransform(self) -> None:
        m = ac.measure_biresolution(*self.georeferenced(7.0), reference_mtf=REFERENCE)
        assert m.shift_px[1].value == pytest.approx(-0.6 + 7 / 20, abs=0.02)
        assert both(m)[0] == pytest.approx(both(measured())[0], abs=0.01)

    def test_ratio_in_contradiction(self) -> None:
        with pytest.raises(ac.AcutanceError, match="geotransforms say 2"):
            ac.measure_biresolution(*self.georeferenced(), ratio=3)

    def test_no_overlap(self) -> None:
        with pytest.raises(ac.RegionError, match="do not overlap along columns"):
            ac.measure_biresolution(*self.georeferenced(1e6))

    def test_turned(self) -> None:
        with pytest.raises(ac.RegionError, match="turned or sheared"):
            ac.measure_biresolution(*self.georeferenced(turn=0.1))


def noise(shape: tuple[int, int], seed: int = 0) -> Floats:
    return np.random.default_rng(seed).normal(size=shape)


class TestRefusals:
    @pytest.mark.parametrize(
        ("low", "high", "options", "message"),
        [
            (noise((80, 80)), noise((150, 190)), {}, "tell no ratio"),
            (noise((80, 80)), noise((160, 160)), {"ratio": 3}, "cut them alike"),
            (noise((80, 80)), noise((160, 160)), {"ratio": 0.5}, "ratio of 0.5"),
            (noise((80, 80)), noise((160, 160)), {"ratio": np.nan}, "ratio of nan"),
            (noise((160, 160)), noise((80, 80)), {}, "LOW one"),
            (np.full((80, 80), 7.0), noise((160, 160)), {}, "nothing in common|no structure"),
            (noise((80, 80)), np.full((160, 160), 7.0), {}, "no structure"),
            (np.full((80, 80), np.nan), noise((160, 160)), {}, "no structure|no pixel|low pixels"),
            (noise((80, 80)), np.full((160, 160), np.nan), {}, "no structure|low pixels"),
            (noise((20, 20)), noise((40, 40)), {}, "at least 16"),
            (noise((80, 80)), noise((160, 160)), {"method": "magic"}, "no bi-resolution method"),
            (noise((80, 80)), noise((160, 160)), {"reference_mtf": 0.9}, "between 0 and 0.637"),
            (noise((80, 80)), noise((160, 160)), {"reference_mtf": "b8"}, "reference_mtf is a str"),
            (noise((80, 80)), noise((160, 160)), {"roi": (0, 0, 90, 10)}, "beyond the image"),
            (noise((80, 80, 3)), noise((160, 160)), {}, "3"),
        ],
    )  # fmt: skip
    def test_with_a_message(
        self, low: Any, high: Any, options: dict[str, Any], message: str
    ) -> None:
        with pytest.raises(ac.AcutanceError, match=message):
            ac.measure_biresolution(low, high, **options)

    def test_different_ground(self) -> None:
        low, _, _ = rendered()
        _, high, _ = rendered("smeared", 2.0, 78)
        try:
            m = ac.measure_biresolution(low, high)
        except ac.TargetError:
            return
        assert "correlation" in {check.name for check in m.failed_checks}

    def test_negative(self) -> None:
        low, high, _ = rendered()
        with pytest.raises(ac.TargetError, match=r"brighter where that is darker|in common"):
            ac.measure_biresolution(-low, high)

    @pytest.mark.parametrize(
        "options",
        [{"stop_change": 0.0}, {"max_steps": 0}, {"reach_px": 40.0}, {"max_pixels": 3},
         {"noise_high": -1.0}, {"max_shift_px": -1}],
    )  # fmt: skip
    def test_options(self, options: dict[str, Any]) -> None:
        with pytest.raises(ac.OptionError):
            ac.BiresolutionOptions(**options)

    def test_documents_that_are_no_measurement(self) -> None:
        for document in ([], {}, {"schema": "acutance/measurement/1"}):
            with pytest.raises(ac.OptionError):
                measured_reference(document, "file")


def test_document_as_a_reference() -> None:
    curves = measured_reference(measured().to_dict(), "file")
    assert curves.across(0.5).value == pytest.approx(measured().across.mtf_nyquist.value, rel=1e-6)


def _edge_of_the_reference(gsd_m: float) -> ac.Measurement:
    image, _ = ac.simulate.edge(REFERENCE, angle_deg=6, snr=100, rng=np.random.default_rng(3))
    return ac.measure_edge(image, gsd_m=gsd_m)


def test_a_reference_in_one_direction_is_said_to_be_one() -> None:
    low, high, _ = rendered()
    image = ac.Image.from_array(high, gsd_m=10.0)
    edge = _edge_of_the_reference(10.0)
    for reference in (edge, measured_reference(edge.to_dict(), "edge.json")):
        m = ac.measure_biresolution(low, image, reference_mtf=reference)
        (check,) = (one for one in m.failed_checks if one.name == "reference_directions")
        assert f"{edge.line.normal_deg:.1f} degrees from the column axis" in check.message
    names = {check.name for check in measured().checks}
    assert "reference_directions" not in names


def test_a_reference_of_other_pixels_is_refused() -> None:
    low, high, _ = rendered()
    wrong = _edge_of_the_reference(0.7)
    message = r"pixels of 0.7 m, those of the high image have 10 m"
    for pair in ((low, ac.Image.from_array(high, 10.0)), (ac.Image.from_array(low, 20.0), high)):
        with pytest.raises(ac.OptionError, match=message):
            ac.measure_biresolution(*pair, reference_mtf=wrong)
    with pytest.raises(ac.OptionError, match=message):
        ac.measure_biresolution(
            low, ac.Image.from_array(high, 10.0),
            reference_mtf=measured_reference(wrong.to_dict(), "edge.json"),
        )  # fmt: skip


def test_a_ratio_is_no_reference() -> None:
    low, high, _ = rendered()
    ratio = ac.measure_biresolution(low, high)
    with pytest.raises(ac.OptionError, match="no sensor's own MTF"):
        measured_reference(ratio.to_dict(), "file")


def test_stopping_threshold() -> None:
    low, high, _ = rendered()
    loose = ac.measure_biresolution(low, high, options=ac.BiresolutionOptions(stop_change=0.2))
    assert len(loose.steps) < len(measured().steps)
    assert loose.steps[-1].change < 0.2
    few = ac.BiresolutionOptions(max_steps=2, limits=BiresolutionLimits())
    m = ac.measure_biresolution(low, high, options=few)
    assert "iteration_change" in {check.name for check in m.failed_checks}


def test_local_statistics() -> None:
    m = measured()
    mtf, std = m.local_mtf_nyquist("across")
    assert mtf.shape == m.local.residual.shape
    usable = np.isfinite(mtf)
    assert usable.mean() > 0.9
    assert abs(np.mean(mtf[usable]) - m.across.mtf_nyquist.value) < 0.02
    assert np.nanstd(mtf) == pytest.approx(np.nanmedian(std), rel=0.6)
    assert np.nanmedian(np.abs(m.local.shift_row_px)) < 0.03


def test_landscape_without_anything() -> None:
    with pytest.raises(ac.ModelError):
        Landscape(fields=0, texture=0.0)
