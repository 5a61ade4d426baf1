"""The numbers that docs/trends.rst prints of the published tables are those of the archive.

Where an estimator changes, the message of a test has the number that the page has to print.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import acutance as ac
from acutance.archive import Archive
from acutance.archive.published import PUBLISHED, published_entries
from acutance.archive.specification import Specification

PAGE = Path(__file__).parents[2] / "docs" / "trends.rst"
SECTION = "The published tables as an archive"
NUMBER = r"(-?\d*\.?\d+)"
MULTISPECTRAL = {"blue": 0.2, "green": 0.2, "NIR": 0.2}


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Archive]:
    with Archive(tmp_path_factory.mktemp("page") / "published.db") as made:
        for name in PUBLISHED:
            made.add_entries(published_entries(name))
        yield made


@pytest.fixture(scope="module")
def section() -> str:
    """The section in one line, with single blanks."""
    return " ".join(PAGE.read_text(encoding="utf-8").partition(SECTION)[2].split())


def require_printed(section: str, sentence: str, *values: float) -> None:
    """Each `#` of the sentence is a number of the page, right in its last digit."""
    pattern = re.escape(sentence).replace(r"\#", NUMBER)
    found = re.search(pattern, section)
    assert found, f"the page does not have: {sentence}"
    for text, value in zip(found.groups(), values, strict=True):
        digits = len(text.partition(".")[2])
        # A tenth of a digit more, for numbers in the middle between two.
        assert float(text) == pytest.approx(value, abs=0.6 * 10.0**-digits), sentence


def percent(share: ac.Estimate) -> tuple[float, float]:
    return 100 * share.value, 100 * share.std


def test_averages_of_kompsat_and_their_scatter(archive: Archive, section: str) -> None:
    rer, mtf = (
        archive.mean(name, sensor="KOMPSAT-3", orientation="across").mean
        for name in ("rer", "mtf_nyquist")
    )
    require_printed(
        section, "RER # ± #, MTF # ± # across", rer.value, rer.std, mtf.value, mtf.std
    )  # fmt: skip


def test_trend_of_kompsat(archive: Archive, section: str) -> None:
    rer, mtf = (
        archive.trend(name, sensor="KOMPSAT-3", orientation="across")
        for name in ("rer", "mtf_nyquist")
    )
    drift = rer.relative_rate_per_year
    widest = max(abs(100 * end) for end in drift.interval())
    require_printed(
        section,
        "no drift of RER (# ± # % a year across): the images cannot tell one below # % a year",
        *percent(drift),
        widest,
    )
    require_printed(
        section,
        "Images scatter by # % in RER and # % in the MTF at Nyquist",
        100 * rer.relative_scatter,
        100 * mtf.relative_scatter,
    )


def test_directions_of_kompsat(archive: Archive, section: str) -> None:
    pairs = []
    for name in ("rer", "fwhm_px", "mtf_nyquist"):
        (one,) = archive.compare(name, sensor="KOMPSAT-3").differences
        value, std = percent(one.relative)
        pairs += [abs(value), std]
    require_printed(
        section,
        "across is sharper than along, by # ± # % in RER, # ± # % in FWHM and # ± # % in the MTF "
        "at Nyquist",
        *pairs,
    )


def test_panchromatic_quickbird(archive: Archive, section: str) -> None:
    pan = {"sensor": "QB02", "band": "pan", "level": "CC", "kind": "edge"}
    table = archive.table(("date",), ("fwhm_m",), **pan)
    widths = [row.cells["across", "fwhm_m"].value for row in table.rows if not row.is_average]
    require_printed(section, "FWHM of #, #, # m in 2002 and # m in 2003", *widths)
    (answer,) = _answers(archive, {"pan": 0.09})
    assert answer.probability > 0.999
    assert "above .09 with a probability of more than .999" in section


def test_multispectral_quickbird(archive: Archive, section: str) -> None:
    blue = archive.trend("mtf_nyquist", sensor="QB02", band="blue", level="CC")
    (event,) = blue.events
    answers = _answers(archive, MULTISPECTRAL)
    first, *others = (answer.probability for answer in answers)
    require_printed(
        section,
        "# ± # at the end, above .20 with a probability of #; the change of GSD in 2003 comes "
        "with a step of # ± #",
        blue.level.value,
        blue.level.std,
        first,
        event.size.value,
        event.size.std,
    )
    require_printed(section, "Green #, which is met, near infrared #: that cannot", *others)
    assert [answer.word for answer in answers] == ["met", "met", "cannot be told yet"]


def _answers(archive: Archive, limits: dict[str, float]):
    spec = Specification.of(
        {
            "requirement": [
                {"metric": "mtf_nyquist", "minimum": least, "sensor": "QB02", "band": band,
                 "level": "CC", "orientation": "across"}
                for band, least in limits.items()
            ]
        }
    )  # fmt: skip
    return archive.check(spec).answers
