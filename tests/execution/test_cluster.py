"""Independent tasks on a dask cluster: two processes of this machine stand for one."""

import importlib
import os
import sys
import time

import numpy as np
import pytest

import acutance as ac
from acutance import simulate
from acutance.execution import run_on_cluster
from acutance.raster import write_geotiff

distributed = pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def cluster():
    """The address of a scheduler with two workers."""
    # Workers import this module to find the tasks.
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None,
        preload=f"import sys; sys.path.insert(0, {os.path.dirname(__file__)!r})",
    ) as running:  # fmt: skip
        yield running.scheduler_address


def square(task):
    return task * task, os.getpid()


def fails_at_seven(task):
    if task == 7:
        raise ac.NoEdgeError("seven")
    time.sleep(0.01)
    return task


def test_every_result_is_handed_over_once(cluster):
    found = {}
    run_on_cluster(square, list(range(40, 0, -1)), found.__setitem__, scheduler=cluster)
    assert {place: value for place, (value, _) in found.items()} == {
        place: (40 - place) ** 2 for place in range(40)
    }
    assert len({process for _, process in found.values()} - {os.getpid()}) == 2


def test_an_error_ends_the_run_as_it_was_raised(cluster):
    found = {}
    with pytest.raises(ac.NoEdgeError, match="seven"):
        run_on_cluster(fails_at_seven, range(2000), found.__setitem__, scheduler=cluster)
    assert 7 not in found
    assert len(found) < 1900


def test_a_scan_on_a_cluster_is_the_same(cluster, tmp_path, monkeypatch, few_forms):
    image, _ = simulate.landscape(
        simulate.reference_systems()["gaussian"],
        shape=(300, 300),
        snr=100,
        options=simulate.LandscapeOptions(soft=0.0, texture=(0.0, 0.0), density_per_mpx=200),
        rng=np.random.default_rng(6),
    )
    write_geotiff(tmp_path / "scene.tif", image.astype(np.float32), gsd_m=2.0)
    monkeypatch.chdir(tmp_path)
    options = ac.ScanOptions(window_px=150)
    with few_forms():
        here = ac.scan_scene("scene.tif", options=options)
        there = ac.scan_scene("scene.tif", options=options, scheduler=cluster)
    for name, column in here.edges.columns().items():
        np.testing.assert_array_equal(column, there.edges.columns()[name])
    assert there.across.mtf_nyquist == here.across.mtf_nyquist
    with pytest.raises(ac.OptionError, match="in memory, where the workers of a cluster"):
        ac.scan_scene(image, scheduler=cluster)


def test_a_file_that_workers_do_not_see_is_said_to_be_theirs(cluster, tmp_path):
    write_geotiff(tmp_path / "scene.tif", np.zeros((64, 64), np.float32))
    image = ac.open_image(tmp_path / "scene.tif")
    (tmp_path / "scene.tif").unlink()
    with pytest.raises(ac.ImageError, match="all of them have to see the file under this name"):
        ac.scan_scene(image, scheduler=cluster)


def ends_its_process(task):
    os._exit(1)


def test_a_cluster_that_loses_its_work_is_named(cluster):
    with pytest.raises(ac.OptionError, match="lost its work"):
        run_on_cluster(ends_its_process, [1], print, scheduler=cluster)


def test_workers_of_another_version_are_refused(cluster, monkeypatch):
    monkeypatch.setattr(ac, "__version__", "9.9")
    with pytest.raises(ac.OptionError, match=r"has acutance .*, and this is 9\.9"):
        run_on_cluster(square, [1], print, scheduler=cluster)


def test_a_cluster_that_is_not_there_is_refused(monkeypatch):
    monkeypatch.setattr("acutance.execution.cluster._PATIENCE_S", 0.5)
    with pytest.raises(ac.OptionError, match=r"tcp://127\.0\.0\.1:9 cannot be reached"):
        run_on_cluster(square, [1], print, scheduler="tcp://127.0.0.1:9")
    with pytest.raises(ac.OptionError, match="cannot be reached"):
        run_on_cluster(square, [1], print, scheduler="nonsense")


def test_without_dask_the_way_out_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    importlib.invalidate_caches()
    with pytest.raises(ac.OptionError, match=r"pip install 'acutance\[dask\]'"):
        run_on_cluster(square, [1], print, scheduler="tcp://127.0.0.1:9")
