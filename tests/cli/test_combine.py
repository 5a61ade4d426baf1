"""``acutance combine`` on the documents the other commands write."""

import json

import numpy as np
import pytest

import acutance as ac
from acutance import optics, simulate

SENSOR = optics.Sensor([optics.Gaussian(0.4), optics.Detector()], gsd_m=0.7)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("measured")
    names = []
    for number, (angle, orientation) in enumerate(((6, "across"), (7, "along"), (30, "across"))):
        image, _ = simulate.edge(
            SENSOR, angle_deg=angle, orientation=orientation, shape=(50, 50), snr=100,
            rng=np.random.default_rng(number),
        )  # fmt: skip
        path = folder / f"edge-{number}.json"
        path.write_text(json.dumps(ac.measure_edge(image, gsd_m=0.7).to_dict()), encoding="utf-8")
        names.append(path)
    return names


def test_text_names_every_file_and_the_sensor(acutance, files):
    result = acutance("combine", *files)
    assert result.exit_code == 0, result.stderr
    for name in ("edge-0", "edge-1", "edge-2", "The sensor", "agreement"):
        assert name in result.stdout


def test_every_output_is_written(acutance, files, shown, tmp_path):
    report, figure, csv = (tmp_path / f"sensor.{end}" for end in ("html", "png", "csv"))
    result = acutance(
        "combine", *files, "--report", report, "--figure", figure, "--csv", csv, "--json"
    )
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["kind"] == "combined"
    assert document["across"]["mtf_nyquist"]["value"] == pytest.approx(0.289, abs=0.02)
    assert [(name, found.kind) for name, found, _ in shown] == [
        ("draw", "combined"), ("page", "combined"),
    ]  # fmt: skip
    assert csv.read_text(encoding="utf-8").startswith("direction,")


def test_one_of_a_file_of_many_is_left_out(acutance, files, tmp_path):
    many = tmp_path / "edges.json"
    results = [json.loads(one.read_text(encoding="utf-8")) for one in files]
    results[1]["image"]["region"] = "north"
    document = {"schema": "acutance/regions/1", "results": results}
    many.write_text(json.dumps(document), encoding="utf-8")
    result = acutance("combine", many, "--leave-out", f"{many} north", "--json")
    assert result.exit_code == 0, result.stderr
    parts = json.loads(result.stdout)["parts"]
    assert [one["name"] for one in parts] == [f"{many} 1", f"{many} 3"]
    refused = acutance("combine", many, "--leave-out", "south")
    assert refused.exit_code == 2
    words = f"none is called south, so it cannot be left out: there are {many} 1, {many} north"
    assert words in " ".join(refused.stderr.split())
    with pytest.raises(ac.OptionError, match="leave_out is 'north': give a list"):
        ac.combine(results, leave_out="north")


def test_strict_asks_for_three_directions(acutance, files):
    assert acutance("combine", *files[:2], "--strict").exit_code == 3
    assert acutance("combine", *files[:2], "--strict", "--limit", "directions=2").exit_code == 0


def test_the_detector_is_an_option(acutance, files):
    result = acutance("combine", *files, "--detector", "1,0.8", "--json")
    assert json.loads(result.stdout)["sensor"]["detector_px"] == [1.0, 0.8]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "holds no JSON"),
        ("[1, 2]", "is a list: give results"),
        ('{"type": "FeatureCollection"}', "no measurement of acutance"),
        (None, "cannot be read"),
    ],
)
def test_wrong_files_are_exit_2(acutance, files, tmp_path, content, message):
    wrong = tmp_path / "wrong.json"
    if content is not None:
        wrong.write_text(content, encoding="utf-8")
    result = acutance("combine", files[0], wrong)
    assert result.exit_code == 2
    assert message in result.stderr
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize("width", ["wide", "0", "1,2,3"])
def test_a_detector_that_is_none_is_exit_2(acutance, files, width):
    assert acutance("combine", *files, "--detector", width).exit_code == 2


def test_the_help_speaks_of_one_result(acutance):
    shown = " ".join(acutance("combine", "--help").stdout.split())
    assert "Draw the result: .png, .svg or .pdf." in shown
    assert "Of several" not in shown
    assert "Of several" in " ".join(acutance("edge", "--help").stdout.split())
