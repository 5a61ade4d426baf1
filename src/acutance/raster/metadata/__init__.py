"""What an image says of itself: sensor, bands, time, angles, GSD and level, each with its source.

In the order the data take: `files_beside` (which documents belong to an image), `documents` (from
bytes to a document, by `xml_document` and `odl`, and which reader knows it), one module a source
(`gdal_tags`, `gml`, `dimap`, `digital_globe`, `landsat`, `sentinel2`, `kompsat`, `gaofen`,
`planetscope`, `stac_item`), `findings` (what one source says), `times` and `sun` (texts to UTC; is
the sun where the source says), `statement` (what all of them say together), `read_statement`.
Nothing is guessed: what no source says stays empty, and what sources say differently is named.
"""

from acutance.raster.metadata.findings import Stated
from acutance.raster.metadata.read_statement import read_statement
from acutance.raster.metadata.statement import ImageStatement

__all__ = ["ImageStatement", "Stated", "read_statement"]
