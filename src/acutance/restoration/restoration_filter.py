"""A restoration filter: its kernel, what it does to a sensor, what it costs, where it is from."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from acutance.arguments import require_floats, require_path
from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.execution.partial_folder import named_whole_file
from acutance.raster.image import AlongTrack
from acutance.restoration.filtered_otf import kernel_otf
from acutance.targets.check import VerdictWord
from acutance.targets.document_fields import refuse_damaged, require_document
from acutance.targets.json_text import json_text
from acutance.targets.recorded_direction import RecordedDirection

__all__ = ["SCHEMA", "RestorationFilter", "Sharpness", "require_filter"]

SCHEMA = "acutance/restoration/1"

_REQUIRED = (
    "schema", "kernel", "method", "snr", "noise_gain", "before", "after", "niirs_change", "trade",
    "aliased_share", "image", "sources", "notes",
)  # fmt: skip
_WRITERS = "'acutance restore design' or RestorationFilter.write(path)"
_SUM_TOLERANCE = 1e-6
MAX_SIZE = 63


@dataclass(frozen=True, eq=False)
class Sharpness(ShortRepr):
    """Numbers and curves of a sensor across and along track.

    Parameters
    ----------
    across, along : RecordedDirection
        With `mtf_nyquist`, `rer`, `fwhm_px`, `overshoot` and all other numbers by name.
    """

    across: RecordedDirection
    along: RecordedDirection

    @property
    def directions(self) -> dict[str, RecordedDirection]:
        """Both by name."""
        return {"across": self.across, "along": self.along}

    @property
    def overshoot(self) -> Estimate:
        """The largest overshoot or undershoot of both directions."""
        both = self.directions.values()
        return max((n for one in both for n in (one.overshoot, one.undershoot)), key=float)

    def summary(self) -> str:
        """The main numbers of both."""
        return f"across: {self.across.summary()}; along: {self.along.summary()}"


@dataclass(frozen=True, eq=False)
class RestorationFilter(ShortRepr):
    """A kernel that sharpens the images of one sensor, and what it does: `design_restoration`.

    Parameters
    ----------
    document : mapping
        The document ``acutance/restoration/1``.

    Raises
    ------
    OptionError
        If it is none of a filter, or damaged.

    Examples
    --------
    >>> filter.after.across.mtf_nyquist, filter.noise_gain, filter.snr_after  # doctest: +SKIP
    """

    document: Mapping[str, Any]

    def __post_init__(self) -> None:
        document = self.document
        advice = f"write one with {_WRITERS}"
        require_document(document, SCHEMA, _REQUIRED, name="the filter", advice=advice)
        with refuse_damaged("the filter", f"give one that {_WRITERS} wrote"):
            _require_kernel(self.kernel, float(document["noise_gain"]))
            _ = self.before.summary(), self.after.summary(), self.niirs_change, self.gsd_m

    @classmethod
    def from_dict(cls, document: Any) -> RestorationFilter:
        """The filter of a document.

        Raises
        ------
        OptionError
            If it is none of a filter, or damaged.
        """
        return cls(document)

    @classmethod
    def read(cls, path: str | Path) -> RestorationFilter:
        """The filter of a file.

        Raises
        ------
        OptionError
            If there is no such file, or it holds no filter.
        """
        require_path(path=path)
        try:
            document = json.loads(Path(path).read_text(encoding="utf-8-sig"))
        except OSError as error:
            raise OptionError(
                f"{path} cannot be read ({error.strerror or error}): give a file that "
                f"{_WRITERS} wrote"
            ) from error
        except ValueError as error:
            raise OptionError(
                f"{path} holds no JSON ({error}): it is no file that {_WRITERS} wrote, or was cut"
            ) from error
        try:
            return cls.from_dict(document)
        except OptionError as error:
            raise OptionError(f"{path}: {error}") from error

    def write(self, path: str | Path) -> None:
        """Write the document to a file, whole or not at all; `read` gives the filter back.

        Raises
        ------
        OptionError
            If the file cannot be written.
        """
        require_path(path=path)
        text = json_text(self.to_dict())
        with named_whole_file(path) as part:
            part.write_text(text, encoding="utf-8")

    def to_dict(self) -> dict[str, Any]:
        """The document; nothing is lost by `from_dict`."""
        return dict(self.document)

    @cached_property
    def kernel(self) -> Floats:
        """The kernel, (size, size), of sum 1: the image is convolved with it."""
        return np.array(self.document["kernel"], float)

    @property
    def size(self) -> int:
        """Its rows and columns."""
        return int(self.kernel.shape[0])

    @property
    def margin_px(self) -> int:
        """How far it reaches from its middle."""
        return self.size // 2

    def otf(self, u_cpp: ArrayLike, v_cpp: ArrayLike) -> NDArray[np.complex128]:
        """Its transfer function at frequencies across the columns and down the rows, (...)."""
        u, v = np.broadcast_arrays(require_floats("u_cpp", u_cpp), require_floats("v_cpp", v_cpp))
        return kernel_otf(self.kernel, u.ravel(), v.ravel()).reshape(u.shape)

    @cached_property
    def before(self) -> Sharpness:
        """The sensor."""
        return _sharpness(self.document["before"])

    @cached_property
    def after(self) -> Sharpness:
        """The sensor and the kernel after it, as predicted."""
        return _sharpness(self.document["after"])

    @property
    def method(self) -> str:
        """How it was designed: "wiener", "constrained" or "target"."""
        return str(self.document["method"])

    @property
    def noise_gain(self) -> float:
        """Standard deviation of white noise after it over that before it."""
        return float(self.document["noise_gain"])

    @property
    def snr(self) -> float | None:
        """SNR before it, if known."""
        snr = self.document["snr"]
        return None if snr is None else float(snr)

    @property
    def snr_after(self) -> float | None:
        """SNR after it, if that before it is known."""
        return None if self.snr is None else self.snr / self.noise_gain

    @cached_property
    def noise_correlation(self) -> Floats:
        """Correlation of white noise after it, by shift in rows and columns, (2 size - 1,) each.

        The middle is 1.
        """
        size = 2 * self.size - 1
        power = np.abs(np.fft.fft2(self.kernel, (size, size))) ** 2
        correlation = np.fft.fftshift(np.fft.ifft2(power).real)
        return np.asarray(correlation / correlation.max())

    @cached_property
    def niirs_change(self) -> dict[int, Estimate]:
        """NIIRS after minus before by version of the GIQE; empty where no SNR is known."""
        found = self.document["niirs_change"]
        return {int(version): Estimate.from_dict(one) for version, one in found.items()}

    @property
    def aliased_share(self) -> tuple[float, float]:
        """Share of the image's signal power that is aliased, before and after."""
        before, after = self.document["aliased_share"]
        return float(before), float(after)

    @property
    def trade(self) -> tuple[Mapping[str, float], ...]:
        """Other kernels of the same family, by rising noise gain: what each would give."""
        return tuple(self.document["trade"])

    @property
    def gsd_m(self) -> tuple[float, float] | None:
        """Distance from row to row and column to column in metres, if known."""
        sides = self.document["image"]["gsd_m"]
        return None if sides is None else (float(sides[0]), float(sides[1]))

    @property
    def band(self) -> int | None:
        """The band of the image that was measured, from 1; ``None`` if there is no one."""
        band = self.document["image"]["band"]
        return None if band is None else int(band)

    @property
    def along_track(self) -> AlongTrack:
        """The image axis along track."""
        return "x" if self.document["image"]["along_track"] == "x" else "y"

    @property
    def sources(self) -> tuple[str, ...]:
        """What the sensor's transfer is known from."""
        return tuple(self.document["sources"])

    @property
    def notes(self) -> tuple[str, ...]:
        """What has to be said of it."""
        return tuple(self.document["notes"])

    @property
    def verdict(self) -> VerdictWord:
        """That of the measurement, or of the combination it was made of; "usable" of older ones."""
        word: VerdictWord = self.document.get("verdict", "usable")
        return word

    def summary(self) -> str:
        """Method, size, and what it does."""
        return (
            f"{self.method}, {self.size} x {self.size}, noise gain {self.noise_gain:.3g}, MTF at "
            f"Nyquist across {self.before.across.mtf_nyquist} -> {self.after.across.mtf_nyquist}, "
            f"along {self.before.along.mtf_nyquist} -> {self.after.along.mtf_nyquist}"
        )


