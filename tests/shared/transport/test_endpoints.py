"""Who listens where and connects to whom, for every service, without and with a router."""

import json

import pytest

from hydrohil.shared.transport.endpoints import (
    HERE,
    LISTENERS,
    ROUTER,
    Network,
    address,
    configuration,
    listener,
    network,
    router_configuration,
)

PORT = 7550
SPREAD = Network((("plant", "10.0.0.5"), ("controller", "robot-pc")))
ROUTED = Network(router="tcp/10.0.0.9:7447")
SESSIONS = (*LISTENERS, "operator")


def said(service, where):
    return json.loads(configuration(service, PORT, where))


def listens(service, where):
    return said(service, where)["listen"]["endpoints"]


def connects(service, where):
    return said(service, where)["connect"]["endpoints"]


def test_on_one_host_each_service_listens_on_its_own_port_and_connects_to_those_before_it():
    for rank, service in enumerate(LISTENERS):
        assert listens(service, HERE) == [f"tcp/127.0.0.1:{PORT + rank}"]
        assert connects(service, HERE) == [f"tcp/127.0.0.1:{PORT + i}" for i in range(rank)]
        assert said(service, HERE)["mode"] == "peer"


def test_every_pair_of_sessions_has_exactly_one_link_whoever_is_where():
    for where in (HERE, SPREAD):
        at = {service: listens(service, where) for service in LISTENERS}
        for first in SESSIONS:
            for second in SESSIONS[: SESSIONS.index(first)]:
                links = sum(end in connects(first, where) for end in at.get(second, ()))
                links += sum(end in connects(second, where) for end in at.get(first, ()))
                assert links == 1, (first, second)


def test_a_service_listens_on_its_own_host_and_is_sought_there():
    assert listens("plant", SPREAD) == ["tcp/10.0.0.5:7550"]
    assert listens("controller", SPREAD) == ["tcp/robot-pc:7551"]
    assert listens("supervisor", SPREAD) == ["tcp/127.0.0.1:7552"]
    assert connects("supervisor", SPREAD) == ["tcp/10.0.0.5:7550", "tcp/robot-pc:7551"]


def test_the_operator_only_connects():
    assert listens("operator", SPREAD) == []
    assert connects("operator", SPREAD) == [listens(service, SPREAD)[0] for service in LISTENERS]
    assert listener("operator", PORT, SPREAD) is None


def test_peers_try_for_ever_and_do_not_wait_in_opening():
    for service in SESSIONS:
        connect = said(service, HERE)["connect"]
        assert connect["timeout_ms"] == -1 and connect["exit_on_failure"] is False
        assert said(service, HERE)["scouting"]["delay"] == 0


@pytest.mark.parametrize("service", SESSIONS)
def test_with_a_router_every_session_is_a_client_of_it_alone_and_listens_nowhere(service):
    session = said(service, ROUTED)
    assert session["mode"] == "client"
    assert session["connect"]["endpoints"] == [ROUTED.router]
    assert session["listen"]["endpoints"] == []
    assert session["connect"]["exit_on_failure"] is True and session["connect"]["timeout_ms"] > 0  # else it blocks for ever
    assert listener(service, PORT, ROUTED) is None


def test_a_router_listens_at_its_endpoint_and_connects_to_none():
    session = json.loads(router_configuration("tcp/0.0.0.0:7447"))
    assert session["mode"] == "router"
    assert session["listen"]["endpoints"] == ["tcp/0.0.0.0:7447"]
    assert session["connect"]["endpoints"] == []


def test_no_session_scouts_gossips_or_shares_memory_and_all_queue_and_lease_alike():
    sessions = [said(service, where) for service in SESSIONS for where in (HERE, SPREAD, ROUTED)]
    sessions.append(json.loads(router_configuration(ROUTER)))
    for one in sessions:
        assert one["scouting"] == {"delay": 0, "multicast": {"enabled": False}, "gossip": {"enabled": False}}
        assert one["transport"] == sessions[0]["transport"]
        assert one["transport"]["shared_memory"] == {"enabled": False}
    tx = sessions[0]["transport"]["link"]["tx"]
    assert tx["lease"] == 500 and set(tx["queue"]["size"].values()) == {16} and len(tx["queue"]["size"]) == 8


@pytest.mark.parametrize("where", [HERE, SPREAD, ROUTED])
def test_the_words_of_a_network_say_the_same_again(where):
    given = dict(zip(where.words[::2], where.words[1::2], strict=True))
    assert network(given.get("--hosts", ""), given.get("--router", "")) == where


def test_hosts_are_read_with_blanks_after_commas():
    assert network("plant=10.0.0.5, controller=robot-pc") == SPREAD
    assert network() == HERE


@pytest.mark.parametrize(
    ("hosts", "words"),
    [
        ("plant", "'plant'"),
        ("plant=", "IPv4"),
        ("10.0.0.5", "SERVICE=ADDRESS"),
        ("plan=10.0.0.5", "plant, controller, supervisor, recorder"),
        ("operator=10.0.0.5", "one of"),
        ("plant=10.0.0.5,plant=10.0.0.6", "twice"),
        ("plant=10.0.0.5,", "''"),
        ("plant=10.0.0.256", "IPv4"),
        ("plant=10.0.0", "IPv4"),
        ("plant=0.0.0.0", "IPv4"),
        ("plant=10.0.0.5:7550", "IPv4"),
        ("plant=::1", "IPv4"),
        ("plant=-robot", "name"),
        ("plant=robot..pc", "name"),
    ],
)
def test_hosts_that_say_nothing_are_refused_with_one_line(hosts, words):
    with pytest.raises(ValueError, match="--hosts") as refused:
        network(hosts)
    assert words in str(refused.value) and "\n" not in str(refused.value)


@pytest.mark.parametrize("port", ["1", "65535"])
def test_the_ports_on_the_limits_are_ports(port):
    assert address(f"tcp/10.0.0.9:{port}", "--router") == ("10.0.0.9", int(port))


@pytest.mark.parametrize(
    "router",
    [
        "10.0.0.9:7447",
        "tcp/10.0.0.9",
        "tcp/10.0.0.9:",
        "tcp/10.0.0.9:0",
        "tcp/10.0.0.9:65536",
        "tcp/:7447",
        "udp/10.0.0.9:7447",
        "tcp/10.0.0.9:7447?prio=1",
        "tcp/10.0.0.9:7447 ",
        "tcp/0.0.0.0:7447",
        "tcp/10.0.0.999:7447",
    ],
)
def test_a_router_that_is_no_endpoint_is_refused_with_one_line(router):
    with pytest.raises(ValueError, match="--router") as refused:
        network(router=router)
    assert repr(router) in str(refused.value) and "\n" not in str(refused.value)


def test_a_router_may_listen_on_every_address_but_no_client_connects_to_that():
    assert address("tcp/0.0.0.0:7447", "--listen") == ("0.0.0.0", 7447)
    with pytest.raises(ValueError, match="reached"):
        network(router="tcp/0.0.0.0:7447")


def test_hosts_and_router_exclude_each_other():
    with pytest.raises(ValueError, match="exclude"):
        network("plant=10.0.0.5", ROUTER)
