"""``acutance study`` and ``acutance plan``: files, answers, and what is refused."""

import csv
import json

import pytest

SMALL = ("--set", "angles_deg=6.0,", "--set", "places=2", "--workers", "1")
PLAN = ("--rows", "30,40", "--angle", "6,9", "--draws", "2", "--workers", "1")


def test_a_study_writes_tables_document_figure_and_trials(acutance, tmp_path):
    done = acutance("study", "angle", *SMALL, "--out", tmp_path / "new" / "studies")
    assert done.exit_code == 0, done.stderr
    assert "at 6 deg the published estimator is" in done.stdout
    assert "(paper: -4.1)" in done.stdout
    folder = tmp_path / "new" / "studies"
    names = {path.name for path in folder.iterdir()}
    assert {"angle.csv", "angle-trials.csv", "angle.json", "angle.png"} < names
    (journal,) = folder.glob("angle-*.trials.jsonl")
    assert len(journal.read_text().splitlines()) == 2
    rows = list(csv.DictReader((folder / "angle.csv").read_text().splitlines()))
    assert [row["angle_deg"] for row in rows] == ["6"]
    document = json.loads((folder / "angle.json").read_text())
    assert document["options"]["places"] == 2
    assert document["options"]["sensor"]["blocks"][0] == "Gaussian sigma 0.39 px"


def test_a_study_again_reads_its_trials(acutance, tmp_path):
    first = acutance("study", "angle", *SMALL, "--out", tmp_path)
    (journal,) = tmp_path.glob("*.jsonl")
    before = journal.read_bytes()
    again = acutance("study", "angle", *SMALL, "--out", tmp_path)
    assert again.stdout == first.stdout
    assert journal.read_bytes() == before


def test_a_damaged_line_of_trials_is_one_line_of_stderr(acutance, tmp_path):
    first = acutance("study", "angle", *SMALL, "--out", tmp_path)
    (journal,) = tmp_path.glob("*.jsonl")
    lines = journal.read_text().splitlines(keepends=True)
    journal.write_text(lines[0] + "snow\n")
    again = acutance("study", "angle", *SMALL, "--out", tmp_path)
    assert (again.exit_code, again.stdout) == (0, first.stdout)
    assert again.stderr.startswith(f"acutance: {journal}, line 2: damaged, so passed over")
    assert "UserWarning" not in again.stderr
    assert journal.read_text() == lines[0] + "snow\n" + lines[1]


def test_json_is_the_document_alone(acutance):
    done = acutance("study", "width", "--set", "widths_px=2.9,3.0", "--workers", 1, "--json")
    document = json.loads(done.stdout)
    assert document["schema"] == "acutance/study/1"
    assert document["tables"]["width"]["stated_px"] == [2.9, 3.0, 3.0, 3.0]
    assert {found["name"] for found in document["findings"]} >= {"ours_width_px"}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("snow",), "there is no study 'snow'"),
        (("plan",), "plan is a command of its own: acutance plan edge"),
        (("angle", "--set", "colour=1"), "the options are angles_deg"),
        (("angle", "--set", "places=many"), "write a number"),
        (("angle", "--set", "places=1.5"), "places is a whole number"),
        (("angle", "--set", "places=0"), "there has to be a place"),
        (("angle", "--set", "sensor=snow"), "the sensor snow is no .toml file"),
        (("all", "--json"), "belong to one study"),
        (("snr", "--set", "noise_dn=5,many"), "write a number or several"),
        (
            ("snr", "--set", "noise_dn='a','b'"),
            "noise_dn is several numbers, as in noise_dn=2.0",
        ),
        (("snr", "--set", "pulse_dn=1,2,3"), "pulse_dn is 2 numbers, as in pulse_dn=100.0,1200.0"),
        (("snr", "--set", "draws=True"), "draws is a whole number, as in draws=10"),
        (("snr", "--set", "draws=1", "--set", "draws=2"), "draws was set before: set it once"),
        (("ground-noise", "--set", "ground=3"), "the options are angle_deg, ground.grains, ground"),
        (("ground-noise", "--set", "ground.variance=-1"), "GroundNoise"),
        (
            ("ground-noise", "--set", "levels_dn=900"),
            'several pairs of numbers, as in "levels_dn=(1100.0, 400.0),(1000.0',
        ),
        (("width-correction", "--set", "cases=3"), "the options are angle_deg, draws, gsd_m, sha"),
    ],
)
def test_what_makes_no_sense_is_refused(acutance, words, message):
    done = acutance("study", *words)
    assert done.exit_code == 2
    assert message in done.stderr
    assert done.stdout == ""


