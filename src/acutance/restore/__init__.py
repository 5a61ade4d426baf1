"""From a measured MTF to a sharper image, and what it costs."""

from acutance.restore.design import design_restoration
from acutance.restore.niirs import Niirs, niirs
from acutance.restore.restoration_filter import RestorationFilter

__all__ = ["Niirs", "RestorationFilter", "design_restoration", "niirs"]
