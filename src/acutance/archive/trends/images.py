"""The measurements of an image joined: what is left to a trend is one number an image.

Measurements of one image share its atmosphere, so that a hundred of them tell no more about the
sensor than the atmosphere of that image allows. Their scatter beyond the stated deviations (the
targets differ, deviations are stated too small) is fitted over all images together.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from acutance.archive.trends.series import Series
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr

__all__ = ["ImageMeans", "image_means", "joined_images", "parts_of_places"]

_HUBER: Final = 2.0
"""Deviations from which a measurement counts less."""
_HUBER_SQUARE: Final = 0.9209
"""Mean square of a standard normal number cut off there."""
_PASSES: Final = 30
_MAX_RATIO: Final = 1e6
_TURNS: Final = 3
_STEPS_A_TURN: Final = 5
"""How often the scale of joined images and their means are fitted: a far image widens the scale
less once the mean has left it."""


@dataclass(frozen=True, eq=False)
class ImageMeans(ShortRepr):
    """One mean an image, in the order of time.

    Attributes
    ----------
    when, value : (j,) array
    variance : (j,) array
        Of the mean, without what all measurements share.
    count : (j,) int array
        Measurements.
    label : (j,) int array
        The image; -1 where several were joined.
    within_std : float
        Scatter within an image beyond the stated deviations.
    typical_std : float
        Of one measurement, with that scatter.
    systematic_std : float
        What all measurements share.
    images : int
        Number of images: that of the places, or more where very many were joined.
    scatter : float
        Between the images that were joined, beyond their stated deviations; 0 where none were.
    ends : (float, float) or None
        Years with decimals of the first and of the last image, where these were joined: places lie
        in the middle of theirs.
    """

    when: Floats
    value: Floats
    variance: Floats
    count: NDArray[np.int64]
    label: NDArray[np.int64]
    within_std: float
    typical_std: float
    systematic_std: float
    images: int
    scatter: float = 0.0
    ends: tuple[float, float] | None = None

    @property
    def first(self) -> float:
        """Year with decimals of the first image."""
        return float(self.when[0]) if self.ends is None else self.ends[0]

    @property
    def last(self) -> float:
        """Year with decimals of the last image."""
        return float(self.when[-1]) if self.ends is None else self.ends[1]

    @property
    def size(self) -> int:
        """Number of places."""
        return int(self.value.size)

    @property
    def are_joined(self) -> bool:
        """Whether a place stands for several images."""
        return self.images > self.size

    @property
    def images_by_place(self) -> NDArray[np.int64]:
        """How many images every place stands for, (j,)."""
        return np.array([part.size for part in parts_of_places(self.images, self.size)])

    @property
    def image_std(self) -> float:
        """Typical standard deviation of the mean of one image, without the scatter between images.

        Of joined images what the places show of it: less than is stated where that is too much.
        """
        square = float(np.median(self.variance * self.images_by_place)) - self.scatter**2
        return float(np.sqrt(max(square, 0.0)))

    def surround(self, year: float) -> bool:
        """Whether there are images before a date and from it on, which show what it changed."""
        return bool(self.when[0] < year <= self.when[-1])

    def to_dict(self) -> dict[str, Any]:
        """All fields, arrays as lists."""
        found = {one.name: getattr(self, one.name) for one in fields(self)}
        return {name: _plain(value) for name, value in found.items()}

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> ImageMeans:
        """What `to_dict` wrote."""
        fields_of: dict[str, Any] = {
            name: _listed(name, value) if isinstance(value, list) else value
            for name, value in document.items()
        }
        return cls(**fields_of)


def _plain(value: Any) -> Any:
    """An array or a pair as a list."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    return list(value) if isinstance(value, tuple) else value


def _listed(name: str, listed: list[float]) -> Any:
    """A list as the array or the pair that it was."""
    if name == "ends":
        return tuple(listed)
    return np.array(listed, np.int64 if name in ("count", "label") else float)


def stated_variance(std: Floats) -> Floats:
    """Squares of the stated deviations; where none is stated, their median stands in."""
    known = std[np.isfinite(std)]
    missing = float(np.median(known)) if known.size else 0.0
    return np.asarray(np.where(np.isfinite(std), std, missing) ** 2)


