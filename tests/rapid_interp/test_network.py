"""Sockets over the loopback of this machine, and the refusal without a network or of other hosts."""

from __future__ import annotations

import socket

import pytest

from rapid_interp import HostNetwork, RapidError, load_text
from tests.rapid_interp.world import World

HOST = "127.0.0.1"
PROGRAM = """MODULE talk
  VAR socketdev server; VAR socketdev client; VAR socketdev peer; VAR socketdev one; VAR socketdev other;
  VAR string text; VAR string address; VAR num port; VAR num count; VAR rawbytes raw; VAR byte bytes{{4}} := [82, 65, 80, 73];
  PROC main()
    SocketCreate server;
    SocketBind server, "{host}", {tcp};
    SocketListen server;
    SocketCreate client;
    TPWrite ""\\Bool:=SocketGetStatus(server) = SOCKET_LISTENING AND SocketGetStatus(client) = SOCKET_CREATED;
    SocketConnect client, "{host}", {tcp} \\Time:=5;
    SocketAccept server, peer \\ClientAddress:=address \\Time:=5;
    TPWrite address;
    SocketSend client \\Str:="hello";
    SocketReceive peer \\Str:=text \\ReadNoOfBytes:=5 \\NoRecBytes:=count \\Time:=5;
    TPWrite text \\Num:=count;
    PackRawBytes 513, raw, 1 \\IntX:=UINT;
    SocketSend peer \\RawData:=raw;
    TPWrite "waiting"\\Num:=SocketPeek(client \\Time:=5);
    ClearRawBytes raw;
    SocketReceive client \\RawData:=raw \\Time:=5;
    TPWrite ""\\Num:=RawBytesLen(raw);
    SocketSend peer \\Data:=bytes \\NoOfBytes:=2;
    bytes := [0, 0, 7, 8];
    SocketReceive client \\Data:=bytes \\ReadNoOfBytes:=2 \\Time:=5;
    TPWrite ValToStr(bytes);
    SocketReceive client \\Str:=text \\Time:=0.01;
    SocketClose client;
    SocketReceive peer \\Str:=text \\Time:=5;
    SocketClose peer;
    SocketClose server;
    SocketCreate one \\UDP;
    SocketCreate other \\UDP;
    SocketBind one, "{host}", {udp};
    SocketSendTo other, "{host}", {udp} \\Str:="datagram";
    SocketReceiveFrom one \\Str:=text \\NoRecBytes:=count, address, port \\Time:=5;
    TPWrite text + address \\Num:=count;
    SocketClose one;
    SocketClose other;
    TPWrite ""\\Bool:=SocketGetStatus(one) = SOCKET_CLOSED;
    SocketCreate one;
    SocketConnect one, "203.0.113.1", 1025;
  ERROR
    TEST ERRNO
    CASE ERR_SOCK_TIMEOUT: TPWrite "in vain";
    CASE ERR_SOCK_CLOSED: TPWrite "closed";
    CASE ERR_SOCK_ADDR_INVALID: TPWrite "not this host";
    ENDTEST
    TRYNEXT;
  ENDPROC
ENDMODULE"""
LINES = ["TRUE", HOST, "hello5", "waiting2", "2", "[82,65,7,8]", "in vain", "closed", f"datagram{HOST}8", "TRUE", "not this host"]


def free_ports() -> tuple[int, int]:
    with socket.socket() as tcp, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        tcp.bind((HOST, 0))
        udp.bind((HOST, 0))
        return tcp.getsockname()[1], udp.getsockname()[1]


def talk() -> list[str]:
    """Gives what a program writes that talks with itself."""
    tcp, udp = free_ports()
    network = HostNetwork([HOST])
    try:
        return World().run(load_text(PROGRAM.format(host=HOST, tcp=tcp, udp=udp)).start(network=network))
    finally:
        network.close_all()


def test_a_program_talks_over_the_network_that_the_caller_gives():
    assert talk() == LINES


def test_without_a_network_the_error_says_how_to_allow_it():
    with pytest.raises(RapidError, match=r"start\(\.\.\., network="):
        list(load_text(PROGRAM.format(host=HOST, tcp=1025, udp=1026)).start().run())
