"""The server gives the files of its folder and nothing else."""

import http.client
import socket
import threading

import pytest

from springline.errors import InputError, OutputError
from springline.outputs.viewer.serve import make_server


@pytest.fixture
def folder(tmp_path):
    inside = tmp_path / "run"
    (inside / "images").mkdir(parents=True)
    (inside / "viewer.html").write_text("<p>viewer</p>")
    (inside / "images" / "a b.png").write_bytes(b"\x89PNG")
    (tmp_path / "secret.txt").write_text("secret")
    (tmp_path / "run-too").mkdir()
    (tmp_path / "run-too" / "secret.txt").write_text("secret")
    (inside / "link.txt").symlink_to(tmp_path / "secret.txt")
    (inside / "up").symlink_to(tmp_path)
    return inside


@pytest.fixture
def server(folder):
    server = make_server(folder, made={"made.html": b"made"})
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield server
    server.shutdown()
    server.server_close()
    thread.join()


def ask(server, path, method="GET", host=None):
    """Send the path as it stands: clients of the standard library would tidy it."""
    connection = http.client.HTTPConnection(*server.server_address, timeout=10)
    connection.putrequest(method, path, skip_host=True)
    connection.putheader("Host", host or f"127.0.0.1:{server.server_address[1]}")
    connection.endheaders()
    answer = connection.getresponse()
    found = answer.status, answer.read(), dict(answer.headers)
    connection.close()
    return found


def test_gives_its_files(server):
    assert ask(server, "/viewer.html")[:2] == (200, b"<p>viewer</p>")
    assert ask(server, "/images/a%20b.png?x=1#y")[:2] == (200, b"\x89PNG")
    assert ask(server, "/made.html")[:2] == (200, b"made")
    status, body, headers = ask(server, "/")
    assert status == 302 and headers["Location"] == "/viewer.html"
    status, body, headers = ask(server, "/viewer.html", "HEAD")
    assert (status, body, headers["Content-Length"]) == (200, b"", "13")
    assert headers["X-Content-Type-Options"] == "nosniff"


@pytest.mark.parametrize(
    "path",
    [
        *("/../secret.txt", "/..%2fsecret.txt", "/%2e%2e/secret.txt", "/images/../../secret.txt", "/..\\secret.txt"),
        *(
            "/link.txt",
            "/up/secret.txt",
            "/../run-too/secret.txt",
            "//etc/passwd",
            "/%2Fetc/passwd",
            "/viewer.html%00.png",
        ),
        *("/images", "/images/", "/missing.txt", "/" + "a" * 5000),
    ],
)
def test_never_leaves_its_folder_and_lists_none(server, path):
    status, body, _ = ask(server, path)
    assert status == 404 and b"secret" not in body and b"root:" not in body


def test_other_methods_and_other_names_are_refused(server):
    assert ask(server, "/viewer.html", "POST")[0] == 501
    assert ask(server, "/viewer.html", "PUT")[0] == 501
    assert ask(server, "/viewer.html", host="evil.example:80")[0] == 403
    assert ask(server, "/viewer.html", host="localhost")[0] == 200


def test_listens_on_the_loopback_address_alone(server):
    assert server.server_address[0] == "127.0.0.1"


def test_what_is_no_inspection_and_a_taken_port_are_refused(tmp_path, server, folder):
    with pytest.raises(InputError, match=r"viewer\.html"):
        make_server(tmp_path)
    with pytest.raises(OutputError, match="another port"), socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        make_server(folder, port=taken.getsockname()[1])
