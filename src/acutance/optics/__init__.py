"""Optical transfer functions: the blocks an imaging system is made of, and their product."""

from acutance.optics.aperture import Defocus, Diffraction, Gaussian, Halo, WavefrontError
from acutance.optics.block import Block
from acutance.optics.detector import ChargeDiffusion, Detector
from acutance.optics.electronics import Butterworth, Exponential
from acutance.optics.motion import Jitter, Smear, Tdi
from acutance.optics.profile import Profile
from acutance.optics.sensor import Sensor

__all__ = [
    "Block",
    "Butterworth",
    "ChargeDiffusion",
    "Defocus",
    "Detector",
    "Diffraction",
    "Exponential",
    "Gaussian",
    "Halo",
    "Jitter",
    "Profile",
    "Sensor",
    "Smear",
    "Tdi",
    "WavefrontError",
]
