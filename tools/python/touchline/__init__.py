"""Frames and commands of Touchline, and its arena. docs/python.md describes the package."""
from .arena import Arena
from .client import Client
from .command import Command, Place, Release, Velocity, Wheels
from .errors import (ArenaError, ClosedError, FrameTimeoutError, MalformedFrameError, NoProgramError, RefusedCommandError,
                     TouchlineError)
from .frame import Ball, Frame, Robot, SentCommand, Telemetry, parse_frame

__all__ = [
    "Arena", "ArenaError", "Ball", "Client", "ClosedError", "Command", "Frame", "FrameTimeoutError", "MalformedFrameError",
    "NoProgramError", "Place", "RefusedCommandError", "Release", "Robot", "SentCommand", "Telemetry", "TouchlineError", "Velocity",
    "Wheels", "parse_frame"]
