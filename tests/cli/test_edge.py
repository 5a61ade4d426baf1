"""``acutance edge``: text, JSON, files, checks and refusals."""

import json
from pathlib import Path

import numpy as np
import pytest

from acutance import optics, simulate

SENSOR = optics.Sensor([optics.Gaussian(0.4), optics.Detector()])


def test_the_text_report_goes_to_stdout(acutance, edge_image):
    result = acutance("edge", edge_image)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.startswith("Edge, method spline: across track")
    assert "MTF at Nyquist" in result.stdout
    assert "GSD 0.7 m" in result.stdout
    assert result.stderr == ""


def test_json_is_all_of_stdout_and_keeps_to_the_schema(
    acutance, edge_image, tmp_path, keeps_to_schema
):
    result = acutance("edge", edge_image, "--json", "--csv", tmp_path / "mtf.csv")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    keeps_to_schema(document)
    low, high = document["mtf_nyquist"]["interval95"]
    assert low - 0.02 < 0.289 < high + 0.02
    assert document["image"]["path"] == edge_image
    assert "factor" not in document["lsf"]
    assert "wrote" in result.stderr


def test_the_covariance_is_added_when_asked(acutance, edge_image, keeps_to_schema):
    document = json.loads(acutance("edge", edge_image, "--json", "--covariance").stdout)
    keeps_to_schema(document)
    assert len(document["mtf"]["factor_real"]) == len(document["mtf"]["freq_cpp"])
    for name in ("esf", "lsf"):
        factor = np.array(document[name]["factor"])
        assert np.linalg.norm(factor, axis=1) == pytest.approx(document[name]["std"], rel=6e-3)


def test_region_band_and_gsd_reach_the_measurement(acutance, edge_image):
    result = acutance(
        *("edge", edge_image, "--roi", "5,3,44,38", "--band", 1, "--gsd", "0.5,0.6", "--json")
    )
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    row, col, height, width = document["image"]["roi"]
    assert row >= 5
    assert col >= 3
    assert row + height <= 49
    assert col + width <= 41
    assert document["fwhm_m"]["value"] == pytest.approx(
        0.6 * document["fwhm_px"]["value"], rel=0.01
    )