def image_means(series: Series) -> ImageMeans:
    """The mean of every image, robust, with its variance.

    Parameters
    ----------
    series : Series
        With dates and values (`Series.dated`).
    """
    _, index = np.unique(series.image, return_inverse=True)
    order = np.argsort(index, kind="stable")
    index, value = index[order], series.value[order]
    variance = stated_variance(series.std)[order]
    count = np.bincount(index)
    mean, added = _within_images(index, count, value, variance)
    total = variance + added
    weight = 1 / np.maximum(total, total.max() / _MAX_RATIO) if total.max() > 0 else total + 1.0
    when = np.bincount(index, series.when[order]) / count
    label = series.image[order][np.concatenate([[0], np.cumsum(count)[:-1]])]
    spread = np.bincount(index, weight**2 * total) / np.bincount(index, weight) ** 2
    systematic = 0.0
    if series.systematic_std is not None:
        systematic = float(np.nan_to_num(series.systematic_std).mean())
    at = np.argsort(when, kind="stable")
    return ImageMeans(
        when[at], mean[at], spread[at], count[at], label[at],
        float(np.sqrt(added)), float(np.sqrt(np.median(total))), systematic, count.size,
    )  # fmt: skip


def _within_images(
    index: NDArray[np.intp], count: NDArray[np.int64], value: Floats, variance: Floats
) -> tuple[Floats, float]:
    """Means of the images (j,), and the variance within them beyond the stated one.

    The variance is that at which the sum of squares, cut off at `_HUBER` deviations, is as large
    as it is expected (the method of Paule and Mandel, made robust).
    """
    mean = np.bincount(index, value) / count
    free = value.size - count.size
    if free == 0:
        return mean, 0.0
    low, high = 0.0, float(np.var(value - mean[index])) * 4 + 1e-300
    share = 1 / np.sqrt(np.maximum(1 - 1 / count[index], 0.5))
    added, first = 0.0, True
    for _ in range(_PASSES):
        mean, square = _robust_means(index, count, value, variance + added, mean, share)
        is_large = square > _HUBER_SQUARE * np.count_nonzero(count[index] > 1)
        if first and not is_large:
            return mean, 0.0
        first = False
        low, high = (added, high) if is_large else (low, added)
        added = 0.5 * (low + high)
    return mean, added


def _robust_means(
    index: NDArray[np.intp], count: NDArray[np.int64], value: Floats, variance: Floats,
    mean: Floats, share: Floats,
) -> tuple[Floats, float]:  # fmt: skip
    """Huber's means of the images, and the sum of squares of residuals cut off."""
    floor = max(float(variance.max()) / _MAX_RATIO, float(np.var(value)) * 1e-12, 1e-300)
    std = np.sqrt(np.maximum(variance, floor))
    for _ in range(3):
        off = np.abs(value - mean[index]) * share / std
        weight = np.minimum(1.0, _HUBER / np.maximum(off, 1e-9)) / std**2
        mean = np.bincount(index, weight * value) / np.bincount(index, weight)
    off = np.minimum(np.abs(value - mean[index]) * share / std, _HUBER)
    return mean, float((off[count[index] > 1] ** 2).sum())


def parts_of_places(size: int, most: int) -> list[NDArray[np.intp]]:
    """Which neighbours in time become one place each, of so many images and places at most."""
    return np.array_split(np.arange(size), min(size, most))


def joined_images(images: ImageMeans, most: int) -> ImageMeans:
    """At most so many places: neighbours in time are joined, each with the scatter it shows."""
    if images.size <= most:
        return images
    count = np.array([part.size for part in parts_of_places(images.size, most)])
    place = np.repeat(np.arange(most), count)
    value, scale = _places(images.value, place, count)
    # The images about their places show what is stated of them, and what they scatter beyond it.
    beyond = max(scale**2 - float(np.median(images.variance)), 0.0)
    return ImageMeans(
        np.bincount(place, images.when) / count, value, scale**2 / count,
        np.bincount(place, images.count).astype(np.int64), np.full(most, -1),
        images.within_std, images.typical_std, images.systematic_std,
        images.images, float(np.sqrt(beyond)), (images.first, images.last),
    )  # fmt: skip


def _places(
    value: Floats, place: NDArray[np.intp], count: NDArray[np.int64]
) -> tuple[Floats, float]:
    """Huber's means of the places, and the scale of the images about them, fitted in turns."""
    mean = np.bincount(place, value) / count
    several = count[place] > 1
    # So many of a place deviate from their own mean by less than they scatter.
    share = 1 / np.sqrt(1 - 1 / count[place][several])
    scale = 0.0
    for _ in range(_TURNS):
        deviation = np.abs(value - mean[place])[several] * share
        scale = max(1.4826 * float(np.median(deviation)), 1e-12)
        for _ in range(_STEPS_A_TURN):
            off = np.abs(value - mean[place]) / scale
            weight = np.minimum(1.0, _HUBER / np.maximum(off, 1e-9))
            mean = np.bincount(place, weight * value) / np.bincount(place, weight)
    return mean, scale
