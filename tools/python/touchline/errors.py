"""The exceptions of this package."""
from __future__ import annotations


class TouchlineError(Exception):
    """Base of all exceptions of this package."""


class NoProgramError(TouchlineError):
    """No Touchline answers at the address."""


class ClosedError(TouchlineError):
    """Touchline has ended, or has closed the connection."""


class FrameTimeoutError(TouchlineError, TimeoutError):
    """No frame came in time."""


class MalformedFrameError(TouchlineError, ValueError):
    """A line is not a frame. The connection can still be used."""


class RefusedCommandError(TouchlineError, ValueError):
    """Touchline would refuse this command. Nothing was sent."""


class RefusedMessageError(TouchlineError, ValueError):
    """The simulation refused a message. Nothing has changed, and the game goes on."""


class ArenaError(TouchlineError):
    """The arena could not be started, or has failed."""
