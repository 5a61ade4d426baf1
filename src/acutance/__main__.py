"""``python -m acutance`` is the command ``acutance``."""

from acutance.cli.app import run

__all__ = ["run"]

if __name__ == "__main__":
    run()
