"""A viewer's server on a free port, for tests."""

import contextlib
import threading
import time

from scripts._view_server import ViewServer
from scripts.view import live_hand


@contextlib.contextmanager
def live_view():
    """Run a hand over an apple and its server; yield both."""
    hand = live_hand("apple", "bench", seed=0)
    server = ViewServer(hand, "127.0.0.1", 0, allow_remote=False)
    threads = [threading.Thread(target=job) for job in (hand.run, server.serve_forever)]
    for thread in threads:
        thread.start()
    try:
        wait_until(lambda: hand.failed or hand.state())
        yield hand, server.server_address[1]
    finally:
        hand.stop()
        server.shutdown()
        server.server_close()
        for thread in threads:
            thread.join()
    assert hand.failed is None


def wait_until(true, seconds=120.0):
    """Ask until it is so: the hand goes on in its own time."""
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "it did not come to pass"
        time.sleep(0.05)
