"""Sockets to Touchline: unix:///PATH or udp://ADDRESS:PORT[%INTERFACE], as in `touchline run --publish json=...`."""
from __future__ import annotations

import contextlib
import ipaddress
import re
import select
import socket
import struct
import time
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Optional, Protocol, Union

from .errors import ClosedError, FrameTimeoutError, NoProgramError

# The publisher's largest message is a datagram, and a datagram is never longer.
MAX_DATAGRAM = 65536
READ_BYTES = 1 << 20
# Reads in one turn. It bounds a turn if the arena runs faster than this program reads.
MAX_READS = 64
RETRY_S = 0.02


@dataclass(frozen=True)
class UnixAddress:
    path: str

    def __str__(self) -> str:
        return f"unix://{self.path}"


@dataclass(frozen=True)
class UdpAddress:
    host: str
    port: int
    interface: Optional[str] = None

    def __str__(self) -> str:
        return f"udp://{self.host}:{self.port}" + (f"%{self.interface}" if self.interface else "")


Address = Union[UnixAddress, UdpAddress]


def parse_address(text: str) -> Address:
    if text.startswith("unix:///"):
        return UnixAddress(text[len("unix://"):])
    found = re.fullmatch(r"udp://([0-9.]+):([0-9]{1,5})(?:%([\w.-]+))?", text)
    if found is not None and 0 < int(found[2]) < 65536:
        with contextlib.suppress(ValueError):
            return UdpAddress(str(ipaddress.IPv4Address(found[1])), int(found[2]), found[3])
    raise ValueError(f"{text!r} is not an address: write unix:///PATH or udp://ADDRESS:PORT, for a group udp://ADDRESS:PORT%INTERFACE")


@contextlib.contextmanager
def _closed_on_error(opened: socket.socket) -> Iterator[None]:
    try:
        yield
    except BaseException:
        opened.close()
        raise


def connect_unix(path: str, timeout: float) -> socket.socket:
    """Connects when the program has created the socket, at the latest after `timeout` seconds."""
    end = time.monotonic() + timeout
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    with _closed_on_error(connection):
        while True:
            try:
                connection.connect(path)
                return connection
            except OSError as error:
                if time.monotonic() >= end:
                    raise NoProgramError(f"unix://{path}: no Touchline answers: {error.strerror or error}") from None
            time.sleep(RETRY_S)


def bind_udp(address: UdpAddress) -> socket.socket:
    """A socket that receives what is sent to this address of this computer, or to this multicast group."""
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with _closed_on_error(receiver):
        is_group = ipaddress.IPv4Address(address.host).is_multicast
        if is_group:
            receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # several programs can listen
        try:
            receiver.bind((address.host, address.port))
            if is_group:
                index = socket.if_nametoindex(address.interface) if address.interface else 0
                request = struct.pack("=4s4si", socket.inet_aton(address.host), b"\0\0\0\0", index)  # struct ip_mreqn
                receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, request)
        except OSError as error:
            raise NoProgramError(f"{address}: cannot listen: {error.strerror or error}") from None
        return receiver


class LineSource(Protocol):
    """Lines from Touchline. Those that have arrived, but were not asked for yet, wait in `waiting`."""

    address: Address
    waiting: deque[bytes]

    def read(self) -> None:
        """Moves all that has arrived to `waiting`; never blocks. Raises ClosedError after the last line."""

    def fileno(self) -> int: ...

    def close(self) -> None: ...


class StreamLines:
    """Lines of a stream. Half a line at its end is dropped: Touchline ended while it was written."""

    def __init__(self, address: UnixAddress, timeout: float) -> None:
        self.address: Address = address
        self.waiting: deque[bytes] = deque()
        self._rest = b""
        self._ended = False
        self._socket = connect_unix(address.path, timeout)
        self._socket.setblocking(False)

    def read(self) -> None:
        parts = [self._rest]
        try:
            for _ in range(MAX_READS):
                part = self._socket.recv(READ_BYTES)
                self._ended = not part
                if self._ended:
                    break
                parts.append(part)
        except BlockingIOError:
            pass
        except OSError:  # reset: the program was killed
            self._ended = True
        *lines, self._rest = b"".join(parts).split(b"\n")
        self.waiting.extend(lines)
        if self._ended and not self.waiting:
            raise ClosedError(f"{self.address}: Touchline has ended or closed the connection")

    def fileno(self) -> int:
        return self._socket.fileno()

    def close(self) -> None:
        self._socket.close()


class DatagramLines:
    """One line in each datagram. UDP does not tell whether there is a sender."""

    def __init__(self, address: UdpAddress) -> None:
        self.address: Address = address
        self.waiting: deque[bytes] = deque()
        self._socket = bind_udp(address)
        self._socket.setblocking(False)

    def read(self) -> None:
        with contextlib.suppress(BlockingIOError):
            for _ in range(MAX_READS):
                self.waiting.append(self._socket.recv(MAX_DATAGRAM))

    def fileno(self) -> int:
        return self._socket.fileno()

    def close(self) -> None:
        self._socket.close()


def open_lines(address: Address, timeout: float) -> LineSource:
    if isinstance(address, UnixAddress):
        return StreamLines(address, timeout)
    return DatagramLines(address)


def wait_for_line(source: LineSource, timeout: float) -> None:
    """Returns when a line waits. Raises FrameTimeoutError, or ClosedError."""
    end = time.monotonic() + timeout
    while True:
        source.read()
        if source.waiting:
            return
        left = end - time.monotonic()
        if left <= 0:
            raise FrameTimeoutError(f"{source.address}: no frame in {timeout:g} s; is Touchline running with --publish json?")
        select.select([source], [], [], left)


class CommandSink:
    """Sends messages to `touchline run --accept json=ADDRESS`."""

    def __init__(self, address: Address, timeout: float) -> None:
        self._address = address
        if isinstance(address, UnixAddress):
            self._socket = connect_unix(address.path, timeout)
            self._end = b"\n"
            self._socket.settimeout(timeout)
            return
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._end = b""
        with _closed_on_error(self._socket):
            self._socket.connect((address.host, address.port))  # so that an address without a program is an error

    def send(self, message: bytes) -> None:
        try:
            self._socket.sendall(message + self._end)
        except ConnectionRefusedError:
            raise NoProgramError(f"{self._address}: no Touchline accepts commands; is it running with --accept json?") from None
        except OSError as error:
            raise ClosedError(f"{self._address}: the command was not sent: {error.strerror or error}") from None

    def close(self) -> None:
        self._socket.close()
