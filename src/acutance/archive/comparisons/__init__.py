"""Comparisons: do across and along differ, do methods, kinds or bands agree?

In the order the data take:

- `groups`: rows of an archive become groups to be compared, each of one sensor, band, direction
- `pairing`: what two groups measured of the same thing, so that what is common to both cancels
- `same_images`: their difference from these pairs; `means`: from different images, the drift
  between them allowed for; `same_targets`: from different images of the same targets;
  `random_difference`: what all of these give
- `target_cells`, `crossed_effects`: what is peculiar to a target, a site or an image, and does not
  average out over the others; `target_notes`: what cannot be told of few targets
- `degrees`: parts of a deviation with few degrees of freedom, joined
- `compare_groups`: all of it; `difference`, `comparison`: the answers, as sentences and as JSON
"""

from acutance.archive.comparisons.compare_groups import compare_groups
from acutance.archive.comparisons.difference import Difference
from acutance.archive.comparisons.group_comparison import GroupComparison, GroupScatter

__all__ = ["Difference", "GroupComparison", "GroupScatter", "compare_groups"]
