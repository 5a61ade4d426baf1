"""From a measured transfer to the kernel that restores it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import UTC, datetime
from numbers import Real
from typing import Any, Literal

import numpy as np

from acutance.arguments import require_flags
from acutance.curves import Otf2d, Response
from acutance.curves.grid import Floats
from acutance.errors import OptionError
from acutance.numerics.one_thread import one_thread
from acutance.optics import Sensor
from acutance.raster import Gsd, Image
from acutance.restoration.aliasing import aliased_share
from acutance.restoration.filtered_otf import FilteredOtf
from acutance.restoration.kernel_family import DESIRED, Desired, KernelFamily
from acutance.restoration.knobs import Knob, Turned, chosen_knob, weight_of
from acutance.restoration.known_otf import KnownOtf, Measured, known_otf
from acutance.restoration.measured_scene import measured_scene
from acutance.restoration.niirs_change import niirs_changes
from acutance.restoration.restoration_filter import SCHEMA, RestorationFilter
from acutance.restoration.scene_spectrum import NaturalScene, SceneSpectrum, StiffScene
from acutance.restoration.trade import trade_rows
from acutance.targets.measurement import direction_document
from acutance.targets.record import strict_json
from acutance.targets.slices import OtfSlices

__all__ = ["METHODS", "RestorationMethod", "SceneLike", "design_restoration"]

RestorationMethod = Literal["wiener", "constrained", "target"]
METHODS: tuple[RestorationMethod, ...] = ("wiener", "constrained", "target")
SceneLike = Literal["natural"] | NaturalScene | Image
"""The scene's power: the natural one, a stated one, or that of an image."""

MIN_SIZE, MAX_SIZE = 3, 41
_CONTRAST = 0.2
"""Standard deviation of a natural scene, a share of the contrast that the SNR counts."""
_USUAL_SNR = 100.0
"""Where no SNR is known, and none matters because a knob is turned."""
_SHARPER = "the sharper aim (desired='point', --desired point)"

_TARGET_WEIGHT = 0.01
"""Of the noise, where a stated transfer is to be reached: it is missed by some 1 % at Nyquist."""
_MISSED, _DEEP, _RINGING = 0.02, 0.02, 0.10


@one_thread
def design_restoration(
    otf: Measured | Sensor | Otf2d | Sequence[Measured],
    *,
    snr: float | None = None,
    noise_gain: float | None = None,
    mtf_nyquist: float | None = None,
    overshoot: float | None = None,
    target: Sensor | Otf2d | None = None,
    size: int = 15,
    method: RestorationMethod | None = None,
    scene: SceneLike = "natural",
    desired: Literal["pixel", "point"] = "pixel",
    isotropic: bool = False,
    gsd_m: float | Gsd | None = None,
    names: Sequence[str] | None = None,
) -> RestorationFilter:
    """Design the kernel that sharpens the images of a measured sensor.

    Of all kernels of its size and of sum 1 it has the least expected error, over scenes, noise, and
    all transfers that the measurement leaves possible. One of `noise_gain`, `mtf_nyquist`,
    `overshoot` or `target` determines how far it goes; without them the error itself does.

    Parameters
    ----------
    otf : Measurement, Record, dict, Sensor, Otf2d, or a sequence of measurements
        What is known of the sensor: a 2-D result, a scene, or edges of several directions.
    snr : float, optional
        Signal to noise ratio: contrast of a target over the noise. That of the measurement without
        it.
    noise_gain : float, optional
        Standard deviation of white noise after the kernel over that before it.
    mtf_nyquist : float, optional
        MTF at Nyquist after it, the mean of across and along.
    overshoot : float, optional
        Largest overshoot or undershoot of an edge across or along, a share of its contrast.
    target : Sensor or Otf2d, optional
        The transfer to be reached, whatever the noise.
    size : int, optional
        Rows and columns of the kernel, odd.
    method : {"wiener", "constrained", "target"}, optional
        The scene that is expected: `scene`, or one without curvature (constrained least squares);
        "target" goes with `target`.
    scene : "natural", NaturalScene or Image, optional
        Power of the scene: 1/f^2 with a fifth of the contrast that `snr` counts, a stated one, or
        that of an image, its blur and noise divided out.
    desired : {"pixel", "point"}, optional
        The image that the least error is taken to: the mean over each pixel's area, which no other
        blur has touched, or the scene at its middle, which is sharper and rings more.
    isotropic : bool, optional
        State that the blur is the same in all directions, where one was measured.
    gsd_m : float or Gsd, optional
        Ground sampling distance in metres, instead of the measurement's.
    names : sequence of str, optional
        What to call the measurements in notes: the names of their files.

    Returns
    -------
    RestorationFilter

    Raises
    ------
    OptionError
        If arguments contradict each other, or no kernel reaches what is asked.

    Examples
    --------
    >>> edges = [ac.measure_edge(tarp, across), ac.measure_edge(tarp, along)]  # doctest: +SKIP
    >>> filter = ac.design_restoration(edges, noise_gain=2.0)  # doctest: +SKIP
    >>> print(filter.after.across.mtf_nyquist, filter.snr_after)  # doctest: +SKIP
    """
    require_flags(isotropic=isotropic)
    knob = chosen_knob(noise_gain=noise_gain, mtf_nyquist=mtf_nyquist, overshoot=overshoot)
    chosen = _method(method, target, knob)
    _require_size(size)
    known = known_otf(otf, isotropic=isotropic, gsd_m=gsd_m, names=names)
    own_snr = _snr(snr, known, needed=knob is None and not isinstance(scene, NaturalScene | Image))
    expected = _scene(scene, known, own_snr, chosen)
    family = KernelFamily.of(known.otf.model, expected, size, _desired(desired, target))
    turned = Turned(family, known)
    aims_at_pixels = desired == "pixel" and target is None
    weight = _weight(knob, chosen, turned, _SHARPER if aims_at_pixels else "")
    return _described(turned, weight, chosen, knob, own_snr, expected, target)


