"""Comparisons: intervals hold, what is common cancels, what confounds is allowed for or said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import acutance as ac
from acutance.archive import Archive, Entry, ImageEntry
from acutance.archive.columns import Columns
from acutance.archive.comparisons import Difference, GroupComparison, compare_groups
from acutance.errors import NothingSelectedError, OptionError

LEVEL = 0.16


def rows_of(*parts: dict[str, Any]) -> Columns:
    """Rows of an archive; every part has columns of n, or one value for all of them."""
    fixed = {
        "sensor": "QB02", "band": "pan", "level": None, "orientation": "across", "kind": "edge",
        "method": "spline", "target": "tarp", "site": "Salon", "gsd_m": 0.6,
        "mtf_nyquist_std": 0.003, "mtf_nyquist_systematic_std": 0.0,
    }  # fmt: skip
    filled = []
    for number, part in enumerate(parts):
        size = len(part["mtf_nyquist"])
        own = {"id": 1000 * number + np.arange(size), **fixed, **part}
        own["acquired"] = dates(own.pop("year", np.full(size, 2024.0)))
        filled.append({
            name: np.full(size, one, object if one is None or isinstance(one, str) else float)
            if np.ndim(one) == 0 else np.asarray(one)
            for name, one in own.items()
        })  # fmt: skip
    return Columns({name: np.concatenate([one[name] for one in filled]) for name in filled[0]})


def dates(year: np.ndarray) -> np.ndarray:
    return np.datetime64("2020-01-01", "us") + (31_557_600e6 * (year - 2020)).astype("m8[us]")


def only(found: GroupComparison) -> Difference:
    assert len(found.differences) == 1
    return found.differences[0]


def edges(rng: np.random.Generator, images: int) -> Columns:
    """Across and along edges of the same images; across is larger by 2 %."""
    air = 0.04 * LEVEL * rng.standard_normal(images)
    parts = [
        {
            "orientation": name, "image_id": np.arange(images), "target": name,
            "mtf_nyquist": level + air + 0.02 * LEVEL * rng.standard_normal(images),
        }
        for name, level in (("across", 1.02 * LEVEL), ("along", LEVEL))
    ]  # fmt: skip
    return rows_of(*parts)


def methods(rng: np.random.Generator, images: int) -> Columns:
    """Two methods on the same edges: nine tenths of the variance of their errors are the same."""
    shape = (images, 1)
    common = 0.04 * LEVEL * rng.standard_normal((images, 1)) + 0.003 * rng.standard_normal(shape)
    parts = [
        {
            "method": name, "image_id": np.arange(images), "target": "a",
            "mtf_nyquist": (level + common + 0.001 * rng.standard_normal(shape)).ravel(),
        }
        for name, level in (("one", 1.02 * LEVEL), ("other", LEVEL))
    ]  # fmt: skip
    return rows_of(*parts)


def followers(rng: np.random.Generator, images: int, rate: float = -0.03) -> Columns:
    """A method that took over from another two years later, of a sensor that drifts."""
    parts = []
    for number, (name, level) in enumerate((("new", 1.02 * LEVEL), ("old", LEVEL))):
        year = 2022 - 2 * number + 3 * rng.random(images)
        drift = 1 + rate * (year - 2022)
        parts.append({
            "method": name, "image_id": 100 * number + np.arange(images), "year": year,
            "mtf_nyquist": level * drift + 0.04 * LEVEL * rng.standard_normal(images),
        })  # fmt: skip
    return rows_of(*parts)


def sensors(rng: np.random.Generator, images: int, alone: float = 0.01) -> Columns:
    """Two sensors over five targets that differ by 5 %, each image of one of them.

    `alone` is what a target does to one of the sensors only.
    """
    targets = 0.05 * LEVEL * rng.standard_normal(5)
    parts = []
    for number, (name, level) in enumerate((("A", 1.02 * LEVEL), ("B", LEVEL))):
        at = np.arange(images) % targets.size
        own = (targets + alone * LEVEL * rng.standard_normal(targets.size))[at]
        parts.append({
            "sensor": name, "image_id": 10**6 * number + np.arange(images),
            "target": np.array([f"target {one}" for one in at], object),
            "mtf_nyquist": level + own + 0.03 * LEVEL * rng.standard_normal(images),
        })  # fmt: skip
    return rows_of(*parts)


@pytest.mark.parametrize(
    ("simulate", "by", "images", "basis", "draws"),
    [(edges, "orientation", 12, "image", 500), (edges, "orientation", 3, "image", 500),
     (methods, "method", 8, "target", 500), (followers, "method", 15, "means", 500),
     (sensors, "sensor", 15, "targets", 1000)],
)  # fmt: skip
def test_intervals_hold(simulate, by, images, basis, draws) -> None:
    """A deviation 0.8 or 1.25 times the true one leaves these bounds, as the other two show."""
    rng = np.random.default_rng(11)
    off = []
    for _ in range(draws):
        one = only(compare_groups(simulate(rng, images), "mtf_nyquist", by))
        assert one.basis == basis
        off.append(abs(one.difference.value - 0.02 * LEVEL) / one.difference.std)
    held = np.mean(np.array(off) < 1.96)
    assert 0.93 < held < 0.97
    if images > 5:
        assert np.mean(np.array(off) < 0.8 * 1.96) < 0.93
        assert np.mean(np.array(off) < 1.25 * 1.96) > 0.97


@pytest.mark.parametrize(("kinds", "least"), [(3, 0.93), (8, 0.93)])
def test_targets_come_again_in_every_image(kinds: int, least: float) -> None:
    """Forty images do not average out what differs between a few targets."""
    rng = np.random.default_rng(12)
    held = 0
    for _ in range(150):
        parts = []
        for name in ("across", "along"):
            own = 0.03 * LEVEL * rng.standard_normal(kinds)
            value = LEVEL + own + 0.01 * LEVEL * rng.standard_normal((40, kinds))
            targets = np.array([f"{name} {at}" for at in range(kinds)] * 40, object)
            parts.append({"orientation": name, "image_id": np.repeat(np.arange(40), kinds),
                          "target": targets, "mtf_nyquist": value.ravel()})  # fmt: skip
        one = only(compare_groups(rows_of(*parts), "mtf_nyquist"))
        held += abs(one.difference.value) < 1.96 * one.difference.std
    assert held / 150 > least


def test_what_a_target_does_to_both_sensors_cancels() -> None:
    """The least possible is what a target does to one of them, and the scatter of images."""
    rng = np.random.default_rng(14)
    std = [
        only(compare_groups(sensors(rng, 40), "mtf_nyquist", "sensor")).relative.std
        for _ in range(100)
    ]
    least = np.hypot(0.01, 0.03 / 8**0.5) * (2 / 5) ** 0.5
    assert least < np.median(std) < 1.6 * least


def test_as_many_images_of_a_target_as_there_are_count() -> None:
    """Of 600 images each has some partners only: the mean difference is of all of them."""
    rng = np.random.default_rng(15)
    rows = sensors(rng, 3000, alone=0.0)
    one = only(compare_groups(rows, "mtf_nyquist", "sensor"))
    is_first = rows["sensor"] == "A"
    difference = rows["mtf_nyquist"][is_first].mean() - rows["mtf_nyquist"][~is_first].mean()
    assert one.difference.value == pytest.approx(difference, abs=1e-12)
    assert one.images == (3000, 3000)
    assert one.sentence.endswith("on the same targets in 3000 and in 3000 images.")


def test_few_common_targets_do_not_hide_what_the_means_tell() -> None:
    """Three targets of both among thirty of each: of them the other ones tell more."""
    rng = np.random.default_rng(16)
    parts = []
    for number, (name, level) in enumerate((("A", 1.02 * LEVEL), ("B", LEVEL))):
        of = np.arange(60) % 30
        names = [f"{'' if at < 3 else name}{at}" for at in of]
        parts.append({
            "sensor": name, "image_id": 1000 * number + np.arange(60),
            "target": np.array(names, object),
            "mtf_nyquist": level + 0.03 * LEVEL * rng.standard_normal(60),
        })  # fmt: skip
    assert only(compare_groups(rows_of(*parts), "mtf_nyquist", "sensor")).basis == "means"


def test_what_an_image_does_to_both_cancels() -> None:
    rng = np.random.default_rng(1)
    rows = edges(rng, 60)
    together = only(compare_groups(rows, "mtf_nyquist"))
    other = np.where(rows["orientation"] == "along", 1000 + rows["image_id"], rows["image_id"])
    apart = only(compare_groups(Columns({**rows.columns, "image_id": other}), "mtf_nyquist"))
    assert together.basis == "image"
    assert apart.basis == "means"
    assert together.difference.std < 0.7 * apart.difference.std


def test_a_drift_is_not_taken_for_a_difference_of_methods() -> None:
    rng = np.random.default_rng(2)
    rows = followers(rng, 30, rate=-0.08)
    value, is_new = rows["mtf_nyquist"], rows["method"] == "new"
    naive = value[is_new].mean() / value[~is_new].mean() - 1
    assert naive < -0.1
    one = only(compare_groups(rows, "mtf_nyquist", "method"))
    low, high = one.relative.interval()
    assert low < 0.02 < high
    assert one.difference.std > 0.0022
    when = np.where(is_new, rows["acquired"], rows["acquired"] - np.timedelta64(2000, "D"))
    late = Columns({**rows.columns, "image_id": rows["image_id"], "acquired": when})
    assert (
        "edge new took over from edge old"
        in only(compare_groups(late, "mtf_nyquist", "method")).summary
    )


def test_what_does_not_average_out_stays() -> None:
    rng = np.random.default_rng(3)
    rows = edges(rng, 200)
    exact = only(compare_groups(rows, "mtf_nyquist"))
    shared = np.full(len(rows), 0.0015)
    one = only(
        compare_groups(
            Columns({**rows.columns, "mtf_nyquist_systematic_std": shared}), "mtf_nyquist"
        )
    )
    assert exact.answer == "differ"
    assert one.systematic_std == pytest.approx(0.0015 * np.sqrt(2))
    assert one.difference.std > one.systematic_std
    assert one.answer == "agree"


def test_answers_in_words() -> None:
    rng = np.random.default_rng(4)
    one = only(compare_groups(edges(rng, 40), "mtf_nyquist"))
    assert one.sentence.startswith("QB02, pan: across is sharper than along by ")
    assert "less than 5 %" in one.sentence
    assert one.sentence.endswith("measured side by side in 40 images.")
    assert one.probability > 0.975
    assert one.summary.endswith(
        "One target of each group: what is peculiar to it is part of the difference."
    )
    strict = only(compare_groups(edges(rng, 3), "mtf_nyquist", margin=0.001))
    assert strict.answer == "cannot be told"
    widths = edges(rng, 40)
    columns = {name.replace("mtf_nyquist", "fwhm_px"): one for name, one in widths.columns.items()}
    blurred = only(compare_groups(Columns(columns), "fwhm_px"))
    assert "along is sharper than across" in blurred.sentence


def test_three_methods_scatter() -> None:
    rng = np.random.default_rng(5)
    air = 0.04 * LEVEL * rng.standard_normal(20)
    parts = [
        {"method": name, "image_id": np.arange(20),
         "mtf_nyquist": level * LEVEL + air + 0.001 * rng.standard_normal(20)}
        for name, level in (("a", 0.95), ("b", 1.0), ("c", 1.05))
    ]  # fmt: skip
    found = compare_groups(rows_of(*parts), "mtf_nyquist", "method")
    assert len(found.differences) == 3
    scatter = found.scatters[0]
    assert scatter.scatter.value == pytest.approx(0.05, rel=0.1)
    assert scatter.interval[0] < 0.05 < scatter.interval[1]
    assert [round(one.value, 2) for one in scatter.offsets.values()] == [-0.05, 0.0, 0.05]
    assert "3 methods scatter by" in found.summary
    assert found.to_dict()["scatters"][0]["offsets"]["edge a"]["value"] < 0


def test_bands_and_sensors_are_not_mixed() -> None:
    rng = np.random.default_rng(6)
    two = [edges(rng, 5), edges(rng, 5)]
    columns = {
        name: np.concatenate([one[name] for one in two]) for name in two[0].columns
    }  # fmt: skip
    columns["band"] = np.array(["pan"] * 10 + ["red"] * 10, object)
    found = compare_groups(Columns(columns), "mtf_nyquist")
    assert [one.of for one in found.differences] == ["QB02, pan", "QB02, red"]


def test_one_measurement_of_each_tells_nothing_without_deviations() -> None:
    rows = rows_of(
        {"method": "a", "image_id": [1], "mtf_nyquist": [0.1]},
        {"method": "b", "image_id": [1], "mtf_nyquist": [0.2]},
    )
    one = only(compare_groups(rows, "mtf_nyquist", "method"))
    assert one.answer == "cannot be told"
    assert one.to_dict()["probability"] is None
    assert "One image" in one.summary
    assert "edge a and edge b differ cannot be told (MTF at Nyquist, without" in one.sentence


def test_what_cannot_be_compared_is_refused() -> None:
    rows = edges(np.random.default_rng(7), 3)
    with pytest.raises(OptionError, match="no metric 'mtf'"):
        compare_groups(rows, "mtf")
    with pytest.raises(OptionError, match="'moon' cannot be compared"):
        compare_groups(rows, "mtf_nyquist", "moon")
    for margin in (0, 5, float("nan")):
        with pytest.raises(OptionError, match=f"margin is {margin}: .* 0.05 for 5 %"):
            compare_groups(rows, "mtf_nyquist", margin=margin)
    many = rows_of(*(
        {"method": f"m{at}", "image_id": [1], "mtf_nyquist": [0.1]} for at in range(13)
    ))  # fmt: skip
    with pytest.raises(OptionError, match="13 methods to be compared"):
        compare_groups(many, "mtf_nyquist", "method")
    none = Columns({name: one[:0] for name, one in rows.columns.items()})
    with pytest.raises(NothingSelectedError):
        compare_groups(none, "mtf_nyquist")
    assert compare_groups(rows, "mtf_nyquist", "kind").summary == (
        "there are no two kinds to be compared: all measurements are of one kind, edge; add "
        "measurements of another one, or widen the filters"
    )


def test_an_archive_pairs_both_directions_of_one_measurement(
    archive: Archive, bars_record: ac.Record
) -> None:
    """A star shows both directions, in three images."""
    rng = np.random.default_rng(8)
    for at in range(3):
        document = dict(bars_record.document)
        for name in ("across", "along"):
            number = dict(document[name]["mtf_nyquist"])
            number["value"] += 0.001 * rng.standard_normal() + 0.01 * (name == "across")
            document[name] = {**document[name], "mtf_nyquist": number}
        image = ImageEntry(path=f"{at}.tif", content=f"{at:064x}", sensor="K3")
        archive.add_entries([Entry(record=ac.Record(document), image=image)])
    one = only(archive.compare(sensor="K3", verdict="invalid"))
    assert one == only(archive.compare("mtf_nyquist", sensor="K3", verdict="invalid"))
    assert one.basis == "measurement"
    assert one.images == (3, 3)
    assert one.difference.value == pytest.approx(0.01, abs=0.004)
    assert one.notes == ()
