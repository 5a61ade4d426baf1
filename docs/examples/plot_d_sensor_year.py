"""
A year of a sensor
==================

Every ten days an image of the same tarp: the optics slowly lose focus, the air differs, and in
September they are refocused. The measurements are kept in an archive, which is asked how the
sensor changes.
"""

# sphinx_gallery_thumbnail_path = "generated/thumbnail-plot_d_sensor_year.png"

from datetime import UTC, datetime, timedelta
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import acutance as ac
from acutance.archive.trends import Event
from acutance.report.archive import trend_figure

# %%
# The sensor as it is on a day, the tarp, and the images.
begin = datetime(2026, 1, 4, 17, tzinfo=UTC)
refocus = datetime(2026, 9, 1, tzinfo=UTC)


def sensor_on(when):
    since = refocus if when >= refocus else begin
    sigma_px = 0.40 + 0.06 * (when - since) / timedelta(days=365)
    return ac.Sensor([ac.optics.Gaussian(sigma_px), ac.optics.Detector(1.0)], gsd_m=0.7)


tarp = ac.simulate.EdgeTarps("tarp", 45.0, 45.0, 6.0, 34.0, 200.0, 1200.0)
dates = [begin + timedelta(days=10 * at) for at in range(36)]
images = ac.simulate.overflights(
    sensor_on, [tarp], (90, 90), dates, noise_std=8.0, air_px=0.05, rng=np.random.default_rng(2)
)

# %%
# Every image is measured and kept. (With images in files ``ac.run_batch`` does all of this.)
folder = TemporaryDirectory()
archive = ac.Archive(Path(folder.name) / "year.db")
for image in images:
    measurement = ac.measure_edge(image.pixels.astype(float), (14, 20, 62, 50), gsd_m=0.7)
    archive.add(measurement, sensor="SIM-1", acquired=image.acquired, target="tarp")
print(archive.measurements().summary())

# %%
# How the sensor changes, if the refocusing is stated.
trend = archive.trend("mtf_nyquist", events=[Event(refocus, "refocus")])
print(trend.summary())
print("drift per year:", trend.rate_per_year)
print("refocusing:", trend.events[0].size)

# %%
# And if nobody knew of it: the step is found, with its date.
unaware = archive.trend("mtf_nyquist")
for change in unaware.changes:
    print(f"{change.date} ({change.since} to {change.until}): {change.size}")

figure = trend_figure(trend, limit=0.2)
folder.cleanup()

# %%
# The figure as a file.
figure.savefig("sensor-year.png", dpi=110)
print("wrote sensor-year.png")
