"""The hand, live, in a browser on this machine: three sliders set the angles.

The page shows the hand closing, and the pressures of the three elements beside it. It is served on the loopback
address; others are let in only where --allow-remote says so.
"""

import threading
from collections.abc import Sequence

import numpy as np

from scripts import _cli
from scripts._view_server import LiveHand, ViewServer, check_host
from softhand_sim.calibration import load_calibration
from softhand_sim.control.table import AngleTable
from softhand_sim.effects import PRESETS
from softhand_sim.effects.build import apply_to_contacts, apply_to_model, build_losses, build_pneumatics
from softhand_sim.grasp.place import place_object
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.hand.scene import build_scene
from softhand_sim.objects.catalogue import make_object
from softhand_sim.objects.mjcf import attach_object
from softhand_sim.render import Camera, RenderUnavailableError
from softhand_sim.simulation import HandSimulation

EXAMPLES = """examples:
  view.py --web
  view.py --web --object mug --port 8123
"""


def parser() -> _cli.Parser:
    """Return the command line's definition."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--web", action="store_true", help="serve the page until Ctrl-C")
    p.add_argument("--object", default="apple", help="catalogue name of what lies there (default %(default)s)")
    p.add_argument("--effects", choices=["bench", "full"], default="bench", help="(default %(default)s)")
    p.add_argument("--host", default="127.0.0.1", help="address to serve on (default %(default)s)")
    p.add_argument("--port", type=_cli.non_negative_int, default=8080, help="0 for any free one (default %(default)s)")
    p.add_argument("--allow-remote", action="store_true", help="let --host be an address that others can reach")
    p.add_common(seed="seed of the sensors' noise", json="write the address that is served to this file")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    return _cli.run(_job, argv)


def _job(argv: Sequence[str] | None) -> int:
    args = parser().parse_args(argv)
    if not args.web:
        raise ValueError("--web: say so; for MuJoCo's own window: python -m mujoco.viewer --mjcf=assets/hand/scene.xml")
    check_host(args.host, args.allow_remote)
    _cli.check_writable(args.json)
    hand = live_hand(args.object, args.effects, args.seed)
    server = ViewServer(hand, args.host, args.port, args.allow_remote)
    runner = threading.Thread(target=hand.run, daemon=True)
    address = f"http://{args.host}:{server.server_address[1]}/"
    try:
        runner.start()
        if args.json is not None:
            _cli.write_json(args.json, {"address": address})
        print(f"{address} (Ctrl-C ends it)", flush=True)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        runner.join()
    except KeyboardInterrupt:
        pass
    finally:
        hand.stop()
        server.shutdown()
        server.server_close()
        runner.join()
    if hand.failed is not None:
        raise ValueError(str(hand.failed)) from hand.failed
    return 0


def live_hand(name: str, effects_name: str, seed: int) -> LiveHand:
    """Return a hand at the scripted grasp of an object.

    Raises
    ------
    ValueError
        If the catalogue has no such object, or this machine cannot draw.
    """
    calibration, effects, model = load_calibration(), PRESETS[effects_name], make_object(name)

    def add_object(root: object) -> None:
        apply_to_model(effects, root)
        attach_object(root, model)
        apply_to_contacts(effects, root)

    scene = build_scene(calibration, add_object=add_object)
    simulation = HandSimulation(
        model=scene.model,
        calibration=calibration,
        pneumatics=build_pneumatics(effects, calibration),
        losses=build_losses(effects, calibration),
    )
    simulation.reset(np.random.default_rng(seed), np.array(plan_grasp(model).wrist_pose))
    place_object(simulation, model.rest_height_m, (0.0, 0.0, 0.0))
    try:
        Camera(scene.model).close()
    except RenderUnavailableError as error:
        raise ValueError(str(error)) from error
    return LiveHand(simulation, AngleTable.of(calibration))


if __name__ == "__main__":
    raise SystemExit(main())
