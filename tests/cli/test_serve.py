"""`mitl serve` says where it is, serves, and ends when told to."""

import os
import re
import signal
import subprocess
import sys
import urllib.error
import urllib.request

import pytest

from mitl.cli import run


@pytest.fixture
def serve():
    started = []

    def begin(*options):
        process = subprocess.Popen(
            [sys.executable, "-m", "mitl", "serve", *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        started.append(process)
        return process

    yield begin
    for process in started:
        process.kill()
        process.communicate()


def test_it_prints_its_address_serves_it_and_ends_with_0_on_ctrl_c(serve):
    process = serve("--fast")
    address = process.stdout.readline().strip()
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+", address)
    with pytest.raises(urllib.error.HTTPError, match="401") as refused:
        urllib.request.urlopen(f"{address}/rw/panel/opmode", timeout=10)  # noqa: S310 - our own address
    assert refused.value.headers["WWW-Authenticate"].startswith("Digest")
    refused.value.close()
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=10)
    assert (process.returncode, out) == (0, "")
    assert "warning" not in err


def test_2_0_is_encrypted_and_tells_its_fingerprint_and_other_than_loopback_is_warned_of(serve):
    process = serve("--rws", "2", "--host", "0.0.0.0")  # noqa: S104 - what it warns of
    assert process.stdout.readline().startswith("https://0.0.0.0:")
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=10)
    assert re.search(r"certificate SHA-256 [0-9a-f]{64}", err)
    assert "not loopback" in err
    assert ("published default" in err) == ("MITL_SERVE_PASSWORD" not in os.environ)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--robot", "irb9000"], "irb9000"),
        (["--signal", "diGo=maybe"], "KIND"),
        (["--fault", "gremlins"], "gremlins"),
        (["--host", "192.0.2.1"], "cannot listen"),
    ],
)
def test_bad_options_are_refused_with_a_message(options, said, capsys):
    assert run(["serve", *options]) == 2
    assert said in capsys.readouterr().err


def test_a_program_with_errors_is_refused_with_all_of_them(tmp_path, capsys):
    (tmp_path / "bad.mod").write_text("MODULE Bad\n  PROC main()\n    MoveX;\n  ENDPROC\nENDMODULE\n", encoding="utf-8")
    assert run(["serve", "--program", str(tmp_path / "bad.mod")]) == 2
    assert "bad.mod:3" in capsys.readouterr().err
