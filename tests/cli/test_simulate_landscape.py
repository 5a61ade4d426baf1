"""``acutance simulate landscape``: an image, and its edges as regions that can be measured."""

import importlib
import json
from collections import Counter

import numpy as np
import pytest

from acutance import simulate
from acutance.cli.sensor import named_sensor
from acutance.raster import open_image
from acutance.simulate.landscape_pixels import draw_tiles


@pytest.fixture
def render(acutance, tmp_path):
    """Render a small landscape: image, edges, what was printed, the file of edges."""

    def run(*words, name="land.tif"):
        out = tmp_path / name
        size = () if "--size" in words else ("--size", "300,320")
        result = acutance("simulate", "landscape", *size, *words, "--out", out)
        assert result.exit_code == 0, result.stderr
        path = out.with_suffix(".truth.geojson")
        return open_image(out), json.loads(path.read_text(encoding="utf-8")), result, path

    return run


def test_every_edge_has_a_region_and_a_truth(render):
    image, document, result, _ = render("--snr", 100, "--half-width", 15, "--seed", 2)
    assert image.shape == (300, 320)
    assert (document["schema"], document["crs"]) == ("acutance/landscape/1", "pixel")
    assert document["seed"] == 2
    assert document["noise"]["read"] == pytest.approx(6.25)
    features = document["features"]
    assert len(features) >= 8
    assert f"{len(features)} edges" in result.stdout
    for feature in features:
        edge, ring = feature["properties"], np.array(feature["geometry"]["coordinates"][0])
        np.testing.assert_array_equal(ring[0], ring[-1])
        # x is the column.
        ends = np.array(edge["ends"])
        assert np.hypot(*(ends[1] - ends[0])) == pytest.approx(edge["length_px"], rel=0.01)
        middle = ring[:-1].mean(axis=0)
        assert np.hypot(middle[1] - edge["row"], middle[0] - edge["col"]) < 0.1
        assert edge["dark"] < edge["bright"]
        if edge["softness_px"] == 0:
            assert edge["mtf_nyquist"] == edge["sensor_mtf_nyquist"]
        else:
            assert edge["mtf_nyquist"] < edge["sensor_mtf_nyquist"]


def test_its_regions_are_measured_by_name(render, acutance):
    _, document, _, path = render("--clean", "--snr", 200, "--texture", "0,0", "--curved", 0)
    image = path.with_name("land.tif")
    result = acutance("edge", image, "--roi", path, "--json")
    assert result.exit_code == 0
    found = {one["region"]: one for one in json.loads(result.stdout)["results"]}
    truths = {one["properties"]["name"]: one["properties"] for one in document["features"]}
    assert set(found) <= set(truths)
    assert len(found) >= 0.8 * len(truths)
    errors = [one["rer"]["value"] - truths[name]["rer"] for name, one in found.items()]
    assert np.median(np.abs(errors)) < 0.01


def test_blur_in_the_corners(render):
    _, even, _, _ = render()
    _, soft, _, _ = render("--corner-blur", 0.5)
    nyquist = [
        [one["properties"]["sensor_mtf_nyquist"] for one in document["features"]]
        for document in (even, soft)
    ]
    assert all(one < before for before, one in zip(*nyquist, strict=True))


def test_a_tilted_focus(render):
    """The blur across and along is that of the column, at the middle of the object."""
    _, even, _, _ = render()
    for blur in ((0.4, 0.4), (0.0, 0.4)):
        _, tilted, _, _ = render("--tilt-blur", f"{blur[0]},{blur[1]}")
        for before, after in zip(even["features"], tilted["features"], strict=True):
            one, other = before["properties"], after["properties"]
            normal = np.radians(one["normal_deg"])
            width = np.hypot(blur[0] * np.cos(normal), blur[1] * np.sin(normal))
            lost = -np.log(other["sensor_mtf_nyquist"] / one["sensor_mtf_nyquist"])
            sigma = np.sqrt(lost / 2) / (0.5 * np.pi)
            assert sigma == pytest.approx(width * one["col"] / 319, abs=70 / 319 * width + 1e-6)


