"""What holds for every published method: symmetry, details, refusals, standard deviations."""

import math
from functools import cache

import numpy as np
import pytest
from closed_form_edge import edge_band, gaussian_pixel_esf, gaussian_pixel_mtf

from acutance.errors import NoEdgeError, OptionError, PhaseError, SupportError
from acutance.geometry.line import Line
from acutance.targets.straight.pixels import EdgePixels
from acutance.targets.straight.published import (
    PUBLISHED,
    FermiOptions,
    Iso12233Options,
    KompsatOptions,
    SdsuOptions,
    SdsuPulseOptions,
)

METHODS = sorted(PUBLISHED)
# The root mean square over 24 images of deviations from 20 draws each scatters by 3 %.
ROW_BOOTSTRAP = {
    "sdsu-2005": SdsuOptions(distance="normal", replicates=20),
    "kompsat-2014": KompsatOptions(replicates=20),
    "iso12233": Iso12233Options(replicates=20),
}
VALUES_ALONE = {
    "sdsu-2005": SdsuOptions(replicates=0),
    "kompsat-2014": KompsatOptions(replicates=0),
    "iso12233": Iso12233Options(replicates=0),
    "fermi": FermiOptions(),
}


def measured(method, trimmed):
    """The band by a method, without draws for its deviations."""
    return PUBLISHED[method](trimmed, VALUES_ALONE[method])


def skewed(s):
    return 0.7 * gaussian_pixel_esf(s + 0.2) + 0.3 * gaussian_pixel_esf(s - 0.6, 0.5)


def turned(trimmed, *, transpose=False, mirror_cols=False, mirror_rows=False, negative=False):
    """The same band in another position; the line goes with it."""
    image, line = trimmed.image, trimmed.line
    x, y = line.normal
    row, col = line.row, line.col
    if transpose:
        image, row, col, x, y = image.T, col, row, y, x
    if mirror_cols:
        image, col, x = image[:, ::-1], image.shape[1] - 1 - col, -x
    if mirror_rows:
        image, row, y = image[::-1], image.shape[0] - 1 - row, -y
    if negative:
        image, x, y = 1400.0 - image, -x, -y
    normal_deg = math.degrees(math.atan2(y, x))
    return EdgePixels(
        np.ascontiguousarray(image),
        Line(row, col, normal_deg),
        200.0,
        1200.0,
        0.5,
        trimmed.noise,
    )


POSITIONS = [
    {"transpose": True},
    {"mirror_cols": True},
    {"mirror_rows": True},
    {"negative": True},
    {"transpose": True, "mirror_rows": True, "mirror_cols": True},
]


@cache
def upright_band(snr):
    """A skewed band as it is drawn, and what every method measures there."""
    noise = np.random.default_rng(4) if snr else None
    trimmed = edge_band(skewed, angle_deg=7.0, snr=snr, rng=noise)
    return trimmed, {method: measured(method, trimmed) for method in METHODS}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("position", POSITIONS, ids=lambda p: "+".join(p))
def test_position_of_the_image_does_not_matter(method, position):
    trimmed, found = upright_band(300)
    upright, other = found[method], measured(method, turned(trimmed, **position))
    # A transposition changes nothing; a mirror moves which end of a half-open bin a pixel
    # falls into and which rows make whole phase cycles.
    exact = set(position) == {"transpose"}
    tolerance = 1e-9 if exact else 0.02
    np.testing.assert_allclose(
        other.response.mtf.value[:51], upright.response.mtf.value[:51], atol=tolerance
    )
    assert other.line.angle_deg == pytest.approx(upright.line.angle_deg, abs=5e-3)


@pytest.mark.parametrize("method", ["fermi", "kompsat-2014", "sdsu-2005"])
@pytest.mark.parametrize("position", POSITIONS, ids=lambda p: "+".join(p))
def test_methods_without_bins_do_not_feel_a_mirror(method, position):
    trimmed, found = upright_band(None)
    upright = found[method].response.mtf.value
    other = measured(method, turned(trimmed, **position)).response.mtf.value
    np.testing.assert_allclose(other[:51], upright[:51], atol=2e-3)


