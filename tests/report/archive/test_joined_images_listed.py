"""The images of a trend listed where there are so many that they were joined."""

from __future__ import annotations

import html
import re
from importlib import import_module

import numpy as np
import pytest

from acutance.archive.trends import Series, fit_trend
from acutance.report.archive import trend_page


@pytest.mark.usefixtures("undrawn")
def test_joined_images_deviate_from_the_trend_by_their_own_deviations(monkeypatch):
    """Over the scatter of single images their deviations were .4 of what they are."""
    monkeypatch.setattr(import_module("acutance.archive.trends.fit_trend"), "MAX_IMAGES", 60)
    rng = np.random.default_rng(3)
    value = 0.3 * (1 + rng.normal(0, 0.04, 300) + rng.normal(0, 0.03, 300))
    when = np.sort(rng.uniform(2015, 2025, 300))
    series = Series(metric="mtf_nyquist", when=when, value=value, std=np.full(300, 0.009),
                    image=np.arange(300))  # fmt: skip
    page = html.unescape(trend_page(fit_trend(series)))
    images = page[page.index("<h2>Images</h2>") :]
    shown = re.findall(r">([+−]?\d+\.\d)</td>", images)
    off = np.array([float(one.replace("−", "-")) for one in shown])
    assert off.size == 60
    assert 0.8 < np.sqrt(np.mean(off**2)) < 1.2
    assert "Means of images that follow one another" in page
