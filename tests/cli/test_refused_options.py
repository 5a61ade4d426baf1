"""Options that mean nothing are refused with exit code 2 and words, never silently changed."""

import pytest

from acutance.raster import open_image


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("target", ["edge", "pulse", "bars", "star", "points", "site", "pair"])
def test_a_seed_is_0_or_more(refused, folder, target):
    more = ("--high", "b.tif") if target == "pair" else ()
    refused(("simulate", target, "--seed", -1, "--out", "a.tif", *more), "--seed")
    assert not list(folder.iterdir())


def test_the_seed_of_a_demo_is_0_or_more(refused, folder):
    refused(("demo", "d", "--seed", -1), "--seed")
    assert not list(folder.iterdir())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("site", "--targets", 0), "--targets"),
        (("site", "--targets", -1), "--targets"),
        (("site", "--size", "300,300"), "--size 300,300 belongs to --targets"),
        (("site", "--texture", -1), "it has to be 0 or more"),
        (("site", "--targets", 3, "--size", "1000000,1000000"), "400 million pixels"),
        (("edge", "--size", "1000000,1000000"), "25 million pixels"),
        (("edge", "--dark", 3, "--bright", 1), "(--falling) turns the edge round"),
        (("pulse", "--width-px", 0), "it has to be above 0 (--width-px, --width-m)"),
        (("pulse", "--width-px", 300), "or a narrower pulse (--width-px, --width-m)"),
        (("points", "--peak", 0), "peak is 0"),
        (("points", "--peak", -3), "peak is -3"),
        (("pair", "--high", "b.tif", "--gain", 0), "the gain cannot be 0"),
        (("pair", "--high", "b.tif", "--gsd", -1), "a GSD of -1 m between rows means nothing"),
        (("pair", "--high", "b.tif", "--gsd", "nan"), "a GSD of nan m"),
        (("pair", "--high", "b.tif", "--gsd", "1e9"), "have 0.005 to 100000 m"),
        (("pair", "--high", "b.tif", "--shift", "1e9,0"), "at most half of the image"),
    ],
)
def test_scenes_that_cannot_be_rendered(refused, folder, words, message):
    refused(("simulate", *words, "--out", "a.tif"), message)
    assert not list(folder.iterdir())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("edge", "--limit", "rows=nan"), "--limit rows=nan: write NAME=VALUE with a number"),
        (
            ("edge", "--limit", "rows=-5"),
            "limit of rows is -5, and what is compared",
        ),
        (("edge", "--limit", "saturation=3"), "is from 0 to 1 (limits, --limit)"),
        (("edge", "--limit", "rows=many"), "with a number, as in rows=10"),
        (("edge", "--limit", "rows"), "write NAME=VALUE"),
        (
            ("edge", "--limit", "plateau_px=30"),
            "no check 'plateau_px' to limit (limits, --limit), only angle_deg",
        ),
        (("pulse", "--limit", "uniformity=30"), "uniformity_behind"),
        (("points", "--limit", "rows=1"), "peak_snr"),
        (("bars", "--limit", "rows=1"), "bar_directions"),
        (("star", "--limit", "rows=1"), "sweep_deg"),
        (("edge", "--method", "fermi", "--no-robust"), "--no-robust) is a choice of the reference"),
        (("edge", "--all", "--method", "fermi", "--no-robust"), "fermi bounds no weights"),
        (("edge", "--compare", "sdsu-2005", "--no-robust"), "sdsu-2005 bounds no weights"),
        (
            ("edge", "--compare", "spline"),
            "compares spline with nothing: name others, of sdsu-2005",
        ),
        (("edge", "--compare", ","), "compares spline with nothing"),
        (("pulse", "--compare", "spline"), "compares spline with nothing"),
        (("edge", "--target-softness-px", "0.3+-nan"), "--target-softness-px is 0.3 ± nan: "),
        (("pulse", "--target-softness-m=-0.1"), "--target-softness-m is -0.1: a standard"),
        (
            ("edge", "--target-softness-m", "0.1+--0.2"),
            "--target-softness-m 0.1+--0.2: its standard deviation is -0.2, below 0",
        ),
        (
            ("pulse", "--target-softness-m", "0.1", "--target-softness-px", "0.2"),
            "acutance: --target-softness-m and --target-softness-px state the same thing: give one",
        ),
        (("points", "--min-snr", "nan"), "--min-snr has to be a number, found nan"),
        (("scan", "--field", "0x0"), "places (--field) is 0 x 0: give 1 to 20"),
        (("scan", "--min-length", "nan"), "--min-length has to be a number, found nan"),
        (("star", "--inner", -5), "inner_px (--inner) is -5"),
        (("star", "--level-std", 3), "give dark and bright (--dark, --bright)"),
        (("bars", "--level-std", 3), "give dark and bright (--dark, --bright)"),
        (("bars", "--dark", 3), "give dark and bright, or neither (--dark, --bright)"),
    ],
)
def test_measurements_that_mean_nothing(refused, edge_image, words, message):
    refused((words[0], edge_image, *words[1:]), message)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("edge", "--draws", 1), "give 2 or more, or 0"),
        (("edge", "--snr", 0), "acutance: --snr is 0: give 1 to 1e+06"),
        (("edge", "--draws", 0, "--snr", "inf"), "acutance: --snr is inf: give 1 to 1e+06"),
        (("edge", "--rows", "nan"), "write whole numbers"),
        (("edge", "--rows", "30.5"), "write whole numbers"),
    ],
)
def test_plans_that_mean_nothing(refused, words, message):
    refused(("plan", *words), message)


@pytest.mark.parametrize(
    ("words", "option"),
    [
        (("edge", "x.tif", "--report", "a.html", "--report", "b.html"), "--report was given 2"),
        (("archive", "list", "a.db", "--last=3", "--last", "2"), "--last was given 2"),
        (("plan", "edge", "--rows", "3", "--rows", "4", "--rows", "5"), "--rows was given 3"),
    ],
)
def test_an_option_of_one_value_is_given_once(refused, folder, words, option):
    refused(words, f"{option} times, and only the last would count: give it once")
    assert not list(folder.iterdir())


def test_options_of_several_values_are_given_often(acutance, edge_image):
    words = ("--limit", "rows=1", "--limit", "angle_deg=0", "--json", "--json")
    assert acutance("edge", edge_image, *words).exit_code == 0


def test_an_edge_can_fall(acutance, folder):
    result = acutance("simulate", "edge", "--falling", "--out", "a.tif")
    assert result.exit_code == 0, result.stderr
    pixels = open_image("a.tif").read()
    assert pixels[:, 0].mean() > 1100
    assert pixels[:, -1].mean() < 300


def test_too_little_memory_is_said(refused, monkeypatch):
    def broken(**_):
        raise MemoryError("Unable to allocate 7 TiB")

    monkeypatch.setattr("acutance.raster.sites", broken)
    refused(("sites",), "not enough memory (Unable to allocate 7 TiB): choose a smaller")
