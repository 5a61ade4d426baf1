"""Every OTF block by name, with its formula and where the formula comes from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass

from acutance.errors import OptionError
from acutance.optics.aberrations import Aberrations
from acutance.optics.aperture import (
    Defocus,
    Diffraction,
    ExponentialHalo,
    Gaussian,
    Halo,
    WavefrontError,
)
from acutance.optics.atmosphere import Aerosol, Moffat, Turbulence
from acutance.optics.block import Block
from acutance.optics.detector import ChargeDiffusion, Detector
from acutance.optics.electronics import Butterworth, Exponential, TransferLoss
from acutance.optics.motion import Jitter, Smear, Tdi
from acutance.optics.processing import Resampling, Rescaled, Sharpening, Shift

__all__ = ["BLOCKS", "BlockKind", "describe_block"]


@dataclass(frozen=True)
class BlockKind:
    """One kind of block.

    Parameters
    ----------
    make : type
        The block's class.
    formula : str
        Its optical transfer function (OTF) in plain text; u is across, v along, f the radial
        frequency, in cycles per pixel.
    source : str
        Where the formula is from.
    """

    make: Callable[..., Block]
    formula: str
    source: str


_GENERIC = "SDSU, Generic Sensor Modeling, 2005"

BLOCKS: dict[str, BlockKind] = {
    "Gaussian": BlockKind(
        Gaussian, "exp(-2 pi^2 (sigma_x^2 u^2 + sigma_y^2 v^2))", f"{_GENERIC}, eq. 2.1"
    ),
    "Halo": BlockKind(
        Halo, "1 - p + p exp(-2 pi^2 sigma^2 f^2)", "a fraction p of the light in a broad Gaussian"
    ),
    "ExponentialHalo": BlockKind(
        ExponentialHalo,
        "1 - p + p (1 + (2 pi d f)^2)^(-3/2)",
        "a fraction p of the light that falls as exp(-r / d)",
    ),
    "Diffraction": BlockKind(
        Diffraction, "autocorrelation of an annular pupil", "O'Neill, JOSA 46, 285, 1956"
    ),
    "Defocus": BlockKind(
        Defocus,
        "4 / (pi (1 - e^2)) int_0^X (a(x) - b(x)) cos(8 pi W nu x) dx, a, b half chords of the "
        "pupil and of its obscuration",
        "Hopkins, Proc. R. Soc. A 231, 91, 1955",
    ),
    "WavefrontError": BlockKind(
        WavefrontError,
        "exp(-(2 pi w)^2 (1 - exp(-(f / (l f_c))^2)))",
        "Hufnagel; Shannon, Art and Science of Optical Design, 1997",
    ),
    "Aberrations": BlockKind(
        Aberrations,
        "autocorrelation of exp(2 pi i W), W of Zernike polynomials",
        "Noll, JOSA 66, 207, 1976",
    ),
    "Aerosol": BlockKind(
        Aerosol,
        "exp(-t min(f / f_a, 1)^2)",
        "Kopeika, A System Engineering Approach to Imaging, 1998",
    ),
    "Turbulence": BlockKind(Turbulence, "exp(-3.44 (f / f_0)^(5/3))", "Fried, JOSA 56, 1372, 1966"),
    "Moffat": BlockKind(
        Moffat,
        "2 (x / 2)^(b - 1) K_(b - 1)(x) / Gamma(b - 1), x = 2 pi a f",
        "transform of (1 + (r / a)^2)^-b; Moffat, Astron. Astrophys. 3, 455, 1969",
    ),
    "Detector": BlockKind(Detector, "sinc(w u) sinc(h v)", f"{_GENERIC}, eq. 2.2"),
    "ChargeDiffusion": BlockKind(
        ChargeDiffusion,
        "cosh(d / L) / cosh(d sqrt((2 pi f)^2 + 1 / L^2))",
        "Crowell, Labuda, Bell Syst. Tech. J. 48, 1481, 1969",
    ),
    "Smear": BlockKind(Smear, "sinc(S v), or sinc(S u)", f"{_GENERIC}, eq. 2.3"),
    "Jitter": BlockKind(
        Jitter, "exp(-2 pi^2 sigma^2 f^2)", "normally distributed displacements in one exposure"
    ),
    "Tdi": BlockKind(
        Tdi, "sin(N x) / (N sin x) sinc(v / phases), x = pi drift . (u, v)", "sum over N exposures"
    ),
    "Butterworth": BlockKind(Butterworth, "1 / (1 + (f / D0)^2)", f"{_GENERIC}, eq. 2.5"),
    "Exponential": BlockKind(
        Exponential, "1 / (1 + 2 pi i L u), or v", "transform of exp(-x / L) / L, x > 0"
    ),
    "TransferLoss": BlockKind(
        TransferLoss,
        "(1 - s) / (1 - s exp(-2 pi i v)), or u",
        "transform of (1 - s) s^k at whole pixels k = 0, 1, ...",
    ),
    "Resampling": BlockKind(
        Resampling,
        "transform of the interpolation kernel",
        "Keys, IEEE Trans. ASSP 29, 1153, 1981 (cubic)",
    ),
    "Shift": BlockKind(
        Shift,
        "sum_k w(k - shift) exp(2 pi i u (k - shift)), times the same in v",
        "Keys, IEEE Trans. ASSP 29, 1153, 1981 (cubic)",
    ),
    "Sharpening": BlockKind(
        Sharpening, "sum k[i, j] exp(-2 pi i (v i + u j)) / sum k", "transform of a finite kernel"
    ),
    "Rescaled": BlockKind(
        Rescaled, "H(u / scale, v / scale)", "another system, in pixels of another size"
    ),
}
"""All blocks by the name of their class."""


def describe_block(block: Block) -> str:
    """A block with its parameters, as a reader writes it: ``Gaussian sigma 0.39 px``.

    Parameters that are ``None`` or no plain numbers or words are not mentioned.

    Raises
    ------
    OptionError
        If it is no block: one is a dataclass.
    """
    if not is_dataclass(block) or isinstance(block, type):
        raise OptionError(f"block is {block!r:.80}: give one, such as Gaussian(0.4)")
    words = [type(block).__name__]
    for field in fields(block):
        value = getattr(block, field.name)
        if value is None:
            continue
        title, _, unit = field.name.rpartition("_")
        if unit == "px":
            words.append(f"{title} {value:g} px")
        elif unit == "cpp":
            words.append(f"{title} {value:g} c/px")
        elif isinstance(value, str | float | int):
            shown = value if isinstance(value, str) else f"{value:g}"
            words.append(f"{field.name.replace('_', ' ')} {shown}")
    return ", ".join([" ".join(words[:2]), *words[2:]]).replace("_", " ")
