"""The browser viewer's server: angles move fingers, others are kept out, refusals by name."""

import http.client
import io
import json

import pytest
from live_view import live_view, wait_until
from PIL import Image

from scripts import view
from scripts._view_server import check_host


@pytest.fixture(scope="module")
def seen():
    """A hand and its port, or the reason of a machine that cannot draw."""
    try:
        with live_view() as (hand, port):
            yield hand, port
    except ValueError as error:
        if "libegl1" not in str(error):
            raise
        yield str(error)


def ask(port, method, path, body=None, **headers):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request(method, path, body, headers)
    answer = connection.getresponse()
    return answer.status, answer.read()


def test_set_angles_move_their_own_fingers_and_the_picture(seen):
    if isinstance(seen, str):
        return
    hand, port = seen
    before = Image.open(io.BytesIO(ask(port, "GET", "/picture.png")[1]))
    body = json.dumps({"set_angle_deg": [0, 90, 0]})
    assert ask(port, "POST", "/angles", body, **{"Content-Type": "application/json"})[0] == 200
    wait_until(lambda: hand.state()["pressure_pa_gauge"][1] > 60e3)
    status, text = ask(port, "GET", "/state")
    assert status == 200
    thumb, index, *others = json.loads(text)["tip_angle_deg"]
    # the apple stops the index on its way
    assert index > 25.0
    assert max(thumb, *others) < 15.0
    after = Image.open(io.BytesIO(ask(port, "GET", "/picture.png")[1]))
    assert before.size == after.size == (640, 480)
    assert before.tobytes() != after.tobytes()


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('{"set_angle_deg": [200, 0, 0]}', "set angle of thumb: angle_deg = 200"),
        ('{"set_angle_deg": [1, 2]}', "set_angle_deg has 2 values"),
        ('{"set_angle_deg": [NaN, 0, 0]}', "nan"),
        ('{"set_angle_deg": [true, 0, 0]}', "must be a list of three numbers"),
        ("[]", "must be a list of three numbers"),
        ("{", "Expecting"),
    ],
)
def test_bad_angles_are_named(seen, body, message):
    if isinstance(seen, str):
        return
    status, text = ask(seen[1], "POST", "/angles", body, **{"Content-Type": "application/json"})
    assert status == 400
    assert message in json.loads(text)["error"]


@pytest.mark.parametrize(
    ("request_", "status"),
    [
        (("GET", "/etc/passwd", None, {}), 404),
        (("GET", "/state", None, {"Host": "elsewhere.example:80"}), 403),
        (("POST", "/angles", '{"set_angle_deg": [1, 1, 1]}', {"Content-Type": "text/plain"}), 404),
        (("POST", "/angles", " " * 2000, {"Content-Type": "application/json"}), 413),
    ],
)
def test_other_sites_and_large_requests_are_turned_away(seen, request_, status):
    if isinstance(seen, str):
        return
    method, path, body, headers = request_
    assert ask(seen[1], method, path, body, **headers)[0] == status


def test_only_loopback_unless_asked(capsys):
    for host in ("0.0.0.0", "192.168.1.2", "::"):
        assert view.main(["--web", "--host", host]) == 2
        assert "loopback" in capsys.readouterr().err
    assert view.main(["--web", "--host", "example.org"]) == 2
    check_host("127.0.0.1", False)
    check_host("::1", False)
    check_host("0.0.0.0", True)


def test_bad_input_is_one_line(capsys):
    assert view.main([]) == 2
    assert "--web" in capsys.readouterr().err
    assert view.main(["--web", "--object", "human_being"]) == 2
    assert "human_being" in capsys.readouterr().err
