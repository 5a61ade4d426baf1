"""Published tables as entries of an archive: what was printed, and nothing beyond it.

Each table is a data file of this folder. A printed row becomes a record without curves and without
standard deviations; what a document does not print is ``None``. `read` makes the entries.
"""

from acutance.archive.published.read import PUBLISHED, published_entries

__all__ = ["PUBLISHED", "published_entries"]
