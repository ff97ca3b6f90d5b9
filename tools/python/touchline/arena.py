"""The arena as a child process: `touchline run` on the mock board, with a client connected to it."""
from __future__ import annotations

import re
import shutil
import signal
import subprocess
import tempfile
import time
import weakref
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Optional, TypeVar, Union

from .client import Client
from .errors import ArenaError, TouchlineError

PROGRAM_IN_CLONE = Path("build/release/firmware/touchline")
BOARD = Path("boards/mock/board.toml")
SHOWN_LINES = 15
# The program ends within a second of SIGINT; the rest is for a loaded machine.
END_S = 10.0
# How often a starting program is looked at.
POLL_S = 0.2

FilePath = Union[str, Path]
Result = TypeVar("Result")


def _clone() -> Path:
    """The clone from which this package was installed, or in which it lies."""
    package = Path(__file__).resolve().parent
    recorded = package / "clone.txt"  # written by build_backend.py
    return Path(recorded.read_text(encoding="utf-8").strip()) if recorded.exists() else package.parents[2]


def find_program(program: Optional[FilePath] = None, *, name: str = "touchline", in_clone: Path = PROGRAM_IN_CLONE) -> Path:
    """The program of the argument, else the clone's, else that of PATH. Raises ArenaError."""
    built = _clone() / in_clone
    if program is not None:
        found = shutil.which(program)
        if found is None:
            raise ArenaError(f"{program} is not a program that can be run")
    else:
        found = shutil.which(built) or shutil.which(name)
        if found is None:
            raise ArenaError(f"no {name} in PATH, and none at {built}; build it (tools/run --help), or name it: program=...")
    return Path(found).resolve()


def find_board(program: Path) -> Path:
    """The mock board beside this program: in its clone, or where the package installs it. Raises ArenaError."""
    folders = [program.parent.parent / "share/touchline"]  # of PREFIX/bin/touchline
    folders += program.parents[3:6]  # of CLONE/build/PRESET/firmware/touchline, or a tool's, which lies deeper
    for folder in [*folders, _clone()]:
        if (folder / BOARD).exists():
            return folder / BOARD
    raise ArenaError(f"{program}: no {BOARD} beside it; name the board file: board=...")


def _stop(process: subprocess.Popen[bytes]) -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(END_S)
        except subprocess.TimeoutExpired:
            process.kill()
    process.wait()


def _clean_up(process: subprocess.Popen[bytes], folder: str) -> None:
    _stop(process)
    shutil.rmtree(folder, ignore_errors=True)


class Arena:
    """Starts the arena, waits for its first frame, and ends it with the block. `client` is connected to it.

        with touchline.Arena(seed=2, duration=60, opponents="stand") as arena:
            for frame in arena.client:
                arena.client.send({0: touchline.Place(0, 0)})
        print(arena.goals())

    `duration` in seconds of the game, None: until it is closed. `own_play`: the built-in play drives our robots that get no commands.
    `pace` "fast" does not wait for this program: frames are skipped. `settings` are keys of the board, venue and team file, as for
    `touchline run --set`. Several arenas can run at the same time. Errors of the program raise ArenaError with its last lines, also at
    the end of the block.
    """

    def __init__(self, program: Optional[FilePath] = None, *, board: Optional[FilePath] = None, seed: int = 1,
                 duration: Optional[float] = None, opponents: str = "follow", own_play: bool = False, pace: str = "real",
                 settings: Optional[Mapping[str, object]] = None, timeout: float = 10.0, every_frame: bool = False) -> None:
        found = find_program(program)
        keys = {"arena.opponents": opponents, "control.play.enabled": own_play, "console.enabled": False, **(settings or {})}
        folder = tempfile.mkdtemp(prefix="touchline-arena-")
        frames, commands = f"unix://{folder}/frames", f"unix://{folder}/commands"
        arguments = [str(found), "run", "--board", str(board or find_board(found)), "--headless", "--seed", str(seed), "--pace", pace,
                     "--publish", "json=" + frames, "--accept", "json=" + commands]
        if duration is not None:
            arguments += ["--duration", str(duration)]
        for key, value in keys.items():
            arguments += ["--set", f"{key}={str(value).lower() if isinstance(value, bool) else value}"]
        self._printed: Optional[str] = None
        self._output = Path(folder, "output")
        with open(self._output, "wb") as output:
            # In a session of its own, Ctrl-C reaches this program only, which then ends the arena.
            self._process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
                                             start_new_session=True)
        self._finalizer = weakref.finalize(self, _clean_up, self._process, folder)
        try:
            self.client = self._connect(frames, commands, timeout, every_frame)
        except BaseException:
            self._finalizer()
            raise

    def _connect(self, frames: str, commands: str, timeout: float, every_frame: bool) -> Client:
        end = time.monotonic() + timeout
        client = self._retry(lambda: Client(frames, commands, timeout=POLL_S, every_frame=every_frame), end)
        try:
            self._retry(lambda: client.wait(POLL_S), end)
        except BaseException:
            client.close()
            raise
        client.timeout = timeout
        return client

    def _retry(self, action: Callable[[], Result], end: float) -> Result:
        """Repeats an action that times out, until the program has ended or it is too late."""
        while True:
            try:
                return action()
            except TouchlineError as error:
                if self._process.poll() is not None:
                    raise self._failed(f"the arena ended with {self._process.returncode} before its first frame") from None
                if time.monotonic() >= end:
                    raise self._failed(f"the arena did not start in time: {error}") from None

    def output(self) -> str:
        """All that the program has printed so far."""
        if self._printed is not None:
            return self._printed
        return self._output.read_text(encoding="utf-8", errors="replace")

    def goals(self) -> Optional[tuple[int, int]]:
        """Our goals and those of the others, as the arena counts them; None before the first status line."""
        found = re.findall(r"\b(?:goals|score) (\d+) ?: ?(\d+)", self.output())
        return (int(found[-1][0]), int(found[-1][1])) if found else None

    def close(self) -> None:
        """Ends the game. Raises ArenaError if the program had failed."""
        if self._printed is not None:
            return
        self.client.close()
        _stop(self._process)
        self._printed = self.output()
        self._finalizer()
        if self._process.returncode != 0:
            raise self._failed(f"the arena ended with {self._process.returncode}")

    def _failed(self, what: str) -> ArenaError:
        lines = self.output().splitlines()[-SHOWN_LINES:]
        return ArenaError("\n  ".join([what + "; its last lines:", *lines]) if lines else what + "; it printed nothing")

    def __enter__(self) -> Arena:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()
