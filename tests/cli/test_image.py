"""``acutance image``: what an image says of itself."""

import json

import numpy as np

from acutance.raster import write_geotiff


def test_what_an_image_says(acutance, tmp_path, refused):
    path = tmp_path / "scene.tif"
    tags = {"SENSOR": "SIM-1", "ACQUISITION_DATETIME": "2026-01-05T10:00:00Z"}
    write_geotiff(path, np.ones((16, 16), np.uint16), gsd_m=0.7, tags=tags)
    shown = acutance("image", path)
    assert shown.exit_code == 0
    assert "SIM-1   (scene.tif: tag SENSOR)" in shown.stdout
    assert "2026-01-05T10:00:00.000Z" in shown.stdout
    assert "0.7, 0.7" in shown.stdout
    document = json.loads(acutance("image", path, "--json").stdout)
    assert document["schema"] == "acutance/image/1"
    assert document["sensor"] == {"value": "SIM-1", "source": "scene.tif: tag SENSOR"}
    assert "sun_elevation_deg" not in document
    refused(("image", tmp_path / "none.tif"), "does not exist")


def test_documents_elsewhere_and_contradictions(acutance, refused, tmp_path):
    path, document = tmp_path / "scene.tif", tmp_path / "other.IMD"
    write_geotiff(path, np.ones((16, 16), np.uint16), tags={"SENSOR": "SIM-1"})
    document.write_text(
        'bandId = "P";\nBEGIN_GROUP = IMAGE_1\nsatId = "WV02";\nEND_GROUP = IMAGE_1\n'
    )
    shown = acutance("image", path, "--metadata", document)
    assert "WV02   (other.IMD: satId)" in shown.stdout
    assert "contradiction: sensor: WV02 (other.IMD: satId), but SIM-1" in shown.stdout
    (tmp_path / "damaged.xml").write_text("<a>")
    damaged = acutance("image", path, "--metadata", tmp_path / "damaged.xml")
    assert "note: damaged.xml cannot be read" in damaged.stdout
    # Who names a document that is not there has mistyped its name.
    refused(("image", path, "--metadata", tmp_path / "none.xml"), "there is no such file")
