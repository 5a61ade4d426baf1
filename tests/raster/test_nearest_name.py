"""The name that may be meant by one that is not there."""

import pytest

from acutance.errors import ImageError
from acutance.raster import open_image
from acutance.raster.nearest_name import nearest_name


def test_the_nearest_name_of_the_folder(tmp_path):
    for name in ("SIM-1-20260104.tif", "SIM-1-20260114.tif", "größe 1.tif", "notes.txt"):
        (tmp_path / name).write_bytes(b"x")
    for wrong, meant in (("SIM-1-2026010.tif", "SIM-1-20260104.tif"),
                         ("sim-1-20260114.TIF", "SIM-1-20260114.tif"),
                         ("grösse 1.tif", "größe 1.tif")):  # fmt: skip
        assert nearest_name(tmp_path / wrong) == meant
    (tmp_path / "e2.tif").write_bytes(b"x")
    for unlike in ("another.jp2", "nope.tif"):
        assert nearest_name(tmp_path / unlike) is None
    assert nearest_name(tmp_path / "no folder" / "notes.txt") is None
    with pytest.raises(ImageError, match=r"its folder exists\): is .*notes.txt meant\?"):
        open_image(tmp_path / "note.txt")


def test_of_thousands_of_names_the_nearest_is_found(tmp_path):
    for day in range(1, 29):
        for number in range(40):
            (tmp_path / f"S2A_MSIL1C_202605{day:02d}T1010{number:02d}_N0500.tif").touch()
    wrong = tmp_path / "S2A_MSIL1C_20260517T10102_N0500.tif"
    meant = nearest_name(wrong)
    assert meant is not None
    assert meant.startswith("S2A_MSIL1C_20260517T1010")
    assert nearest_name(tmp_path / "s2a_MSIL1C_20260517T101023_NO500.tiff") == (
        "S2A_MSIL1C_20260517T101023_N0500.tif"
    )
