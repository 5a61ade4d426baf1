"""What a .zip or .tar file holds, by the names GDAL reads it under."""

from __future__ import annotations

import posixpath
import tarfile
import zipfile

__all__ = ["packed_names"]


def packed_names(path: str) -> tuple[str, ...] | None:
    """The files inside a packed file as GDAL's names, the largest first.

    Parameters
    ----------
    path : str
        Any file.

    Returns
    -------
    tuple of str or None
        "/vsizip/a.zip/b.tif", "/vsitar/a.tar.gz/b.tif" ...; ``None`` for a file that is neither
        .zip nor .tar (compressed or not).
    """
    try:
        if zipfile.is_zipfile(path):
            with zipfile.ZipFile(path) as packed:
                sizes = {
                    one.filename: one.file_size for one in packed.infolist() if not one.is_dir()
                }
            prefix = "/vsizip/"
        elif tarfile.is_tarfile(path):
            with tarfile.open(path) as packed_tar:
                sizes = {one.name: one.size for one in packed_tar.getmembers() if one.isfile()}
            prefix = "/vsitar/"
        else:
            return None
    except (OSError, zipfile.BadZipFile, tarfile.TarError, EOFError):
        return None
    largest_first = sorted(sizes, key=lambda name: -sizes[name])
    return tuple(f"{prefix}{path}/{posixpath.normpath(name)}" for name in largest_first)
