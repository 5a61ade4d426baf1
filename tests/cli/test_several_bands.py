"""Several bands of one image: each is measured by itself, one result a band."""

import json

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate
from acutance.archive import Archive
from acutance.raster import open_bands, write_geotiff
from acutance.raster.dataset import open_quietly

SENSORS = [optics.Sensor([optics.Gaussian(size), optics.Detector()]) for size in (0.35, 0.5)]


@pytest.fixture(scope="module")
def image(tmp_path_factory):
    """Two bands of one edge, the second softer, and a third without it."""
    rng = np.random.default_rng(3)
    bands = [
        simulate.edge(sensor, angle_deg=6.0, shape=(48, 48), snr=100, rng=rng)[0]
        for sensor in SENSORS
    ]
    place = tmp_path_factory.mktemp("bands") / "bands.tif"
    write_geotiff(place, np.stack([*bands, rng.normal(500.0, 5.0, (48, 48))]))
    return place


def test_every_band_has_a_result_and_one_without_an_edge_is_named(acutance, image, tmp_path):
    done = acutance("edge", image, "--band", "all", "--json", "--figure", tmp_path / "e.png")
    assert done.exit_code == 0
    document = json.loads(done.stdout)
    assert document["schema"] == "acutance/bands/1"
    assert [one["band"] for one in document["results"]] == ["1", "2"]
    assert [one["image"]["band"] for one in document["results"]] == [1, 2]
    sharp, soft = (one["mtf_nyquist"]["value"] for one in document["results"])
    assert sharp > soft + 0.1
    assert [one["values"] for one in document["rejected"]] == [{"band": "3"}]
    assert "acutance: band 3: " in done.stderr
    assert sorted(one.name for one in tmp_path.iterdir()) == ["e-band-1.png", "e-band-2.png"]
    assert acutance("edge", image, "--band", "all", "--strict").exit_code == 3


def test_bands_of_one_region(acutance, image):
    done = acutance("edge", image, "--band", "1,2", "--roi", "2,2,40,44", "--strict")
    assert done.exit_code == 0
    assert [line[:7] for line in done.stdout.splitlines() if line.startswith("band")] == [
        "band 1:", "band 2:",
    ]  # fmt: skip
    assert "region" not in done.stdout.split("\n")[0]


def test_bands_of_several_regions(acutance, image, tmp_path):
    """The second region lies on one side of the edge of both bands."""
    squares = {"north": (2, 40, 2, 46), "corner": (36, 46, 2, 12)}
    features = [
        {
            "type": "Feature", "properties": {"name": name},
            "geometry": {"type": "Polygon", "coordinates": [
                [[left, top], [right, top], [right, low], [left, low], [left, top]]
            ]},
        }
        for name, (top, low, left, right) in squares.items()
    ]  # fmt: skip
    file = tmp_path / "two.geojson"
    file.write_text(json.dumps({"type": "FeatureCollection", "crs": "pixel", "features": features}))
    done = acutance(
        "edge", image, "--band", "1,2", "--roi", file, "--json", "--csv", tmp_path / "e.csv"
    )
    document = json.loads(done.stdout)
    assert [(one["band"], one["region"]) for one in document["results"]] == [
        ("1", "north"), ("2", "north"),
    ]  # fmt: skip
    assert [one["values"] for one in document["rejected"]] == [
        {"band": "1", "region": "corner"}, {"band": "2", "region": "corner"},
    ]  # fmt: skip
    assert "acutance: band 2, region corner: " in done.stderr
    written = sorted(one.name for one in tmp_path.glob("*.csv"))
    assert written == ["e-band-1-north.csv", "e-band-2-north.csv"]


def test_bands_are_kept_apart_in_an_archive(acutance, image, tmp_path):
    file = tmp_path / "edges.json"
    file.write_text(acutance("edge", image, "--band", "1,2", "--json").stdout)
    assert acutance("archive", "import", tmp_path / "kept.db", file, "--sensor", "S").exit_code == 0
    with Archive(tmp_path / "kept.db", read_only=True) as archive:
        assert sorted(archive.measurements()["band"]) == ["1", "2"]


def test_bands_one_by_one_are_the_bands_of_all(acutance, image, tmp_path):
    kept = tmp_path / "kept.db"
    for band in ("1", "2", "all"):
        file = tmp_path / f"{band}.json"
        file.write_text(acutance("edge", image, "--band", band, "--json").stdout)
        assert acutance("archive", "import", kept, file, "--sensor", "S").exit_code == 0
    one = ac.measure_edge(ac.open_image(image, band=2))
    with Archive(kept) as archive:
        assert not archive.add(one, sensor="S").new
        assert sorted(archive.measurements()["band"]) == ["1", "2"]


