"""Optical transfer functions: the blocks an imaging system is made of, and their product."""

from acutance.optics.aberrations import Aberrations
from acutance.optics.aperture import (
    Defocus,
    Diffraction,
    ExponentialHalo,
    Gaussian,
    Halo,
    WavefrontError,
)
from acutance.optics.atmosphere import Aerosol, Moffat, Turbulence
from acutance.optics.block import Block
from acutance.optics.budget import Budget, BudgetRow, budget
from acutance.optics.catalogue import BLOCKS, BlockKind, describe_block
from acutance.optics.detector import ChargeDiffusion, Detector
from acutance.optics.electronics import Butterworth, Exponential, TransferLoss
from acutance.optics.metres import GroundCurves, on_the_ground, psf_on_the_ground
from acutance.optics.motion import Jitter, Smear, Tdi
from acutance.optics.population import FAMILIES, draw_sensor
from acutance.optics.preset import preset, presets
from acutance.optics.processing import Resampling, Rescaled, Sharpening, Shift
from acutance.optics.profile import Profile
from acutance.optics.raster_psf import RasterPsf, numerical_psf
from acutance.optics.sensor import Sensor
from acutance.optics.sensor_file import (
    SensorFile,
    read_sensor,
    sensor_file_from_toml,
    sensor_file_to_toml,
    write_sensor,
)

__all__ = [
    "BLOCKS",
    "FAMILIES",
    "Aberrations",
    "Aerosol",
    "Block",
    "BlockKind",
    "Budget",
    "BudgetRow",
    "Butterworth",
    "ChargeDiffusion",
    "Defocus",
    "Detector",
    "Diffraction",
    "Exponential",
    "ExponentialHalo",
    "Gaussian",
    "GroundCurves",
    "Halo",
    "Jitter",
    "Moffat",
    "Profile",
    "RasterPsf",
    "Resampling",
    "Rescaled",
    "Sensor",
    "SensorFile",
    "Sharpening",
    "Shift",
    "Smear",
    "Tdi",
    "TransferLoss",
    "Turbulence",
    "WavefrontError",
    "budget",
    "describe_block",
    "draw_sensor",
    "numerical_psf",
    "on_the_ground",
    "preset",
    "presets",
    "psf_on_the_ground",
    "read_sensor",
    "sensor_file_from_toml",
    "sensor_file_to_toml",
    "write_sensor",
]
