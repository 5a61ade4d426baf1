"""Whether a measurement is a sensor's own MTF, or only its ratio to another sensor's."""

from __future__ import annotations

from acutance.errors import OptionError
from acutance.targets.record import Record

__all__ = ["require_own_mtf"]

_RATIO = "mtf_low_over_mtf_high"
"""What printed documents call the curves."""


def require_own_mtf(record: Record, origin: str) -> None:
    """Refuse the ratio of two sensors' MTFs, which two resolutions give without a reference.

    Parameters
    ----------
    record : Record
    origin : str
        What to call it in the message.

    Raises
    ------
    OptionError
        If it is one.
    """
    is_named = record.document.get("quantity") == _RATIO
    if is_named or not record.options.get("reference_given", True):
        raise OptionError(
            f"{origin} is the ratio MTF_low / MTF_high, no sensor's own MTF: measure it again "
            "with that of the high image (reference_mtf, --reference)"
        )
