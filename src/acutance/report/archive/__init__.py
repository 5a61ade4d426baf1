"""Archives on paper: what was kept of a sensor, and how it changed.

- `dates`: years with decimals on the axis of a drawing; `wording`: changes in words
- `trend_figure`, `trend_page`: one trend, its numbers, its images
- `trend_plan`: a planned watch as text and figure
- `sensor_state`, `sensor_comparisons`, `sensor_tables`, `sensor_curves`, `sensor_page`: what there
  is of a sensor
"""

from acutance.report.archive.sensor_page import sensor_page
from acutance.report.archive.trend_figure import trend_figure
from acutance.report.archive.trend_page import trend_page, trend_plate
from acutance.report.archive.trend_plan import trend_plan_figure, trend_plan_text

__all__ = [
    "sensor_page",
    "trend_figure",
    "trend_page",
    "trend_plan_figure",
    "trend_plan_text",
    "trend_plate",
]
