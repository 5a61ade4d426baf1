"""What no image and no target can have is refused where it is added as where it is corrected."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest

from acutance.archive import Archive, ImageCorrection, ImageEntry, TargetEntry
from acutance.archive.exchange.stac_item import image_properties, item_name
from acutance.archive.specification import Specification
from acutance.archive.tables import images
from acutance.archive.trends.series import date_of, decimal_year
from acutance.errors import OptionError

LATER = f"{datetime.now(UTC).year + 11}-01-01"
IMPOSSIBLE = [
    {"acquired": "1956-12-31"},
    {"acquired": "0001-01-01"},
    {"acquired": LATER},
    {"acquired": "9999-12-31"},
    {"gsd_m": (-1.0, 0.7)},
    {"gsd_m": (float("nan"), 0.7)},
    {"gsd_m": (1e-4, 1e-4)},
    {"sun_azimuth_deg": 400.0},
    {"view_zenith_deg": float("nan")},
    {"sun_elevation_deg": "high"},
]


def described(values):
    """An image with some values, dates as datetimes."""
    day = values.get("acquired")
    moment = {} if day is None else {"acquired": datetime.fromisoformat(day)}
    return ImageEntry(path="a.tif", **{**values, **moment})


@pytest.mark.parametrize("values", IMPOSSIBLE, ids=str)
def test_the_same_is_refused_of_additions_and_corrections(archive, edge_record, values):
    (name,) = values
    with pytest.raises(OptionError, match=name) as added:
        archive.add(edge_record, image=described(values))
    with pytest.raises(OptionError, match=name) as corrected:
        ImageCorrection(image="a.tif", **values)
    assert str(added.value).split(": ", 1)[1] == str(corrected.value).split(": ", 1)[1]
    assert len(archive.measurements()) == 0


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ({"lat": 200.0}, "lat of target t is 200.0"),
        ({"lon": float("nan")}, "lon of target t is nan"),
        ({"kind": "egde"}, "of the kind 'egde', and there are only edge"),
    ],
)
def test_targets_that_cannot_be(archive, entry_of, values, found):
    target = replace(TargetEntry(name="t", kind="edge"), **values)
    with pytest.raises(OptionError, match=found):
        archive.add_entries([entry_of(0, target=target)])


def test_days_that_can_be(archive, entry_of):
    days = datetime(1957, 1, 1, tzinfo=UTC), datetime.now(UTC) + timedelta(days=1)
    entries = [
        entry_of(2 * i, image=ImageEntry(content=f"{i:064x}", acquired=day))
        for i, day in enumerate(days)
    ]
    assert archive.add_entries(entries) == 2


def test_documents_that_cannot_be_are_refused_alone(archive, entry_of, tmp_path):
    archive.add_entries([entry_of(0), entry_of(2)])
    _write_date(archive, "0.tif", datetime(9999, 12, 31, tzinfo=UTC))
    assert archive.export(tmp_path / "out.jsonl", to="jsonl") == 2
    with Archive(tmp_path / "again.db") as again:
        done = again.import_documents(tmp_path / "out.jsonl")
    assert done.new == 1
    (reason,) = done.refused.values()
    assert "acquired is 9999-12-31: write a date from 1957-01-01" in reason


def test_one_gsd_is_that_of_square_pixels():
    assert ImageEntry(gsd_m=0.7) == ImageEntry(gsd_m=(0.7, 0.7))
    for wrong in ("0.7", (0.7,), (1, 2, 3)):
        with pytest.raises(OptionError, match="give metres"):
            ImageEntry(gsd_m=wrong)


def test_a_measured_gsd_is_kept_whatever_it_is(archive, edge_record):
    info = edge_record.document["image"]
    tiny = {**info, "pixel_gsd_m": [1e-4, 1e-4]} if "pixel_gsd_m" in info else info
    record = type(edge_record)({**edge_record.document, "image": tiny})
    assert archive.add(record, sensor="S").new


def test_empty_names_are_none(archive, entry_of, edge_record):
    assert archive.add(edge_record, sensor="").new
    assert archive.measurements()["sensor"].tolist() == [None]
    assert len(archive.measurements(sensor="")) == 1
    entry = entry_of(1, band="", target=TargetEntry(name="t", kind="edge", site=""))
    assert (entry.band, entry.target.site) == (None, None)
    assert ImageEntry(level="").level is None


def test_azimuths_of_stac_are_from_0_to_360():
    image = ImageEntry(view_azimuth_deg=-170.0, sun_azimuth_deg=400.0, sun_elevation_deg=-5.0)
    assert image_properties(image) == {
        "view:azimuth": 190.0, "view:sun_azimuth": 40.0, "view:sun_elevation": -5.0,
    }  # fmt: skip


def test_long_names_of_files_are_cut_in_stac(archive, entry_of, tmp_path):
    when = datetime(2026, 1, 1, tzinfo=UTC)
    names = ["x" * 251 + ".tif", "x" * 250 + "y.tif", "近" * 83 + ".tif"]
    each = [ImageEntry(path=name, content=f"{i:064x}", acquired=when)
            for i, name in enumerate(names)]  # fmt: skip
    archive.add_entries(entry_of(2 * i, image=image) for i, image in enumerate(each))
    assert archive.export(tmp_path / "out", to="stac") == 3
    assert len({item_name(image) for image in each}) == 3
    assert len(list((tmp_path / "out").glob("*/*.json"))) == 3
    assert item_name(ImageEntry(path="a b.tif")).startswith("a-b-")


def _write_date(archive, name, when):
    """Write a date that a version before this one took."""
    archive._database.write(
        lambda connection: connection.execute(
            images.update().where(images.c.name == name).values(acquired=when)
        )
    )


def test_kept_dates_that_cannot_be_end_nothing_and_are_named(archive, entry_of):
    archive.add_entries(entry_of(2 * i) for i in range(0, 40, 2))
    before = archive.trend("mtf_nyquist", sensor="K3")
    for name, year in (("4.tif", 9999), ("6.tif", 1), ("8.tif", 2150)):
        _write_date(archive, name, datetime(year, 1, 31, tzinfo=UTC))
    trend = archive.trend("mtf_nyquist", sensor="K3")
    assert trend.images.images == before.images.images - 3
    assert (trend.first, trend.last) == (before.first, before.last)
    (note,) = (one for one in trend.notes if "Correct them" in one)
    assert "3 images" in note
    for words in ("4.tif (9999-01-31)", "6.tif (0001-01-31)", "8.tif (2150-01-31)"):
        assert words in note
    wanted = {"metric": "mtf_nyquist", "minimum": 0.05, "window_days": 365, "sensor": "K3"}
    check = archive.check(Specification.of({"requirement": [wanted]}))
    assert check.answers[0].images == before.images.images - 3


@pytest.mark.parametrize("when", ["9999-12-31", "9999-12-31T23:59:59.999999Z", "0001-01-01"])
def test_first_and_last_days_are_years(when):
    assert date_of(decimal_year(when)).isoformat() == when[:10]


def test_images_of_days_to_come_are_named_by_the_trend(archive, entry_of):
    begin = datetime.now(UTC)
    entries = [
        entry_of(2 * i, image=ImageEntry(content=f"{i:064x}", sensor="S1", acquired=day))
        for i, day in enumerate(begin + timedelta(days=40 * at) for at in range(-4, 3))
    ]
    archive.add_entries(entries)
    trend = archive.trend("mtf_nyquist", sensor="S1")
    assert trend.images.images == 7
    assert "2 images have dates to come: a simulation, or wrong." in trend.notes
