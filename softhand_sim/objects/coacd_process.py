"""CoACD in a process of its own: `python -m softhand_sim.objects.coacd_process mesh.npz parts.npz seconds`."""

import sys
from contextlib import suppress

import numpy as np

COACD_RECIPE: dict[str, float | int | str | bool] = {
    # choice: of the settings tried on a scanned mug and cup among the fastest (20 to 30 s instead of 90 s) at the same
    # number of parts, their volume within 10 % on the mug and 1 % on the cup; a scanned banana takes 1 s
    "threshold": 0.1,  # concavity allowed, relative to the size
    "max_convex_hull": 24,  # choice: more parts slow each contact search
    "preprocess_mode": "auto",  # remeshes what is not manifold
    "preprocess_resolution": 30,
    "resolution": 500,
    "mcts_nodes": 10,
    "mcts_iterations": 20,
    "mcts_max_depth": 3,
    "decimate": True,
    "max_ch_vertex": 64,
    "seed": 0,
}


def main(given: str, found: str, longest_s: str) -> None:
    """Read vertices and faces from one npz file and write the corners of the convex parts to the other.

    On a POSIX system the process is ended by a signal after `longest_s` seconds of processor time, a whole number.
    """
    with suppress(ImportError):
        import resource  # noqa: PLC0415 - POSIX only

        resource.setrlimit(resource.RLIMIT_CPU, (int(longest_s), int(longest_s) + 5))
    # here, not above: whoever wants the recipe alone need not load the library
    import coacd  # noqa: PLC0415

    coacd.set_log_level("off")
    with np.load(given, allow_pickle=False) as data:
        mesh = coacd.Mesh(data["vertices"], data["faces"])
    parts = [vertices for vertices, _ in coacd.run_coacd(mesh, **COACD_RECIPE)]
    np.savez(
        found,
        vertices=np.vstack([np.zeros((0, 3)), *parts]),
        counts=np.array([len(part) for part in parts], dtype=np.int64),
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
