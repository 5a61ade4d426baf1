"""Measurements kept over years, and the questions that are asked of them.

Sees records only, never pixels. In the order the data take:

- `entry`: one measurement, or one rejection, with what is known of its image and its target
- `identity`: what makes an entry the one that is there already
- `dates`: moments in UTC, and how dates without a time or a zone are read
- `tables`, `migrations`: the tables of an archive, and how older ones become today's
- `counted`: numbers with what they count
- `connection`, `failures`: SQLite or PostgreSQL, transactions that wait, errors in words
- `packing`, `systematic`, `rows`, `adding`: entries become rows, added once each
- `runs`, `outcomes`, `removing`: batches that wrote into the archive; how what they ask for came
  out; rejections that hold no longer
- `selection`, `columns`, `measurements`: which rows are meant, and what they hold as columns
- `stored_entries`, `overview`: rows become entries again, and are counted
- `image_corrections`, `named_images`, `correction_notes`: dates, sensors, GSD, angles of images
  that are kept already, shared by all rows of a content
- `exchange`: files of documents and tables, in and out
- `weighted_means`: means of measurements that disagree
- `trends`: drift, steps, season and scatter of a sensor through the years
- `mean_of_images`: the mean of a series over its images, targets and sites
- `comparison_margin`, `comparisons`: whether across and along differ, whether methods agree
- `specification`, `specification_check`, `requirement_answers`: requirements, are they met
- `tables_by`: tables across and along by sensor, band, site, date
- `published`: the tables that publications print, as entries
- `questions`, `rows_of_runs`, `archive`: all of it under one name, `Archive`
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from acutance.names_on_use import names_on_use

if TYPE_CHECKING:
    from acutance.archive.archive import Archive
    from acutance.archive.entry import Entry, ImageEntry, Kept, RunEntry, TargetEntry
    from acutance.archive.image_corrections import CorrectedImage, ImageCorrection
    from acutance.archive.measurements import Measurements, Rejections
    from acutance.archive.published.read import published_entries
    from acutance.archive.weighted_means import WeightedMean, weighted_mean

__all__ = [
    "Archive",
    "CorrectedImage",
    "Entry",
    "ImageCorrection",
    "ImageEntry",
    "Kept",
    "Measurements",
    "Rejections",
    "RunEntry",
    "TargetEntry",
    "WeightedMean",
    "published_entries",
    "weighted_mean",
]

# The modules are loaded when a name is first used: an entry costs no SQLAlchemy.
_HOMES = {
    "Archive": "archive",
    "CorrectedImage": "image_corrections",
    "Entry": "entry",
    "ImageCorrection": "image_corrections",
    "ImageEntry": "entry",
    "Kept": "entry",
    "Measurements": "measurements",
    "Rejections": "measurements",
    "RunEntry": "entry",
    "TargetEntry": "entry",
    "WeightedMean": "weighted_means",
    "published_entries": "published.read",
    "weighted_mean": "weighted_means",
}

__getattr__ = names_on_use(__name__, _HOMES)
