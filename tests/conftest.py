"""What tests of several rooms need: the command line run inside the test, a private server of
PostgreSQL, scenes that are fitted fast, pages without drawings."""

from __future__ import annotations

import gc
import os
import pwd
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import create_engine, text

BINARIES = sorted(Path("/usr/lib/postgresql").glob("*/bin"))
UNPRIVILEGED = ("postgres", "nobody")


def pytest_collection_finish() -> None:
    """Twelve thousand tests live to the end: the collector need not look at them each time."""
    gc.collect()
    gc.freeze()


@dataclass(frozen=True)
class PostgresServer:
    """A server in a folder of its own, reached by a socket in it.

    Parameters
    ----------
    folder, binaries : Path
    user : str
        Who the server runs as; it refuses to run as root.
    """

    folder: Path
    binaries: Path
    user: str

    def start(self) -> None:
        """Start the server, and wait until it answers."""
        options = f"-k {self.folder} -c listen_addresses='' -c fsync=off"
        self._call("pg_ctl", "start", "-w", "-D", self._data, "-o", options, "-l", self._log)

    def stop(self) -> None:
        """Stop the server at once, as a crash would."""
        self._call("pg_ctl", "stop", "-w", "-m", "immediate", "-D", self._data)

    def make(self) -> None:
        """Make the folder of the data."""
        self._call("initdb", "-N", "-D", self._data, "-A", "trust", "-U", "tester", "-E", "UTF8")

    def empty_database(self, name: str) -> str:
        """The URL of an empty database: made once, and emptied for every test after the first.

        A database takes ten times as long to be made as its tables take to be dropped.
        """
        engine = create_engine(self.url("postgres"), isolation_level="AUTOCOMMIT")
        with engine.connect() as connection:
            named = {"name": name}
            end = "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = :name"
            connection.execute(text(end), named)
            is_there = text("SELECT 1 FROM pg_database WHERE datname = :name")
            if not connection.execute(is_there, named).first():
                connection.execute(text(f'CREATE DATABASE "{name}"'))
        engine.dispose()
        own = create_engine(self.url(name), isolation_level="AUTOCOMMIT")
        with own.connect() as connection:
            connection.execute(text("DROP SCHEMA public CASCADE"))
            connection.execute(text("CREATE SCHEMA public"))
        own.dispose()
        return self.url(name)

    def url(self, database: str) -> str:
        """The URL of a database."""
        return f"postgresql+psycopg://tester@/{database}?host={self.folder}"

    @property
    def _data(self) -> str:
        return str(self.folder / "data")

    @property
    def _log(self) -> str:
        return str(self.folder / "log")

    def _call(self, program: str, *words: str) -> None:
        as_user = {"user": self.user, "group": pwd.getpwnam(self.user).pw_gid}
        done = subprocess.run(
            [str(self.binaries / program), *words],
            **(as_user if os.geteuid() == 0 else {}),
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE if program == "initdb" else subprocess.DEVNULL,
            check=False,
        )
        assert done.returncode == 0, f"{program} failed: {done.stderr!r}"


@pytest.fixture(scope="session")
def postgres_server() -> Iterator[PostgresServer]:
    """A server of PostgreSQL, skipped where Debian's package is not installed."""
    if not BINARIES:
        pytest.skip("PostgreSQL is not installed: apt-get install postgresql")
    pytest.importorskip("psycopg")
    user = pwd.getpwuid(os.geteuid()).pw_name
    if os.geteuid() == 0:
        user = next(
            name for name in UNPRIVILEGED if name in {one.pw_name for one in pwd.getpwall()}
        )
    # Names of sockets are short: pytest's own folders are too deep.
    folder = Path(tempfile.mkdtemp(prefix="pg-"))
    if os.geteuid() == 0:
        shutil.chown(folder, user)
    server = PostgresServer(folder, BINARIES[-1], user)
    try:
        server.make()
        server.start()
        yield server
    finally:
        if (folder / "data" / "postmaster.pid").exists():
            server.stop()
        shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture
def postgres_url(postgres_server: PostgresServer) -> str:
    """An empty database."""
    return postgres_server.empty_database("test")


@pytest.fixture(scope="session")
def acutance() -> Iterator[Callable[..., Any]]:
    """Run a command line; the result has .exit_code, .stdout and .stderr."""
    from typer.main import get_command
    from typer.testing import CliRunner

    from acutance.cli.app import app

    def run(*words: object) -> Any:
        return CliRunner().invoke(app, [str(word) for word in words])

    # The runner builds all commands anew for every line, which takes longer than most lines do.
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("typer.testing._get_command", cache(get_command), raising=False)
        yield run


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages whose words and tables are asked: drawings take most of their time.

    Figures are made and not written. Of every kind of page another test writes them.
    """
    monkeypatch.setattr("acutance.report.html.figure_bytes", lambda figure, ending: b"")


@pytest.fixture(scope="session")
def schema_validator() -> Any:
    """Validates documents of measurements.

    A covariance has a million numbers, for each of which a validator is made: where every item
    is a plain number, which is all that its schema asks, none need be.
    """
    from jsonschema import Draft202012Validator
    from jsonschema.validators import extend

    from acutance.report import measurement_schema

    thorough = Draft202012Validator.VALIDATORS["items"]

    def items(validator: Any, wanted: Any, found: Any, schema: Any) -> Iterator[Any]:
        is_plain = isinstance(found, list) and {type(one) for one in found} <= {int, float}
        if not (is_plain and wanted == {"type": "number"}):
            yield from thorough(validator, wanted, found, schema)

    return extend(Draft202012Validator, {"items": items})(measurement_schema())


@pytest.fixture(scope="session")
def few_forms() -> Callable[[], AbstractContextManager[None]]:
    """``with few_forms():`` the sensor of a scene is one of two plain forms.

    All steps of a scan are done, in two thirds of the time or less: of scenes whose edges, windows
    or documents are asked, not how well the forms together describe their sensor.
    """
    from acutance.scan import first_sensor, sensor_fit
    from acutance.targets.combine.sensor_forms import SCENE_FORMS

    @contextmanager
    def restricted() -> Iterator[None]:
        with pytest.MonkeyPatch.context() as patched:
            for module in (first_sensor, sensor_fit):
                patched.setattr(module, "SCENE_FORMS", SCENE_FORMS[:2])
            yield

    return restricted
