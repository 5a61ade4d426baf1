"""Every OTF block against its closed form, or against the physics it is made of."""

import math

import numpy as np
import pytest
from scipy.integrate import simpson
from scipy.special import j0

from acutance.errors import ModelError
from acutance.optics import (
    Aberrations,
    Aerosol,
    Butterworth,
    ChargeDiffusion,
    Defocus,
    Detector,
    Diffraction,
    Exponential,
    ExponentialHalo,
    Gaussian,
    Halo,
    Jitter,
    Moffat,
    Resampling,
    Rescaled,
    Sensor,
    Sharpening,
    Shift,
    Smear,
    Tdi,
    TransferLoss,
    Turbulence,
    WavefrontError,
)
from acutance.optics.interpolation import KERNEL_REACH_PX, interpolation_weight

BLOCKS = [
    Aberrations(1.2, 0.3, coma_across_waves=0.08, astigmatism_waves=0.05),
    Aerosol(0.3, 0.1),
    Butterworth(1.4),
    ChargeDiffusion(0.3),
    ChargeDiffusion(0.3, 2.0),
    Defocus(0.7, 1.2),
    Defocus(0.7, 1.2, 0.35),
    Detector(0.9, 1.1),
    Diffraction(1.2),
    Diffraction(1.2, 0.35),
    Exponential(0.4, "across"),
    Exponential(0.4, "along"),
    ExponentialHalo(0.1, 2.0),
    Gaussian(0.4, 0.6),
    Halo(0.1, 2.5),
    Jitter(0.2),
    Moffat(0.6),
    Moffat(0.6, 1.5),
    Resampling("nearest"),
    Resampling("bilinear"),
    Resampling("cubic", -0.75),
    Resampling("spline"),
    Resampling("lanczos"),
    Rescaled(Gaussian(0.4), 1.3),
    Sharpening.both_axes(0.2),
    Sharpening(((0.0, -0.1, -0.2),)),
    Shift(0.25, 0.6),
    Shift(0.25, 0.6, "spline"),
    Smear(1.2),
    Tdi(48, 0.02, 0.01),
    TransferLoss(0.2),
    TransferLoss(0.2, "across"),
    Turbulence(4.0),
    WavefrontError(0.07, 0.2, 1.2),
]


@pytest.mark.parametrize("block", BLOCKS, ids=repr)
class TestEveryBlock:
    def test_is_one_at_zero_frequency(self, block):
        assert block.otf(np.zeros(1), np.zeros(1)) == pytest.approx(1.0, abs=1e-12)

    def test_belongs_to_a_real_point_spread_function(self, block):
        u, v = np.array([0.13, 0.4, -0.7]), np.array([0.2, -0.31, 0.05])
        np.testing.assert_allclose(block.otf(-u, -v), np.conj(block.otf(u, v)), atol=1e-14)

    def test_broadcasts_rows_against_columns(self, block):
        u, v = np.linspace(-1, 1, 7), np.linspace(0, 1, 5)[:, None]
        grid = block.otf(u, v)
        assert grid.shape == (5, 7)
        assert grid[3, 2] == pytest.approx(complex(block.otf(u[2:3], v[3])[0]), abs=1e-14)

    def test_broadcasts_columns_against_rows(self, block):
        u, v = np.linspace(-1, 1, 7), np.linspace(0, 1, 5)
        transposed = block.otf(u[:, None], v)
        assert transposed.shape == (7, 5)
        np.testing.assert_allclose(transposed, block.otf(u, v[:, None]).T, atol=1e-14)

    def test_gives_one_number_for_one_frequency(self, block):
        found = block.otf(np.float64(0.3), np.float64(0.2))
        assert np.shape(found) == ()
        assert complex(found) == pytest.approx(
            complex(block.otf(np.array([0.3]), np.array([0.2]))[0])
        )

    def test_compares_and_hashes_by_value(self, block):
        assert hash(block) == hash(type(block)(**vars(block)))


