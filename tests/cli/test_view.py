"""`springline view` in a process of its own."""

import re
import signal
import subprocess
import sys
import urllib.request

import pytest
from tests.unit.outputs.finished import finished_survey

from springline.outputs.write import write_outputs


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("view") / "run"
    write_outputs(finished_survey(stations=60, bearings=36), folder, config_toml="")
    return folder


def view(*words):
    return subprocess.Popen(
        [sys.executable, "-m", "springline", "view", *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # Where tests run in the background, an interrupt is ignored and handed on so.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


@pytest.mark.parametrize("options", [(), ("--full",)])
def test_serves_the_viewer_until_it_is_stopped(folder, options):
    process = view(folder, "--no-open", *options)
    address = process.stdout.readline().strip()
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/viewer\.html", address)
    with urllib.request.urlopen(address, timeout=20) as answer:
        page = answer.read().decode()
    assert "MH 12 to MH 13" in page and "three.js authors" in page
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert process.returncode == 0 and errors == "stopped\n"


def test_a_folder_that_is_none_of_an_inspection_is_refused(tmp_path):
    process = view(tmp_path, "--no-open")
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 2 and "viewer.html" in errors and "Traceback" not in errors