def test_along_track_may_be_the_x_axis(acutance, edge_image, keeps_to_schema):
    result = acutance("edge", edge_image, "--along-track", "x", "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    keeps_to_schema(document)
    assert (document["orientation"], document["image"]["along_track"]) == ("along", "x")
    refused = acutance("edge", edge_image, "--along-track", "up")
    assert refused.exit_code == 2
    assert "--along-track up: it has to be x or y" in refused.stderr


@pytest.mark.parametrize("method", ["sdsu-2005", "kompsat-2014", "iso12233", "fermi"])
def test_every_method_measures(acutance, edge_image, method):
    result = acutance("edge", edge_image, "--method", method, "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["method"] == method
    assert document["rer"]["value"] == pytest.approx(0.682, abs=0.08)


def test_figure_report_and_csv_are_written(acutance, edge_image, tmp_path):
    result = acutance(
        *("edge", edge_image, "--figure", tmp_path / "edge.png"),
        *("--report", tmp_path / "edge.html", "--csv", tmp_path / "mtf.csv"),
    )
    assert result.exit_code == 0, result.stderr
    assert (tmp_path / "edge.png").read_bytes().startswith(b"\x89PNG")
    assert "MTF at Nyquist" in (tmp_path / "edge.html").read_text(encoding="utf-8")
    assert (tmp_path / "mtf.csv").read_text().startswith("freq_cpp,mtf,std,low95,high95,freq_cpm")
    assert len(result.stderr.splitlines()) == 3
    assert len(list(tmp_path.iterdir())) == 3


def test_every_drawing_is_written_by_itself(acutance, edge_image, tmp_path):
    assert acutance("edge", edge_image, "--panels", tmp_path / "e.pdf").exit_code == 0
    names = ("edge-spread-function", "line-spread-function", "modulation-transfer-function",
             "the-pixels-and-the-line")  # fmt: skip
    assert sorted(one.name for one in tmp_path.iterdir()) == [f"e-{name}.pdf" for name in names]
    # Letters that journals take: outlines of glyphs are refused.
    content = (tmp_path / "e-modulation-transfer-function.pdf").read_bytes()
    assert b"/Type3" not in content
    assert b"/CIDFontType2" in content


def test_no_drawing_takes_the_place_of_an_input(refused, edge_image, tmp_path):
    image = tmp_path / "e-line-spread-function.png"
    # A GeoTIFF is known by its first bytes.
    image.write_bytes(Path(edge_image).read_bytes())
    before = image.read_bytes()
    refused(["edge", image, "--panels", tmp_path / "e.png"], "e-line-spread-function.png")
    assert image.read_bytes() == before


def test_drawings_of_compared_methods_are_numbered(acutance, edge_image, shown, tmp_path):
    words = ("edge", edge_image, "--compare", "spline,fermi", "--panels", tmp_path / "e.svg")
    assert acutance(*words).exit_code == 0
    names = [one.name for one in tmp_path.iterdir()]
    for number in (1, 2):
        assert f"e-{number}-modulation-transfer-function.svg" in names


def test_methods_are_compared(acutance, edge_image, shown, tmp_path):
    words = ("edge", edge_image, "--compare", "spline,iso12233", "--report", tmp_path / "c.html")
    result = acutance(*words)
    assert result.exit_code == 0, result.stderr
    ((_, comparison, _),) = shown
    assert [one.method for one in comparison.measurements] == ["spline", "iso12233"]
    assert all(method in result.stdout for method in ("spline", "iso12233"))
    document = json.loads(acutance("edge", edge_image, "--compare", "fermi", "--json").stdout)
    assert document["schema"] == "acutance/comparison/1"
    assert [one["method"] for one in document["measurements"]] == ["spline", "fermi"]
    assert document["rejected"] == []


@pytest.mark.usefixtures("undrawn")
def test_a_method_that_cannot_measure_leaves_the_others_their_results(acutance, tmp_path):
    """At 14 degrees the phases repeat after four rows, too few for the method of 2005."""
    image, _ = simulate.edge(
        SENSOR, angle_deg=14.036, shape=(24, 24), snr=100, rng=np.random.default_rng(1)
    )
    np.save(tmp_path / "short.npy", image)
    words = ("edge", tmp_path / "short.npy", "--compare", "sdsu-2005,fermi")
    result = acutance(*words, "--report", tmp_path / "c.html", "--figure", tmp_path / "c.svg")
    assert result.exit_code == 0, result.stderr
    assert "sdsu-2005: not measured: an angle of 14" in result.stdout
    assert "method sdsu-2005: an angle of 14" in result.stderr
    page = (tmp_path / "c.html").read_text(encoding="utf-8")
    assert "sdsu-2005 – Not measured: an angle of 14" in page
    document = json.loads(acutance(*words, "--json").stdout)
    assert [one["method"] for one in document["measurements"]] == ["spline", "fermi"]
    ((stage, reason, values),) = (one.values() for one in document["rejected"])
    assert (stage, values) == ("method", {"method": "sdsu-2005"})
    assert reason.startswith("an angle of 14")
    assert acutance(*words, "--strict").exit_code == 3
    alone = acutance("edge", tmp_path / "short.npy", "--method", "sdsu-2005")
    assert (alone.exit_code, alone.stdout) == (4, "")


def test_all_edges_of_a_site_are_measured(acutance, site_image, shown, tmp_path, keeps_to_schema):
    result = acutance(
        *("edge", site_image, "--all", "--json", "--figure", tmp_path / "all.svg"),
        *("--roi", "4,6,110,108", "--report", tmp_path / "all.html", "--csv", tmp_path / "all.csv"),
    )
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["schema"] == "acutance/target/1"
    verdicts = [one["verdict"]["word"] for one in document["measurements"]]
    ranked = ("invalid", "doubtful", "usable", "good")
    assert document["verdict"]["word"] == min(verdicts, key=ranked.index)
    checks = [check["passed"] for one in document["measurements"] for check in one["checks"]]
    failed = f"{checks.count(False)} of" if False in checks else "All"
    assert document["verdict"]["sentence"].startswith(f"{failed} {len(checks)} checks ")
    for one in document["measurements"]:
        keeps_to_schema(one)
    assert set(document["groups"]) == {"across", "along"}
    assert {path.name for path in tmp_path.iterdir()} == {"all.svg", "all.html", "all.csv"}
    for _, found, how in shown:
        assert len(found.measurements) == len(document["measurements"])
        assert (how["backdrop"].shape, how["origin"]) == ((110, 108), (4, 6))


def test_all_edges_in_words(acutance, site_image):
    assert acutance("edge", site_image, "--all").stdout.splitlines()[0].endswith("rejected")


def test_a_flat_image_has_no_edges_which_is_exit_4(refused, tmp_path):
    np.save(tmp_path / "flat.npy", np.random.default_rng(0).normal(500.0, 5.0, (40, 40)))
    for words in ((), ("--all",)):
        refused(("edge", tmp_path / "flat.npy", *words), "the region is flat", code=4)


def test_strict_is_exit_3_after_the_result(acutance, edge_image):
    limit = ("--limit", "contrast_snr=100000")
    loose = acutance("edge", edge_image, *limit)
    assert (loose.exit_code, loose.stderr) == (0, "")
    assert "NOTE  contrast_snr" in loose.stdout
    strict = acutance("edge", edge_image, *limit, "--strict", "--json")
    assert strict.exit_code == 3
    assert not all(check["passed"] for check in json.loads(strict.stdout)["checks"])
    assert "check failed" in strict.stderr


def test_rer_can_be_centred_on_the_peak(acutance, edge_image):
    document = json.loads(acutance("edge", edge_image, "--rer-centre", "peak", "--json").stdout)
    assert document["rer_centre"] == "peak"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--figure", "edge.doc"), "has to be .png or .svg or .pdf"),
        (("--report", "nowhere/edge.html"), "the folder nowhere does not exist"),
        (("--csv", "mtf.txt"), "has to be .csv"),
        (("--covariance",), "add --json"),
        (("--all", "--compare", "fermi"), "cannot be combined"),
        (("--roi", "0,0,20,20", "--site", "stennis"), "give one of them"),
        (("--roi", "0,0,20"), "ROW,COL,HEIGHT,WIDTH"),
        (("--roi", "50,0,20,20"), "50"),
        (("--site", "atlantis"), "the sites are"),
        (("--site", "stennis"), "no CRS"),
        (("--band", "2"), "band 2"),
        (("--gsd", "metre"), "is not a distance"),
        (("--gsd", "-1"), "-1"),
        (("--method", "magic"), "magic"),
        (("--compare", "magic"), "magic"),
        (("--rer-centre", "middle"), "half or peak"),
        (
            ("--limit", "nonsense=1"),
            "no check 'nonsense' to limit (limits, --limit), only angle_deg, ",
        ),
        (("--limit", "rows=much"), "write NAME=VALUE with a number, as in rows=10"),
    ],
)
def test_what_means_nothing_is_exit_2_with_a_message(
    refused, edge_image, tmp_path, monkeypatch, words, message
):
    monkeypatch.chdir(tmp_path)
    refused(("edge", edge_image, *words), message)
    assert list(tmp_path.iterdir()) == []