def _method(method: RestorationMethod | None, target: Any, knob: Knob | None) -> RestorationMethod:
    """The method, made sure that it goes with what else is asked for."""
    default: RestorationMethod = "wiener" if target is None else "target"
    chosen = default if method is None else method
    if not isinstance(chosen, str) or chosen not in METHODS:
        raise OptionError(f"method is {method!r}: it has to be one of {', '.join(METHODS)}")
    if (chosen == "target") != (target is not None):
        raise OptionError(
            f"method is {chosen!r} and a target was {'not ' if target is None else ''}given: "
            "the method 'target' and a target go together"
        )
    if target is not None and knob is not None:
        raise OptionError(
            f"a target and {knob.name} were given, and each of them determines the kernel: give one"
        )
    if chosen == "constrained" and knob is None:
        raise OptionError(
            "the method 'constrained' knows no scene, so no kernel is the best: give a noise gain, "
            "an MTF at Nyquist or an overshoot"
        )
    return chosen


def _require_size(size: int) -> None:
    whole = isinstance(size, int | np.integer) and not isinstance(size, bool)
    if not whole or size % 2 == 0 or not MIN_SIZE <= size <= MAX_SIZE:
        raise OptionError(
            f"size is {size!r}: a kernel has an odd number of rows from {MIN_SIZE} to {MAX_SIZE}"
        )


def _snr(snr: float | None, known: KnownOtf, *, needed: bool) -> float | None:
    """The SNR that was stated, or that of the measurement."""
    if snr is not None:
        if isinstance(snr, bool) or not isinstance(snr, Real) or not 0 < snr < math.inf:
            raise OptionError(f"snr is {snr!r}: give a finite number above 0")
        return float(snr)
    if known.snr is None and needed:
        raise OptionError(
            "no SNR is known, and the best kernel depends on it: state it (snr, --snr), or turn a "
            "knob (noise_gain, mtf_nyquist, overshoot)"
        )
    return known.snr


def _scene(
    scene: SceneLike, known: KnownOtf, snr: float | None, method: RestorationMethod
) -> SceneSpectrum:
    if method == "constrained":
        return StiffScene()
    if isinstance(scene, NaturalScene):
        return scene
    if isinstance(scene, Image):
        return measured_scene(scene, known.otf.model)
    if not (isinstance(scene, str) and scene == "natural"):
        raise OptionError(
            f"scene is {scene!r:.80}: give 'natural', a NaturalScene or an Image, of an array "
            "Image.from_array(array)"
        )
    return NaturalScene(_CONTRAST * (snr or _USUAL_SNR))


def _desired(name: str, target: Sensor | Otf2d | None) -> Desired:
    if name not in DESIRED:
        raise OptionError(f"desired is {name!r}: it has to be one of {', '.join(DESIRED)}")
    if target is None:
        return DESIRED[name]
    if not isinstance(target, Sensor | Otf2d):
        raise OptionError(f"the target is a {type(target).__name__}: give a Sensor or an Otf2d")
    return known_otf(target).otf.model.otf


def _weight(knob: Knob | None, method: RestorationMethod, turned: Turned, sharper: str) -> float:
    """The weight of the noise that the knob asks for; without one, that of the noise itself."""
    if knob is not None:
        return weight_of(knob, turned, sharper)
    return _TARGET_WEIGHT if method == "target" else 1.0


