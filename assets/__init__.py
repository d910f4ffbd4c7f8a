"""Data of softhand-sim, and the one locator that finds it in a checkout and in an installed wheel."""

from pathlib import Path

_ROOT = Path(__file__).resolve().parent


def asset_path(*parts: str) -> Path:
    """Return the path of an asset, for example ``asset_path("materials", "pet.toml")``.

    Raises
    ------
    FileNotFoundError
        If no such asset is shipped; the message lists what the folder holds.
    """
    path = _ROOT.joinpath(*parts)
    if not path.exists():
        there = sorted(p.name for p in path.parent.glob("*")) if path.parent.is_dir() else []
        raise FileNotFoundError(f"no asset {'/'.join(parts)!r}; the folder holds {there}")
    return path
