"""What the tests with whole programs share."""
import socket
import sys
import time


def connect(path):
    """A connection to a unix socket that appears within ten seconds."""
    connection = socket.socket(socket.AF_UNIX)
    for _ in range(1000):
        try:
            connection.connect(path)
            return connection
        except OSError:
            time.sleep(0.01)
    sys.exit(f"{path}: nobody listens")


def check(condition, text):
    if not condition:
        sys.exit("FAILED: " + text)
