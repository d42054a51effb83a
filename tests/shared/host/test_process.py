"""The command line that services share: what it says, what it refuses."""

import random
import signal
import socket
import subprocess
import sys
import threading

import pytest

from hydrohil.services.controller.service import main as controller
from hydrohil.services.recorder.service import main as recorder
from hydrohil.services.router.service import main as router
from hydrohil.shared.host.process import await_router, options_of, parser
from hydrohil.shared.transport.endpoints import Network


def options(*arguments):
    line = parser("plant", None)
    return options_of(line, line.parse_args(arguments))


def test_options_say_where_the_others_are():
    assert options().network == Network()
    assert options("--hosts", "plant=10.0.0.5").network == Network((("plant", "10.0.0.5"),))
    assert options("--router", "tcp/10.0.0.9:7447").network == Network(router="tcp/10.0.0.9:7447")


@pytest.mark.parametrize(
    ("service", "arguments", "words"),
    [
        (controller, ("--hosts", "plan=10.0.0.5"), "--hosts has 'plan=10.0.0.5'"),
        (recorder, ("--router", "10.0.0.9"), "--router is '10.0.0.9'"),
        (recorder, ("--router", "tcp/10.0.0.9:7447", "--hosts", "plant=10.0.0.5"), "exclude"),
        (router, ("--listen", "7447"), "--listen is '7447'"),
        (controller, ("--port", "many"), "--port"),
        (controller, ("--colour",), "--colour"),
    ],
)
def test_what_a_service_cannot_use_is_refused_in_one_line_with_2(service, arguments, words, capsys):
    with pytest.raises(SystemExit) as ended:
        service(list(arguments))
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert words in line


@pytest.mark.live
def test_a_router_ends_with_5_where_its_port_is_taken():
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        line = [sys.executable, "-m", "hydrohil.services.router", "--listen", f"tcp/127.0.0.1:{port}"]
        ended = subprocess.run(line, capture_output=True, text=True, check=False, timeout=60)
    assert ended.returncode == 5
    (line,) = ended.stderr.strip().splitlines()
    assert f"port {port} on 127.0.0.1 is in use" in line and "--listen" in line


@pytest.mark.live
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_router_says_where_it_listens_and_ends_with_0_on_a_signal(number):
    line = [sys.executable, "-m", "hydrohil.services.router", "--listen", f"tcp/127.0.0.1:{random.randrange(20_000, 30_000)}"]
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert f"router: listens on {line[-1]}, " in process.stdout.readline()
        process.send_signal(number)
        assert process.wait(20.0) == 0
        assert process.stderr.read() == ""


def test_a_service_waits_for_its_router_and_for_none_that_it_does_not_need(capsys):
    assert await_router("plant", Network())
    with socket.socket() as late:
        late.bind(("127.0.0.1", 0))
        threading.Timer(0.3, late.listen).start()
        assert await_router("plant", Network(router=f"tcp/127.0.0.1:{late.getsockname()[1]}"))
    assert capsys.readouterr().out.count("waits for the router") == 1


def test_ctrl_c_ends_the_waiting(monkeypatch):
    def interrupted(_seconds):
        raise KeyboardInterrupt

    monkeypatch.setattr("hydrohil.shared.host.process.time.sleep", interrupted)
    assert not await_router("plant", Network(router="tcp/127.0.0.1:1"))
