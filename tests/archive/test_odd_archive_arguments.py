"""Whatever an archive is asked wrongly is refused in words, and numbers of numpy are numbers."""

import re
from datetime import date

import numpy as np
import pytest

import acutance as ac
from acutance.archive import Entry, ImageCorrection, ImageEntry, published_entries, weighted_mean
from acutance.archive.trends import Event, date_of, fit_trend
from acutance.errors import AcutanceError, OptionError
from acutance.targets import Rejected

WRONG = ["x", b"x", {"a": 1}, ["a"], 1j, list, object(), np.zeros((3, 3))]
REJECTED = Rejected("find", "no edge", {})


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    place = tmp_path_factory.mktemp("odd") / "odd.db"
    with ac.Archive(place) as opened:
        opened.add_entries(published_entries("kompsat3-2014"))
        opened.add_entries(
            Entry(rejected=REJECTED, image=ImageEntry(path=name, content=content), key=name)
            for name, content in (("/a/one.tif", "1" * 64), ("/b/two.tif", "2" * 64))
        )
        yield opened


def correction(image, **values):
    return ImageCorrection(image=image, **values)


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize(
    "call",
    [
        lambda a, x: ac.Archive(a.place, read_only=x),
        lambda a, x: a.add_entries(x if not isinstance(x, dict) else 3),
        lambda a, x: a.correct_images(x),
        lambda a, x: a.correct_images([], dry_run=x),
        lambda a, x: a.compare(x),
        lambda a, x: a.compare(by=x),
        lambda a, x: a.entry(x),
        lambda a, x: a.export("never.jsonl", to=x),
        lambda a, x: a.export(x if not isinstance(x, str) else 3, to="jsonl"),
        lambda a, x: a.import_documents([], sensor=x if not isinstance(x, str) else 3),
        lambda a, x: a.import_documents(["never.json"], run=x),
        lambda a, x: a.import_documents(["never.json"], progress=x if x is not list else 3),
        lambda a, x: a.import_documents(["never.json"], target=x if not isinstance(x, str) else 3),
        lambda a, x: a.export("never.jsonl", to="jsonl", progress=x if x is not list else 3),
        lambda a, x: a.add_entries([], run=x),
        lambda a, x: a.add_entries([], progress=x if x is not list else 3),
        lambda a, x: a.start_run(x if not isinstance(x, dict) else 3),
        lambda a, x: a.end_run(x, {}),
        lambda a, x: a.end_run(1, x if not isinstance(x, dict) else 3),
        lambda a, x: a.earlier_contents(x if not isinstance(x, dict) else 3),
        lambda a, x: a.kept_otherwise(x if not isinstance(x, dict) else 3),
        lambda a, x: a.kept_otherwise({}, x if not isinstance(x, dict) else 3),
        lambda a, x: a.require_known_names(x),
        lambda a, x: a.measurements(kind=x),
        lambda a, x: a.measurements(orientation=x),
        lambda a, x: a.measurements(verdict=x),
        lambda a, x: a.measurements(limits=x),
        lambda a, x: a.measurements(run=x),
        lambda a, x: a.remove_images(x),
        lambda a, x: a.remove_images([], dry_run=x),
        lambda a, x: a.series(x),
        lambda a, x: a.table(by=x),
        lambda a, x: a.table(metrics=x),
        lambda a, x: Entry(record=x),
        lambda a, x: Entry(rejected=REJECTED, image=x),
        lambda a, x: Event(x if not isinstance(x, str) else "yesterday", "refocus"),
        lambda a, x: Event("2026-05-01", x if not isinstance(x, str) else 3),
        lambda a, x: date_of(x),
        lambda a, x: fit_trend(x),
        lambda a, x: published_entries(x),
        lambda a, x: weighted_mean([0.1, 0.2], [0.1, 0.1]).probability_below(x),
    ],
)
def test_what_is_of_the_wrong_kind_is_refused(archive, call, wrong):
    with pytest.raises(
        AcutanceError, match=r"give|ha(s|ve) to|there is no|it is|choose|select|write|there are"
    ):
        call(archive, wrong)


