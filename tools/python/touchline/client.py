"""The connection of a program to a running Touchline."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import TracebackType
from typing import Optional

from .command import Command, command_message
from .connection import CommandSink, open_lines, parse_address, wait_for_line
from .errors import ClosedError, TouchlineError
from .frame import Frame, parse_frame

FRAMES = "udp://127.0.0.1:9870"  # the usual addresses of docs/network.md
COMMANDS = "udp://127.0.0.1:20012"


class Client:
    """Receives frames from `touchline run --publish json=FRAMES`, and sends commands to its `--accept json=COMMANDS`.

        with touchline.Client() as client:
            for frame in client:
                client.send({0: touchline.Velocity(v=0.2, w=1.0)})

    If this program is slower than the camera, it gets the newest frame, and `skipped` counts those that were left out; with
    `every_frame` it gets each one. With `commands=None` it only listens. `timeout` in seconds is that of connecting and of waiting for a
    frame. Iteration ends when Touchline closes a unix socket; by UDP, FrameTimeoutError ends it.
    """

    def __init__(self, frames: str = FRAMES, commands: Optional[str] = COMMANDS, *, timeout: float = 5.0,
                 every_frame: bool = False) -> None:
        self.skipped = 0
        self.timeout = timeout
        self._every_frame = every_frame
        self._closed = False
        targets = parse_address(commands) if commands is not None else None
        self._lines = open_lines(parse_address(frames), timeout)
        try:
            self._commands = CommandSink(targets, timeout) if targets is not None else None
        except BaseException:
            self._lines.close()
            raise

    def next_frame(self, timeout: Optional[float] = None) -> Frame:
        """Waits for a frame. Raises FrameTimeoutError, ClosedError, or MalformedFrameError."""
        self.wait(timeout)
        waiting = self._lines.waiting
        if not self._every_frame:
            self.skipped += len(waiting) - 1
            while len(waiting) > 1:
                waiting.popleft()
        return parse_frame(waiting.popleft())

    def wait(self, timeout: Optional[float] = None) -> None:
        """Waits until next_frame() has a frame at once. Raises FrameTimeoutError, or ClosedError."""
        self._check_open()
        if self._every_frame and self._lines.waiting:
            return  # the rest waits in the socket: Touchline leaves out lines if it is full, and this program's memory is bounded
        wait_for_line(self._lines, self.timeout if timeout is None else timeout)

    def __iter__(self) -> Iterator[Frame]:
        while True:
            try:
                frame = self.next_frame()
            except ClosedError:
                return
            yield frame

    def send(self, commands: Mapping[int, Command]) -> None:
        """Sends commands by robot id; an empty mapping sends nothing.

        Without a new command, a robot stops after `control.external.max_age_s` (0.2 s). Raises RefusedCommandError for what Touchline
        would refuse, NoProgramError, or ClosedError.
        """
        self._check_open()
        if self._commands is None:
            raise TouchlineError("this client has no address for commands")
        if commands:
            self._commands.send(command_message(commands))

    def close(self) -> None:
        """Closes the connection; robots that followed commands stop."""
        self._closed = True
        self._lines.close()
        if self._commands is not None:
            self._commands.close()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()

    def _check_open(self) -> None:
        if self._closed:
            raise ClosedError("this client is closed")