def test_bands_of_older_documents_are_told_where_they_meet(acutance, image, tmp_path):
    """Documents that do not say how many bands there are give no number for a name."""
    for band in ("1", "2"):
        document = json.loads(acutance("edge", image, "--band", band, "--json").stdout)
        del document["image"]["band_count"], document["image"]["band_name"]
        (tmp_path / f"{band}.json").write_text(json.dumps(document))
    files = [tmp_path / "1.json", tmp_path / "2.json"]
    told = acutance("archive", "import", tmp_path / "kept.db", *files, "--sensor", "S")
    assert told.exit_code == 0
    assert "bands.tif: bands 1 and 2 are kept without a name, and means are of both" in told.stderr
    told = acutance("archive", "import", tmp_path / "other.db", files[0], "--sensor", "S", "--json")
    assert told.stderr == ""
    assert "notes" not in json.loads(told.stdout)


@pytest.fixture(scope="module")
def named(image, tmp_path_factory):
    """The bands of the image, with names."""
    place = tmp_path_factory.mktemp("named") / "named.tif"
    with open_quietly(image) as source, open_quietly(place, "w", **source.profile) as written:
        written.write(source.read())
        written.descriptions = ("B2", "B3", "B4")
    return place


@pytest.mark.usefixtures("undrawn")
def test_bands_are_called_by_their_names(acutance, refused, named, tmp_path):
    page = tmp_path / "e.html"
    done = acutance("edge", named, "--band", "b3", "--json", "--report", page)
    one = json.loads(done.stdout)
    assert (one["image"]["band"], one["image"]["band_name"]) == (2, "B3")
    assert "2 (B3)" in page.read_text()
    done = acutance("edge", named, "--band", "1,B3,3", "--json")
    document = json.loads(done.stdout)
    assert [part["band"] for part in document["results"]] == ["1", "2"]
    assert [part["band_name"] for part in document["results"]] == ["B2", "B3"]
    assert [part["values"] for part in document["rejected"]] == [{"band": "3", "band_name": "B4"}]
    assert "acutance: band 3 (B4): " in done.stderr
    refused(("edge", named, "--band", "red"), "named.tif are B2, B3, B4")
    for name, text in (("one.json", json.dumps(one)), ("all.json", done.stdout)):
        (tmp_path / name).write_text(text)
        acutance("archive", "import", tmp_path / "kept.db", tmp_path / name, "--sensor", "S")
    with Archive(tmp_path / "kept.db", read_only=True) as archive:
        assert sorted(archive.measurements()["band"]) == ["B2", "B3"]
        assert list(archive.rejected()["band"]) == ["B4"]


def test_bands_are_opened_by_their_names(named):
    assert ac.open_image(named, band="b3").band_label == "2 (B3)"
    assert [one.band for one in open_bands(named, bands=["B4", 1])] == [3, 1]
    with pytest.raises(ac.errors.ImageError, match=r"band 'B9' .* are B2, B3, B4"):
        ac.open_image(named, band="B9")
    with pytest.raises(ac.errors.OptionError, match="every band once"):
        open_bands(named, bands=["B3", 2])


@pytest.mark.parametrize(
    ("names", "asked", "found"),
    [
        (("Pan", "Pan", "Red"), "pan", "name of 2 bands of .*: give a number, as 1 and 2"),
        (("b", "B", "B "), "b", 1),
        (("b", "B", "c"), "B", 2),
        (("2", "1", "3"), 2, 2),
    ],
)  # fmt: skip
def test_a_name_of_two_bands_is_the_name_of_none(image, tmp_path, names, asked, found):
    place = tmp_path / "alike.tif"
    with open_quietly(image) as source, open_quietly(place, "w", **source.profile) as written:
        written.write(source.read())
        written.descriptions = names
    if isinstance(found, int):
        assert ac.open_image(place, band=asked).band == found
    else:
        with pytest.raises(ac.errors.ImageError, match=found):
            ac.open_image(place, band=asked)


def test_the_band_of_a_finer_image_is_called_by_its_name(acutance, named, tmp_path, monkeypatch):
    seen = []

    def noted(path, band, nodata=None):
        seen.append(band)
        raise ac.errors.ImageError("seen")

    monkeypatch.setattr("acutance.raster.open_image", noted)
    acutance("biresolution", named, named, "--high-band", "B3")
    assert seen == ["B3"]


def test_an_image_lists_its_bands(acutance, image, named):
    assert "3, without names (1 to 3)" in acutance("image", image).stdout
    assert "1 (B2), 2 (B3), 3 (B4)   (named.tif: " in acutance("image", named).stdout
    document = json.loads(acutance("image", image, "--json").stdout)
    assert (document["band_count"], document["shape"]) == (3, [48, 48])


def test_other_kinds_take_several_bands(acutance, image):
    done = acutance("pulse", image, "--band", "all", "--width-px", "3")
    assert done.exit_code == 4
    assert "none of the 3 bands and regions could be measured" in done.stderr


def test_every_band_answers_what_is_required(acutance, image):
    words = ("edge", image, "--band", "1,2", "--require", "mtf_nyquist>=0.01")
    done = acutance(*words)
    assert done.exit_code == 0, done.stderr
    assert done.stdout.count("mtf_nyquist >= 0.01 is met") == 2
    document = json.loads(acutance(*words, "--json").stdout)
    assert [one["requirements"][0]["word"] for one in document["results"]] == ["met", "met"]
