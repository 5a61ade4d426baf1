"""Eight kinds of imaging system that benchmarks, tests and documentation share."""

from __future__ import annotations

from acutance.optics import (
    Defocus,
    Detector,
    Diffraction,
    Exponential,
    Gaussian,
    Halo,
    Sensor,
    Sharpening,
    Smear,
)

__all__ = ["reference_systems"]


def reference_systems() -> dict[str, Sensor]:
    """Systems by name, each with a curve of its own shape; all see through a square pixel.

    - "gaussian", "wide": a well sampled and a soft Gaussian-like system;
    - "diffraction": an obscured aperture cut off at 1.2 cycles per pixel, tails like 1/x^2;
    - "halo": a tenth of the light scattered over some pixels, wide wings;
    - "sharpened": compensated on the ground, overshoot of about 9 %;
    - "asymmetric": a charge trail along both axes, phase and a one-sided wing;
    - "smeared": 1.2 px of motion along both axes, a zero near 0.83 cycles per pixel;
    - "defocused": 0.35 waves out of focus, a dent in the middle of the band.
    """
    pixel = Detector()
    return {
        "gaussian": Sensor([Gaussian(0.4), pixel]),
        "wide": Sensor([Gaussian(0.6), pixel]),
        "diffraction": Sensor([Diffraction(1.2, obscuration=0.3), pixel]),
        "halo": Sensor([Gaussian(0.4), Halo(0.10, 2.5), pixel]),
        "sharpened": Sensor([Gaussian(0.45), pixel, Sharpening.both_axes(0.27)]),
        "asymmetric": Sensor(
            [Gaussian(0.3), Exponential(0.4, "across"), Exponential(0.4, "along"), pixel]
        ),
        "smeared": Sensor([Gaussian(0.3), Smear(1.2, "across"), Smear(1.2, "along"), pixel]),
        "defocused": Sensor([Defocus(0.35, 1.2), Gaussian(0.2), pixel]),
    }