@pytest.mark.parametrize("method", METHODS)
def test_gain_and_offset_do_not_matter(method):
    trimmed = edge_band(snr=100, rng=np.random.default_rng(8))
    other = EdgePixels(
        trimmed.image * 0.3 - 40, trimmed.line, 20.0, 320.0, 0.5, trimmed.noise * 0.3
    )
    first, second = measured(method, trimmed), measured(method, other)
    np.testing.assert_allclose(second.response.mtf.value, first.response.mtf.value, atol=2e-5)


@pytest.mark.parametrize("method", METHODS)
def test_evidence_agrees_with_the_curves(method):
    trimmed = edge_band(angle_deg=5.0, snr=200, rng=np.random.default_rng(6))
    untouched = trimmed.image.copy()
    fit = PUBLISHED[method](trimmed)
    np.testing.assert_array_equal(trimmed.image, untouched)
    assert fit.distance_px.shape == fit.value.shape == fit.residual.shape == (60 * 40,)
    row, col = np.mgrid[:60, :40]
    np.testing.assert_allclose(fit.distance_px, fit.line.normal_distance(row, col).ravel())
    assert np.std(fit.residual) < 2.5 / 200
    assert fit.dark == pytest.approx(200, abs=12)
    assert fit.bright == pytest.approx(1200, abs=12)
    assert fit.response.esf(0.0).value == pytest.approx(0.5, abs=2e-3)
    assert fit.response.mtf.otf[0] == 1
    assert fit.response.lsf.value.sum() * 0.05 == pytest.approx(1.0, abs=0.02)
    assert fit.line.length_px == pytest.approx(60, abs=5)
    assert abs(fit.line.angle_deg - 5.0) < 5 * fit.line.angle_std_deg


@pytest.mark.parametrize("method", METHODS)
def test_the_lsf_stands_where_the_esf_rises(method):
    response = measured(method, edge_band(shape=(200, 60))).response
    centroid = response.lsf.value @ response.lsf.distance_px / response.lsf.value.sum()
    assert abs(centroid) < 0.008
    np.testing.assert_allclose(response.mtf.phase_rad[:51], 0.0, atol=0.01)


@pytest.mark.parametrize("method", METHODS)
def test_curves_share_their_latent_variables(method):
    response = PUBLISHED[method](edge_band(snr=100, rng=np.random.default_rng(9))).response
    k = response.mtf.factor.shape[1]
    assert response.esf.factor.shape[1] == response.lsf.factor.shape[1] == k
    slope = np.gradient(response.esf.factor, 0.05, axis=0)
    between = slice(80, 121)
    agreement = np.sum(slope[between] * response.lsf.factor[between]) / (
        np.linalg.norm(slope[between]) * np.linalg.norm(response.lsf.factor[between])
    )
    # Apart from what each pipeline smooths between the two; independent ones would give 0.
    assert agreement > 0.6


@pytest.mark.parametrize("method", METHODS)
def test_the_same_band_gives_the_same_answer(method):
    trimmed = edge_band(snr=100, rng=np.random.default_rng(10))
    first, second = PUBLISHED[method](trimmed), PUBLISHED[method](trimmed)
    np.testing.assert_array_equal(first.response.mtf.std, second.response.mtf.std)
    np.testing.assert_array_equal(first.response.mtf.value, second.response.mtf.value)