def _described(
    turned: Turned,
    weight: float,
    method: RestorationMethod,
    knob: Knob | None,
    snr: float | None,
    scene: SceneSpectrum,
    target: Sensor | Otf2d | None,
) -> RestorationFilter:
    """The kernel with everything that is predicted of it."""
    from acutance import __version__

    known, kernel = turned.known, turned.family.kernel(weight)
    gain = math.sqrt(float(np.sum(kernel**2)))
    sensor = known.otf
    restored = Otf2d(FilteredOtf(sensor.model, kernel), sensor.gsd_m)
    before, after = _responses(sensor, known), _responses(restored, known)
    changes = (
        {} if snr is None else niirs_changes(list(before.values()), list(after.values()), snr, gain)
    )
    document = {
        "schema": SCHEMA,
        "kernel": kernel.tolist(),
        "method": method,
        "asked": None if knob is None else {knob.name: knob.value},
        "noise_weight": weight,
        "scene": scene.to_dict(),
        "snr": snr,
        "noise_gain": gain,
        "snr_after": None if snr is None else snr / gain,
        "before": {name: direction_document(one) for name, one in before.items()},
        "after": {name: direction_document(one) for name, one in after.items()},
        "plane": OtfSlices.of_otf2d(sensor).to_dict(),
        "niirs_change": {str(version): one.to_dict() for version, one in changes.items()},
        "aliased_share": list(aliased_share(sensor.model, scene, kernel)),
        "trade": trade_rows(turned, snr),
        "image": {
            "gsd_m": None if sensor.gsd_m is None else list(sensor.gsd_m),
            "band": known.band,
            "along_track": known.along_track,
        },
        "sources": list(known.sources),
        "notes": list(_notes(known, before, after, snr, target)),
        "verdict": known.verdict,
        "software": {"acutance": __version__},
        "designed_at": datetime.now(UTC).isoformat(timespec="seconds"),
    }
    return RestorationFilter.from_dict(strict_json(document))


def _responses(otf: Otf2d, known: KnownOtf) -> dict[str, Response]:
    return {name: otf.response(angle) for name, angle in known.axes_deg.items()}


def _notes(
    known: KnownOtf,
    before: dict[str, Response],
    after: dict[str, Response],
    snr: float | None,
    target: Sensor | Otf2d | None,
) -> tuple[str, ...]:
    """What has to be said of the filter."""
    notes = list(known.cautions)
    for name, one in before.items():
        inside = one.mtf.freq_cpp <= 0.5
        lowest = int(np.argmin(one.mtf.value[inside]))
        if one.mtf.value[lowest] < _DEEP:
            notes.append(
                f"the MTF {name} falls to {one.mtf.value[lowest]:.3f} at "
                f"{one.mtf.freq_cpp[lowest]:.2f} c/px: no kernel brings back what is lost there"
            )
    for name, one in after.items():
        worst = max(one.overshoot, one.undershoot, key=float)
        if worst > _RINGING:
            notes.append(
                f"edges {name} will overshoot by {100 * worst.value:.0f} % of their contrast"
            )
    # A target may be softer than the sensor: then a smoother image is what was asked for.
    notes += _missed(known, after, target) if target is not None else _blurred(before, after)
    if snr is None:
        notes.append("no SNR is known: that after the filter and the change of NIIRS are not told")
    return tuple(dict.fromkeys(notes))


def _blurred(before: dict[str, Response], after: dict[str, Response]) -> list[str]:
    """The directions whose edges the kernel makes softer, in one note."""
    softer = [
        f"RER {name} falls from {before[name].rer.value:.3f} to {one.rer.value:.3f}, MTF at "
        f"Nyquist from {before[name].mtf_nyquist.value:.3f} to {one.mtf_nyquist.value:.3f}"
        for name, one in after.items()
        if one.rer.value < before[name].rer.value
    ]
    if not softer:
        return []
    listed = "; ".join(softer)
    return [f"the kernel blurs edges, it does not sharpen: {listed}: a larger noise gain sharpens"]


def _missed(known: KnownOtf, after: dict[str, Response], target: Sensor | Otf2d) -> list[str]:
    """Directions in which the transfer that was asked for is not reached."""
    wanted = _responses(known_otf(target).otf, known)
    return [
        f"the target's MTF {name} at Nyquist is {wanted[name].mtf_nyquist.value:.3f}, reached is "
        f"{one.mtf_nyquist.value:.3f}"
        for name, one in after.items()
        if abs(_off(one.mtf.value, wanted[name].mtf.value)) > _MISSED
    ]


def _off(found: Floats, wanted: Floats) -> float:
    """Largest difference up to Nyquist, on the grid of the curves."""
    return float(np.abs(found - wanted)[:51].max())
