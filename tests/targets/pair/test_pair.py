"""The bi-resolution method: truth, invariances, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pair_scenes import NYQUIST, REFERENCE, SMALL, both, measured, rendered

import acutance as ac
from acutance.curves.grid import Floats
from acutance.raster.geolocation import Geolocation
from acutance.simulate import NativeGrid, PairGround
from acutance.targets.pair import pair
from acutance.targets.pair.gaussian_fit import GaussianFit
from acutance.targets.pair.grid import pair_grid
from acutance.targets.pair.noise import HighNoise
from acutance.targets.pair.register import register


class TestTruth:
    @pytest.mark.parametrize(
        ("system", "ratio"),
        [("smeared", 2.0), ("halo", 3.0), ("asymmetric", 2.5), ("sharpened", 3.0),
         ("diffraction", 3.0)],
    )  # fmt: skip
    def test_mtf_at_nyquist(self, system: str, ratio: float) -> None:
        m = measured(system, ratio)
        _, _, truth = rendered(system, ratio)
        true = np.array([truth.response(axis).mtf_nyquist.value for axis in ("across", "along")])
        value, std = both(m)
        assert np.abs(value - true).max() < (2 if system == "sharpened" else 1.4) * NYQUIST
        assert np.all(np.abs(value - true) < 3.5 * std)
        # How far kernels follow a shape is a share of its departure from a Gaussian.
        assert np.all(std < (1.6 if system == "sharpened" else 1.2) * NYQUIST)

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
        low, high, truth = rendered(shape=SMALL)
        m = ac.measure_biresolution(low, high)
        half, nothing = np.array([0.5]), np.zeros(1)
        true = float(np.abs(truth.ratio_otf(half, nothing))[0])
        assert abs(m.across.mtf_nyquist.value - true) < 3.5 * m.across.mtf_nyquist.std
        assert not m.reference_known
        assert "reference_mtf" in {check.name for check in m.failed_checks}
        assert m.to_dict()["quantity"] == "mtf_low_over_mtf_high"

    def test_trail_shows_in_the_phase(self) -> None:
        """With the sign of the truth: in the curve, in the slices, and in the LSF."""
        m, true = measured("trail"), rendered("trail")[2].response("along")
        at = int(np.searchsorted(true.mtf.freq_cpp, 0.4))
        phase = true.mtf.phase_rad[at]
        assert abs(phase) > 0.2
        assert m.along.mtf.phase_rad[at] == pytest.approx(phase, abs=0.06)
        assert abs(m.across.mtf.phase_rad[at]) < 0.06
        slices = m.slices.otf.reshape(m.slices.normal_deg.size, -1)
        assert np.sign(slices[2, 7].imag) == np.sign(phase)
        leaning = [
            one.half_extent_bright_px.value - one.half_extent_dark_px.value
            for one in (m.along, true)
        ]
        assert leaning[0] == pytest.approx(leaning[1], abs=0.1)
        assert abs(leaning[1]) > 0.2

    def test_axes_have_their_own_curves(self) -> None:
        truth = rendered("trail")[2]
        true = [truth.response(axis).mtf_nyquist.value for axis in ("across", "along")]
        assert true[0] - true[1] > 5 * NYQUIST
        assert both(measured("trail"))[0] == pytest.approx(true, abs=1.5 * NYQUIST)

    @pytest.mark.parametrize("shift", [(2.0, 2.0), (-5.4, 3.7)])
    def test_large_errors_of_registration(self, shift: tuple[float, float]) -> None:
        low, high, truth = rendered("gaussian", 2.0, 3, SMALL, shift)
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

    def test_the_largest_shift_that_can_be_asked_for_is_looked_at(self) -> None:
        """Half a tile of 96 px; more was accepted, and nothing done with it."""
        options = ac.BiresolutionOptions(max_shift_px=48)
        with pytest.raises(ac.OptionError, match="0 to 48"):
            ac.BiresolutionOptions(max_shift_px=49)
        image = np.random.default_rng(1).standard_normal((98, 100))
        assert register(image, image, options.max_shift_px).reach_px == 48

    def test_images_further_apart_than_was_looked_at(self) -> None:
        low, high, _ = rendered("gaussian", 2.0, 3, (96, 96), (0.0, 0.0))
        low, high = low[:, :70], high[:, 52:]
        with pytest.raises(ac.TargetError, match="than the 8 low pixels looked at, look further"):
            ac.measure_biresolution(low, high, ratio=2)
        options = ac.BiresolutionOptions(max_shift_px=48)
        with pytest.raises(ac.TargetError, match=r"looked at, choose a larger region"):
            ac.measure_biresolution(low[:, :30], high[:, -60:], ratio=2, options=options)

    def test_spectral_ratio_agrees(self) -> None:
        m = measured(method="spectral-ratio")
        _, _, truth = rendered()
        value, std = both(m)
        assert np.all(np.abs(value - truth.response().mtf_nyquist.value) < 3.5 * std)
        fitted = both(measured())
        assert np.all(std > fitted[1] * 0.8), "the pixels determine more than the spectra"

    def test_spectral_ratio_is_not_high(self) -> None:
        """The mean over systems: frequencies chosen by their own coherence made it 0.02 high."""
        errors = []
        for seed, system in enumerate(("gaussian", "smeared", "sharpened", "wide")):
            low, high, truth = rendered(system, 2.0, seed + 400, (80, 80))
            m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE, method="spectral-ratio")
            true = [truth.response(axis).mtf_nyquist.value for axis in ("across", "along")]
            errors.append(both(m)[0] - true)
        assert abs(np.mean(errors)) < 0.012

    def test_aliasing_does_no_harm(self) -> None:
        """A low sensor sharp enough to alias strongly: the spectrum of its image is no help."""
        sharp = ac.Sensor([ac.optics.Gaussian(0.15), ac.optics.Detector(0.8)])
        low, high, truth = ac.simulate.pair(
            sharp, REFERENCE, ratio=4, shape=(64, 64), snr=200, rng=np.random.default_rng(8)
        )
        m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE)
        assert truth.response().mtf_nyquist.value > 0.6
        value, std = both(m)
        assert np.all(
            np.abs(value - truth.response().mtf_nyquist.value) < np.maximum(3.5 * std, 0.02)
        )


class TestProducts:
    """Both images interpolated onto a map from native grids turned by 18 degrees."""

    def test_mean_transfer_of_the_product(self) -> None:
        sensor = ac.Sensor([ac.optics.Gaussian(0.25), ac.optics.Detector(1.0)])
        errors = []
        for seed in (50, 51, 52):
            low, high, truth = ac.simulate.pair(
                sensor, REFERENCE, shape=(120, 120), shift_px=(0.6, -0.3), gain=1.2, snr=100,
                native=NativeGrid(), rng=np.random.default_rng(seed),
            )  # fmt: skip
            m = ac.measure_biresolution(low, high, reference_mtf=truth.reference)
            true = [truth.response(axis).mtf_nyquist.value for axis in ("across", "along")]
            assert max(true) < 0.65 * sensor.response().mtf_nyquist.value
            errors.append(both(m)[0] - true)
        # Without functions for the interpolation the kernel is too smooth: 0.010 to 0.016 here.
        assert abs(np.mean(errors)) < 0.006


class TestDeviations:
    def test_they_are_those_of_the_errors(self) -> None:
        """Fixed scenes, whose errors are .98 of the stated deviations.

        Deviations 0.8 or 1.25 times as large leave the bounds.
        """
        z = []
        for system in ("gaussian", "smeared", "trail"):
            for seed in range(10, 15):
                low, high, truth = rendered(system, 2.0, seed, (52, 52), (0.4, -1.7))
                m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE)
                for axis in ("across", "along"):
                    found, true = getattr(m, axis), truth.response(axis)
                    for freq in (0.25, 0.35, 0.5):
                        one = found.mtf(freq)
                        z.append((one.value - true.mtf(freq).value) / one.std)
        assert np.mean(np.abs(z) < 1.96) >= 0.9
        assert 0.86 < np.sqrt(np.mean(np.square(z))) < 1.13


class TestFamilies:
    def test_halo_in_a_small_region(self) -> None:
        """Taps of 4.5 px leave it out: M(.25) is then .015 too low, four deviations."""
        z = []
        for seed in range(4):
            rng = np.random.default_rng((5, seed))
            halo = ac.Sensor(
                [ac.optics.Gaussian(0.4), ac.optics.Halo(0.12, 3.0), ac.optics.Detector(1.0)]
            )
            low, high, truth = ac.simulate.pair(
                halo, REFERENCE, shape=(54, 54), shift_px=(0.4, -1.7), snr=100, rng=rng
            )
            m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE)
            for axis in ("across", "along"):
                one = getattr(m, axis).mtf(0.25)
                z.append((one.value - truth.response(axis).mtf(0.25).value) / one.std)
        assert abs(np.mean(z)) < 1.0

    def test_budget_adds_up(self) -> None:
        m = measured("halo", 3.0)
        rows = [row for row in m.budget if row.direction == "across"]
        assert [row.name for row in rows] == [
            "fit", "reference_noise", "light_from_beyond", "kernel_shape", "reference_mtf",
        ]  # fmt: skip
        assert sum(row.share["rer"] for row in rows) == pytest.approx(1.0)
        assert np.hypot.reduce([row.std["mtf_nyquist"] for row in rows]) == pytest.approx(
            m.across.mtf_nyquist.std, rel=1e-3
        )

    def test_quiet_pairs_allow_for_what_the_basis_cannot_follow(self) -> None:
        """Without the allowance for the kernel's shape, errors are 3 of their deviations."""
        taps = (-0.08, 0.16, -0.32, 0.7, -1.56, 3.2, -1.56, 0.7, -0.32, 0.16, -0.08)
        kernel = ac.optics.Sharpening(tuple(map(tuple, np.outer(taps, taps).tolist())))
        pixel = ac.optics.Detector()
        z, rng = [], np.random.default_rng(21)
        for blocks in (
            [ac.optics.Diffraction(1.45, 0.4), ac.optics.Gaussian(0.35)],
            [ac.optics.Gaussian(0.5), ac.optics.Halo(0.05, 4.0)],
            [ac.optics.Gaussian(0.6), kernel],
        ):
            low, high, truth = ac.simulate.pair(
                ac.Sensor([*blocks, pixel]), REFERENCE, shape=(96, 96), shift_px=(0.4, -0.7),
                snr=400, rng=rng,
            )  # fmt: skip
            m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE)
            for axis in ("across", "along"):
                found, true = getattr(m, axis), truth.response(axis)
                numbers = [(found.mtf(f), true.mtf(f).value) for f in (0.1, 0.25, 0.5)]
                z += [(one.value - wanted) / one.std for one, wanted in numbers]
        assert np.sqrt(np.mean(np.square(z))) < 1.6

    def test_texture_is_not_all_noise(self) -> None:
        """Sixth differences alone give 6.4 for a noise of 2.5."""
        _, high, _ = rendered("gaussian", 2.0, 3, (96, 96), snr=400.0)
        found = HighNoise.of_samples(high)
        assert found.std < 5.5
        assert abs(found.power - 2.5**2 * 1.0) < 2.0 * found.power_std