def _sharpness(document: Mapping[str, Any]) -> Sharpness:
    return Sharpness(*(RecordedDirection(document[name]) for name in ("across", "along")))


def require_filter(filter: Any) -> None:
    """Refuse what is no filter, such as the name of its file.

    Raises
    ------
    OptionError
        Says how to get one.
    """
    if not isinstance(filter, RestorationFilter):
        raise OptionError(
            f"the filter is a {type(filter).__name__}: give one of design_restoration, or "
            "RestorationFilter.read(path)"
        )


def _require_kernel(kernel: Floats, noise_gain: float) -> None:
    """Refuse what cannot be a kernel.

    Raises
    ------
    ValueError
        If it is not square and odd, not finite, of another sum than 1, or has another noise gain.
    """
    if kernel.ndim != 2 or kernel.shape[0] != kernel.shape[1] or kernel.shape[0] % 2 == 0:
        raise ValueError(f"a kernel of shape {kernel.shape}, which has to be square and odd")
    if kernel.shape[0] > MAX_SIZE:
        raise ValueError(f"a kernel of {kernel.shape[0]} pixels, at most {MAX_SIZE} are possible")
    if not np.isfinite(kernel).all():
        raise ValueError("a kernel that is not finite")
    if abs(kernel.sum() - 1) > _SUM_TOLERANCE:
        raise ValueError(f"a kernel of sum {kernel.sum():.6g}, which has to be 1")
    own = math.sqrt(float(np.sum(kernel**2)))
    if abs(own - noise_gain) > _SUM_TOLERANCE * own:
        raise ValueError(f"a noise gain of {noise_gain:g}, that of its kernel is {own:g}")
