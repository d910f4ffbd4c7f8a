"""``--objects`` of the scripts: names of the catalogue."""

from softhand_sim.objects.catalogue import load_catalogue


def catalogue_names(text: str) -> list[str]:
    """Return the names of a comma-separated list, in its order; ``all`` for the whole catalogue.

    Raises
    ------
    ValueError
        If one is not in the catalogue.
    """
    known = list(load_catalogue())
    asked = known if text == "all" else [name.strip() for name in text.split(",")]
    for name in asked:
        if name not in known:
            raise ValueError(f"--objects: {name!r} is not in the catalogue {known}")
    return asked
