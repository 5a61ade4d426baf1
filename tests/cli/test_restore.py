"""``acutance restore design | apply`` and ``acutance niirs``."""

import json

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate
from acutance.raster import open_image, write_geotiff
from acutance.raster.dataset import open_quietly

SENSOR = optics.Sensor([optics.Gaussian(0.5), optics.Detector()], gsd_m=0.7)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, acutance):
    """Two edges, their measurements, and a filter made from them."""
    place = tmp_path_factory.mktemp("restore")
    for number, name in enumerate(("across", "along")):
        pixels, _ = simulate.edge(
            SENSOR, angle_deg=6.0, shape=(70, 70), snr=100, orientation=name,
            rng=np.random.default_rng(number),
        )  # fmt: skip
        write_geotiff(place / f"{name}.tif", pixels.astype(np.float32), gsd_m=0.7)
        result = acutance("edge", place / f"{name}.tif", "--json")
        (place / f"{name}.json").write_text(result.stdout)
    result = acutance(
        "restore", "design", place / "across.json", place / "along.json", "--noise-gain", 1.7,
        "--size", 9, "--out", place / "filter.json", "--report", place / "filter.html",
        "--figure", place / "filter.png",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    (place / "told.txt").write_text(result.stdout)
    return place


def test_a_design_is_written_and_told(folder):
    document = json.loads((folder / "filter.json").read_text())
    assert document["schema"] == "acutance/restoration/1"
    assert np.sum(document["kernel"]) == pytest.approx(1)
    assert document["noise_gain"] == pytest.approx(1.7)
    assert "noise gain 1.7 asked for" in (folder / "told.txt").read_text()
    assert (folder / "filter.html").read_text().startswith("<!DOCTYPE html>")
    assert (folder / "filter.png").read_bytes().startswith(b"\x89PNG")


def test_an_image_is_filtered_and_verified(acutance, folder):
    out = folder / "sharp.tif"
    result = acutance(
        "restore", "apply", folder / "across.tif", "--filter", folder / "filter.json", "--out", out,
        "--verify", "--roi", "5,5,60,60", "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["bands"]["1"]["pixels"] == 4900
    (edge,) = document["proof"]["edges"]
    off = edge["mtf_nyquist_after"]["value"] - edge["mtf_nyquist_predicted"]["value"]
    assert abs(off) < 0.05
    assert open_image(out).gsd().col_m == pytest.approx(0.7)


def test_edges_are_verified_by_a_method_that_expects_no_sensor(acutance, folder, tmp_path):
    words = ["restore", "apply", folder / "across.tif", "--filter", folder / "filter.json"]
    words += ["--out", tmp_path / "sharp.tif", "--method", "iso12233"]
    result = acutance(*words, "--verify", "--roi", "5,5,60,60", "--json")
    assert result.exit_code == 0, result.stderr
    proof = json.loads(result.stdout)["proof"]
    (edge,) = proof["edges"]
    before = ac.measure_edge(open_image(folder / "across.tif"), (5, 5, 60, 60), method="iso12233")
    assert edge["mtf_nyquist_before"]["value"] == pytest.approx(before.mtf_nyquist.value)
    result = acutance(*words)
    assert result.exit_code == 2
    assert "--method measures edges for --verify" in result.stderr


def test_a_described_sensor_and_an_image_make_a_filter(acutance, folder, tmp_path):
    result = acutance(
        "restore", "design", "--sensor", "gaussian", "--target", "generic-2005", "--snr", 100,
        "--size", 7, "--out", tmp_path / "f.json", "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["method"] == "target"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--noise-gain", "1.5"], "give the JSON files"),
        (["across.json", "--sensor", "gaussian"], "one of them"),
        (["across.json", "--noise-gain", "1.5"], "shows one direction"),
        (["across.json", "along.json", "--noise-gain", "70"], "reach"),
        (["across.json", "along.json", "--overshoot", "0.05", "--mtf-nyquist", "0.3"], "each of"),
        (["across.tif", "--noise-gain", "1.5"], "holds no JSON"),
        (["none.json", "--noise-gain", "1.5"], "cannot be read"),
    ],
)
def test_designs_that_cannot_be_are_refused(
    acutance, folder, tmp_path, monkeypatch, words, message
):
    monkeypatch.chdir(folder)
    result = acutance("restore", "design", *words, "--out", tmp_path / "f.json")
    assert result.exit_code == 2
    assert message in result.stderr
    assert not (tmp_path / "f.json").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["across.tif", "--filter", "across.json", "--out", "b.tif"], "no document"),
        (["across.tif", "--filter", "filter.json", "--out", "across.tif"], "overwrite"),
        (["across.tif", "--filter", "filter.json", "--out", "b.png"], "ends in"),
        (["across.tif", "--filter", "filter.json", "--out", "b.tif", "--roi", "1,1,9,9"], "add it"),
        (["none.tif", "--filter", "filter.json", "--out", "b.tif"], "none.tif"),
        (["across.tif", "--filter", "filter.json", "--out", "b.tif", "--band", "x"], "band"),
    ],
)
def test_applications_that_cannot_be_are_refused(acutance, folder, monkeypatch, words, message):
    monkeypatch.chdir(folder)
    result = acutance("restore", "apply", *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert not (folder / "b.tif").exists()


def test_niirs_of_a_measurement_and_of_numbers(acutance, folder):
    result = acutance(
        "niirs",
        folder / "across.json",
        "--gsd-m",
        0.7,
        "--snr",
        80,
        "--elevation-deg",
        70,
        "--json",
    )
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["version"] == 5
    assert document["inputs_std"] > 0
    stated = acutance("niirs", "--rer", "0.45,0.42", "--gsd-m", "0.7", "--snr", "80",
                      "--elevation-deg", "70")  # fmt: skip
    assert "4.68 ± 0.30" in stated.stdout
    assert acutance("niirs", "--gsd-m", "0.7", "--snr", "80").exit_code == 2
    assert acutance("niirs", "--rer", "0.4", "--gsd-m", "0.7").exit_code == 2


def test_niirs_of_a_file_for_each_direction(acutance, folder, two_regions):
    files = folder / "across.json", folder / "along.json"
    result = acutance("niirs", *files, "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["inputs"]["rer_across"] != document["inputs"]["rer_along"]
    assert "one direction" not in [note["name"] for note in document["notes"]]
    together = json.loads(acutance("niirs", two_regions, "--json").stdout)
    assert together["value"] == pytest.approx(document["value"], abs=0.01)
    told = acutance("niirs", *files, "--gsd-m", "0.3").stdout
    assert "(stated; the document's own is 0.7 m)" in told
    result = acutance("niirs", files[0], files[0])
    assert result.exit_code == 2
    assert "the same measurement" in result.stderr


def test_niirs_tells_the_verdict_of_each_file(acutance, folder, tmp_path):
    document = json.loads((folder / "along.json").read_text())
    document["checks"][0] |= {"passed": False, "severity": "fail", "message": "it is a mask"}
    (tmp_path / "mask.json").write_text(json.dumps(document))
    for files in ([tmp_path / "mask.json"], [folder / "across.json", tmp_path / "mask.json"]):
        result = acutance("niirs", *files)
        assert result.exit_code == 0, result.stderr
        assert "invalid measurement: mask.json: it is a mask" in result.stdout


@pytest.mark.parametrize("gsd", ["-0.7", "-1,1", "-1,-1", "nan", "0"])
def test_a_gsd_that_no_image_has_is_refused(acutance, gsd):
    result = acutance("niirs", "--rer", "0.4", "--snr", "80", "--gsd-m", gsd)
    assert result.exit_code == 2
    assert "--gsd-m is" in result.stderr


@pytest.fixture(scope="module")
def two_regions(folder, acutance):
    """Edges across and along in one image, and the document of both polygons."""
    both = np.concatenate([open_image(folder / f"{one}.tif").read() for one in ("across", "along")])
    write_geotiff(folder / "both.tif", both.astype(np.float32), gsd_m=0.7)
    squares = {"north": (2, 2, 66, 66), "south": (72, 2, 66, 66)}
    features = [
        {"type": "Feature", "properties": {"name": name}, "geometry": {"type": "Polygon",
         "coordinates": [[[c, r], [c + w, r], [c + w, r + h], [c, r + h], [c, r]]]}}
        for name, (r, c, h, w) in squares.items()
    ]  # fmt: skip
    (folder / "two.geojson").write_text(
        json.dumps({"type": "FeatureCollection", "crs": "pixel", "features": features})
    )
    result = acutance("edge", folder / "both.tif", "--roi", folder / "two.geojson", "--json")
    assert result.exit_code == 0, result.stderr
    (folder / "two.json").write_text(result.stdout)
    return folder / "two.json"


def test_several_measurements_of_a_file_are_read(acutance, two_regions, tmp_path):
    words = ["--noise-gain", "1.5", "--size", "5", "--out", tmp_path / "f.json", "--json"]
    result = acutance("restore", "design", two_regions, *words)
    assert result.exit_code == 0, result.stderr
    assert len(json.loads(result.stdout)["sources"]) == 2
    result = acutance("niirs", two_regions, "--json")
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["inputs"]["gsd_m"] == pytest.approx(0.7)
    result = acutance("combine", two_regions, "--json")
    assert result.exit_code == 0, result.stderr
    alone = json.loads(two_regions.read_text())["results"][:1]
    target = {"schema": "acutance/target/1", "measurements": alone, "groups": {}, "rejected": []}
    (tmp_path / "target.json").write_text(json.dumps(target))
    assert acutance("niirs", tmp_path / "target.json").exit_code == 0
    result = acutance("restore", "design", tmp_path / "target.json", *words)
    assert result.exit_code == 2
    assert "target.json (edge" in result.stderr
    assert "shows one direction" in result.stderr


def test_the_file_that_is_no_measurement_is_named(acutance, folder, tmp_path):
    for command in (["niirs"], ["restore", "design", folder / "across.json"]):
        out = ["--out", tmp_path / "f.json"] if len(command) > 1 else []
        result = acutance(*command, folder / "filter.json", *out)
        assert result.exit_code == 2
        assert "filter.json is a document acutance/restoration/1" in result.stderr


@pytest.mark.usefixtures("undrawn")
def test_notes_name_the_file_and_the_failed_checks_of_the_combination(acutance, folder, tmp_path):
    document = json.loads((folder / "along.json").read_text())
    del document["image"]["gsd_m"], document["image"]["pixel_gsd_m"]
    document["checks"][0] |= {"passed": False, "severity": "caution", "message": "it is bent"}
    (tmp_path / "bent.json").write_text(json.dumps(document))
    result = acutance(
        "restore", "design", folder / "across.json", tmp_path / "bent.json", "--noise-gain", "1.5",
        "--size", "5", "--out", tmp_path / "f.json", "--report", tmp_path / "f.html",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    filter = json.loads((tmp_path / "f.json").read_text())
    notes = "\n".join(filter["notes"])
    assert "bent.json: doubtful: it is bent" in notes
    assert "the combination: 2 directions were measured" in notes
    assert "without a GSD" in notes
    assert filter["verdict"] == "doubtful"
    page = (tmp_path / "f.html").read_text()
    assert "Doubtful: Bent.json" not in page
    assert "bent.json: it is bent" in page
    assert "Nothing has to be said" not in page


def test_regions_beyond_the_image_are_refused_before_anything_is_written(
    acutance, folder, tmp_path
):
    out = tmp_path / "o.tif"
    words = ["restore", "apply", folder / "across.tif", "--filter", folder / "filter.json"]
    words += ["--out", out, "--verify"]
    for more, message in (
        (["--roi", "500,500,40,40"], "outside the image"),
        (["--roi", "1,1,40,40", "--method", "none"], "none"),
    ):
        result = acutance(*words, *more)
        assert result.exit_code == 2
        assert message in result.stderr
        assert "wrote" not in result.stderr
        assert not out.exists()


def test_a_proof_names_its_edges_and_fails_where_it_does_not_agree(
    acutance, folder, two_regions, tmp_path, monkeypatch
):
    words = ["restore", "apply", folder / "both.tif", "--filter", folder / "filter.json", "--out",
             tmp_path / "o.tif", "--verify", "--roi", folder / "two.geojson"]  # fmt: skip
    result = acutance(*words)
    assert result.exit_code == 0, result.stderr
    assert "north" in result.stdout
    assert "The image agrees with the prediction: 2 edges" in result.stdout
    assert "Overshoot after" in result.stdout
    # A file that was not filtered by what is told to have been.
    other = json.loads((folder / "filter.json").read_text())
    kernel = np.zeros((9, 9))
    kernel[4, 4] = 1.0
    other |= {"kernel": kernel.tolist(), "noise_gain": 1.0}
    identity = ac.RestorationFilter.from_dict(other)
    real = ac.restoration.applying.restored_window
    monkeypatch.setattr(
        ac.restoration.applying, "restored_window",
        lambda *window: real(*window[:3], identity.kernel, window[4]),
    )  # fmt: skip
    result = acutance(*words, "--json")
    assert result.exit_code == 3
    proof = json.loads(result.stdout)["proof"]
    assert proof["band"] == 1
    assert not proof["agrees"]
    assert proof["sentence"].startswith("does not agree")


def test_an_interrupted_proof_does_not_advise_what_is_not_there(
    acutance, folder, tmp_path, monkeypatch
):
    def interrupted(*_, **__):
        raise KeyboardInterrupt("name a file that keeps them (keep, --keep)")

    monkeypatch.setattr("acutance.restoration.verify_restoration", interrupted)
    result = acutance(
        "restore", "apply", folder / "across.tif", "--filter", folder / "filter.json",
        "--out", tmp_path / "o.tif", "--verify",
    )  # fmt: skip
    assert result.exit_code == 130
    assert "--keep" not in result.stderr
    assert "o.tif is written" in result.stderr


def test_the_proof_is_of_the_band_the_filter_is_of(acutance, folder, tmp_path):
    pixels = open_image(folder / "across.tif").read()
    flat = 100 + np.random.default_rng(2).normal(size=pixels.shape)
    write_geotiff(tmp_path / "two.tif", np.stack([flat, pixels]).astype(np.float32), gsd_m=0.7)
    document = json.loads((folder / "filter.json").read_text())
    document["image"]["band"] = 2
    (tmp_path / "f.json").write_text(json.dumps(document))
    result = acutance(
        "restore", "apply", tmp_path / "two.tif", "--filter", tmp_path / "f.json", "--band", "all",
        "--out", tmp_path / "o.tif", "--verify", "--roi", "5,5,60,60",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert "band 2:\nEdges before and after" in result.stdout
    assert "filtered though the filter is of band 2: band 1" in result.stdout


def test_bands_are_called_by_their_names(acutance, folder, tmp_path):
    pixels = open_image(folder / "across.tif").read()
    image = tmp_path / "two.tif"
    write_geotiff(image, np.stack([pixels, pixels]).astype(np.float32), gsd_m=0.7)
    with open_quietly(image, "r+") as written:
        written.descriptions = ("B2", "B3")
    words = "restore", "apply", image, "--filter", folder / "filter.json", "--out"
    result = acutance(*words, tmp_path / "o.tif", "--band", "b3", "--accept-mismatch", "--json")
    assert list(json.loads(result.stdout)["bands"]) == ["2"]
    result = acutance(*words, tmp_path / "p.tif", "--band", "red")
    assert (result.exit_code, "two.tif are B2, B3" in result.stderr) == (2, True)


def test_what_was_written_is_told_where_no_edge_proves_it(acutance, folder, tmp_path):
    flat = tmp_path / "flat.tif"
    pixels = np.random.default_rng(3).normal(100, 1, (80, 80)).astype(np.float32)
    write_geotiff(flat, pixels, gsd_m=0.7)
    result = acutance(
        "restore", "apply", flat, "--filter", folder / "filter.json", "--out", tmp_path / "o.tif",
        "--verify",
    )  # fmt: skip
    assert result.exit_code == 4
    assert "band 1: 6400 pixels" in result.stdout
    assert "name regions with edges" in result.stderr
    assert (tmp_path / "o.tif").exists()


def test_an_overshoot_is_stated_in_per_cent_as_well(acutance, folder, monkeypatch):
    """The second request is the first one: its filter need not be made again."""
    made, asked = [], []
    design = ac.restoration.design_restoration

    def once(*known, **how):
        asked.append(how)
        made.append(made[0] if made else design(*known, **how))
        return made[-1]

    monkeypatch.setattr("acutance.restoration.design_restoration", once)
    out = folder / "over.json"
    for text in ("4%", "0.04"):
        result = acutance(
            "restore", "design", folder / "across.json", folder / "along.json", "--size", 5,
            "--overshoot", text, "--out", out,
        )  # fmt: skip
        assert result.exit_code == 0, result.stderr
    assert [one["overshoot"] for one in asked] == [0.04, 0.04]
    assert asked[0] == asked[1]
    assert np.shape(json.loads(out.read_text())["kernel"]) == (5, 5)
    refused = acutance(
        "restore", "design", folder / "across.json", "--overshoot", "much", "--out", out
    )
    assert refused.exit_code == 2
    assert "--overshoot much: write a share of the contrast (0.5% or 0.005)" in refused.stderr
