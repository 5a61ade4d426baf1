"""A restoration filter in tables: what it does, what it costs, its kernel."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from acutance.arguments import require_class
from acutance.curves.metric_words import metric_words
from acutance.report.html import Table
from acutance.report.labels import MISSING, format_number, word_estimate, write_fixed

if TYPE_CHECKING:
    from acutance.curves import Estimate
    from acutance.restoration import RestorationFilter, RestorationProof
    from acutance.restoration.interpretability import Niirs
    from acutance.restoration.proof import VerifiedEdge

__all__ = ["niirs_table", "proof_table", "restoration_tables"]

_SHOWN = (
    "mtf_nyquist", "rer", "fwhm_px", "fwhm_m", "mtf50_cpp", "mtf_area", "edge_slope_per_px",
    "overshoot", "undershoot", "giqe_h",
)  # fmt: skip
_KERNEL_REACH_PX = 7


def restoration_tables(filter: RestorationFilter) -> tuple[Table, ...]:
    """Sharpness before and after, noise and interpretability, the trade, the kernel.

    Parameters
    ----------
    filter : RestorationFilter
    """
    require_class("RestorationFilter", filter=filter)
    return _sharpness(filter), _cost(filter), _trade(filter), _kernel(filter)


def _sharpness(filter: RestorationFilter) -> Table:
    rows = []
    for name in _SHOWN:
        words = metric_words(name)
        numbers = [
            sharpness.directions[direction].numbers.get(name)
            for direction in ("across", "along")
            for sharpness in (filter.before, filter.after)
        ]
        if any(number is not None for number in numbers):
            cells = (
                MISSING if one is None else word_estimate(one).value_and_std for one in numbers
            )
            rows.append((words.label_with_unit, *cells))
    return Table(
        ("Number", "Across before", "after", "Along before", "after"), tuple(rows), "lrrrr",
        title="Sharpness before and after",
        notes=(
            "After: as predicted, with the deviation of the measurement; that of the kernel is 0.",
        ),
    )  # fmt: skip


def _cost(filter: RestorationFilter) -> Table:
    """Noise, SNR, MTF times SNR, aliasing, NIIRS."""
    snr, after = filter.snr, filter.snr_after
    before_share, after_share = (f"{100 * share:.1f}" for share in filter.aliased_share)
    near = filter.noise_correlation
    middle = near.shape[0] // 2
    of_columns, of_rows = float(near[middle, middle + 1]), float(near[middle + 1, middle])
    is_turned = filter.along_track == "x"
    across, along = (of_rows, of_columns) if is_turned else (of_columns, of_rows)
    rows = [
        ("Noise, of that before", "1", write_fixed(filter.noise_gain, 3)),
        ("SNR", _number(snr), _number(after)),
        *(
            (f"MTF at Nyquist × SNR, {name}", *_products(filter, name))
            for name in ("across", "along")
        ),
        ("Correlation of the noise of neighbours, across", "0", write_fixed(across, 3)),
        ("Correlation of the noise of neighbours, along", "0", write_fixed(along, 3)),
        ("Share of fine detail that is aliased [%]", before_share, after_share),
        *(
            (f"Change of NIIRS, GIQE {version}", "", _in_words(one))
            for version, one in filter.niirs_change.items()
        ),
    ]  # fmt: skip
    return Table(
        ("Cost", "Before", "After"), tuple(rows), "lrr", title="Noise and interpretability",
        notes=(
            "Noise before is taken to be white; where a product was resampled it is not, and its "
            "gain is another. Detail beyond Nyquist is amplified like the frequency it was folded "
            "to: no filter tells them apart. A change of NIIRS has the deviation of the "
            "measurement; GIQE 5 was made for images before sharpening.",
        ),
    )  # fmt: skip


def _number(value: float | None) -> str:
    return MISSING if value is None else format_number(value, 3)


def _products(filter: RestorationFilter, direction: str) -> tuple[str, str]:
    """MTF at Nyquist times SNR, before and after."""
    found = []
    for sharpness, snr in ((filter.before, filter.snr), (filter.after, filter.snr_after)):
        number = sharpness.directions[direction].mtf_nyquist
        found.append(MISSING if snr is None else _in_words(number * snr))
    return found[0], found[1]


def _in_words(number: Estimate) -> str:
    """A number with its deviation; without one three digits have to do."""
    if number.std > 0:
        return word_estimate(number).value_and_std
    return format_number(number.value, 3).replace("-", "−")


def _trade(filter: RestorationFilter) -> Table:
    rows = tuple(
        (
            write_fixed(row["noise_gain"], 2),
            write_fixed(row["mtf_nyquist_across"], 3),
            write_fixed(row["mtf_nyquist_along"], 3),
            write_fixed(100 * row["overshoot"], 1),
            MISSING if row["niirs_change"] is None else write_fixed(row["niirs_change"], 2),
        )
        for row in filter.trade
    )
    return Table(
        ("Noise gain", "MTF at Nyquist across", "along", "Over- or undershoot [%]",
         "Change of NIIRS, GIQE 4"), rows,
        "rrrrr", title="The trade", page_only=True,
        notes=("What other kernels of this size and kind would give for their noise. Of overshoot "
               "and undershoot, across and along, the largest.",),
    )  # fmt: skip


def _kernel(filter: RestorationFilter) -> Table:
    """The weights, of a large kernel the middle ones: a page is no wider."""
    reach = min(filter.margin_px, _KERNEL_REACH_PX)
    inner = slice(filter.margin_px - reach, filter.margin_px + reach + 1)
    shown = filter.kernel[inner, inner]
    places = [
        f"{place:+d}".replace("-", "−") if place else "0" for place in range(-reach, reach + 1)
    ]
    rows = tuple(
        (place, *(write_fixed(1000 * float(one), 2) for one in row))
        for place, row in zip(places, shown, strict=True)
    )
    size = filter.size
    part = f", of which the middle {2 * reach + 1} by {2 * reach + 1} are shown"
    return Table(
        ("", *places), rows, "l" + "r" * len(places), title="The kernel", page_only=True,
        notes=(
            f"{size} by {size} weights that sum to 1{part if size > len(places) else ''}, in "
            "thousandths; rows run downwards. The image is convolved with it: the weight to the "
            "right of the middle is that of the pixel to the left. All digits are in the JSON "
            "document.",
        ),
    )  # fmt: skip


def proof_table(proof: RestorationProof) -> Table:
    """Edges before and after a filter, beside the prediction.

    Parameters
    ----------
    proof : RestorationProof
    """
    rows = tuple(
        (
            one.name, "" if one.normal_deg is None else f"{one.normal_deg:.1f}",
            MISSING if one.designed is None else _in_words(one.designed),
            word_estimate(one.before).value_and_std, word_estimate(one.predicted).value_and_std,
            word_estimate(one.after).value_and_std,
            word_estimate(one.difference).value_and_std, write_fixed(one.deviations, 1),
            word_estimate(one.overshoot).value_and_std,
            _noise_gain_words(one),
        )
        for one in proof.edges
    )  # fmt: skip
    alerts = {i for i, one in enumerate(proof.edges) if abs(one.deviations) > proof.limit}
    return Table(
        (
            "Edge", "Normal [°]", "MTF at Nyquist designed for", "before", "predicted", "measured",
            "difference", "in deviations", "Overshoot after", "SNR before/after",
        ),
        rows, "lrrrrrrrrr", alerts=frozenset(alerts), title="Edges before and after",
        notes=(
            "Designed for: MTF along the edge's normal of the sensor that the filter was made for. "
            "Predicted: the edge before, times the filter's transfer along its normal. The "
            "deviation of the difference allows for what both measurements share.",
            "SNR before/after: in brackets that of white noise, the noise gain of the filter.",
        ),
    )  # fmt: skip


def _noise_gain_words(edge: VerifiedEdge) -> str:
    """SNR before over that after, and what it is of white noise."""
    if not np.isfinite(edge.noise_gain):
        return MISSING
    white = edge.white_noise_gain
    expected = "" if white is None else f" ({write_fixed(white, 2)})"
    return f"{write_fixed(edge.noise_gain, 2)}{expected}"


def niirs_table(found: Niirs) -> Table:
    """A NIIRS with what it was computed from.

    Parameters
    ----------
    found : Niirs
    """
    own = found.inputs
    assert own is not None
    low, high = found.interval(0.95)
    gsd, snr = format_number(own.gsd_m), format_number(own.snr)
    rer = f"{own.rer_across:.4f}, {own.rer_along:.4f}"
    if found.measured_gsd_m is not None:
        gsd += f" (stated; the document's own is {format_number(found.measured_gsd_m)} m)"
    if found.measured_rer is not None:
        across, along = found.measured_rer
        rer += f" (stated; measured {across:.4f}, {along:.4f})"
    if found.measured_snr is not None:
        snr += f" (stated; measured {format_number(found.measured_snr)})"
    given = "inputs" if found.verdict is None else "measurement"
    # Version 5 is of images that were not sharpened, and has neither of them.
    of_sharpening = (
        ("overshoot H", format_number(own.giqe_h)),
        ("noise gain", format_number(own.noise_gain)),
    )
    rows = (
        (f"NIIRS (GIQE {found.version})", word_estimate(found).value_and_std),
        ("95 % interval", f"{write_fixed(low, 2)} … {write_fixed(high, 2)}"),
        (f"of the {given}", write_fixed(found.inputs_std, 3)),
        ("of the equation", write_fixed(found.equation_std, 1)),
        ("GSD [m]", gsd),
        ("RER across, along", rer),
        ("SNR", snr),
        ("elevation [°]", format_number(own.elevation_deg)),
        *(of_sharpening if found.version != 5 else ()),
    )
    notes = tuple(str(note) for note in found.notes)
    return Table(("Number", "Value"), rows, "lr", title="Interpretability", notes=notes)
