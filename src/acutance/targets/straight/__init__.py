"""Straight targets, measured along their normals: edges, and pulses between two plateaus.

In the order data take: `find_edges`, `find_pulse` (where is a target), `trim` (which pixels are
usable; `pixels` holds them), `first_fit` (a Gaussian through a pixel; `bend`: on a curved line),
`fit_edge` and `fit_pulse` (the reference estimator: `solve` finds the line, `linear_model` the
curves, with `spline`, `spline_equations`, `lsf`, `lsf_prior`, `gradients`, `ground_steps`,
`step_profile`; the last pass is `among_sensors`, its prior `sensor_density`; `learn_lsf` learned
both priors), `edge` and `pulse` (the public functions; `many_edges`, `many_pulses` for all edges
of a target and for many regions),
`edge_checks`, `pulse_checks`, `pixel_checks`, `structure_checks`, `odd_even`,
`removed_noise` and `ground_checks` (is the target good enough; `check_data` is their input). What
takes a model of its own: `rim` (a strip along the border), `nonlinearity` (a characteristic that
curves: of edges `mirror_sum` and `side_noise`, of pulses `curved_model` with `lsf_parity`).
`error_causes`: what the uncertainty consists of; `pixels_alone`: what pixels say, the prior apart;
`stated_target`: what is stated of the target.
`pulse_halo`, `pulse_response`, `pulse_spectrum`, `pulse_width`: for pulses only. `published`:
the methods of the literature, biases included.
"""

from typing import TYPE_CHECKING

from acutance.names_on_use import names_on_use

if TYPE_CHECKING:
    from acutance.targets.straight.edge import METHODS, measure_edge
    from acutance.targets.straight.many_edges import each_edge, measure_edges
    from acutance.targets.straight.many_pulses import each_pulse, measure_pulses
    from acutance.targets.straight.options import EdgeOptions, PulseOptions
    from acutance.targets.straight.pulse import PULSE_METHODS, measure_pulse
    from acutance.targets.straight.straight_measurement import StraightDetails, StraightMeasurement

__all__ = [
    "METHODS",
    "PULSE_METHODS",
    "EdgeOptions",
    "PulseOptions",
    "StraightDetails",
    "StraightMeasurement",
    "each_edge",
    "each_pulse",
    "measure_edge",
    "measure_edges",
    "measure_pulse",
    "measure_pulses",
]

# The modules are loaded when a name is first used: an edge needs none of those of pulses.
_HOMES = {
    "METHODS": "edge",
    "PULSE_METHODS": "pulse",
    "EdgeOptions": "options",
    "PulseOptions": "options",
    "StraightDetails": "straight_measurement",
    "StraightMeasurement": "straight_measurement",
    "each_edge": "many_edges",
    "each_pulse": "many_pulses",
    "measure_edge": "edge",
    "measure_edges": "many_edges",
    "measure_pulse": "pulse",
    "measure_pulses": "many_pulses",
}

__getattr__ = names_on_use(__name__, _HOMES)
