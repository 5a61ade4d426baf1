"""Compile most loops once, before several processes that run tests would each compile them.

It takes most of a minute of processor time a process. What the measurements here do not call, and
calls with other types, are compiled by the first test that needs them.
"""

import numpy as np

import acutance as ac
from acutance import simulate
from acutance.archive.trends import Series, fit_trend
from acutance.targets.straight import METHODS, PULSE_METHODS


def main() -> None:
    """Measure something of every kind."""
    sensor = simulate.reference_systems()["gaussian"]
    options = simulate.LandscapeOptions(soft=0.3, texture=(0.0, 0.0), density_per_mpx=120)
    rng = np.random.default_rng(6)
    image, _ = simulate.landscape(sensor, shape=(300, 300), snr=100, options=options, rng=rng)
    ac.scan_scene(image, workers=1)
    edge, _ = simulate.edge(sensor, angle_deg=6, shape=(60, 60), snr=100, rng=rng)
    for method in METHODS:
        ac.measure_edge(edge, method=method)
    board = simulate.checkerboard(sensor, snr=100, rng=rng).image
    ac.combine(ac.measure_edges(board).measurements)
    pulse, _ = simulate.pulse(sensor, snr=100, rng=rng)
    for method in PULSE_METHODS:
        ac.measure_pulse(pulse, width_px=3.0, method=method)
    points, truth = simulate.points(sensor, snr=100, rng=rng)
    ac.measure_points(points, positions=truth.positions)
    ac.measure_points(points)
    ac.measure_bars(simulate.bars(sensor, snr=100, rng=rng)[0])
    fit_trend(steady_series(rng))


def steady_series(rng: np.random.Generator) -> Series:
    """Twelve images of a year: from eight on steps are sought."""
    when = 2024 + np.arange(12) / 12
    value = 0.3 + 0.003 * rng.standard_normal(12)
    return Series(
        metric="mtf_nyquist", when=when, value=value, std=np.full(12, 0.002), image=np.arange(12)
    )


if __name__ == "__main__":
    main()
