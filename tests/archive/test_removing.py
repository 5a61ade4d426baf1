"""Rejections that hold no longer are removed, and nothing else."""

from __future__ import annotations

from typing import Any

import pytest

import acutance as ac
from acutance.archive import Archive, Entry, ImageCorrection, ImageEntry


def test_only_rejections_are_removed_and_images_of_nothing_else(
    archive: Archive, entry_of: Any
) -> None:
    image = ImageEntry(path="gone.tif")
    of_one_image = [
        Entry(rejected=ac.Rejected("image", "gone", {}), image=image, key=name) for name in "ab"
    ]
    archive.add_entries([entry_of(0, key="measured"), *of_one_image])
    assert archive.remove_rejections(["measured", "a", "none"]) == 1
    assert archive.keys() == {"measured", "b"}
    assert (archive.overview().images, archive.overview().rejected) == (2, 1)
    assert archive.remove_rejections(["b", "measured"]) == 1
    assert (archive.overview().images, archive.overview().rejected) == (1, 0)
    assert len(archive.measurements().records()) == 1
    with pytest.raises(ac.OptionError, match=r"there is no image gone\.tif"):
        archive.correct_images([ImageCorrection(image="gone.tif", sensor="S")])
