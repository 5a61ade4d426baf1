"""Names that are no UTF-8, and streams whose encoding lacks characters."""

import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

from acutance.errors import ImageError
from acutance.raster import open_image, write_geotiff


def test_a_name_that_is_no_utf8_is_refused_in_words(edge_image, tmp_path):
    strange = os.fsdecode(os.fsencode(tmp_path) + b"/m\xfcnchen.tif")
    try:
        shutil.copy(edge_image, strange)
    except OSError:
        pytest.skip("the disk takes no such name")
    with pytest.raises(ImageError, match="is no UTF-8: rename the file"):
        open_image(strange)


def test_characters_that_streams_lack_are_replaced():
    code = (
        "from acutance.cli.terminal import replace_what_streams_lack, say\n"
        "replace_what_streams_lack(); say('x\\u2013y \\ud800'); print('x\\u2013y \\ud800')"
    )
    for encoding in ("latin-1", "utf-8"):
        found = subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "PYTHONIOENCODING": encoding},
            capture_output=True,
            check=True,
        )
        assert found.stdout.rstrip().endswith(b"y ?")
        assert found.stderr == found.stdout


# rasterio's own log stumbles over the same bytes.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_damaged_document_beside_an_image_is_named(tmp_path):
    path = tmp_path / "e.tif"
    write_geotiff(path, np.zeros((20, 20), np.uint16))
    (tmp_path / "e.xml").write_bytes(b"<broken\xff\xfe\0")
    with pytest.raises(ImageError, match=r"beside it, such as e\.xml, may be damaged"):
        open_image(path)
