"""Optical transfer functions: the blocks an imaging system is made of, and their product."""

from acutance.optics.aperture import Defocus, Diffraction, Gaussian, Halo, WavefrontError
from acutance.optics.atmosphere import Aerosol, Turbulence
from acutance.optics.block import Block
from acutance.optics.detector import ChargeDiffusion, Detector
from acutance.optics.electronics import Butterworth, Exponential
from acutance.optics.motion import Jitter, Smear, Tdi
from acutance.optics.processing import Resampling, Rescaled, Sharpening, Shift
from acutance.optics.profile import Profile
from acutance.optics.sensor import Sensor

__all__ = [
    "Aerosol",
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
    "Resampling",
    "Rescaled",
    "Sensor",
    "Sharpening",
    "Shift",
    "Smear",
    "Tdi",
    "Turbulence",
    "WavefrontError",
]