def transform(function, f, low, high, pieces=40):
    """Fourier transform of a function of one variable by piecewise Gauss-Legendre quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    ends = np.linspace(low, high, pieces + 1)
    half = np.diff(ends)[:, None] / 2
    x = (ends[:-1, None] + half + half * nodes).ravel()
    mass = (half * weights).ravel() * function(x)
    return np.exp(-2j * math.pi * np.multiply.outer(f, x)) @ mass


def pupil_autocorrelation(nu, obscuration=0.0, waves=0.0):
    """OTF of an annular pupil by counting points of a fine grid, unit outer radius."""
    x = np.linspace(-1, 1, 1501)[:, None] + nu
    y = np.linspace(-1, 1, 1001)[None, :]

    def pupil(shift):
        r2 = (x + shift) ** 2 + y**2
        return np.where((r2 <= 1) & (r2 >= obscuration**2), np.exp(2j * math.pi * waves * r2), 0)

    def total(shift):
        return np.sum(pupil(-nu + shift) * np.conj(pupil(-nu - shift)))

    return (total(nu) / total(0.0)).real


F = np.array([0.05, 0.2, 0.5, 0.9])
ZERO = np.zeros(4)


def test_gaussian_has_its_own_width_along_each_axis():
    block = Gaussian(0.4, 0.7)
    np.testing.assert_allclose(block.otf(F, ZERO), np.exp(-2 * (math.pi * 0.4 * F) ** 2))
    np.testing.assert_allclose(block.otf(ZERO, F), np.exp(-2 * (math.pi * 0.7 * F) ** 2))


def test_jitter_is_a_round_gaussian():
    np.testing.assert_allclose(Jitter(0.3).otf(F, 2 * F), Gaussian(0.3).otf(F, 2 * F))


def test_detector_is_zero_at_its_inverse_width():
    assert Detector(0.8, 1.25).otf(np.array([1.25]), ZERO[:1]) == pytest.approx(0, abs=1e-15)
    assert Detector(0.8, 1.25).otf(ZERO[:1], np.array([0.8])) == pytest.approx(0, abs=1e-15)
    assert Detector().otf(np.array([0.5]), ZERO[:1]) == pytest.approx(2 / math.pi)


def test_smear_acts_on_its_axis_only():
    np.testing.assert_allclose(Smear(1.2, "along").otf(F, ZERO), 1.0)
    np.testing.assert_allclose(Smear(1.2, "along").otf(ZERO, F), np.sinc(1.2 * F))
    np.testing.assert_allclose(Smear(1.2, "across").otf(F, ZERO), np.sinc(1.2 * F))


def test_butterworth_halves_at_its_cutoff_in_any_direction():
    assert Butterworth(1.4).otf(np.array([1.4]), ZERO[:1]) == pytest.approx(0.5)
    assert Butterworth(1.4).otf(np.array([1.4 * 0.6]), np.array([1.4 * 0.8])) == pytest.approx(0.5)


def test_exponential_is_the_transform_of_a_trail_towards_higher_columns():
    def trail(x):
        return np.exp(-x / 0.4) / 0.4

    expected = transform(trail, F, 0.0, 16.0)
    np.testing.assert_allclose(Exponential(0.4).otf(F, ZERO), expected, atol=1e-12)


def test_halo_keeps_the_core():
    assert Halo(0.12, 2.5).otf(np.array([0.5]), ZERO[:1]) == pytest.approx(0.88, abs=1e-12)
    low = Halo(0.12, 2.5).otf(np.array([0.05]), ZERO[:1])
    assert low == pytest.approx(0.88 + 0.12 * math.exp(-2 * (math.pi * 2.5 * 0.05) ** 2))


@pytest.mark.parametrize("decay_px", [0.8, 4.0])
def test_an_exponential_halo_falls_over_its_decay(decay_px):
    r = np.linspace(0.0, 40 * decay_px, 40001)
    light = r * np.exp(-r / decay_px) / decay_px**2
    for freq_cpp in (0.02, 0.1, 0.3):
        expected = 0.9 + 0.1 * simpson(light * j0(2 * math.pi * freq_cpp * r), x=r)
        u, v = np.array([0.6 * freq_cpp]), np.array([0.8 * freq_cpp])
        found = ExponentialHalo(0.1, decay_px).otf(u, v)
        assert found == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("obscuration", [0.0, 0.3, 0.6])
@pytest.mark.parametrize("nu", [0.1, 0.33, 0.5, 0.77])
def test_diffraction_is_the_autocorrelation_of_the_pupil(obscuration, nu):
    found = Diffraction(1.2, obscuration).otf(np.array([1.2 * nu]), ZERO[:1])[0]
    assert found == pytest.approx(pupil_autocorrelation(nu, obscuration), abs=1.5e-3)


def test_diffraction_of_an_open_circle_has_the_classical_form():
    nu = F
    expected = 2 / math.pi * (np.arccos(nu) - nu * np.sqrt(1 - nu**2))
    np.testing.assert_allclose(Diffraction(1.2).otf(1.2 * nu, ZERO), expected, atol=1e-14)
    assert np.all(Diffraction(1.2, 0.3).otf(np.array([1.2, 1.3, 40.0]), np.zeros(3)) == 0)


@pytest.mark.parametrize("nu", [0.1, 0.33, 0.5, 0.77])
def test_defocus_is_the_autocorrelation_of_the_curved_pupil(nu):
    found = Defocus(0.9, 1.2).otf(np.array([1.2 * nu]), ZERO[:1])[0]
    assert found == pytest.approx(pupil_autocorrelation(nu, waves=0.9), abs=1.5e-3)


@pytest.mark.parametrize("obscuration", [0.2, 0.5])
@pytest.mark.parametrize("nu", [0.05, 0.2, 0.35, 0.5, 0.7, 0.9])
def test_defocus_of_an_obscured_pupil_is_its_autocorrelation(nu, obscuration):
    found = Defocus(0.6, 1.2, obscuration).otf(np.array([1.2 * nu]), ZERO[:1])[0]
    assert found == pytest.approx(pupil_autocorrelation(nu, obscuration, waves=0.6), abs=1.5e-3)


@pytest.mark.parametrize("obscuration", [0.0, 0.1, 0.35, 0.8])
def test_an_obscured_pupil_in_focus_is_plain_diffraction(obscuration):
    np.testing.assert_allclose(
        Defocus(0.0, 1.2, obscuration).otf(1.3 * F, ZERO),
        Diffraction(1.2, obscuration).otf(1.3 * F, ZERO),
        atol=1e-10,
    )


def test_a_vanishing_obscuration_leaves_the_open_pupil():
    np.testing.assert_allclose(
        Defocus(0.8, 1.2, 1e-6).otf(F, ZERO), Defocus(0.8, 1.2).otf(F, ZERO), atol=1e-9
    )


def test_one_pupil_is_not_described_twice():
    with pytest.raises(ModelError, match=r"write Defocus\(0.3, 1.3, obscuration=0.35\) alone"):
        Sensor([Diffraction(1.3, 0.35), Defocus(0.3, 1.3)])
    with pytest.raises(ModelError, match=r"2 times.* write Aberrations alone"):
        Sensor([Aberrations(1.3, 0.35), Defocus(0.3, 1.3)])


def test_defocus_of_nothing_is_diffraction_and_a_lot_reverses_contrast():
    np.testing.assert_allclose(
        Defocus(0.0, 1.2).otf(F, ZERO), Diffraction(1.2).otf(F, ZERO), atol=1e-12
    )
    assert Defocus(1.0, 1.2).otf(np.array([0.4]), ZERO[:1])[0] < -0.02


@pytest.mark.parametrize(
    ("waves", "obscuration", "error"),
    [(0.05, 0.0, 2e-5), (0.15, 0.3, 2e-4), (0.15, 0.6, 4e-4), (0.4, 0.9, 2e-3), (1.0, 0.99, 5e-3)],
)
def test_aberrations_hold_defocus(waves, obscuration, error):
    # So many that some lie at the kinks, where rims of pupil and obscuration touch.
    freq_cpp = np.linspace(0.0, 1.3, 2001)
    found = Aberrations(1.2, obscuration, defocus_waves=waves).otf(0.6 * freq_cpp, 0.8 * freq_cpp)
    # A wavefront of W20 r^2 has W20 / (2 sqrt 3) root mean square, without its mean.
    expected = Defocus(2 * math.sqrt(3) * waves, 1.2, obscuration).otf(freq_cpp, 0 * freq_cpp)
    np.testing.assert_allclose(found, expected, atol=error)


def test_coma_is_the_autocorrelation_of_a_pupil_that_is_not_even():
    x, y = np.meshgrid(*2 * [np.linspace(-1, 1, 1601)])
    coma_waves, shift = 0.08, 0.5

    def pupil(x):
        square = x**2 + y**2
        wavefront = coma_waves * math.sqrt(8) * (3 * square - 2) * x
        return (square < 1) * np.exp(2j * math.pi * wavefront)

    expected = np.sum(pupil(x + shift) * np.conj(pupil(x - shift))) / np.sum(x**2 + y**2 < 1)
    found = Aberrations(1.2, coma_across_waves=coma_waves).otf(np.array([1.2 * shift]), ZERO[:1])
    assert abs(found[0].imag) > 0.05
    assert found[0] == pytest.approx(expected, abs=1e-3)
    turned = Aberrations(1.2, coma_along_waves=coma_waves).otf(ZERO[:1], np.array([1.2 * shift]))
    assert turned[0] == pytest.approx(found[0], abs=1e-9)


def test_positive_coma_has_its_tail_towards_lower_columns():
    sensor = Sensor([Aberrations(1.5, coma_across_waves=0.08), Gaussian(0.1)])
    profile = sensor.profile(0.0)
    away_px = np.linspace(1.0, 3.0, 41)
    assert profile.lsf(-away_px).sum() > 5 * profile.lsf(away_px).sum()


def test_aberrations_of_opposite_sign_mirror_the_spread():
    u, v = np.array([0.3, 0.5]), np.array([0.2, -0.1])
    both = Aberrations(1.2, 0.2, coma_across_waves=0.06, coma_along_waves=-0.04)
    opposite = Aberrations(1.2, 0.2, coma_across_waves=-0.06, coma_along_waves=0.04)
    np.testing.assert_allclose(both.otf(u, v), np.conj(opposite.otf(u, v)), atol=1e-9)


def test_wavefront_error_levels_off_at_the_strehl_ratio():
    block = WavefrontError(0.07, 0.2, 1.2)
    assert block.otf(np.array([1.2]), ZERO[:1]) == pytest.approx(
        math.exp(-((2 * math.pi * 0.07) ** 2)), rel=1e-9
    )
    at_correlation = block.otf(np.array([0.24]), ZERO[:1])[0]
    fallen = (2 * math.pi * 0.07) ** 2 * (1 - math.exp(-1))
    assert at_correlation == pytest.approx(math.exp(-fallen))


def test_charge_diffusion_is_one_over_cosh_when_nothing_recombines():
    np.testing.assert_allclose(
        ChargeDiffusion(0.3).otf(F, ZERO), 1 / np.cosh(2 * math.pi * 0.3 * F), rtol=1e-12
    )
    lossy = np.cosh(0.3 / 2) / np.cosh(0.3 * np.sqrt((2 * math.pi * F) ** 2 + 0.25))
    np.testing.assert_allclose(ChargeDiffusion(0.3, 2.0).otf(ZERO, F), lossy, rtol=1e-12)


def test_tdi_is_the_dirichlet_kernel_of_its_stages():
    x = math.pi * 0.05 * F
    np.testing.assert_allclose(
        Tdi(16, drift_across_px=0.05).otf(F, ZERO), np.sin(16 * x) / (16 * np.sin(x)), rtol=1e-10
    )
    np.testing.assert_allclose(Tdi(16, phases=2).otf(ZERO, F), np.sinc(F / 2), rtol=1e-12)


def test_charge_that_is_left_comes_whole_pixels_late():
    late = np.arange(40)
    wanted = np.exp(-2j * math.pi * np.outer(F, late)) @ (0.7 * 0.3**late)
    np.testing.assert_allclose(TransferLoss(0.3).otf(ZERO, F), wanted, atol=1e-12)
    np.testing.assert_allclose(TransferLoss(0.3).otf(F, ZERO), 1.0)
    with pytest.raises(ModelError, match="share"):
        TransferLoss(0.95)


def test_atmosphere():
    assert Turbulence(4.0).otf(np.array([4.0]), ZERO[:1]) == pytest.approx(math.exp(-3.44))
    aerosol = Aerosol(0.3, 0.1).otf(np.array([0.05, 0.1, 0.5]), np.zeros(3))
    np.testing.assert_allclose(aerosol, np.exp([-0.075, -0.3, -0.3]))


@pytest.mark.parametrize("exponent", [1.5, 2.0, 4.765])
def test_moffat_is_the_transform_of_a_power(exponent):
    # Light along a line through the plane falls as (1 + x^2)^(1/2 - b).
    peak = math.gamma(exponent - 0.5) / math.gamma(exponent - 1) / math.sqrt(math.pi) / 0.6
    places = np.linspace(-4, 4, 41)
    found = Sensor([Moffat(0.6, exponent)]).profile(0.0).lsf(places)
    np.testing.assert_allclose(
        found, peak * (1 + (places / 0.6) ** 2) ** (0.5 - exponent), atol=1e-6
    )


def test_moffat_lies_between_an_exponential_and_a_gaussian():
    np.testing.assert_allclose(Moffat(0.3, 1.5).otf(F, ZERO), np.exp(-0.6 * math.pi * np.abs(F)))
    sigma_px = 0.4 / math.sqrt(2 * 20)
    np.testing.assert_allclose(
        Moffat(0.4, 20).otf(F, ZERO), Gaussian(sigma_px).otf(F, ZERO), atol=0.02
    )
    with pytest.raises(ModelError, match=r"exponent is 1\.2, it has to be finite, at least 1\.5"):
        Moffat(0.4, 1.2)


@pytest.mark.parametrize(
    ("kernel", "a"),
    [
        ("nearest", -0.5), ("bilinear", -0.5), ("cubic", -0.5), ("cubic", -1.0), ("spline", -0.5),
        ("lanczos", -0.5),
    ],
)  # fmt: skip
def test_resampling_is_the_transform_of_its_kernel(kernel, a):
    # Pieces end where the kernels have their corners.
    reach = max(KERNEL_REACH_PX[kernel], 2.0)
    pieces = round(8 * reach)
    expected = transform(lambda x: interpolation_weight(kernel, x, a), F, -reach, reach, pieces)
    # A spline reaches on beyond where it is cut.
    tolerance = 1e-7 if kernel == "spline" else 1e-12
    np.testing.assert_allclose(Resampling(kernel, a).otf(F, ZERO), expected.real, atol=tolerance)


@pytest.mark.parametrize("kernel", ["cubic", "lanczos"])
def test_resampling_passes_next_to_nothing_at_high_frequencies(kernel):
    freq_cpp = np.array([5.5, 7.7, 9.2, 12.3, 12.7, 20.4, 64.5, 300.3])
    reach = KERNEL_REACH_PX[kernel]
    expected = transform(lambda x: interpolation_weight(kernel, x), freq_cpp, -reach, reach, 1200)
    found = Resampling(kernel).otf(freq_cpp, np.zeros(8))
    np.testing.assert_allclose(found, expected.real, atol=1e-6)


def test_a_bare_detector_seen_through_lanczos_has_a_smooth_profile():
    profile = Sensor([Detector(), Resampling("lanczos")]).profile(0.0)
    places, step_px = np.linspace(-1.5, 1.5, 301), 0.01
    slope = (profile.esf(places + step_px) - profile.esf(places - step_px)) / (2 * step_px)
    np.testing.assert_allclose(profile.lsf(places), slope, atol=3e-4)


@pytest.mark.parametrize("kernel", ["nearest", "bilinear", "cubic", "spline", "lanczos"])
def test_resampling_is_the_mean_of_all_shifts(kernel):
    shifts = (np.arange(2000) + 0.5) / 2000
    mean = np.mean([Shift(0.0, s, kernel).otf(F, ZERO) for s in shifts], axis=0)
    np.testing.assert_allclose(Resampling(kernel).otf(F, ZERO), mean, atol=1e-6)


def test_shift_by_half_a_pixel():
    assert Shift(0.0, 0.5, "bilinear").otf(np.array([0.5]), ZERO[:1]) == pytest.approx(0, abs=1e-12)
    cubic = Shift(0.0, 0.5, "cubic").otf(F, ZERO)
    expected = 2 * (9 / 16 * np.cos(math.pi * F) - 1 / 16 * np.cos(3 * math.pi * F))
    np.testing.assert_allclose(cubic, expected, atol=1e-12)
    np.testing.assert_allclose(Shift(3.0, -2.0).otf(F, 2 * F), 1.0, atol=1e-12)


def test_sharpening_is_a_sum_of_cosines():
    block = Sharpening(((-0.2, 1.4, -0.2),))
    np.testing.assert_allclose(block.otf(F, F), 1.4 - 0.4 * np.cos(2 * math.pi * F))
    assert block.noise_gain == pytest.approx(math.sqrt(1.4**2 + 2 * 0.04))
    both = Sharpening.both_axes(0.2).otf(F, 2 * F)
    expected = (1.4 - 0.4 * np.cos(2 * math.pi * F)) * (1.4 - 0.4 * np.cos(4 * math.pi * F))
    np.testing.assert_allclose(both, expected)


def test_larger_pixels_see_lower_frequencies():
    np.testing.assert_allclose(
        Rescaled(Gaussian(0.5), 2.0).otf(F, ZERO), Gaussian(0.25).otf(F, ZERO)
    )


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: Gaussian(-0.1), "Gaussian: sigma_px is -0.1"),
        (lambda: Gaussian(math.nan), "finite"),
        (lambda: Halo(1.2, 3.0), "at most 1"),
        (lambda: ExponentialHalo(0.1, -1.0), "ExponentialHalo: decay_px is -1"),
        (lambda: Aberrations(1.2, spherical_waves=2.0), "spherical_waves is 2"),
        (lambda: Diffraction(0.0), "above 0"),
        (lambda: Sharpening(((1.0, -1.0),)), "odd"),
        (lambda: Sharpening(((1.0, -2.0, 1.0),)), "sums to zero"),
        (lambda: Resampling("sinc"), "'sinc'"),
        (lambda: Tdi(0), "stages is 0"),
        (lambda: Tdi(2.5, 0.1), "stages is 2.5, it has to be a whole number"),
        (lambda: Tdi(True), "stages is True"),
        (lambda: Tdi(8, phases=1.5), "phases is 1.5"),
        (lambda: Gaussian("a"), "Gaussian: sigma_px is 'a', it has to be a number"),
        (lambda: Gaussian(True), "sigma_px is True"),
        (lambda: Gaussian(0.4, sigma_along_px={}), "Gaussian: sigma_along_px is {}"),
        (lambda: Gaussian(0.4, -0.1), "Gaussian: sigma_along_px is -0.1"),
        (lambda: Detector(1.0, height_px=False), "Detector: height_px is False"),
        (lambda: Rescaled(3, 2.0), "Rescaled: system is 3, which has no OTF"),
        (lambda: Rescaled(Detector, 2.0), "Rescaled: system is <class .*, which has no OTF"),
        (lambda: Resampling([1, 2]), r"Resampling: kernel is \[1, 2\], it has to be one of"),
        (lambda: Sharpening("a"), "rows of equally many numbers"),
        (lambda: Sharpening(((0.0, 1.0, 0.0), (1.0,))), "rows of equally many numbers"),
    ],
)
def test_meaningless_parameters_are_refused(build, words):
    with pytest.raises(ModelError, match=words):
        build()
