"""Frames and commands of Touchline, and its arena. docs/python.md describes the package."""
from .arena import Arena
from .client import Client
from .command import Command, Place, Release, Velocity, Wheels
from .environment import Environment, Randomization, TwoSidedEnvironment
from .errors import (ArenaError, ClosedError, FrameTimeoutError, MalformedFrameError, NoProgramError, RefusedCommandError,
                     RefusedMessageError, TouchlineError)
from .frame import Ball, Event, Frame, Robot, SentCommand, Telemetry, parse_frame
from .simulation import Simulation

__all__ = [
    "Arena", "ArenaError", "Ball", "Client", "ClosedError", "Command", "Environment", "Event", "Frame", "FrameTimeoutError",
    "MalformedFrameError", "NoProgramError", "Place", "Randomization", "RefusedCommandError", "RefusedMessageError", "Release", "Robot",
    "SentCommand", "Simulation", "Telemetry", "TouchlineError", "TwoSidedEnvironment", "Velocity", "Wheels", "parse_frame"]