def test_numbers_of_numpy_are_numbers(archive):
    rows = archive.measurements()
    number = rows["id"][0]
    assert archive.entry(np.int64(number)) == archive.entry(int(number))
    low = np.float64(rows["rer"].max())
    for limit in (float(low), low):
        found = archive.measurements(limits={"rer": (limit, None)})
        assert 0 < len(found) < len(rows)
    everything = archive.measurements(limits={"rer": (np.int64(0), np.int64(1))})
    assert len(everything) == len(archive.measurements(limits={"rer": (0, 1)})) > 0


def test_a_table_is_printed_as_one(archive):
    table = archive.table(by=("site",))
    lines = str(table).splitlines()
    assert re.match(r"site +images +GSD \[m\] +rer across", lines[0])
    assert len(lines) > len(table.rows)
    assert not any(line.startswith("MeasurementTable(") for line in lines)


def test_corrections_are_printed_by_what_changes(archive):
    found = archive.correct_images([correction("one.tif", sensor="A")], dry_run=True)
    assert repr(found) == "[<CorrectedImage: /a/one.tif: sensor – → A (1 rejection)>]"


@pytest.mark.parametrize("names", [("one.tif", "/a/one.tif"), ("/a/one.tif", "1" * 64)])
def test_one_image_has_one_value_whatever_it_is_called(archive, names):
    first, second = names
    two = [correction(first, sensor="A"), correction(second, sensor="B")]
    with pytest.raises(OptionError, match=r"are one image, and its sensor is to be A and B: leave"):
        archive.correct_images(two, dry_run=True)
    same = [correction(first, sensor="A"), correction(second, sensor="A", level="1")]
    assert len(archive.correct_images(same, dry_run=True)) == 1


def test_an_exception_follows_a_pattern(archive):
    some = [correction("*.tif", sensor="A"), correction("/b/two.tif", sensor="B")]
    found = archive.correct_images(some, dry_run=True)
    assert [one.changes["sensor"] for one in found] == [(None, "A"), (None, "B")]


def test_years_without_a_day_are_refused():
    with pytest.raises(OptionError, match="year is 0: give one from 1 to 9999"):
        date_of(0)
    assert date_of(np.float64(2026.0)) == date(2026, 1, 1)


def test_a_comparison_names_images_of_days_to_come(tmp_path):
    sensor = ac.Sensor([ac.optics.Gaussian(0.4), ac.optics.Detector()])
    with ac.Archive(tmp_path / "dates.db") as archive:
        for seed, along in ((0, False), (1, True)):
            pixels, _ = ac.simulate.edge(
                sensor, snr=100, rng=np.random.default_rng(seed),
                orientation="along" if along else "across",
            )  # fmt: skip
            archive.add(
                ac.measure_edge(pixels),
                image=ImageEntry(path=f"{seed}.tif", sensor="S"), target="field",
            )  # fmt: skip
        assert archive.compare().notes == ()
        ahead = f"{date.today().year + 5}-01-01"
        archive.correct_images([correction("0.tif", acquired=ahead)])
        found = archive.compare()
    assert found.notes == ("1 image has a date to come: a simulation, or wrong.",)
    assert found.notes[0] in found.summary
    assert found.to_dict()["notes"] == list(found.notes)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"value": "x"}, "value is 'x': it has to hold numbers"),
        ({"value": [], "std": []}, "0 measurements"),
        ({"std": [0.1, 0.1, 0.1]}, r"std has the shape \(3,\), the values \(2,\): give"),
        ({"systematic_std": "x"}, "systematic_std is 'x'"),
        ({"group": 3}, "group is 3: give a list"),
        ({"group": [1]}, "1 groups of 2 measurements: give one of each"),
        ({"lowest": "x"}, "lowest is 'x', it has to be a number"),
    ],
)
def test_means_are_of_numbers(arguments, message):
    with pytest.raises(OptionError, match=message):
        weighted_mean(**{"value": [0.1, 0.2], "std": [0.1, 0.1], **arguments})
