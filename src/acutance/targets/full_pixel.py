"""Is an image sharper than any sensor can see whose pixels touch?"""

from __future__ import annotations

from collections.abc import Sequence

from acutance.curves.estimate import Estimate
from acutance.targets.check import Check, Limits, answer

__all__ = ["full_pixel"]

_SURE = 2.0
_TOO_SOFT = (
    "no sensor whose pixels touch is that sharp: the border is sharper than stated, or the image "
    "was sharpened or decimated; check the softness, and the GSD"
)


def full_pixel(
    mtf_nyquist: Sequence[Estimate],
    limits: Limits,
    *,
    caution: float | None = None,
    with_border: Estimate | None = None,
) -> Check:
    """Whether an MTF at Nyquist is surely above that of a full square pixel without optics.

    That pixel transfers sin(pi/2) / (pi/2) = 0.637 along its sides and 0.651 along its diagonal;
    whatever lies before it only takes from that.

    Parameters
    ----------
    mtf_nyquist : sequence of Estimate
        Of every direction measured, each from 0 up.
    limits : mapping of str to float
        Limits the caller changed.
    caution : float, optional
        From where on it is a caution.
    with_border : Estimate, optional
        What the image has there, where a stated softness of the border was divided out: if that is
        possible, the statement is what is not, and a caution.
    """
    surest = max(mtf_nyquist, key=_at_least)
    least = _at_least(surest)
    sure = (
        f"{surest}, surely (by {_SURE:.0f} standard deviations) above {least:.2f}; that of a full "
        "pixel without any optics is .64"
    )
    found = f"the MTF at Nyquist is {sure}"
    as_asked = answer("full_pixel", least, found, limits, caution=caution)
    if with_border is None or as_asked.passed or _at_least(with_border) > as_asked.limit:
        return as_asked
    found = f"the MTF at Nyquist is {with_border}, and behind the border's stated softness {sure}"
    return answer("full_pixel", least, found, limits, caution=0.0, advice=_TOO_SOFT)


def _at_least(mtf: Estimate) -> float:
    return max(mtf.value - _SURE * mtf.std, 0.0)
