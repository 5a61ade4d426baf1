"""Metrics as people name them: by their keys, or by the labels that reports print."""

from __future__ import annotations

from difflib import get_close_matches

from acutance.curves.metric_words import METRIC_WORDS
from acutance.curves.response import METRICS

__all__ = ["did_you_mean", "likely_metric", "metric_of"]

_KEYS = {METRIC_WORDS[name].label: name for name in METRICS} | {
    METRIC_WORDS[name].label_with_unit: name for name in METRICS
}
"""Keys by what reports print."""
_LIKE = 0.6
"""Share of letters in common, from which on one name may be meant by another."""


def metric_of(name: str) -> str:
    """The key of a metric that is named as a report prints it; of any other name itself.

    Parameters
    ----------
    name : str
        "MTF at Nyquist", "FWHM", "FWHM [px]".

    Examples
    --------
    >>> metric_of("MTF at Nyquist"), metric_of("rer")
    ('mtf_nyquist', 'rer')
    """
    return _KEYS.get(name, name)


def did_you_mean(name: str) -> str:
    """A question to end an error with, of what an unknown name resembles; empty if it is nothing.

    Parameters
    ----------
    name : str
    """
    likely = likely_metric(name)
    return "" if likely is None else f"; did you mean {likely}?"


def likely_metric(name: str) -> str | None:
    """The key of the metric that an unknown name most resembles; ``None`` if it resembles none.

    Parameters
    ----------
    name : str

    Examples
    --------
    >>> likely_metric("mtf50")
    'mtf50_cpp'
    """
    folded = {label.casefold(): key for label, key in _KEYS.items()}
    folded |= {key.casefold(): key for key in METRICS}
    wanted = name.casefold()
    if wanted in folded:
        return folded[wanted]
    begun = [key for key in METRICS if wanted and key.startswith(wanted)]
    if begun:
        # Of several that begin so, none is likelier: "mtf".
        return begun[0] if len(begun) == 1 else None
    close = get_close_matches(wanted, folded, n=1, cutoff=_LIKE)
    return folded[close[0]] if close else None
