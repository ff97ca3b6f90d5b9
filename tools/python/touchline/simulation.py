"""A game whose time passes only in steps: `touchline-simulate serve` as a child process, or one that somebody else started."""
from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import tempfile
import time
import weakref
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Optional

from .arena import SHOWN_LINES, FilePath, _stop, find_board, find_program
from .command import Command, command_list
from .connection import connect_unix
from .errors import ArenaError, ClosedError, FrameTimeoutError, NoProgramError, RefusedMessageError
from .frame import Frame, frame_of

SIMULATE_IN_CLONE = Path("build/release/tools/programs/simulate/touchline-simulate")
RETRY_S = 0.02
SHOWN_BYTES = 1 << 20

Places = Mapping[str, Any]


def _setting(value: object) -> object:
    return value if isinstance(value, (bool, int, float)) else str(value)


def _start(arguments: Sequence[str], output: IO[bytes]) -> subprocess.Popen[bytes]:
    # In a session of its own, Ctrl-C reaches this program only, which then ends the game.
    return subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT, start_new_session=True)


def _connect(address: str, timeout: float) -> socket.socket:
    """Connects when the program listens, at the latest after `timeout` seconds."""
    if address.startswith("unix://"):
        return connect_unix(address[len("unix://"):], timeout)
    found = re.fullmatch(r"tcp://([0-9.]+|localhost):([0-9]{1,5})", address)
    if found is None:
        raise ValueError(f"{address!r} is not an address: write unix:///PATH or tcp://ADDRESS:PORT")
    end = time.monotonic() + timeout
    while True:
        try:
            connection = socket.create_connection((found[1], int(found[2])), timeout)
        except OSError as error:
            if time.monotonic() >= end:
                raise NoProgramError(f"{address}: no touchline-simulate answers: {error.strerror or error}") from None
            time.sleep(RETRY_S)
            continue
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return connection


class _Messages:
    """Questions and answers, one line each."""

    def __init__(self, connection: socket.socket, timeout: float) -> None:
        self._socket = connection
        self._timeout = timeout
        connection.settimeout(timeout)
        self._lines = connection.makefile("rb")

    def ask(self, name: str, members: Mapping[str, object]) -> dict[str, Any]:
        try:
            self._socket.sendall(json.dumps({name: members}).encode() + b"\n")
        except OSError:
            pass  # its last words can still be read
        try:
            line = self._lines.readline()
        except TimeoutError:
            raise FrameTimeoutError(f"touchline-simulate gave no answer in {self._timeout:g} s") from None
        except (OSError, ValueError):
            line = b""
        if not line.endswith(b"\n"):
            raise ClosedError("touchline-simulate has ended, or this game is closed")
        answer = json.loads(line)
        if not isinstance(answer, dict):
            raise ClosedError("the answer is not that of touchline-simulate")
        if "error" in answer:
            text = str(answer["error"])
            raise ClosedError(text) if answer.get("ended") else RefusedMessageError(text)
        return answer

    def close(self) -> None:
        self._lines.close()
        self._socket.close()


