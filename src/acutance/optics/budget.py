"""The MTF budget: the transfer of every block of a sensor at one frequency."""

from __future__ import annotations

from dataclasses import dataclass

from acutance.arguments import require_finite
from acutance.curves.metrics import NYQUIST_CPP
from acutance.errors import ModelError
from acutance.optics.block import Block
from acutance.optics.catalogue import BLOCKS, describe_block
from acutance.optics.sensor import Sensor, require_sensor

__all__ = ["Budget", "BudgetRow", "budget"]


@dataclass(frozen=True)
class BudgetRow:
    """One block's part of a budget.

    Parameters
    ----------
    block : Block
    description : str
        Its kind and parameters, with units.
    across, along : float
        Modulus of its optical transfer function (OTF) at the budget's frequency along either image
        axis.
    formula : str
        Its OTF in plain text.
    source : str
        Where the formula comes from.
    """

    block: Block
    description: str
    across: float
    along: float
    formula: str
    source: str


@dataclass(frozen=True)
class Budget:
    """A sensor's MTF at one frequency, split among its blocks.

    Parameters
    ----------
    sensor : Sensor
    freq_cpp : float
        The frequency, in cycles per pixel.
    rows : tuple of BudgetRow
        One a block, in the sensor's order.
    across, along : float
        MTF of the whole: the product of the rows.
    """

    sensor: Sensor
    freq_cpp: float
    rows: tuple[BudgetRow, ...]
    across: float
    along: float

    @property
    def freq_cpm(self) -> tuple[float, float] | None:
        """The frequency in cycles per metre (across, along); ``None`` without a GSD."""
        if self.sensor.pixel_m is None:
            return None
        row_m, col_m = self.sensor.pixel_m
        return self.freq_cpp / col_m, self.freq_cpp / row_m


def budget(sensor: Sensor, freq_cpp: float = NYQUIST_CPP) -> Budget:
    """Split a sensor's MTF at one frequency among its blocks.

    Parameters
    ----------
    sensor : Sensor
    freq_cpp : float, optional
        Frequency in cycles per pixel, at least 0; Nyquist unless given.

    Returns
    -------
    Budget

    Raises
    ------
    OptionError
        If there is no sensor, or the frequency is no number.
    ModelError
        If the frequency is below 0, or not finite.
    """
    require_sensor(sensor)
    require_finite(freq_cpp=freq_cpp)
    if freq_cpp < 0:
        raise ModelError(f"freq_cpp is {freq_cpp:g}, it has to be at least 0")
    rows = tuple(_row(block, freq_cpp) for block in sensor.blocks)
    across, along = abs(sensor.otf(freq_cpp, 0.0)), abs(sensor.otf(0.0, freq_cpp))
    return Budget(sensor, freq_cpp, rows, float(across), float(along))


def _row(block: Block, freq_cpp: float) -> BudgetRow:
    alone = Sensor([block])
    kind = BLOCKS.get(type(block).__name__)
    return BudgetRow(
        block=block,
        description=describe_block(block),
        across=float(abs(alone.otf(freq_cpp, 0.0))),
        along=float(abs(alone.otf(0.0, freq_cpp))),
        formula="" if kind is None else kind.formula,
        source="" if kind is None else kind.source,
    )