@pytest.mark.parametrize("method", METHODS)
def test_unusable_pixels_are_left_out(method):
    rng = np.random.default_rng(12)
    trimmed = edge_band(snr=200, rng=rng)
    image = trimmed.image.copy()
    image[7] = np.nan
    image[20:23, 15:25] = np.nan
    image[rng.uniform(size=image.shape) < 0.01] = np.nan
    distance = trimmed.line.normal_distance(*np.mgrid[:60, :40])
    image[np.abs(distance) > 12] = np.nan
    holed = EdgePixels(image, trimmed.line, trimmed.dark, trimmed.bright, 0.5, trimmed.noise)
    fit = measured(method, holed)
    assert fit.distance_px.size == np.isfinite(image).sum()
    assert np.isfinite(fit.residual).all()
    truth = gaussian_pixel_mtf(0.25)
    assert fit.response.mtf(0.25).value == pytest.approx(truth, rel=0.04)


@pytest.mark.parametrize("method", METHODS)
def test_an_edge_that_leaves_the_band_keeps_its_other_rows(method):
    trimmed = edge_band(angle_deg=25.0, shape=(120, 30), snr=200, rng=np.random.default_rng(13))
    if method == "sdsu-2005":
        options = SdsuOptions(distance="normal", trim_px=6.0, replicates=0)
        fit = PUBLISHED[method](trimmed, options)
    else:
        fit = measured(method, trimmed)
    assert fit.response.mtf(0.25).value == pytest.approx(gaussian_pixel_mtf(0.25), rel=0.04)
    if method != "fermi":
        assert fit.line.length_px < 75


@pytest.mark.parametrize("method", METHODS)
def test_too_few_rows_are_refused(method):
    with pytest.raises(SupportError, match="at least 10 rows must cross the edge"):
        PUBLISHED[method](edge_band(shape=(8, 40)))


@pytest.mark.parametrize("method", METHODS)
def test_an_edge_along_the_border_is_refused(method):
    with pytest.raises(SupportError, match="found 0 of 60"):
        PUBLISHED[method](edge_band(angle_deg=2.0, offset_px=-20.0))


@pytest.mark.parametrize("method", sorted(ROW_BOOTSTRAP))
@pytest.mark.parametrize(
    ("angle_deg", "advice"),
    [(0.2, r"use a region of \d+ rows"), (math.degrees(math.atan(0.5)), "another angle")],
)
def test_missing_phases_are_refused_with_advice(method, angle_deg, advice):
    with pytest.raises(PhaseError, match=advice):
        PUBLISHED[method](edge_band(angle_deg=angle_deg, shape=(40, 60)))


@pytest.mark.parametrize("method", METHODS)
def test_a_flat_image_holds_no_edge(method):
    trimmed = edge_band()
    flat = EdgePixels(np.full((60, 40), 300.0), trimmed.line, 300.0, 300.0, 0.5, 0.0)
    with pytest.raises((NoEdgeError, SupportError)):
        PUBLISHED[method](flat)


@pytest.mark.parametrize("method", sorted(ROW_BOOTSTRAP))
def test_stated_deviation_is_the_scatter_of_new_images(method):
    rng = np.random.default_rng(15)
    found = [
        PUBLISHED[method](edge_band(snr=80, rng=rng), ROW_BOOTSTRAP[method]).response
        for _ in range(24)
    ]
    for name in ("mtf_nyquist", "rer"):
        estimates = [getattr(response, name) for response in found]
        scatter = np.std([estimate.value for estimate in estimates], ddof=1)
        stated = math.sqrt(np.mean([estimate.std**2 for estimate in estimates]))
        assert 0.6 < stated / scatter < 2.2


@pytest.mark.parametrize("method", sorted(ROW_BOOTSTRAP))
def test_no_draws_give_curves_without_deviations(method):
    options = type(ROW_BOOTSTRAP[method])(replicates=0)
    response = PUBLISHED[method](edge_band(), options).response
    assert response.mtf.factor.shape == (101, 0)
    assert response.mtf_nyquist.std == 0


@pytest.mark.parametrize("kind", [SdsuOptions, KompsatOptions, Iso12233Options, SdsuPulseOptions])
@pytest.mark.parametrize("name", ["replicates", "seed"])
def test_no_draws_below_zero(kind, name):
    with pytest.raises(OptionError, match=f"{name} must be 0 or more, found -1"):
        kind(**{name: -1})
