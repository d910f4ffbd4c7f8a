"""A loopback web server around one running hand: its picture, its state, three set angles."""

import io
import ipaddress
import json
import threading
import time
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import numpy as np
from PIL import Image

from scripts._view_page import PAGE, SCRIPT
from softhand_sim.control.table import AngleTable
from softhand_sim.render import Camera
from softhand_sim.simulation import HandSimulation

PICTURE_S = 0.1
"""Choice: ten pictures a second of simulated time; a software renderer draws no more on two cores."""
MOST_BYTES = 1000
"""Choice: a request to set angles takes less than a hundred bytes."""
_POLICY = "default-src 'none'; img-src 'self'; script-src 'self'; connect-src 'self'; style-src 'unsafe-inline'"


class LiveHand:
    """A hand that goes on by itself, in one thread, which alone touches simulation and GL context."""

    def __init__(self, simulation: HandSimulation, table: AngleTable) -> None:
        self._simulation, self._table = simulation, table
        self._lock = threading.Lock()
        self._angles = [0.0, 0.0, 0.0]
        self._state: dict[str, Any] = {}
        self._png = b""
        self._pictures = 0
        self._stop = threading.Event()
        self.failed: Exception | None = None

    def set_angles(self, angles_deg: Any) -> None:
        """Ask for an angle of each element.

        Raises
        ------
        ValueError
            If they are not three numbers within the controller's table.
        """
        if not isinstance(angles_deg, list) or not all(type(a) in (int, float) for a in angles_deg):
            raise ValueError(f"set_angle_deg = {angles_deg!r}: must be a list of three numbers")
        self._table.pressures(angles_deg)
        with self._lock:
            self._angles = [float(a) for a in angles_deg]

    def state(self) -> dict[str, Any]:
        """Return the latest figures."""
        with self._lock:
            return dict(self._state)

    def picture(self) -> bytes:
        """Return the latest picture, PNG."""
        with self._lock:
            return self._png

    def stop(self) -> None:
        """Let `run` return."""
        self._stop.set()

    def run(self) -> None:
        """Advance in real time, or as fast as the machine can, until `stop`."""
        try:
            with Camera(self._simulation.model) as camera:
                due = time.monotonic()
                while not self._stop.is_set():
                    self._advance(camera)
                    due = max(due + PICTURE_S, time.monotonic())
                    self._stop.wait(max(0.0, due - time.monotonic()))
        except Exception as error:  # told to the main thread
            self.failed = error

    def _advance(self, camera: Camera) -> None:
        simulation = self._simulation
        with self._lock:
            angles = list(self._angles)
        simulation.set_pressure_pa_gauge = np.array(self._table.pressures(angles))
        simulation.advance(round(PICTURE_S / simulation.dt))
        if simulation.diverged:
            raise RuntimeError("the simulation diverged")
        buffer = io.BytesIO()
        # quick rather than small
        Image.fromarray(camera.picture(simulation.data, "front")).save(buffer, format="PNG", compress_level=1)
        state = {
            "time_s": float(simulation.data.time),
            "set_angle_deg": angles,
            "highest_angle_deg": self._table.angle_deg[-1],
            "set_pressure_pa_gauge": simulation.set_pressure_pa_gauge.tolist(),
            "pressure_pa_gauge": simulation.pressure_pa_gauge().tolist(),
            "tip_angle_deg": np.degrees(simulation.tip_angles_rad()).tolist(),
        }
        with self._lock:
            self._pictures += 1
            self._png, self._state = buffer.getvalue(), state | {"pictures": self._pictures}


def check_host(host: str, allow_remote: bool) -> None:
    """Refuse an address that others can reach, unless they may.

    Raises
    ------
    ValueError
        If the address is not a number of this machine's loopback.
    """
    try:
        loopback = ipaddress.ip_address(host).is_loopback
    except ValueError:
        raise ValueError(f"--host {host}: must be an IP address, such as 127.0.0.1") from None
    if not loopback and not allow_remote:
        raise ValueError(f"--host {host}: others could reach it; only loopback without --allow-remote")


class ViewServer(ThreadingHTTPServer):
    """Listens as soon as it is made; answers within ``serve_forever``."""

    daemon_threads = True

    def __init__(self, hand: LiveHand, host: str, port: int, allow_remote: bool) -> None:
        self.hand, self.host, self.allow_remote = hand, host, allow_remote
        super().__init__((host, port), _Handler)


class _Handler(BaseHTTPRequestHandler):
    server: ViewServer

    def do_GET(self) -> None:
        """Answer for the page, its script, the state or the picture."""
        path = self.path.partition("?")[0]
        if not self._trusted():
            return
        if path == "/":
            self._answer(PAGE.encode(), "text/html; charset=utf-8")
        elif path == "/view.js":
            self._answer(SCRIPT.encode(), "text/javascript")
        elif path == "/state":
            self._answer(json.dumps(self.server.hand.state()).encode(), "application/json")
        elif path == "/picture.png":
            self._answer(self.server.hand.picture(), "image/png")
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        """Take set angles."""
        if not self._trusted():
            return
        length = self.headers.get("Content-Length", "")
        # another site's form can not send this type without asking first
        if self.path != "/angles" or self.headers.get("Content-Type") != "application/json":
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        if not length.isdigit() or int(length) > MOST_BYTES:
            self.send_error(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
            return
        try:
            asked = json.loads(self.rfile.read(int(length)))
            self.server.hand.set_angles(asked.get("set_angle_deg") if isinstance(asked, dict) else None)
        except ValueError as error:
            self._answer(json.dumps({"error": str(error)}).encode(), "application/json", HTTPStatus.BAD_REQUEST)
            return
        self._answer(b"{}", "application/json")

    def _trusted(self) -> bool:
        """Refuse names that are not this machine's: a page elsewhere could have its own name lead here."""
        name = self.headers.get("Host", "").rpartition(":")[0].strip("[]")
        if self.server.allow_remote or name in ("localhost", self.server.host):
            return True
        self.send_error(HTTPStatus.FORBIDDEN)
        return False

    def _answer(self, body: bytes, kind: str, status: HTTPStatus = HTTPStatus.OK) -> None:
        self.send_response(status)
        for name, value in (
            ("Content-Type", kind),
            ("Content-Length", str(len(body))),
            ("Cache-Control", "no-store"),
            ("Content-Security-Policy", _POLICY),
            ("X-Content-Type-Options", "nosniff"),
        ):
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing."""
