"""The tables of the QuickBird and KOMPSAT-3 documents, typed in as an archive."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

import acutance as ac
from acutance.archive import Archive
from acutance.archive.published import PUBLISHED, published_entries
from acutance.archive.specification import Specification

# Averages as they are printed, two more digits than the least of our rounding.
KOMPSAT = {
    "Salon": (0.4269, 1.674, 9.89, 0.4103, 1.929, 6.79),
    "Stennis": (0.4509, 1.610, 11.76, 0.4348, 1.793, 8.58),
    "Penghu": (0.4263, 1.631, 10.85, 0.4174, 1.907, 7.99),
    "average": (0.4388, 1.631, 11.07, 0.4243, 1.856, 7.99),
}


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Archive]:
    place: Path = tmp_path_factory.mktemp("published") / "published.db"
    with Archive(place) as made:
        for name in PUBLISHED:
            entries = published_entries(name)
            assert made.add_entries(entries) == len(entries)
            assert made.add_entries(entries) == 0
        yield made


def test_the_averages_of_kompsat_are_those_printed(archive: Archive) -> None:
    found = archive.table(("site", "date", "target"), sensor="KOMPSAT-3")
    names = ("rer", "fwhm_px", "mtf_nyquist")
    for site, printed in KOMPSAT.items():
        (row,) = [one for one in found.rows if one.group[0] == site and one.is_average
                  and (site == "average" or one.group[1] == "average")]  # fmt: skip
        cells = [row.cells[side, name] for side in ("across", "along") for name in names]
        for cell, value in zip(cells, printed, strict=True):
            scale = 100 if value > 5 else 1
            # Means are printed to four digits, of numbers that were rounded themselves.
            assert scale * cell.value == pytest.approx(value, abs=0.006 if scale > 1 else 0.0011)
            assert cell.std > 0
    assert sum(not row.is_average for row in found.rows) == 24
    assert {row.gsd_m for row in found.rows} == {(0.7, 0.7)}


def test_single_rows_are_as_printed(archive: Archive) -> None:
    found = archive.table(("date",), ("fwhm_px", "fwhm_m", "mtf_nyquist"), sensor="QB02",
                          band="pan", kind="edge", level="CC")  # fmt: skip
    texts = list(found.texts())
    assert found.header[:3] == ("date", "images", "GSD [m]")
    assert texts[0] == ("2002-07-20", "1", "0.7", "1.4560", "1.0192", "0.1599")
    assert texts[3] == ("2003-09-15", "1", "0.6", "1.3943", "0.8366", "0.1511")
    assert texts[4][2] == "0.6–0.7"


def test_pulse_responses_are_the_tarp_in_metres(archive: Archive) -> None:
    found = archive.table(("date",), ("prf_fwhm_px", "prf_fwhm_m"), band="blue", level="CC")
    cells = {row.group[0]: row.cells for row in found.rows}
    assert cells["2002-06-27"]["across", "prf_fwhm_px"].value == 4.1680
    metres = [one["across", "prf_fwhm_m"].value for day, one in cells.items() if day > "2002-07"]
    assert all(8.7 < one < 9.3 for one in metres)


def test_levels_and_bands_are_never_mixed(archive: Archive) -> None:
    found = archive.table(("site",), ("mtf_nyquist",), sensor="QB02", kind="pulse")
    assert found.by == ("band", "level", "site")
    assert not any(row.is_average for row in found.rows)
    with pytest.raises(ac.OptionError, match="of 2 levels, CC, MTF: select one"):
        archive.trend("mtf_nyquist", sensor="QB02", band="blue")


def test_the_trend_of_kompsat_finds_the_day_its_authors_ask_about(archive: Archive) -> None:
    for orientation in ("across", "along"):
        trend = archive.trend("rer", sensor="KOMPSAT-3", orientation=orientation)
        assert [str(day.date) for day in trend.bad_days] == ["2014-01-17"]
        low, high = trend.relative_rate_per_year.interval()
        assert low < 0 < high
        assert not trend.changes
        assert trend.images.images == 12


def test_a_changed_gsd_is_said(archive: Archive) -> None:
    trend = archive.trend("mtf_nyquist", sensor="QB02", band="blue", level="CC")
    assert [event.name for event in trend.events] == ["GSD 2.8 to 2.4 m"]
    widths = archive.trend("fwhm_m", sensor="QB02", band="pan", kind="edge", level="CC")
    assert not widths.events


def test_the_specification_of_the_data_purchase(archive: Archive) -> None:
    spec = Specification.of({"requirement": [
        {"metric": "mtf_nyquist", "minimum": 0.09, "sensor": "QB02", "band": "pan", "level": "CC"},
        {"metric": "mtf_nyquist", "minimum": 0.2, "sensor": "QB02", "band": "NIR", "level": "CC"},
        {"metric": "mtf_nyquist", "minimum": 0.2, "sensor": "KOMPSAT-3", "band": "NIR"},
    ]})  # fmt: skip
    found = archive.check(spec, orientation="across")
    assert [answer.word for answer in found.answers] == [
        "met", "cannot be told yet", "cannot be told yet"
    ]  # fmt: skip
    assert found.word == "cannot be told yet"
    assert "there is no image" in found.answers[2].summary


def test_the_mean_of_images_has_their_scatter(archive: Archive) -> None:
    found = archive.mean("mtf_nyquist", sensor="KOMPSAT-3", orientation="across")
    assert found.count == 12
    assert found.mean.value == pytest.approx(0.1107, abs=1e-4)
    assert found.scatter.value > found.mean.std


def test_documents_say_what_was_not_printed() -> None:
    record = published_entries("quickbird-2003")[0].record
    assert record is not None
    assert record.method == "published"
    assert record.verdict.word == "good"
    assert "standard deviations" in record.document["published"]["not_printed"]
    assert record.across.numbers["mtf_nyquist"] == ac.Estimate(0.1599, float("nan"))
    with pytest.raises(ac.OptionError, match="there is no publication 'x'"):
        published_entries("x")


@pytest.mark.parametrize(
    ("by", "metrics", "message"),
    [(("moon",), ("rer",), "a table is by moon"), (("site",), ("mtf",), "there is no metric mtf")],
)
def test_tables_that_mean_nothing(
    archive: Archive, by: tuple[str, ...], metrics: tuple[str, ...], message: str
) -> None:
    with pytest.raises(ac.OptionError, match=message):
        archive.table(by, metrics)
