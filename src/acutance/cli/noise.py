"""The options of the noise of a simulated image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from acutance.simulate import Noise

__all__ = ["NoiseOptions", "Quantum", "Saturation", "ShotGain", "described_noise"]

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


@dataclass(frozen=True)
class NoiseOptions:
    """What the detector adds."""

    snr: Annotated[
        float | None,
        typer.Option(
            metavar="RATIO",
            help="Contrast, or peak of a point, over noise; no noise unless given.",
        ),
    ] = None
    read_noise: Annotated[
        float | None,
        typer.Option(metavar="DN", help="Standard deviation of white noise, instead of --snr."),
    ] = None
    shot_gain: ShotGain = None
    quantum: Quantum = None
    saturation: Saturation = None

    def described(self) -> Noise | None:
        """The noise the options describe beyond ``--snr``; ``None`` where none was given."""
        return described_noise(self.read_noise, self.shot_gain, self.quantum, self.saturation)


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
