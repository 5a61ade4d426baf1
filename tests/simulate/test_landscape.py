"""Landscapes: every edge where and as the truth has it, and beside it what is listed."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

import acutance as ac
from acutance.errors import ModelError, OptionError
from acutance.raster import Region
from acutance.simulate import (
    LandscapeOptions,
    Noise,
    SoftCorners,
    TiltedFocus,
    landscape,
    landscape_tiles,
    reference_systems,
)
from acutance.simulate.landscape_layout import draw_layout

SYSTEMS = reference_systems()
SHAPE = (600, 600)
EVEN = LandscapeOptions(texture=(0.0, 0.0), slope_per_px=0.0)
BARE = replace(EVEN, rims=0.0, gutters=0.0, shadows=0.0, side_roads=0.0, neighbours=0.0)


def seeded(sensor=SYSTEMS["gaussian"], *, seed=5, **arguments):
    return landscape(sensor, **{"shape": SHAPE, "rng": np.random.default_rng(seed), **arguments})


@pytest.fixture(scope="module")
def even():
    """Without texture and slopes: what is not the edge lies beside it."""
    return seeded(options=replace(EVEN, curved=0.4), shape=(800, 800))


def around(edge, image):
    """Pixels near an edge: where they lie along and across it, and their values."""
    reach = 0.5 * edge.length_px + 45
    top, left = (max(0, int(at - reach)) for at in (edge.ground_line.row, edge.ground_line.col))
    window = image[top : top + int(2 * reach), left : left + int(2 * reach)]
    rows, cols = np.indices(window.shape)
    at, bend = edge.ground_line, edge.curvature_per_px
    s = at.normal_distance(rows + top, cols + left)
    t = at.tangent_distance(rows + top, cols + left)
    if bend:
        # Distance from a circle whose centre lies on the bright side when the bend is above 0.
        s = (1 / abs(bend) - np.hypot(s - 1 / bend, t)) * np.sign(bend)
    return t, s, window


def test_the_ground_around_every_edge_is_as_clean_as_the_truth_says(even):
    image, truth = even
    errors = {"straight": [], "curved": []}
    for edge in truth.edges:
        t, s, values = around(edge, image)
        # A rim that touches the border leaves no clean ground.
        kept = (np.abs(t) < 0.5 * edge.length_px) & (s > 4 - edge.clean_dark_px)
        kept &= s < edge.clean_bright_px - 4
        if min(edge.clean_dark_px, edge.clean_bright_px) < 4 or not kept.any():
            continue
        esf = edge.system.profile(edge.ground_line.normal_deg).esf(s[kept])
        # A faint road beside a bright roof: the roof's light counts.
        strongest = max([1.0, *(abs(one.contrast_share) for one in edge.beside)]) * edge.contrast
        error = np.max(np.abs(values[kept] - edge.dark - edge.contrast * esf)) / strongest
        errors["straight" if edge.curvature_per_px == 0 else "curved"].append(error)
    assert len(errors["straight"]) > 80
    assert len(errors["curved"]) > 5
    # Soft things 4 px farther out still send 1e-6 of their light.
    assert max(errors["straight"]) < 1e-5
    # An arc of 300 px moves inwards by half the variance of the blur over the radius: .0007 px.
    assert max(errors["curved"]) < 1e-3


def test_what_is_listed_is_there(even):
    """The nearest thing begins where it is said to: the ground stops to be clean there."""
    image, truth = even
    seen = {"rim": 0, "gutter": 0, "shadow": 0, "road": 0, "neighbour": 0, "opposite": 0}
    for edge in truth.edges:
        for side, sign in (("dark", -1), ("bright", 1)):
            near = [one for one in edge.beside if one.side == side]
            # Softness aside, something strong enough that stands alone.
            if not near or abs(near[0].contrast_share) < 0.03 or near[0].near_px > 36:
                continue
            first = near[0]
            if any(two.near_px < first.far_px for two in near[1:]) or first.near_px < 3:
                continue
            t, s, values = around(edge, image)
            kept = np.abs(t) < 0.5 * edge.length_px + 2
            kept &= (sign * s > first.near_px) & (sign * s < first.near_px + 3)
            level = edge.dark if side == "dark" else edge.bright
            change = (values[kept] - level) / edge.contrast
            strongest = change[np.argmax(np.abs(change))]
            assert np.sign(strongest) == np.sign(first.contrast_share)
            assert abs(strongest) > 0.2 * min(abs(first.contrast_share), 1.0)
            seen[first.kind] += 1
    assert seen["neighbour"] > 5
    assert seen["opposite"] > 5
    assert seen["road"] > 0
    assert seen["rim"] + seen["gutter"] > 0


@pytest.mark.parametrize("name", ["gaussian", "diffraction", "sharpened", "asymmetric"])
def test_measured_edges_agree_with_the_truth(name):
    """In several shapes of the OTF: z of mean 0 and deviation 1, places to .01 px."""
    options = replace(BARE, curved=0.0, roads=0.0, discs=0.0)
    image, truth = seeded(SYSTEMS[name], seed=3, shape=(450, 450), options=options, snr=200)
    scores, places = [], []
    for edge in truth.edges:
        if edge.length_px < 25 or edge.ground_line.angle_deg < 2:
            continue
        found = ac.measure_edge(image, roi=Region(edge.region(16, clean=True)))
        number = found.mtf_nyquist
        scores.append((number.value - edge.mtf_nyquist.value) / number.std)
        places.append(found.line.normal_distance(edge.line.row, edge.line.col))
    assert len(scores) >= 20
    assert abs(np.mean(scores)) < 0.7
    assert 0.6 < np.std(scores) < 1.4
    assert np.std(places) < 0.008


def test_soft_borders_have_a_lower_mtf_and_the_sensor_keeps_its_own():
    _, truth = seeded(options=replace(BARE, soft=1.0, roofs=0.0))
    edge = next(one for one in truth.edges if one.softness_px > 0.3)
    lower = math.exp(-2 * (math.pi * edge.softness_px * 0.5) ** 2)
    alone = edge.sensor_response.mtf_nyquist.value
    assert edge.mtf_nyquist.value == pytest.approx(lower * alone, abs=1e-9)
    assert edge.sensor == SYSTEMS["gaussian"]


@pytest.mark.parametrize("middle_deg", [90.0, 180.0])
def test_borders_may_be_soft_in_some_directions_only(middle_deg):
    every = replace(BARE, soft=1.0, roofs=0.0)
    _, all_soft = seeded(options=every)
    some = replace(every, soft_normal_deg=(middle_deg - 30, middle_deg + 30))
    _, truth = seeded(options=some)
    soft = []
    for before, edge in zip(all_soft.edges, truth.edges, strict=True):
        off_deg = (edge.ground_line.normal_deg - middle_deg + 90) % 180 - 90
        soft.append(abs(off_deg) <= 30)
        assert edge.softness_px == (before.softness_px if soft[-1] else 0.0)
    assert 0 < sum(soft) < len(soft)


def test_directions_of_soft_borders_that_mean_nothing_are_refused():
    for normals in ((135.0, 400.0), (120.0, 60.0)):
        with pytest.raises(ac.ModelError, match="soft_normal_deg"):
            replace(BARE, soft_normal_deg=normals)


def test_a_field_varies_from_object_to_object():
    field = SoftCorners(SYSTEMS["gaussian"], SHAPE, 0.5)
    image, truth = seeded(field, options=replace(BARE, soft=0.0, curved=0.0))
    middle = (np.array(SHAPE) - 1) / 2
    away = [math.hypot(*(np.array([e.line.row, e.line.col]) - middle)) for e in truth.edges]
    nyquist = [edge.mtf_nyquist.value for edge in truth.edges]
    assert np.corrcoef(away, nyquist)[0, 1] < -0.8
    for edge in (truth.edges[int(np.argmax(away))], truth.edges[int(np.argmin(away))]):
        t, s, values = around(edge, image)
        kept = (np.abs(t) < 0.4 * edge.length_px) & (np.abs(s) < 6)
        esf = edge.system.profile(edge.ground_line.normal_deg).esf(s[kept])
        np.testing.assert_allclose(values[kept], edge.dark + edge.contrast * esf, atol=0.05)
    assert field.at(*middle) == SYSTEMS["gaussian"]
    assert field.at(0.0, 0.0).blocks[-1].sigma_px == pytest.approx(0.5)


def test_a_tilted_focus_blurs_one_side_and_one_direction_more():
    field = TiltedFocus(SYSTEMS["gaussian"], SHAPE, 0.6, 0.2)
    image, truth = seeded(field, options=replace(BARE, soft=0.0, curved=0.0))
    across = [one for one in truth.edges if abs(math.cos(angle(one))) > 0.9]
    along = [one for one in truth.edges if abs(math.sin(angle(one))) > 0.9]
    slopes = [
        np.polyfit([one.line.col for one in group], [float(one.mtf_nyquist) for one in group], 1)[0]
        for group in (across, along)
    ]
    assert slopes[0] < 2 * slopes[1] < 0
    edge = max(across, key=lambda one: one.line.col)
    t, s, values = around(edge, image)
    kept = (np.abs(t) < 0.4 * edge.length_px) & (np.abs(s) < 6)
    esf = edge.system.profile(edge.ground_line.normal_deg).esf(s[kept])
    np.testing.assert_allclose(values[kept], edge.dark + edge.contrast * esf, atol=0.05)


def angle(edge):
    return math.radians(edge.ground_line.normal_deg)


def test_a_focus_is_sharpest_in_its_column():
    field = TiltedFocus(SYSTEMS["gaussian"], (50, 301), 0.6, 0.3, focus_col=100.0)
    assert field.at(20.0, 100.0) == SYSTEMS["gaussian"]
    for col, share in ((300.0, 1.0), (200.0, 0.5), (0.0, 0.5)):
        added = field.at(7.0, col).blocks[-1]
        assert added.sigma_px == pytest.approx(0.6 * share)
        assert added.sigma_along_px == pytest.approx(0.3 * share)
    # The transfer across is that of the first number.
    otf = field.at(0.0, 300.0).otf([0.5, 0.0], [0.0, 0.5]) / SYSTEMS["gaussian"].otf(0.5, 0.0)
    np.testing.assert_allclose(otf, np.exp(-2 * (math.pi * np.array([0.6, 0.3]) * 0.5) ** 2))
    with pytest.raises(ModelError, match="along_px is -1"):
        TiltedFocus(SYSTEMS["gaussian"], (50, 300), 0.6, -1.0)
    with pytest.raises(ModelError, match="focus_col is 300"):
        TiltedFocus(SYSTEMS["gaussian"], (50, 300), 0.6, 0.2, focus_col=300)


def test_ground_slopes_and_has_texture():
    _, flat = seeded(options=BARE)
    slope, contrast = 0.001, BARE.typical_contrast
    image, truth = seeded(options=replace(BARE, slope_per_px=slope, density_per_mpx=3.0))
    ground = truth.ground.at(np.arange(600)[:, None], np.arange(600)[None, :])
    steepness = np.hypot(*np.gradient(ground))
    assert np.sqrt(np.mean(steepness**2)) == pytest.approx(slope * contrast, rel=0.5)
    assert image[0, 0] == pytest.approx(float(truth.ground.at(0, 0)), abs=0.02)
    assert float(flat.ground.at(10, 20)) == BARE.ground
    rough, truth = seeded(options=replace(BARE, texture=(0.03, 0.03), density_per_mpx=20.0))
    parcel = max(truth.parcels, key=lambda one: min(b.length_px for b in one.borders))
    assert parcel.texture_std == pytest.approx(0.03 * abs(parcel.contrast))
    assert truth.ground_texture == pytest.approx(0.03 * contrast)
    distance = np.max([one.distance(*np.indices(SHAPE)) for one in truth.parcels], axis=0)
    assert np.std(rough[distance < -20]) == pytest.approx(truth.ground_texture, rel=0.15)
    within = parcel.distance(*np.indices(SHAPE)) > 6
    assert np.std(rough[within]) == pytest.approx(parcel.texture_std, rel=0.4)


def test_the_same_seed_gives_the_same_landscape():
    options = LandscapeOptions(density_per_mpx=20.0)
    images = [
        seeded(seed=seed, options=options, snr=100, shape=(300, 300))[0] for seed in (1, 1, 2)
    ]
    np.testing.assert_array_equal(images[0], images[1])
    assert not np.array_equal(images[0], images[2])


def test_tiles_are_the_image():
    shape = (1100, 1200)
    options = replace(LandscapeOptions(), density_per_mpx=20.0)
    image, truth = seeded(shape=shape, options=options, snr=100)
    tiles, listed = landscape_tiles(
        SYSTEMS["gaussian"], shape=shape, options=options, snr=100, rng=np.random.default_rng(5)
    )
    seen = np.zeros(shape, int)
    for box, pixels in tiles:
        assert pixels.dtype == np.float32
        np.testing.assert_array_equal(pixels, image[box.slices])
        seen[box.slices] += 1
    assert np.all(seen == 1)
    assert [one.name for one in listed.edges] == [one.name for one in truth.edges]


def test_objects_and_textures_do_not_depend_on_the_tiles(monkeypatch):
    """Objects to the last bit; a texture is filtered with other ground around it."""
    objects, whole = (seeded(options=options)[0] for options in (EVEN, LandscapeOptions()))
    monkeypatch.setattr("acutance.simulate.landscape_pixels.TILE_PX", 192)
    np.testing.assert_array_equal(seeded(options=EVEN)[0], objects)
    in_tiles = seeded(options=LandscapeOptions())[0]
    np.testing.assert_allclose(in_tiles, whole, atol=1e-3)


def test_noise_is_white_across_tiles(monkeypatch):
    monkeypatch.setattr("acutance.simulate.landscape_pixels.TILE_PX", 64)
    options = replace(BARE, density_per_mpx=3.0)
    noise = seeded(options=options, snr=50)[0] - seeded(options=options)[0]
    assert np.std(noise) == pytest.approx(BARE.typical_contrast / 50, rel=0.01)
    for lag in (1, 64):
        for shifted in (noise[lag:] * noise[:-lag], noise[:, lag:] * noise[:, :-lag]):
            assert abs(np.mean(shifted)) < 4 * np.var(noise) / math.sqrt(noise.size)


def test_shares_are_kept_and_edges_are_of_every_direction():
    seen = []
    _, truth = seeded(
        shape=(1200, 1200), options=replace(EVEN, discs=0.2), progress=lambda *at: seen.append(at)
    )
    assert [done for done, _ in seen] == sorted({done for done, _ in seen})
    assert seen[-1] == (1200 * 1200, 1200 * 1200)
    kinds = [edge.kind(16.0) for edge in truth.edges]
    assert len(kinds) > 250
    assert 0.3 < kinds.count("clean") / len(kinds) < 0.65
    for kind in ("rim", "gutter", "shadow", "road", "neighbour", "opposite"):
        assert kinds.count(kind) >= 5
    normals = [edge.ground_line.normal_deg for edge in truth.edges]
    assert np.all(np.histogram(normals, 8, (-180, 180))[0] > 15)
    assert sum(one.kind == "disc" for one in truth.parcels) >= 5
    assert not any(edge.name.startswith("disc") for edge in truth.edges)
    assert len({edge.name for edge in truth.edges}) == len(truth.edges)


def drawn_lines(parcels):
    """Points on the borders of an object, and on those of strips outside, half a pixel apart."""
    for parcel in parcels:
        for j, border in enumerate(parcel.borders):
            outer = [one.near_px for one in parcel.strips if one.border == j and one.near_px < 0]
            along = np.arange(-0.5 * border.length_px, 0.5 * border.length_px, 0.5)
            yield from (np.column_stack(border.point(along, at)) for at in (0.0, *outer))


@pytest.mark.parametrize("seed", [1, 2])
def test_as_much_ground_as_wanted_lies_between_two_objects(seed):
    """They moved by up to a cell after the search for room: 6.3 px were left of 8."""
    options = LandscapeOptions(density_per_mpx=400.0, clear_px=8.0)
    layout = draw_layout((600, 600), options, np.random.default_rng(seed))
    points = [np.concatenate([*drawn_lines(one)]) for one in layout.objects]
    trees = [cKDTree(one) for one in points]
    gaps = [trees[i].query(points[j])[0].min() for i in range(len(points)) for j in range(i)]
    # Of points a pixel apart a gap of 8 px seems to be as much larger.
    assert min(gaps) > 8.0 - 0.02
    assert len(points) > 25


def test_regions_hold_the_edge_and_no_more_than_asked_for(even):
    edge = next(
        one
        for one in even[1].edges
        if one.clean_dark_px < 12 < one.clean_bright_px and one.curvature_per_px == 0
    )
    wide, clean = edge.region(20.0), edge.region(20.0, clean=True)
    line = edge.ground_line
    np.testing.assert_allclose(line.normal_distance(*wide.T), [-20, -20, 20, 20])
    np.testing.assert_allclose(np.abs(line.tangent_distance(*wide.T)), edge.length_px / 2)
    assert line.normal_distance(*clean.T).min() == pytest.approx(-edge.clean_dark_px)
    np.testing.assert_allclose(edge.ends().mean(axis=0), [line.row, line.col], atol=1e-6)


def test_snr_and_noise_are_those_of_the_levels():
    _, truth = seeded(options=replace(BARE, density_per_mpx=10.0), snr=100)
    assert truth.noise == Noise(read=6.25)
    edge = truth.edges[0]
    assert edge.snr == pytest.approx(edge.contrast / 6.25)
    assert replace(edge, noise=None).snr == math.inf


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"rims": 0.5, "neighbours": 0.6}, "add up to"),
        ({"soft": 1.2}, "soft is 1.2"),
        ({"gap_px": (5.0, 2.0)}, "gap_px is 5 to 2"),
        ({"texture": 0.02}, "two numbers"),
        ({"field_px": (5.0, 20.0)}, "field_px is 5"),
        ({"road_width_px": (0.5, 3.0)}, "road_width_px is 0.5"),
        ({"texture_grain_px": 0.2}, "texture_grain_px"),
    ],
)
def test_impossible_options_are_refused(changed, words):
    with pytest.raises(ModelError, match=words):
        LandscapeOptions(**changed)


def test_impossible_landscapes_are_refused():
    with pytest.raises(ModelError, match="finds room"):
        seeded(shape=(30, 30))
    with pytest.raises(OptionError, match="default_rng"):
        seeded(rng=1)
