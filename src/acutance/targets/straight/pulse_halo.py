"""The systematic error of the halo of a line spread function (LSF) measured on a pulse.

The halo of an edge lifts a whole plateau; that of a pulse is faint light next to it, which the
fit cannot separate from the level and the slope of the plateaus. The fitted halo is wrong by a
share of itself, more than its covariance gives: 0 to 28 % over halos of 1.5 to 4 px, diffraction
and defocus (documentation, "Pulses"). Every LSF is therefore uncertain by a share of its own halo.
"""

from __future__ import annotations

import numpy as np

from acutance.curves import Esf, Lsf, Mtf, Response
from acutance.curves.grid import Floats
from acutance.targets.straight.error_causes import with_cause

__all__ = ["halo", "light_of_halo", "with_halo_error"]

_FROM_WIDTHS, _TO_WIDTHS = 1.0, 2.0


def halo(lsf: Lsf, fwhm_px: float) -> Floats:
    """The light of an LSF beyond 1.5 FWHM, (n,): it sets in smoothly from 1 to 2 FWHM.

    FWHM is the full width at half maximum.

    The dark fringe of a sharpened system does not count: no plateau looks like it.
    """
    outwards = np.abs(lsf.distance_px) / fwhm_px
    within = np.clip((outwards - _FROM_WIDTHS) / (_TO_WIDTHS - _FROM_WIDTHS), 0.0, 1.0)
    return np.asarray(np.maximum(lsf.value, 0.0) * (0.5 - 0.5 * np.cos(np.pi * within)))


def light_of_halo(response: Response) -> float:
    """Share of an LSF's light that lies in its halo; 0 where it has no width."""
    width, lsf = response.fwhm_px.value, response.lsf
    if not np.isfinite(width):
        return 0.0
    return float(halo(lsf, width).sum() / lsf.value.sum())


def with_halo_error(response: Response, share: float) -> tuple[Esf, Lsf, Mtf]:
    """The same curves, with one more common cause of error: `share` of the halo.

    Of an LSF L = core + F with the halo's energy E, one standard deviation more of it is
    ``share (F - E L)``, normalised again; edge spread function
    (ESF) and transfer function (OTF) err by its integral and its transform.

    Parameters
    ----------
    response : Response
    share : float
        Standard deviation of the halo, relative to the halo.
    """
    esf, lsf, mtf = response.esf, response.lsf, response.mtf
    width = response.fwhm_px.value
    if not np.isfinite(width):
        return esf, lsf, mtf
    s = lsf.distance_px
    step = float(s[1] - s[0])
    part = halo(lsf, width)
    change = share * (part - part.sum() * step * lsf.value)
    # The total light is kept: the part of the LSF outside the grid lies beyond it.
    change -= change.sum() / lsf.value.sum() * lsf.value
    lifted = np.cumsum(change) * step - 0.5 * change * step
    centre = float(s @ lsf.value / lsf.value.sum())
    # Both grids are regular: so many samples are one cycle of the lowest frequency, or several.
    cycle = round(1 / (float(mtf.freq_cpp[1]) * step))
    cycles = -(-s.size // cycle)
    turn = np.exp(-2j * np.pi * mtf.freq_cpp * (s[0] - centre))
    moved = np.fft.rfft(change, cycles * cycle)[::cycles][: mtf.freq_cpp.size] * turn * step
    return (
        with_cause(esf, np.interp(esf.distance_px, s, lifted)),
        with_cause(lsf, change),
        with_cause(mtf, moved),
    )
