#!/usr/bin/env python3
"""The client with a program that the test plays: newest frames, lines in pieces, time-outs, ends, and addresses."""
import json
import pathlib
import shutil
import socket
import tempfile
import threading
import unittest

import package  # noqa: F401
from touchline import (Client, ClosedError, FrameTimeoutError, MalformedFrameError, NoProgramError, RefusedCommandError, TouchlineError,
                       Velocity)
from touchline.connection import UdpAddress, parse_address

SHORT_S = 0.05


def line(number):
    return json.dumps({"frame": number, "t": 0.0}).encode() + b"\n"


def listen(path):
    server = socket.socket(socket.AF_UNIX)
    server.bind(path)
    server.listen()
    return server


class ByUnixSocket(unittest.TestCase):
    def setUp(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        self.paths = [str(pathlib.Path(folder, name)) for name in ("frames", "commands")]
        self.servers = [listen(path) for path in self.paths]
        for server in self.servers:
            self.addCleanup(server.close)

    def connect(self, **options):
        client = Client(*("unix://" + path for path in self.paths), **options)
        self.addCleanup(client.close)
        self.program, self.received = (server.accept()[0] for server in self.servers)
        self.addCleanup(self.program.close)
        self.addCleanup(self.received.close)
        return client

    def test_gives_the_newest_frame(self):
        client = self.connect()
        self.program.sendall(line(1) + line(2) + line(3)[:5])
        self.assertEqual((client.next_frame().number, client.skipped), (2, 1))
        self.program.sendall(line(3)[5:])
        self.assertEqual((client.next_frame().number, client.skipped), (3, 1))

    def test_gives_every_frame_if_asked(self):
        client = self.connect(every_frame=True)
        self.program.sendall(line(1) + line(2) + line(3))
        self.program.close()
        self.assertEqual(([frame.number for frame in client], client.skipped), ([1, 2, 3], 0))

    def test_reads_every_frame_no_faster_than_it_is_asked(self):
        client = self.connect(every_frame=True)
        self.program.sendall(line(1) + line(2))
        self.assertEqual(client.next_frame().number, 1)
        self.program.sendall(line(3))
        client.wait()
        self.assertEqual(len(client._lines.waiting), 1)
        self.assertEqual([client.next_frame().number for _ in range(2)], [2, 3])

    def test_ends_with_the_program(self):
        client = self.connect()
        self.program.sendall(line(1) + line(2)[:9])
        self.program.close()
        self.assertEqual([frame.number for frame in client], [1])
        with self.assertRaisesRegex(ClosedError, "frames: Touchline has ended or closed the connection"):
            client.next_frame()

    def test_a_silent_program_is_a_time_out(self):
        client = self.connect(timeout=SHORT_S)
        for wait in (client.next_frame, lambda: next(iter(client))):
            with self.assertRaisesRegex(FrameTimeoutError, r"no frame in 0.05 s; is Touchline running with --publish json\?"):
                wait()
        self.program.sendall(line(1))
        client.wait()
        self.assertEqual(client.next_frame(timeout=0).number, 1)

    def test_goes_on_after_a_malformed_line(self):
        client = self.connect(every_frame=True)
        self.program.sendall(b"nothing\n" + line(2))
        self.assertRaises(MalformedFrameError, client.next_frame)
        self.assertEqual(client.next_frame().number, 2)

    def test_sends_commands_as_lines(self):
        client = self.connect()
        client.send({1: Velocity(0.5, -1)})
        client.send({})
        self.assertRaises(RefusedCommandError, client.send, {0: Velocity(0, 0), 1: Velocity(99, 0)})
        client.send({2: Velocity(0, 0)})
        lines = self.received.makefile()
        self.assertEqual([json.loads(lines.readline()) for _ in range(2)],
                         [{"commands": [{"id": 1, "v": 0.5, "w": -1}]}, {"commands": [{"id": 2, "v": 0, "w": 0}]}])

    def test_commands_after_the_end_are_an_error(self):
        client = self.connect()
        self.received.close()
        with self.assertRaisesRegex(ClosedError, "commands: the command was not sent: Broken pipe"):
            client.send({1: Velocity(0, 0)})

    def test_waits_for_a_program_that_starts(self):
        self.servers[1].close()
        pathlib.Path(self.paths[1]).unlink()
        started = []
        timer = threading.Timer(SHORT_S, lambda: started.append(listen(self.paths[1])))
        timer.start()
        with Client(*("unix://" + path for path in self.paths)):
            timer.join()
        started[0].close()

    def test_no_program_is_an_error(self):
        pathlib.Path(self.paths[0]).unlink()
        with self.assertRaisesRegex(NoProgramError, "^unix://.*/frames: no Touchline answers: No such file or directory$"):
            Client("unix://" + self.paths[0], timeout=0)

    def test_a_closed_client_says_so(self):
        with self.connect() as client:
            pass
        for action in (client.next_frame, lambda: client.send({})):
            with self.assertRaisesRegex(ClosedError, "this client is closed"):
                action()

    def test_a_client_without_commands_only_listens(self):
        with Client("unix://" + self.paths[0], None) as client:
            program = self.servers[0].accept()[0]
            self.addCleanup(program.close)
            program.sendall(line(7))
            self.assertEqual(client.next_frame().number, 7)
            self.assertRaises(TouchlineError, client.send, {1: Velocity(0, 0)})


class ByUdp(unittest.TestCase):
    def setUp(self):
        self.program = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(self.program.close)
        self.program.bind(("127.0.0.1", 0))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            self.frames = free.getsockname()
        self.addresses = [f"udp://{host}:{port}" for host, port in (self.frames, self.program.getsockname())]

    def test_gives_the_newest_frame_and_sends_commands(self):
        with Client(*self.addresses, timeout=SHORT_S) as client:
            for number in (1, 2, 3):
                self.program.sendto(line(number), self.frames)
            self.assertEqual((client.next_frame().number, client.skipped), (3, 2))
            self.assertRaises(FrameTimeoutError, client.next_frame)
            client.send({1: Velocity(0.5, 0)})
            self.assertEqual(json.loads(self.program.recv(1000)), {"commands": [{"id": 1, "v": 0.5, "w": 0}]})

    def test_no_program_is_an_error(self):
        self.program.close()
        with Client(*self.addresses) as client, self.assertRaisesRegex(NoProgramError, "is it running with --accept json"):
            for _ in range(2):  # the first message's refusal comes back with the second
                client.send({1: Velocity(0, 0)})

    def test_a_used_port_is_an_error(self):
        with Client(*self.addresses), self.assertRaisesRegex(NoProgramError, "cannot listen: Address already in use"):
            Client(*self.addresses)

    def test_groups_are_joined(self):
        with Client(f"udp://224.0.0.200:{self.frames[1]}%lo", None) as client:
            self.program.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
            self.program.sendto(line(4), ("224.0.0.200", self.frames[1]))
            self.assertEqual(client.next_frame().number, 4)


class Addresses(unittest.TestCase):
    def test_are_those_of_the_program(self):
        self.assertEqual(str(parse_address("unix:///run/touchline.sock")), "unix:///run/touchline.sock")
        self.assertEqual(parse_address("udp://224.5.23.2:10006%eth0"), UdpAddress("224.5.23.2", 10006, "eth0"))
        for text in ("udp://127.0.0.1", "udp://300.0.0.1:5", "udp://127.0.0.1:70000", "unix://run", "127.0.0.1:9870", ""):
            self.assertRaisesRegex(ValueError, "is not an address: write unix:///PATH or udp://ADDRESS:PORT", parse_address, text)


if __name__ == "__main__":
    unittest.main()
