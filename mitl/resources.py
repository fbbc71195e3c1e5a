"""Finds `models/` and `oracles/`: beside the packages in a checkout, inside the package in an installed wheel."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def _folder(name: str) -> Path:
    """Gives the folder `name`; the wheel carries it as mitl/_data/<name> (see pyproject.toml)."""
    for candidate in (_PACKAGE / "_data" / name, _PACKAGE.parent / name):
        if candidate.is_dir():
            return candidate
    raise FileNotFoundError(f"mitl's data folder {name!r} is missing from the installation ({_PACKAGE})")


def models_folder() -> Path:
    """Gives the folder with one folder a robot and trackers/."""
    return _folder("models")


def oracles_folder() -> Path:
    """Gives the folder with the stored oracles."""
    return _folder("oracles")
