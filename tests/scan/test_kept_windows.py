"""Interrupted scans: finished windows are kept, and a scan that goes on ends as if nothing were."""

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.raster import Box, Image, write_geotiff
from acutance.scan.scan_identity import difference, scan_identity

OPTIONS = ac.ScanOptions(window_px=128)
PROGRAM = """
import sys
import acutance as ac

if __name__ == "__main__":
    image, kept, workers = sys.argv[1:]
    ac.scan_scene(
        image, options=ac.ScanOptions(window_px=128), workers=int(workers), keep=kept,
        progress=lambda done, total: print(done, total, flush=True),
    )
"""


@pytest.fixture(scope="module", autouse=True)
def _of_few_forms(few_forms):
    with few_forms():
        yield


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A scene of nine windows."""
    image, _ = simulate.landscape(
        simulate.reference_systems()["gaussian"],
        shape=(380, 380),
        snr=100,
        options=simulate.LandscapeOptions(soft=0.0, texture=(0.0, 0.0), density_per_mpx=120),
        rng=np.random.default_rng(6),
    )
    name = tmp_path_factory.mktemp("scenes") / "scene.tif"
    write_geotiff(name, image.astype(np.float32), gsd_m=2.0)
    return name


@pytest.fixture(scope="module")
def whole(path):
    """The scan of all windows at once; its windows are kept beside the image."""
    return ac.scan_scene(path, options=OPTIONS, keep=path.with_name("scan.parts"))


@pytest.fixture
def kept(path, whole, tmp_path):
    """The windows of a finished scan."""
    return Path(shutil.copy(path.with_name("scan.parts"), tmp_path))


def same(one, other):
    """Whether two scans have the same numbers to the last digit."""
    assert one.to_dict() | {"measured_at": None} == other.to_dict() | {"measured_at": None}
    for name, column in one.edges.columns().items():
        np.testing.assert_array_equal(column, other.edges.columns()[name])


@pytest.mark.parametrize("workers", [1, 2])
def test_a_killed_scan_goes_on_where_it_was(path, whole, tmp_path, workers):
    kept = tmp_path / "scan.parts"
    words = [sys.executable, "-c", PROGRAM, str(path), str(kept), str(workers)]
    if workers > 1:
        # Other processes find the program by the name of its file.
        program = tmp_path / "program.py"
        program.write_text(PROGRAM)
        words[1:3] = [str(program)]
    running = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    for line in running.stdout:
        if line == "3 9\n":
            os.kill(running.pid, signal.SIGKILL)
            break
    running.wait()
    running.stdout.close()
    assert running.returncode == -signal.SIGKILL
    seen = []
    resumed = ac.scan_scene(
        path, options=OPTIONS, keep=kept, progress=lambda done, total: seen.append((done, total))
    )
    assert seen[0][0] >= 3
    assert seen[0][0] < seen[-1][0] == 9
    same(resumed, whole)


def test_an_interrupt_says_where_the_windows_are_kept(path, whole, tmp_path, monkeypatch):
    kept = tmp_path / "scan.parts"

    def interrupt(done, total):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match=r"2 of 9 windows are kept in .*scan\.parts"):
        ac.scan_scene(path, options=OPTIONS, keep=kept, progress=interrupt)
    with pytest.raises(KeyboardInterrupt, match="2 of 9 windows were done and are lost"):
        ac.scan_scene(path, options=OPTIONS, progress=interrupt)
    same(ac.scan_scene(path, options=OPTIONS, keep=kept), whole)

    def interrupted(*arguments, **options):
        raise KeyboardInterrupt

    # The fit that follows takes longer than the windows of many a scene.
    with monkeypatch.context() as patched:
        patched.setattr("acutance.scan.scene.fit_sensor", interrupted)
        patched.setattr("acutance.scan.bands.fit_sensor", interrupted)
        with pytest.raises(KeyboardInterrupt, match=r"9 of 9 windows are kept in .*scan\.parts"):
            ac.scan_scene(path, options=OPTIONS, keep=kept)
        with pytest.raises(KeyboardInterrupt, match="9 of 9 windows were done and are lost"):
            ac.scan_bands(path, options=OPTIONS)
    seen = []
    said = []
    again = ac.scan_scene(
        path, options=OPTIONS, keep=kept, progress=lambda *n: seen.append(n), tell=said.append
    )
    same(again, whole)
    edges, used = whole.edges.size, whole.edges.used.sum()
    assert said == [
        f"{edges} edges, {used} to be used",
        f"the sensor under {used} of {edges} edges",
    ]
    assert seen == [(9, 9)]


def test_a_window_that_is_damaged_is_scanned_again(path, whole, kept):
    with sqlite3.connect(kept) as database:
        (content,) = database.execute("SELECT content FROM windows WHERE place = 4").fetchone()
        middle = len(content) // 2
        spoilt = content[:middle] + bytes(64) + content[middle + 64 :]
        database.execute("UPDATE windows SET content = ? WHERE place = 4", (spoilt,))
    database.close()
    seen = []
    again = ac.scan_scene(
        path, options=OPTIONS, keep=kept, progress=lambda done, total: seen.append(done)
    )
    assert seen == [8, 9]
    same(again, whole)


def test_the_windows_of_another_scan_are_refused(path, kept, tmp_path):
    with pytest.raises(ac.OptionError, match="another scan: min_length_px differs"):
        ac.scan_scene(path, options=ac.ScanOptions(window_px=128, min_length_px=20), keep=kept)
    with pytest.raises(ac.OptionError, match="another scan: region differs"):
        ac.scan_scene(path, (0, 0, 300, 300), options=OPTIONS, keep=kept)
    copy = shutil.copy(path, tmp_path)
    with pytest.raises(ac.OptionError, match="another scan: name of the image differs"):
        ac.scan_scene(copy, options=OPTIONS, keep=kept)
    found = path.stat()
    os.utime(path, ns=(1, 1))
    try:
        with pytest.raises(ac.OptionError, match="image, as it was before it changed"):
            ac.scan_scene(path, options=OPTIONS, keep=kept)
    finally:
        os.utime(path, ns=(found.st_atime_ns, found.st_mtime_ns))


def test_limits_of_the_answer_are_no_other_scan(path, kept):
    options = ac.ScanOptions(window_px=128, limits={"edges_used": 10_000.0})
    seen = []
    scene = ac.scan_scene(path, options=options, keep=kept, progress=lambda *n: seen.append(n))
    assert seen == [(9, 9)]
    assert "edges_used" in [check.name for check in scene.failed_checks]


def test_how_an_image_is_read_is_part_of_the_scan(path, tmp_path):
    def identity(**how):
        image = ac.open_image(path, **how)
        return scan_identity([image], Box.whole(image.shape), None, None, OPTIONS)

    every_value = identity(nodata=float("nan"))
    assert difference(every_value, json.loads(json.dumps(every_value))) is None
    table = tmp_path / "curve.csv"
    table.write_text("0,0\n1000,900\n3000,3000\n")
    curved = identity(linearize=str(table))
    assert difference(curved, identity(linearize=str(table))) is None
    for other in (curved, identity(linearize=2.2)):
        assert difference(identity(), other).startswith("characteristic curve (linearize, --gamma")
    assert difference(identity(), every_value) == "nodata value (nodata, --nodata)"
    assert difference(identity(nodata=7), every_value) == "nodata value (nodata, --nodata)"
    table.write_text("0,0\n1000,901\n3000,3000\n")
    again = difference(curved, identity(linearize=str(table)))
    assert again.startswith("characteristic curve")
    two = {"images": [*identity()["images"]] * 2}
    assert difference(identity(), identity() | two) == "number of bands"


def test_an_array_is_known_by_its_pixels(path, tmp_path):
    kept = tmp_path / "scan.parts"
    pixels = ac.open_image(path).read()
    first = ac.scan_scene(pixels, options=OPTIONS, keep=kept)
    same(ac.scan_scene(pixels.copy(), options=OPTIONS, keep=kept), first)
    pixels[300, 300] += 1
    with pytest.raises(ac.OptionError, match="image or band differs"):
        ac.scan_scene(pixels, options=OPTIONS, keep=kept)


def test_pixels_of_another_type_saturate_elsewhere(path):
    pixels = np.minimum(ac.open_image(path).read(), 255.0).astype(np.uint8)
    images = [Image.from_array(pixels.astype(kind)) for kind in (np.uint8, np.uint16)]
    one, other = (
        scan_identity([image], Box.whole(image.shape), None, None, OPTIONS) for image in images
    )
    assert one["images"][0]["pixels"] == other["images"][0]["pixels"]
    assert difference(one, other) == "saturation level"


def test_files_of_others_are_left_alone(path, tmp_path):
    before = path.read_bytes()
    with pytest.raises(ac.OptionError, match="no file of kept windows"):
        ac.scan_scene(path, keep=path)
    assert path.read_bytes() == before
    with pytest.raises(ac.OptionError, match=r"cannot be kept in .* does not exist, make it"):
        ac.scan_scene(path, keep=tmp_path / "nowhere" / "scan.parts")
    foreign = tmp_path / "foreign.db"
    with sqlite3.connect(foreign) as database:
        database.execute("CREATE TABLE notes (text TEXT)")
    database.close()
    with pytest.raises(ac.OptionError, match="database of another program"):
        ac.scan_scene(path, keep=foreign)


def test_two_scans_do_not_share_a_file(path, kept):
    def meanwhile(done, total):
        with pytest.raises(ac.OptionError, match="in use by another scan"):
            ac.scan_scene(path, options=OPTIONS, keep=kept)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ac.scan_scene(path, options=OPTIONS, keep=kept, progress=meanwhile)
