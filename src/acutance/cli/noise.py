"""The options that say what the detector of a simulated image adds to the signal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from acutance.simulate import Noise

__all__ = ["Quantum", "ReadNoise", "Saturation", "ShotGain", "Snr", "described_noise"]

Snr = Annotated[
    float | None,
    typer.Option(metavar="RATIO", help="Contrast over noise; no noise if nothing says it."),
]
ReadNoise = Annotated[
    float | None,
    typer.Option(metavar="DN", help="Standard deviation of white noise, instead of --snr."),
]
ShotGain = Annotated[
    float | None,
    typer.Option(
        metavar="DN", help="Shot noise too: image units per electron, its variance over the signal."
    ),
]
Quantum = Annotated[
    float | None,
    typer.Option(metavar="DN", help="Round to multiples of this: 1 for whole numbers."),
]
Saturation = Annotated[
    float | None, typer.Option(metavar="DN", help="Level that no pixel exceeds.")
]


def described_noise(
    read: float | None,
    shot_gain: float | None,
    quantum: float | None,
    saturation: float | None,
) -> Noise | None:
    """The noise the options describe; ``None`` where none of them was given."""
    if (read, shot_gain, quantum, saturation) == (None, None, None, None):
        return None
    from acutance.simulate import Noise

    return Noise(read or 0.0, shot_gain or 0.0, quantum or 0.0, saturation)