def test_ground_and_a_pair_of_levels_can_be_typed(acutance):
    done = acutance(
        "study", "ground-noise", "--set", "ground.variance=400", "--set", "ground.grains=1,2",
        "--set", "levels_dn=900,600", "--set", "runs=1", "--workers", 1, "--json",
    )  # fmt: skip
    document = json.loads(done.stdout)
    assert document["options"]["levels_dn"] == [[900, 600]]
    assert document["findings"][0]["text"].startswith("ground that varies by 28.3 DN")
    assert document["options"]["ground"]["grains"] == [1, 2]


def test_a_folder_that_is_a_file_is_refused(acutance, tmp_path):
    file = tmp_path / "file"
    file.write_text("")
    done = acutance("study", "angle", "--out", file)
    assert done.exit_code == 2
    assert "name a folder" in done.stderr


def test_an_edge_is_planned(acutance, tmp_path):
    done = acutance(
        "plan", "edge", "--gsd", 0.7, "--snr", 100, *PLAN, "--accuracy", 0.005,
        "--csv", tmp_path / "plan.csv", "--figure", tmp_path / "plan.png",
    )  # fmt: skip
    assert done.exit_code == 0, done.stderr
    for words in ("MTF at Nyquist: 0.00", "rows: a standard deviation of 0.005", "free LSF"):
        assert words in done.stdout, words
    rows = list(csv.DictReader((tmp_path / "plan.csv").read_text().splitlines()))
    assert float(rows[0]["length_m"]) == pytest.approx(30 * 0.7, rel=0.01)
    assert (tmp_path / "plan.png").stat().st_size > 10_000


def test_a_pulse_is_planned_in_metres(acutance):
    done = acutance(
        "plan", "pulse", "--width-m", "8.83,8.4", "--gsd", 2.8, "--contrast", 1000,
        "--noise", 20, *PLAN, "--json",
    )  # fmt: skip
    document = json.loads(done.stdout)
    assert document["options"]["snr"] == 50
    table = document["tables"]["plan"]
    # Of two widths the better is planned: 8.4 m are three pixels.
    assert table["target_width_m"][0] == pytest.approx(8.4)
    assert set(table["varied"]) == {"plan", "rows", "angle", "width"}


def test_a_width_in_metres_is_along_the_normal_where_pixels_are_not_square(acutance, tmp_path):
    sensor = "gsd_m = 1.0\ngsd_along_m = 2.0\n[[block]]\nkind = 'Gaussian'\nsigma_px = 0.4\n"
    (tmp_path / "long.toml").write_text(sensor)
    done = acutance(
        "plan", "pulse", "--sensor", tmp_path / "long.toml", "--width-m", "3", "--angle", "20",
        "--rows", "30", "--draws", "0", "--json",
    )  # fmt: skip
    table = json.loads(done.stdout)["tables"]["plan"]
    assert table["target_width_m"][0] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("edge", "--angle", "0"), "no sub-pixel phases"),
        (("edge", "--rows", "many"), "--rows many: write numbers"),
        (("edge", "--noise", "3"), "--contrast and --noise together"),
        (("edge", "--sensor", "snow"), "the sensor snow is no"),
        (("pulse", "--width-px", "3", "--width-m", "8"), "give one of them"),
        (("pulse", "--width-m", "8", "--sensor", "gaussian"), "add --gsd"),
        (
            ("pulse", "--width-m", "0.09"),
            "at a GSD of 1 m (that of generic-2005; --gsd is another)",
        ),
        (("pulse", "--width-m", "9", "--gsd", "0.03"), "at a GSD of 0.03 m (--gsd) is 300 px"),
        (("edge", "--gsd", "3cm"), "'3cm' is no number"),
        (("edge", "--csv", "plan.txt"), "has to be .csv"),
        (("edge", "--width-px", "3"), "an edge has no width"),
        (("bars",), "No such command 'bars'"),
        (("edge", "--rows", "100000"), "2000 are the most"),
    ],
)
def test_impossible_plans_are_refused(acutance, words, message):
    done = acutance("plan", *words)
    assert done.exit_code == 2
    assert message in done.stderr


@pytest.mark.parametrize("target", ["edge", "pulse", "mirrors"])
def test_the_usage_of_a_plan_names_its_command(acutance, target):
    usage = acutance("plan", target, "--help").stdout.splitlines()[0]
    assert usage.endswith(f" plan {target} [OPTIONS]")


def test_the_help_of_an_edge_s_plan_is_of_an_edge(acutance):
    edge, pulse = (acutance("plan", one, "--help").stdout for one in ("edge", "pulse"))
    assert "--width" not in edge
    assert "plan pulse" not in edge
    assert "--width-m" in pulse
    assert "plan edge" not in pulse