class Simulation:
    """A game without pictures that waits for this program. The same seed and commands give the same game bit for bit.

        with touchline.Simulation() as game:
            frame = game.reset(seed=1, opponent="univector")
            while frame.score["own"] == 0:
                frame = game.step({0: touchline.Place(frame.ball.x, frame.ball.y)} if frame.ball else {})

    `address`: that of `touchline-simulate serve --listen`; else the program is started. `silence`: the game ends with an error if this
    program says nothing for so long, in seconds; 0: never. `settings` are keys of the three files for all games. `timeout`: for the
    start and for each answer. `opponent_frame` is the opponents' newest frame, if this program drives them.
    """

    def __init__(self, program: Optional[FilePath] = None, *, board: Optional[FilePath] = None, address: Optional[str] = None,
                 settings: Optional[Mapping[str, object]] = None, silence: float = 5.0, timeout: float = 20.0) -> None:
        self.opponent_frame: Optional[Frame] = None
        self.description: Mapping[str, Any] = {}
        self._process: Optional[subprocess.Popen[bytes]] = None
        self._output: Optional[IO[bytes]] = None
        if address is not None:
            self._messages = _Messages(_connect(address, timeout), timeout)
            return
        found = find_program(program, name="touchline-simulate", in_clone=SIMULATE_IN_CLONE)
        self._output = tempfile.TemporaryFile()  # kept until close()
        # The folder is not needed once both are connected, so that nothing is left if this program is killed.
        with tempfile.TemporaryDirectory(prefix="touchline-simulation-") as folder:
            arguments = [str(found), "serve", "--board", str(board or find_board(found)), "--listen", f"unix://{folder}/game",
                         "--silence", str(silence)]
            for key, value in (settings or {}).items():
                arguments += ["--set", f"{key}={str(value).lower() if isinstance(value, bool) else value}"]
            self._process = _start(arguments, self._output)
            self._finalizer = weakref.finalize(self, _stop, self._process)
            try:
                self._messages = _Messages(self._connect_child(f"unix://{folder}/game", timeout), timeout)
            except BaseException:
                self._finalizer()
                self._output.close()
                raise

    def _connect_child(self, address: str, timeout: float) -> socket.socket:
        assert self._process is not None
        end = time.monotonic() + timeout
        while True:
            try:
                return _connect(address, RETRY_S)
            except NoProgramError as error:
                if self._process.poll() is not None:
                    raise self._failed(f"touchline-simulate ended with {self._process.returncode}") from None
                if time.monotonic() >= end:
                    raise self._failed(f"touchline-simulate did not start in time: {error}") from None

    def reset(self, seed: int = 1, *, own: str = "external", opponent: str = "stand", robots: Optional[int] = None,
              robots_return: bool = True, settings: Optional[Mapping[str, object]] = None, place: Optional[Places] = None,
              faults: Sequence[Mapping[str, object]] = ()) -> Frame:
        """Begins a new game and returns its first frame.

        `own` and `opponent`: "external" (this program), the name of a strategy, a team file, or for the opponents "program" (another
        one). `robots` of each side; None: all. `robots_return`: robots return to their places at each kick-off, and stand for a second
        after it. `place`: {"ball": {"x": 0, "y": 0}, "robots": {"blue": {0: {"x": 0, "y": 0, "theta": 0}}}}.
        """
        self.begin(seed, own=own, opponent=opponent, robots=robots, robots_return=robots_return, settings=settings, place=place,
                   faults=faults)
        return self.step()

    def begin(self, seed: int = 1, **members: Any) -> Mapping[str, Any]:
        """Begins a new game as reset() does, without its first frame. Returns teams and robots, which are `description`, too."""
        message = {name: value for name, value in members.items() if value is not None and value != ()}
        if "settings" in message:
            message["settings"] = {key: _setting(value) for key, value in message["settings"].items()}
        answer = self._ask("reset", {"seed": seed, **message})
        self.opponent_frame = None
        self.description = answer["reset"]
        return self.description

    def join(self) -> Mapping[str, Any]:
        """For the opponents' program: waits for a game. Returns teams and robots, which are `description`, too."""
        answer = self._ask("step", {})
        self.description = answer["reset"]
        return self.description

    def step(self, commands: Optional[Mapping[int, Command]] = None, opponent_commands: Optional[Mapping[int, Command]] = None, *,
             frames: int = 1, truth: bool = False, sightings: bool = False) -> Frame:
        """Lets `frames` frames pass and returns the last one. A command ends 0.2 s after it was sent, as on a real field."""
        return self._step(commands, opponent_commands, frames, truth, sightings, True)[-1]

    def step_frames(self, commands: Optional[Mapping[int, Command]] = None, opponent_commands: Optional[Mapping[int, Command]] = None, *,
                    frames: int = 1, truth: bool = False, sightings: bool = False) -> list[Frame]:
        """As step(), but returns all frames."""
        return self._step(commands, opponent_commands, frames, truth, sightings, False)

    def _step(self, commands: Optional[Mapping[int, Command]], opponent_commands: Optional[Mapping[int, Command]], frames: int,
              truth: bool, sightings: bool, only_last: bool) -> list[Frame]:
        members: dict[str, object] = {"frames": frames}
        if commands:
            members["commands"] = command_list(commands)
        if opponent_commands:
            members["opponent_commands"] = command_list(opponent_commands)
        for name, value in (("truth", truth), ("sightings", sightings), ("only_last", only_last)):
            if value:
                members[name] = True
        answer = self._ask("step", members)
        if "reset" in answer:
            self.description = answer["reset"]
            raise RefusedMessageError("a new game has begun; this step had no effect")
        for frame in answer.get("opponent_frames") or ():
            self.opponent_frame = frame_of(frame)
        return [frame_of(frame) for frame in answer["frames"]]

    def place(self, places: Places) -> None:
        """Puts robots and ball elsewhere, as `place` of reset(). Raises RefusedMessageError if something is in the way."""
        self._ask("place", places)

    def throw(self, vx: float, vy: float, x: Optional[float] = None, y: Optional[float] = None) -> None:
        """Gives the ball a velocity in m/s, where it is or at a place. Raises ValueError for one coordinate without the other."""
        if (x is None) != (y is None):
            raise ValueError(f"throw: {'y' if y is None else 'x'} is missing; give both coordinates of the place, or none")
        self._ask("throw", {"vx": vx, "vy": vy, **({} if x is None else {"x": x, "y": y})})

    def fault(self, kind: str, duration: float = 1.0, *, id: int | None = None, team: str | None = None) -> None:
        """Injects a fault of our camera or radio, beginning now: camera_stall, camera_lost, radio_lost, radio_busy, or hide_robot, which
        needs the id of the robot that our camera does not see, and team="opponent" if it is not ours."""
        robot = {key: value for key, value in (("id", id), ("team", team)) if value is not None}
        self._ask("fault", {"kind": kind, "for_s": duration, **robot})

    def hash(self) -> str:
        """The hash of the game's complete state."""
        return str(self._ask("hash", {})["hash"])

    def output(self) -> str:
        """All that the started program has printed so far."""
        if self._output is None or self._output.closed:
            return ""
        # The child writes at the file's position, which must not change.
        return os.pread(self._output.fileno(), SHOWN_BYTES, 0).decode(errors="replace")

    def close(self) -> None:
        """Ends the game."""
        self._messages.close()
        if self._process is not None:
            self._finalizer()
        if self._output is not None:
            self._output.close()

    def _ask(self, name: str, members: Mapping[str, object]) -> dict[str, Any]:
        return self._messages.ask(name, members)

    def _failed(self, what: str) -> ArenaError:
        lines = self.output().splitlines()[-SHOWN_LINES:]
        return ArenaError("\n  ".join([what + "; its last lines:", *lines]) if lines else what + "; it printed nothing")

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()