def test_the_input_is_never_overwritten(acutance, edge_image, tmp_path):
    image = tmp_path / "scene.png"
    image.write_bytes(b"pixels")
    assert acutance("edge", image, "--figure", image).exit_code == 2
    assert image.read_bytes() == b"pixels"


def test_values_of_a_known_curve_are_linearised(acutance, edge_image, keeps_to_schema):
    result = acutance("edge", edge_image, "--gamma", "1.2", "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    keeps_to_schema(document)
    assert document["image"]["linearized"].startswith("gamma 1.2, full scale ")
    plain = json.loads(acutance("edge", edge_image, "--json").stdout)
    assert plain["image"]["linearized"] is None
    both = acutance("edge", edge_image, "--gamma", "1.2", "--linearize", "sRGB")
    assert both.exit_code == 2
    assert "--gamma and --linearize both name a curve: give one of them" in both.stderr


@pytest.mark.parametrize("softness", ["0.05+-0.02", "0.05±0.02", "0.05+/-0.02"])
def test_statements_reach_the_measurement_and_its_budget(
    acutance, edge_image, softness, keeps_to_schema
):
    stated = ("--target-softness-m", softness, "--level-uncertainty", "0.5%")
    document = json.loads(acutance("edge", edge_image, "--json", *stated).stdout)
    keeps_to_schema(document)
    assert document["options"]["target_softness_m"] == {"value": 0.05, "std": 0.02}
    assert document["options"]["level_uncertainty"] == pytest.approx(0.005)
    names = [row["term"] for row in document["budget"]]
    assert names[-2:] == ["target_softness", "level_uncertainty"]
    plain = json.loads(acutance("edge", edge_image, "--json").stdout)
    assert document["mtf_nyquist"]["value"] > plain["mtf_nyquist"]["value"]


@pytest.mark.parametrize(
    "wrong",
    [
        ("--target-softness-m", "soft"),
        ("--target-softness-px", "0.1+-0.2+-0.3"),
        ("--level-uncertainty", "half"),
        ("--level-uncertainty", "%"),
    ],
)
def test_statements_that_are_no_numbers_are_refused(acutance, edge_image, wrong):
    result = acutance("edge", edge_image, *wrong)
    assert result.exit_code == 2
    assert " ".join(wrong) in result.stderr


@pytest.mark.usefixtures("undrawn")
def test_requirements_are_answered_everywhere(acutance, edge_image, tmp_path, keeps_to_schema):
    words = ("edge", edge_image, "--require", "mtf_nyquist>=0.09", "--require", "fwhm_m <= 0.1")
    text = acutance(*words, "--report", tmp_path / "edge.html")
    assert text.exit_code == 0, text.stderr
    assert "across: mtf_nyquist >= 0.09 is met" in text.stdout
    assert "across: fwhm_m <= 0.1 is not met" in text.stdout
    page = (tmp_path / "edge.html").read_text()
    assert "Required across: mtf_nyquist &gt;= 0.09 is met" in page
    strict = acutance(*words, "--strict", "--json")
    assert strict.exit_code == 3
    assert "1 requirement is not met" in strict.stderr
    document = json.loads(strict.stdout)
    keeps_to_schema(document)
    assert [one["word"] for one in document["requirements"]] == ["met", "not met"]
    refused = acutance("edge", edge_image, "--require", "mtf_nyquist")
    assert refused.exit_code == 2
    assert "mtf_nyquist>=0.09" in refused.stderr


def test_methods_compared_answer_each_and_all_edges_by_their_means(acutance, edge_image):
    words = ("edge", edge_image, "--require", "mtf_nyquist>=0.09", "--json")
    compared = json.loads(acutance(*words, "--compare", "fermi").stdout)["requirements"]
    assert [one["method"] for one in compared] == ["spline", "fermi"]
    whole = json.loads(acutance(*words, "--all").stdout)
    (answer,) = whole["requirements"]
    assert answer["number"] == whole["groups"]["across"]["metrics"]["mtf_nyquist"]
