"""Comparisons of few images, few targets, unlike pixels: intervals hold, words say no more."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from acutance.archive.columns import Columns
from acutance.archive.comparisons import Difference, GroupComparison, compare_groups
from acutance.curves import MAIN_NUMBERS

LEVEL = 0.16
FIXED = {
    "sensor": "QB02", "band": "pan", "level": None, "orientation": "across", "kind": "edge",
    "method": "spline", "target": "tarp", "site": "Salon", "gsd_m": 0.6,
    "acquired": np.datetime64("2024-01-01", "us"), "std": 0.02 * LEVEL, "systematic_std": 0.0,
}  # fmt: skip


def group(number: int, relative: np.ndarray, **own: Any) -> dict[str, Any]:
    """One group; each value in an image of its own if none is given."""
    images = 1000 * number + np.arange(relative.size)
    return {"image_id": images, "id": images, "value": LEVEL * relative, **FIXED, **own}


def compared(
    *groups: dict[str, Any], by: str = "method", metric: str = "mtf_nyquist"
) -> GroupComparison:
    parts = []
    for one in groups:
        size = one["value"].size
        parts.append({
            name: np.full(size, word, object) if word is None or isinstance(word, str)
            else np.broadcast_to(word, size)
            for name, word in one.items()
        })  # fmt: skip
    columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    for name in MAIN_NUMBERS:
        columns |= {f"{name}_std": columns["std"], f"{name}_systematic_std": 0 * columns["std"]}
    for name, own in (("value", ""), ("std", "_std"), ("systematic_std", "_systematic_std")):
        columns[metric + own] = columns.pop(name)
    return compare_groups(Columns(columns), metric, by)


def only(found: GroupComparison) -> Difference:
    assert len(found.differences) == 1
    return found.differences[0]


def holds(one: Difference) -> bool:
    low, high = one.difference.interval()
    return low <= 0 <= high


def years(*number: float) -> np.ndarray:
    return np.datetime64("2024-01-01", "us") + (365.25 * 86400e6 * np.array(number)).astype("m8")


def both_directions(
    rng: np.random.Generator, sites: np.ndarray, *, own: float = 0.02, **words: Any
) -> Difference:
    """One target a direction and site, as many images as there are `sites`."""
    air = 0.04 * rng.standard_normal(sites.size)
    found = []
    for number, name in enumerate(("across", "along")):
        peculiar = own * rng.standard_normal(sites.max() + 1)
        value = 1 + air + peculiar[sites] + 0.022 * rng.standard_normal(sites.size)
        found.append(
            group(
                number, value, orientation=name, image_id=np.arange(sites.size),
                site=np.array([f"S{at}" for at in sites], object), **words,
            )
        )  # fmt: skip
    return only(compared(*found, by="orientation"))


def test_one_target_a_site_is_one_number_a_site() -> None:
    """Forty images of four sites held the truth in 60 % when images alone were counted."""
    rng = np.random.default_rng(1)
    sites = np.arange(40) % 4
    held = [holds(both_directions(rng, sites)) for _ in range(200)]
    assert np.mean(held) > 0.91
    alike = [both_directions(rng, sites, own=0.0).relative.std for _ in range(50)]
    assert np.median(alike) < 0.01


def test_a_name_at_two_sites_is_two_targets() -> None:
    one = both_directions(np.random.default_rng(2), np.arange(12) % 3, target="edge 1")
    assert not any("One target" in note for note in one.notes)
    two = both_directions(np.random.default_rng(2), np.arange(12) % 2, target="edge 1")
    assert any("Two targets of each group" in note for note in two.notes)
    assert two.relative.std > 3 * one.relative.std


def test_means_of_few_targets() -> None:
    rng = np.random.default_rng(3)
    held = []
    for _ in range(200):
        sites = np.arange(36) % 3
        groups = [
            group(at, 1 + 0.02 * (rng.standard_normal(3)[sites] + rng.standard_normal(36)),
                  method=name, target=np.array([f"{name}{one}" for one in sites], object))
            for at, name in enumerate("pq")
        ]  # fmt: skip
        held.append(holds(only(compared(*groups))))
    assert np.mean(held) > 0.92


@pytest.mark.parametrize(("sizes", "widest"), [((2, 2), 6.0), ((2, 5), 0.6), ((1, 5), 0.6)])
def test_few_images_that_drift_have_intervals_of_this_world(
    sizes: tuple[int, int], widest: float
) -> None:
    rng = np.random.default_rng(4)
    stds, held = [], []
    for _ in range(300):
        groups = [
            group(at, 1 + 0.04 * rng.standard_normal(size), method="pq"[at],
                  acquired=years(*(at + rng.random(size))))
            for at, size in enumerate(sizes)
        ]  # fmt: skip
        one = only(compared(*groups))
        stds.append(one.relative.std)
        held.append(holds(one))
    assert max(stds) < widest
    assert np.mean(held) > 0.915


def test_a_lone_image_without_a_deviation_scatters_as_the_others_do() -> None:
    """It was taken for exact: 60 % held."""
    rng = np.random.default_rng(5)
    held = []
    for _ in range(200):
        many, lone = (1 + 0.02 * rng.standard_normal(size) for size in (10, 1))
        groups = group(0, many, method="p"), group(1, lone, method="q", std=np.nan)
        held.append(holds(only(compared(*groups))))
    assert np.mean(held) > 0.91


def test_what_does_not_differ_is_the_first_minus_the_second() -> None:
    """As the numbers of the same comparison are, whichever of them is larger."""
    value = 1 + 0.01 * np.random.default_rng(6).standard_normal(12)
    for ratio in (0.999, 1.001):
        noise = 0.01 * np.random.default_rng(7).standard_normal(12)
        across = group(0, ratio * value + noise, orientation="across", image_id=np.arange(12))
        along = group(1, value, orientation="along", image_id=np.arange(12))
        one = only(compared(across, along, by="orientation"))
        assert one.answer != "differ"
        assert "across minus along" in one.sentence
        ends = map(float, re.findall(r"95 %: (\S+) to (\S+) %", one.sentence)[0])
        expected = [100 * end for end in one.relative.interval()]
        assert list(ends) == pytest.approx(expected, abs=0.06)


def test_groups_that_are_never_together_are_named() -> None:
    value = np.ones(4)
    apart = compared(group(0, value, method="p"), group(1, value, method="q", sensor="K3"))
    assert apart.groups == ("edge p", "edge q")
    assert not apart.differences
    assert "there are edge p, edge q, but no two of them with the same sensor" in apart.summary
    assert "sensor and level" in compared(
        group(0, value, band="pan"), group(1, value, band="red", sensor="K3"), by="band"
    ).summary  # fmt: skip


def test_sentence_and_interval_have_one_sign() -> None:
    value = 1 + 0.01 * np.random.default_rng(6).standard_normal(12)
    across = group(0, value, orientation="across", image_id=np.arange(12))
    along = group(1, 1.1 * value, orientation="along", image_id=np.arange(12))
    one = only(compared(across, along, by="orientation"))
    assert one.relative.value < 0
    assert "along is sharper than across by" in one.sentence
    low, high = map(float, re.findall(r"95 %: (\S+) to (\S+) %", one.sentence)[0])
    assert 0 < low < 100 * abs(one.relative.value) < high


def test_pixels_of_other_sizes_are_not_called_sharper() -> None:
    value = 1 + 0.01 * np.random.default_rng(7).standard_normal(12)
    pan = group(0, value, band="pan", image_id=np.arange(12))
    blue = group(1, 3 * value, band="blue", image_id=np.arange(12), gsd_m=2.4)
    one = only(compared(pan, blue, by="band"))
    assert "blue is larger per pixel than pan" in one.sentence
    assert "blue has a GSD of 2.4 m, pan of 0.6 m" in one.summary
    assert one.to_dict()["gsds_m"] == [2.4, 0.6]
    metres = only(compared(pan, blue, by="band", metric="fwhm_m"))
    assert "pan is sharper than blue" in metres.sentence
    alike = only(compared(pan, {**blue, "gsd_m": 0.605}, by="band"))
    assert "blue is sharper than pan" in alike.sentence


def test_groups_without_deviation_are_no_exact_ones() -> None:
    rng = np.random.default_rng(8)
    known = [
        group(at, level + 0.02 * rng.standard_normal(10), method=name)
        for at, (name, level) in enumerate((("p", 0.95), ("q", 1.0), ("r", 1.05)))
    ]
    unknown = [group(3 + at, np.ones(1), method=name, std=np.nan) for at, name in enumerate("xyz")]
    scatter = compared(*known, *unknown[:1]).scatters[0]
    assert all(one.std > 0.001 for one in scatter.offsets.values())
    lone = compared(*unknown).scatters[0]
    assert [np.isnan(one.std) for one in lone.offsets.values()] == [True] * 3
    assert "how 3 methods scatter cannot be told" in lone.sentence
    assert lone.to_dict()["interval"] == [0.0, None]


def test_a_group_that_is_hardly_known_makes_no_other_exact() -> None:
    """Two methods on the same pixels, whose difference is known far better than the third."""
    rng = np.random.default_rng(9)
    images = np.arange(10)
    common = 1 + 0.05 * rng.standard_normal(10)
    groups = [
        group(at, common + std * rng.standard_normal(10), method=name, image_id=images)
        for at, (name, std) in enumerate((("p", 0.001), ("q", 0.001), ("r", 0.05)))
    ]
    offsets = compared(*groups).scatters[0].offsets
    assert min(one.std for one in offsets.values()) > 1e-4


def test_edges_across_and_pulses_along_are_paired_in_their_images() -> None:
    rng = np.random.default_rng(10)
    air = 1 + 0.1 * rng.standard_normal(12)
    groups = [
        group(at, air + 0.01 * rng.standard_normal(12), orientation=name, kind=kind,
              image_id=np.arange(12))
        for at, (name, kind) in enumerate((("across", "edge"), ("along", "pulse")))
    ]  # fmt: skip
    one = only(compared(*groups, by="orientation"))
    assert one.basis == "image"
    assert one.relative.std < 0.02
    assert "across was measured by edge spline, along by pulse spline" in one.summary


@pytest.mark.parametrize("images", [1, 2])
def test_one_or_two_images_do_not_tell(images: int) -> None:
    rng = np.random.default_rng(11)
    labels = np.arange(40) % images
    names = np.array([f"T{at // images}" for at in range(40)], object)
    groups = [
        group(at, level + 0.01 * rng.standard_normal(40), method=name, image_id=labels,
              target=names)
        for at, (name, level) in enumerate((("p", 1.0), ("q", 1.05)))
    ]  # fmt: skip
    one = only(compared(*groups))
    assert one.relative.interval()[1] < 0
    assert one.answer == "cannot be told"
    assert f"in {'this image' if images == 1 else 'these images'})" in one.sentence


def test_one_image_of_each_group_does_not_tell() -> None:
    """Images that scatter by more than what is stated were said to differ in half of all cases."""
    one = only(
        compared(group(0, np.array([1.0]), method="p"), group(1, np.array([1.1]), method="q"))
    )
    assert one.basis == "means"
    assert one.relative.interval()[1] < 0
    assert one.answer == "cannot be told"
    assert "of so few images" in one.sentence
    assert "in these images)" in one.sentence


@pytest.mark.parametrize(("few", "many"), [(3, 12), (2, 8)])
def test_few_images_that_scatter_more_keep_their_own_scatter(few: int, many: int) -> None:
    """With that of all 74 to 86 % of the intervals held."""
    rng = np.random.default_rng(13)
    held = []
    for _ in range(400):
        groups = [
            group(at, 1 + scatter * rng.standard_normal(size), method="pq"[at],
                  acquired=years(*(2 * rng.random(size))))
            for at, (size, scatter) in enumerate(((few, 0.06), (many, 0.03)))
        ]  # fmt: skip
        held.append(holds(only(compared(*groups))))
    assert np.mean(held) > 0.9


def test_one_target_of_means_is_said() -> None:
    rng = np.random.default_rng(12)
    groups = [group(at, 1 + 0.02 * rng.standard_normal(9), method="pq"[at]) for at in range(2)]
    assert any("One target of each group" in note for note in only(compared(*groups)).notes)


def test_overshoot_is_no_share_of_nothing() -> None:
    rng = np.random.default_rng(13)
    groups = [
        group(at, 0.01 * rng.standard_normal(12), orientation=name, image_id=np.arange(12))
        for at, name in enumerate(("across", "along"))
    ]
    one = only(compared(*groups, by="orientation", metric="overshoot"))
    assert one.relative == one.difference
    assert one.answer == "agree"


def test_what_is_unknown_is_no_group() -> None:
    groups = [group(at, np.ones(5), target=name) for at, name in enumerate((None, "x"))]
    assert compared(*groups, by="target").differences == ()


def test_few_common_images_of_many_do_not_decide_alone() -> None:
    rng = np.random.default_rng(14)
    images = np.arange(60), np.r_[np.arange(3), 1000 + np.arange(57)]
    groups = [
        group(at, 1 + 0.02 * rng.standard_normal(60), method="pq"[at], image_id=images[at])
        for at in range(2)
    ]
    one = only(compared(*groups))
    assert one.basis == "means"
    assert one.relative.std < 0.006
    assert "3 images hold both" in one.summary


def test_equal_numbers_without_deviations_tell_nothing() -> None:
    groups = [
        group(at, level * np.ones(5), method="pq"[at], image_id=np.arange(5), std=np.nan)
        for at, level in enumerate((1.0, 1.1))
    ]
    assert only(compared(*groups)).answer == "cannot be told"