class TestInvariances:
    def test_gain_and_offset(self) -> None:
        low, high, _ = rendered(shape=SMALL)
        m = ac.measure_biresolution(0.01 * low - 5, 3 * high + 1000, reference_mtf=REFERENCE)
        assert m.across.mtf_nyquist.value == pytest.approx(
            measured(shape=SMALL).across.mtf_nyquist.value, abs=1e-5
        )

    def test_flip(self) -> None:
        low, high, _ = rendered(shape=SMALL)
        m = ac.measure_biresolution(low[:, ::-1], high[:, ::-1], reference_mtf=REFERENCE)
        expected = measured(shape=SMALL)
        assert m.shift_px[1].value == pytest.approx(-expected.shift_px[1].value, abs=2e-3)
        assert both(m)[0] == pytest.approx(both(expected)[0], abs=2.5e-3)


class TestRealTrouble:
    def test_clouds_are_left_out(self) -> None:
        low, high, truth = rendered()
        rows, cols = np.indices(low.shape)
        cloudy = np.where(np.hypot(rows - 30, cols - 70) < 12, 2500.0, low)
        m = ac.measure_biresolution(cloudy, high, reference_mtf=REFERENCE)
        value, std = both(m)
        assert m.left_out > 350
        assert np.all(
            np.abs(value - truth.response().mtf_nyquist.value) < np.maximum(3.5 * std, 0.01)
        )
        assert m.details is not None
        residuals = m.details.residuals
        assert np.isnan(residuals.values[30 - m.image.roi[0], 70 - m.image.roi[1]])

    @pytest.mark.parametrize("texture", [0.0, 1.0])
    def test_cloud_over_half_the_scene(self, texture: float) -> None:
        """As much of the scene as there is ground: no median separates the two."""
        low, high, truth = rendered("smeared", 2.0, 4, (112, 112))
        other, _, _ = rendered("smeared", 2.0, 79, (112, 112))
        noisy = 3000 + 10 * noise(low.shape) + texture * other
        cloudy = np.where(np.arange(112) < 56, noisy, low)
        m = ac.measure_biresolution(cloudy, high, reference_mtf=REFERENCE)
        value, std = both(m)
        assert m.left_out > (0.35 if texture else 0.15) * low.size
        assert np.all(np.abs(value - truth.response().mtf_nyquist.value) < 2.5 * std)
        assert np.all(std < 0.03)
        assert {"left_out", "residual_correlation"} & {check.name for check in m.failed_checks}

    def test_clipped_below_the_end_of_the_scale(self) -> None:
        low, high, _ = rendered(shape=SMALL)
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
        assert m.used < 0.95 * measured().used
        assert np.all(
            np.abs(value - truth.response().mtf_nyquist.value) < np.maximum(3.5 * std, 0.01)
        )

    def test_another_band_widens_the_intervals(self) -> None:
        low, high, _ = rendered()
        other, _, _ = rendered("smeared", 2.0, 77)
        m = ac.measure_biresolution(low + 0.15 * other, high, reference_mtf=REFERENCE)
        value, std = both(m)
        assert np.all(std > 1.05 * both(measured())[1])
        # Other ground is no blur: it changes the coarse frequencies most.
        for found, plain in ((m.across, measured().across), (m.along, measured().along)):
            assert found.mtf(0.25).std > 2.5 * plain.mtf(0.25).std
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
        low, high, _ = rendered("smeared", 2.0, 5, (100, 190))
        options = ac.BiresolutionOptions(max_pixels=9216)
        m = ac.measure_biresolution(low, high, reference_mtf=REFERENCE, options=options)
        assert m.share_read == pytest.approx(0.5, abs=0.01)
        assert m.used <= 9216
        assert np.isnan(m.local.residual).any()


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
        assert m.image.pixel_gsd_m == pytest.approx((20.0, 20.0))

    @pytest.mark.parametrize("west", [-180.0002, 179.9998])
    def test_images_on_two_turns_of_the_earth(self, west: float) -> None:
        low, high = ac.Image.from_array(np.ones((20, 40))), ac.Image.from_array(np.ones((80, 80)))
        degrees = "EPSG:4326"
        coarse = Geolocation((2e-5, 0.0, west, 0.0, -2e-5, 10.0), degrees)
        fine = Geolocation((1e-5, 0.0, 179.9998, 0.0, -1e-5, 10.0), degrees)
        grid = pair_grid(replace(low, geolocation=coarse), replace(high, geolocation=fine), None)
        assert (grid.down.origin, grid.across.origin) == pytest.approx((0.5, 0.5), abs=1e-6)

    def test_fraction_of_a_pixel_in_the_geotransform(self) -> None:
        m = ac.measure_biresolution(*self.georeferenced(7.0), reference_mtf=REFERENCE)
        assert m.shift_px[1].value == pytest.approx(-0.6 + 7 / 20, abs=0.02)
        assert both(m)[0] == pytest.approx(both(measured())[0], abs=0.01)

    def test_ratio_in_contradiction(self) -> None:
        with pytest.raises(ac.AcutanceError, match="geotransforms have 2"):
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
    def test_fit_that_leaves_the_samples(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Its page has no kernel to draw, and its curves no meaning."""
        fitted = pair.fit_gaussian

        def drifted(*given: Any, **options: Any) -> GaussianFit:
            found = fitted(*given, **options)
            return replace(found, across=replace(found.across, shift_px=21.1))

        monkeypatch.setattr(pair, "fit_gaussian", drifted)
        low, high, _ = rendered(shape=SMALL)
        with pytest.raises(ac.TargetError, match=r"moved the low image by 21\.1 pixels"):
            ac.measure_biresolution(low, high)

    @pytest.mark.parametrize(
        ("low", "high", "options", "message"),
        [
            (noise((80, 80)), noise((150, 190)), {}, "low image of 80 x 80 .* ratios of 1.88"),
            (noise((80, 80)), noise((160, 160)), {"ratio": 3}, "cut both to the same ground"),
            (noise((80, 80)), noise((160, 160)), {"ratio": 0.5}, "ratio of 0.5"),
            (noise((80, 80)), noise((160, 160)), {"ratio": np.nan}, "ratio of nan"),
            (noise((160, 160)), noise((80, 80)), {}, "low image of 160 x 160.*exchanged"),
            (np.full((80, 80), 7.0), noise((160, 160)), {}, "nothing in common|no structure"),
            (noise((80, 80)), np.full((160, 160), 7.0), {}, "no structure"),
            (np.full((80, 80), np.nan), noise((160, 160)), {}, "low image holds no data .*--nod"),
            (noise((80, 80)), np.full((160, 160), np.nan), {}, "high image holds no data .*--h"),
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
        low, _, _ = rendered(shape=SMALL)
        _, high, _ = rendered("smeared", 2.0, 78, SMALL)
        try:
            m = ac.measure_biresolution(low, high)
        except ac.TargetError:
            return
        assert "correlation" in {check.name for check in m.failed_checks}

    def test_negative(self) -> None:
        low, high, _ = rendered(shape=SMALL)
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


def test_stopping_threshold() -> None:
    low, high, _ = rendered(shape=SMALL)
    loose = ac.measure_biresolution(low, high, options=ac.BiresolutionOptions(stop_change=0.2))
    assert len(loose.steps) < len(measured(shape=SMALL).steps)
    assert loose.steps[-1].change < 0.2
    few = ac.BiresolutionOptions(max_steps=2)
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
        PairGround(fields=0, texture=0.0)
