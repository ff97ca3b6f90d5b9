"""touchline-arena serve and touchline run as two processes: serve_test.py CASE TOUCHLINE TOUCHLINE_ARENA BOARDS"""
import os
import pathlib
import pty
import random
import re
import select
import signal
import socket
import subprocess
import sys
import tempfile
import termios
import threading
import time
import tty

CASE, TOUCHLINE, ARENA, BOARDS = sys.argv[1:5]
# Ports of this process, so that several tests can run at once.
PICTURES, ROBOTS, RELAYED, CONTROL = (21000 + 4 * (os.getpid() % 2500) + i for i in range(4))


def check(condition, message):
    if not condition:
        raise SystemExit(f"{CASE}: {message}")


def number(pattern, text):
    found = re.search(pattern, text)
    check(found, f"{pattern!r} is not in:\n{text}")
    return float(found.group(1))


class Program:
    """A process whose output is read by a thread."""

    def __init__(self, *command):
        self.process = subprocess.Popen([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        text=True, errors="replace")
        self.lines = []
        self.reader = threading.Thread(target=lambda: self.lines.extend(iter(self.process.stdout.readline, "")))
        self.reader.start()

    @property
    def text(self):
        return "".join(self.lines)

    def wait_for(self, words, timeout_s=60, count=1):
        end = time.monotonic() + timeout_s
        while self.text.count(words) < count:
            ended = self.process.poll() is not None and not self.reader.is_alive()
            check(not ended and time.monotonic() < end, f"{words!r} did not appear in:\n{self.text}")
            time.sleep(0.02)

    def finish(self, signal_number=None, timeout_s=120):
        if signal_number is not None:
            self.process.send_signal(signal_number)
        self.process.wait(timeout_s)
        self.reader.join()
        return self.text


def serve(*options):
    arena = Program(ARENA, "serve", "--board", f"{BOARDS}/mock/board.toml", "--pictures", f"tcp://127.0.0.1:{PICTURES}",
                    "--robots", f"udp://127.0.0.1:{ROBOTS}", "--control", f"udp://127.0.0.1:{CONTROL}", *options)
    arena.wait_for("level: ")
    return arena


def run(*options, robots=ROBOTS):
    return Program(TOUCHLINE, "run", "--headless", "--board", f"{BOARDS}/hil/board.toml", "--set",
                   f"camera.address=tcp://127.0.0.1:{PICTURES}", "--set", f"radio.address=127.0.0.1:{robots}", *options)


def plays_in_lockstep(seed):
    # Small pictures would need another venue; a game of 6 s takes less than that on a PC.
    arena = serve("--lockstep", "--seed", seed)
    with tempfile.TemporaryDirectory() as games:
        firmware = run("--set", "camera.lockstep=true", "--duration", 6, "--record", games, "--set", "recording.every=0")
        played = firmware.finish()
    check(firmware.process.returncode == 0, played)
    arena.wait_for("gone")
    return arena.finish(signal.SIGINT) + played


def lockstep_is_repeatable():
    first, second, other = plays_in_lockstep(1), plays_in_lockstep(1), plays_in_lockstep(2)
    check(first.splitlines()[0].startswith("level: network, in lock-step; pictures: rgb24 640x480, 60 Hz"), first)
    check(number(r"packets received: (\d+)", first) >= 360, first)
    check(number(r", (\d+) missing", first) == 0, first)
    check(number(r"without a packet in time: (\d+)", first) == 0, first)
    check(number(r"touched (\d+) times", first) >= 1, first)

    def results(text):
        return re.findall(r"hash:? [0-9a-f]{16}|arena state: [0-9a-f]{16}", text)
    check(len(results(first)) == 3 and results(first) == results(second), f"not repeatable:\n{first}{second}")
    check(results(first) != results(other), f"the seed has no effect:\n{first}{other}")


class Relay(threading.Thread):
    """Passes datagrams on after `delay_s`, without a share `loss` of them."""

    def __init__(self, delay_s, loss):
        super().__init__(daemon=True)
        self.delay_s, self.loss, self.random = delay_s, loss, random.Random(1)
        self.passed = self.dropped = 0
        self.front = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.front.bind(("127.0.0.1", RELAYED))
        self.back = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.back.connect(("127.0.0.1", ROBOTS))
        self.start()

    def run(self):
        waiting, client = [], None
        while True:
            left = waiting[0][0] - time.monotonic() if waiting else 1.0
            ready = select.select([self.front, self.back], [], [], max(0.0, left))[0]
            due = time.monotonic() + self.delay_s
            if self.front in ready:
                data, client = self.front.recvfrom(2048)
                # The first packets, among them the first sequence number, arrive: losses are counted from there.
                if self.passed > 20 and self.random.random() < self.loss:
                    self.dropped += 1
                else:
                    self.passed += 1
                    waiting.append((due, data, None))
            if self.back in ready:
                waiting.append((due, self.back.recv(2048), client))
            while waiting and waiting[0][0] <= time.monotonic():
                _, data, to = waiting.pop(0)
                self.back.send(data) if to is None else self.front.sendto(data, to)


def plays_through_a_network_that_loses():
    relay = Relay(0.005, 0.01)
    pictures = ["--set", "camera.rate_hz=30", "--set", "camera.format=mjpg", "--venue", f"{BOARDS}/mock/venue-mjpg.toml"]
    arena = serve(*pictures)
    firmware = run(*pictures, "--set", "radio.delay_s=0.023", "--duration", 15, robots=RELAYED)
    played = firmware.finish()
    check(firmware.process.returncode == 0, played)
    text = arena.finish(signal.SIGINT)
    check("level: network, in real time; pictures: mjpg" in text, text)
    received, missing = number(r"packets received: (\d+)", text), number(r", (\d+) missing", text)
    print(f"relay: {relay.passed} passed, {relay.dropped} dropped; {text}{played}")
    check(relay.dropped > 0, "the relay dropped nothing")
    check(received == relay.passed, f"{relay.passed} passed\n{text}")
    # The last ones can only be missed if another one follows.
    check(relay.dropped - 2 <= missing <= relay.dropped, f"{relay.dropped} dropped\n{text}")
    check(number(r"touched (\d+) times", text) >= 1, text)


def robots_stop_while_the_arena_is_gone():
    arena = serve("--set", "camera.rate_hz=30")
    firmware = run("--set", "camera.rate_hz=30", "--set", "faults.reopen_after_s=0.1")
    arena.wait_for("has connected")
    time.sleep(2.0)
    arena.finish(signal.SIGKILL)
    firmware.wait_for("has closed the connection")
    # Stop packets go on without pictures.
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as robots:
        robots.bind(("127.0.0.1", ROBOTS))
        robots.settimeout(5.0)
        time.sleep(0.5)
        robots.setblocking(False)
        while True:
            try:
                robots.recv(2048)
            except BlockingIOError:
                break
        robots.settimeout(5.0)
        packets = [robots.recv(2048) for _ in range(5)]
    # docs/radio.md: bit 0 of the flags is the stop.
    check(all(packet[STOP_BYTE] & 1 for packet in packets), f"no stop packets: {packets}")
    arena = serve("--set", "camera.rate_hz=30")
    arena.wait_for("has connected", timeout_s=20)
    time.sleep(2.0)
    text = firmware.finish(signal.SIGINT)
    after = arena.finish(signal.SIGINT)
    check(firmware.process.returncode == 0, text)
    check(f"tcp://127.0.0.1:{PICTURES}" in text, text)
    check(number(r"packets received: (\d+)", after) > 20, after)
    check(number(r"moved ([0-9.]+) m", after) >= 0, after)


def others_control_the_arena():
    arena = serve("--set", "arena.opponents=stand")
    firmware = run("--set", "control.play.enabled=false", "--duration", 6)
    arena.wait_for("has connected")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.connect(("127.0.0.1", CONTROL))
        other.settimeout(10.0)

        def ask(text):
            other.send(text.encode())
            return other.recv(2048).decode()
        check(ask('{"place": {"ball": {"x": 0.2, "y": 0.1}}}') == "ok", "the ball is not placed")
        check(ask('{"throw": {"vx": 1, "vy": 0}}') == "ok", "the ball is not thrown")
        check(ask('{"fault": {"kind": "dark", "for_s": 0.2}}') == "ok", "no fault")
        check("there is neither a robot nor the ball" in ask('{"move": {"u_px": 0, "v_px": 0, "to_u_px": 9, "to_v_px": 9}}'), "something is in the corner")
        check("its time cannot be changed" in ask('{"pause": {}}'), "the time stands")
        for bad in ("{", "[]", '{"fly": {}}', '{"fault": {"kind": "unicorns"}}', "\0" * 5000):
            check(ask(bad) != "ok", f"{bad!r} is carried out")
    played = firmware.finish()
    check(firmware.process.returncode == 0, played)
    text = arena.finish(signal.SIGINT)
    check(number(r"packets received: (\d+)", text) > 20, text)


def robots_on_a_serial_line():
    """Two pseudo terminals, joined as an adapter's wires are."""
    ends = [pty.openpty() for _ in range(2)]
    for master, slave in ends:
        tty.setraw(master, termios.TCSANOW)
        tty.setraw(slave, termios.TCSANOW)
    names = [os.ttyname(slave) for _, slave in ends]
    stop = threading.Event()

    def join():
        masters = [master for master, _ in ends]
        while not stop.is_set():
            for file in select.select(masters, [], [], 0.1)[0]:
                os.write(masters[1 - masters.index(file)], os.read(file, 4096))
    wires = threading.Thread(target=join)
    wires.start()
    arena = Program(ARENA, "serve", "--board", f"{BOARDS}/mock/board.toml", "--lockstep", "--control", "none", "--pictures",
                    f"tcp://127.0.0.1:{PICTURES}", "--robots", names[0])
    arena.wait_for("level: wires, in lock-step")
    firmware = run("--set", "camera.lockstep=true", "--set", "radio.backend=serial", "--set", f"radio.device={names[1]}",
                   "--duration", 3)
    played = firmware.finish()
    check(firmware.process.returncode == 0, played)
    arena.wait_for("gone")
    text = arena.finish(signal.SIGINT)
    stop.set()
    wires.join()
    check(number(r"packets received: (\d+)", text) >= 180, text)
    check(number(r"(\d+) bytes of no packet", text) == 0, text)
    check(number(r"without a packet in time: (\d+)", text) == 0, text)
    check(number(r"telemetry: (\d+)", played) > 0 if "telemetry: " in played else True, played)


def errors_name_device_and_reason():
    def fails(*options):
        done = subprocess.run([ARENA, "serve", "--board", f"{BOARDS}/mock/board.toml", *(() if "--control" in options else ("--control", "none")), *options],
                              capture_output=True, text=True, timeout=60)
        check(done.returncode != 0 and done.stdout == "", f"{options}: {done}")
        return done.stderr
    pictures = ["--pictures", f"tcp://127.0.0.1:{PICTURES}", "--robots", f"udp://127.0.0.1:{ROBOTS}"]
    with tempfile.TemporaryDirectory() as folder:
        for options, words in [
                ([*pictures, "--loopback", f"{folder}/video7"], f"{folder}/video7: no such device; load the kernel module"),
                ([*pictures, "--loopback", "/dev/null"], "/dev/null: not a video device"),
                (["--pictures", "none"], "--pictures none needs --loopback"),
                (["--pictures", "udp://127.0.0.1:1"], "expected tcp://ADDRESS:PORT"),
                ([*pictures, "--control", "unix:///tmp/arena"], "--control unix:///tmp/arena: expected udp://ADDRESS:PORT"),
                ([*pictures, "--control", "arena"], "--control arena: expected udp://ADDRESS:PORT"),
                ([*pictures[:3], "ttyUSB0"], "--robots ttyUSB0: expected udp://ADDRESS:PORT or a serial device"),
                ([*pictures[:3], f"{folder}/ttyUSB0"], f"{folder}/ttyUSB0: "),
                ([*pictures, "--lockstep", "--loopback", "/dev/null"], "--lockstep needs a receiver")]:
            check(words in fails(*options), f"{options}: {fails(*options)}")
    with socket.create_server(("127.0.0.1", PICTURES)):
        text = fails(*pictures)
        check(f"tcp://127.0.0.1:{PICTURES}: binding failed" in text, text)
    missing = run("--duration", 1)
    text = missing.finish()
    check(missing.process.returncode != 0 and f"tcp://127.0.0.1:{PICTURES}: connecting failed: Connection refused" in text, text)


def garbage_at_its_ports_does_no_harm():
    arena = serve("--lockstep")
    for junk in (b"", b"GET / HTTP/1.1\r\n\r\n", bytes(range(256)) * 100):
        with socket.create_connection(("127.0.0.1", PICTURES)) as other:
            try:
                other.sendall(junk)
                other.recv(100)
            except ConnectionError:
                pass
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        for junk in (b"", b"x", bytes(300), bytes(60000)):
            other.sendto(junk, ("127.0.0.1", ROBOTS))
    firmware = run("--set", "camera.lockstep=true", "--frames", 30)
    played = firmware.finish()
    check(firmware.process.returncode == 0, played)
    text = arena.finish(signal.SIGINT)
    check(number(r"(\d+) bytes of no packet", text) >= 301, text)
    check(number(r"packets received: (\d+)", text) >= 30, text)


# docs/radio.md: the flags follow two bytes of start and the version.
STOP_BYTE = 3
CASES = {"LockstepIsRepeatable": lockstep_is_repeatable,
         "PlaysThroughANetworkThatLoses": plays_through_a_network_that_loses,
         "RobotsStopWhileTheArenaIsGone": robots_stop_while_the_arena_is_gone,
         "RobotsOnASerialLine": robots_on_a_serial_line,
         "ErrorsNameDeviceAndReason": errors_name_device_and_reason,
         "OthersControlTheArena": others_control_the_arena,
         "GarbageAtItsPortsDoesNoHarm": garbage_at_its_ports_does_no_harm}
CASES[CASE]()