def test_borders_soft_in_some_directions(render):
    words = ("--soft", 1, "--soft-normal", "135,225")
    _, document, _, _ = render(*words)
    edges = [one["properties"] for one in document["features"]]
    faces_across = [abs((one["normal_deg"] + 90) % 180 - 90) <= 45 for one in edges]
    soft = [one["softness_px"] > 0 for one in edges]
    assert any(soft)
    # Roofs are ideal whatever they face, and an arc faces where its object does.
    assert all(not one or across for one, across in zip(soft, faces_across, strict=True))


def test_the_image_and_its_parts_are_those_of_python(render):
    image, _, _, _ = render("--snr", 100, "--seed", 7, "--size", "300,1100")
    drawn, _ = simulate.landscape(
        named_sensor("generic-2005"), shape=(300, 1100), snr=100, rng=np.random.default_rng(7)
    )
    np.testing.assert_array_equal(image.read(), drawn)


def test_an_interruption_leaves_no_file(acutance, tmp_path, monkeypatch):
    """Ctrl-C after the first tile."""

    def stopped(*arguments):
        yield next(draw_tiles(*arguments))
        raise KeyboardInterrupt

    drawing = importlib.import_module("acutance.simulate.landscape")
    monkeypatch.setattr(drawing, "draw_tiles", stopped)
    size = ("--size", "300,1100")
    result = acutance("simulate", "landscape", *size, "--out", tmp_path / "land.tif")
    assert result.exit_code == 130
    assert list(tmp_path.iterdir()) == []


def counted(document):
    return Counter(one["properties"]["kind"] for one in document["features"])


@pytest.mark.parametrize(
    ("option", "kind"),
    [
        ("--rims", "rim"),
        ("--gutters", "gutter"),
        ("--shadows", "shadow"),
        ("--side-roads", "road"),
        ("--neighbours", "neighbour"),
    ],
)
def test_what_is_asked_for_lies_beside_the_borders(render, option, kind):
    others = [
        word
        for one in ("--rims", "--gutters", "--shadows", "--side-roads", "--neighbours")
        for word in (one, 0.9 if one == option else 0)
    ]
    _, document, _, _ = render(*others, "--size", "500,500", "--seed", 3)
    found = counted(document)
    assert found[kind] >= 5
    assert not ({"rim", "gutter", "shadow"} - {kind}) & set(found)


def test_density_softness_and_slope(render):
    common = ("--clean", "--texture", "0,0", "--size", "500,500", "--seed", 4)
    flat, few, _, _ = render(*common, "--density", 20, "--soft", 0, "--slope", 0)
    words = ("--density", 60, "--soft", 1, "--slope", 0.002)
    steep, many, _, _ = render(*common, *words, name="steep.tif")
    assert len(many["features"]) > 1.5 * len(few["features"])
    softness = [[one["properties"]["softness_px"] for one in d["features"]] for d in (few, many)]
    assert max(softness[0]) == 0 < np.median(softness[1])
    rises = [np.median(np.abs(np.diff(image.read(), axis=1))) for image in (flat, steep)]
    assert rises[0] < 0.01 < 0.1 < rises[1]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--clean", "--rims", 0.1), "leave it out, or --rims"),
        (("--texture", "0.1"), "lowest and highest"),
        (("--rims", 0.9, "--shadows", 0.4), "add up to"),
        (("--size", "20,20"), "finds room"),
        (("--size", "30000,30000"), "400 million pixels"),
        (("--tilt-blur", "0.3"), "across and along"),
        (("--tilt-blur", "0.3,-1"), "along_px is -1"),
        (("--tilt-blur", "0.3,0.1", "--corner-blur", 0.2), "use one"),
    ],
)
def test_what_cannot_be_is_refused(acutance, tmp_path, words, message):
    result = acutance("simulate", "landscape", *words, "--out", tmp_path / "land.tif")
    assert result.exit_code == 2
    assert message in result.stderr
    assert list(tmp_path.iterdir()) == []
