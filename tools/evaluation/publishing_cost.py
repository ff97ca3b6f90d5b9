"""Measures what publishing and the console cost; tools/publishing-cost runs it. docs/latency.md explains the result."""
import argparse
import csv
import json
import math
import multiprocessing
import os
import pathlib
import random
import selectors
import socket
import struct
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPAN = "frame to packet"
LISTENERS = 3
GROUPS = {"ssl-vision": ("224.5.23.2", 10006), "ssl-tracked": ("224.5.23.2", 10010), "firasim": ("224.0.0.1", 10002)}
LIMIT = 0.02
RESAMPLES = 2000
MIN_ROUNDS = 8  # a bootstrap of fewer gives intervals that are too narrow


# ---- arithmetic: a round is a pair of lists of times, without and with outputs

def rank_from_top(count, percent):
    """Place of the percentile among `count` values, 1 for the largest, by nearest rank as touchline-latency has it."""
    # Rounded first: 0.999 * 1000 is not exactly 999.
    return count - max(1, math.ceil(round(count * percent / 100, 6))) + 1


def percentile(values, percent):
    return sorted(values, reverse=True)[rank_from_top(len(values), percent) - 1]


class Pool:
    """The runs of one kind. Percentiles of any selection of them need only the largest values of each."""

    def __init__(self, runs, percent):
        self.counts = [len(run) for run in runs]
        self.percent = percent
        most = len(runs) * max(self.counts)
        needed = max(rank_from_top(count, percent) for count in (most, max(most - 1, 1)))
        self.largest = [sorted(run, reverse=True)[:needed] for run in runs]

    def percentile(self, selection):
        """Of the runs with these numbers together; a number may appear several times."""
        values = sorted((value for i in selection for value in self.largest[i]), reverse=True)
        return values[rank_from_top(sum(self.counts[i] for i in selection), self.percent) - 1]


class Difference:
    """Relative difference of a percentile with outputs against without, with its 95 % interval.

    The interval is a bootstrap over rounds: both runs of a round are drawn together, because neighboring runs see the same state
    of the computer, and frames of a run are not independent.
    """

    def __init__(self, rounds, percent, resamples=RESAMPLES, seed=1):
        without, with_outputs = (Pool([pair[kind] for pair in rounds], percent) for kind in (0, 1))
        everything = range(len(rounds))
        self.without, self.with_outputs = without.percentile(everything), with_outputs.percentile(everything)
        self.value = self.with_outputs / self.without - 1
        chance = random.Random(seed)
        drawn = []
        for _ in range(resamples):
            selection = chance.choices(everything, k=len(rounds))
            drawn.append(with_outputs.percentile(selection) / without.percentile(selection) - 1)
        self.low, self.high = percentile(drawn, 2.5), percentile(drawn, 97.5)

    def verdict(self):
        if self.high <= LIMIT:
            return f"within {LIMIT:.0%}"
        if self.low > LIMIT:
            return f"more than {LIMIT:.0%}"
        return (f"undecided: the interval contains {LIMIT:.0%}. Other programs may have used the processors; else more rounds "
                "make it narrower")


# ---- measurement

def build():
    """Returns the program touchline-latency."""
    folder = ROOT / "build/run"
    ccache = {"CMAKE_CXX_COMPILER_LAUNCHER": "ccache", "CMAKE_C_COMPILER_LAUNCHER": "ccache"}
    for command in (["--preset", "release", "-B", str(folder), "-DTOUCHLINE_TESTS=OFF", "--log-level=WARNING"],
                    ["--build", str(folder), "--target", "touchline-latency"]):
        if subprocess.run(["cmake", *command], cwd=ROOT, env={**ccache, **os.environ}, stdout=sys.stderr, check=False).returncode != 0:
            sys.exit("tools/publishing-cost: the build failed, see above")
    return str(folder / "tools/programs/latency/touchline-latency")


def busy_share(seconds):
    """Share of the time for which the processors are busy."""
    def times():
        # user, nice, system, idle, iowait, ...: proc(5)
        values = [int(value) for value in pathlib.Path("/proc/stat").read_text(encoding="utf-8").splitlines()[0].split()[1:]]
        return sum(values), values[3] + values[4]

    all_before, idle_before = times()
    time.sleep(seconds)
    all_after, idle_after = times()
    return 1 - (idle_after - idle_before) / max(1, all_after - all_before)


def listen(folder, number):
    """Receives all outputs until it is killed; a file counts the bytes of each. The unix socket may appear later."""
    selector = selectors.DefaultSelector()
    received = dict.fromkeys([*GROUPS, "json"], 0)
    for name, (group, port) in GROUPS.items():
        listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((group, port))
        loopback = struct.pack("4s4s", socket.inet_aton(group), socket.inet_aton("127.0.0.1"))
        listener.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, loopback)
        selector.register(listener, selectors.EVENT_READ, name)
    stream = None
    written = 0.0
    while True:
        if stream is None:
            try:
                stream = socket.socket(socket.AF_UNIX)
                stream.connect(str(folder / "json"))
                selector.register(stream, selectors.EVENT_READ, "json")
            except OSError:
                stream = None
        for key, _ in selector.select(timeout=0.1):
            data = key.fileobj.recv(65536)
            received[key.data] += len(data)
            if not data and key.data == "json":  # the run has ended
                selector.unregister(key.fileobj)
        if time.monotonic() > written + 0.5:
            written = time.monotonic()
            (folder / f"listener-{number}").write_text(json.dumps(received), encoding="utf-8")


def check_console(traffic, clients):
    if traffic["elapsed_s"] <= 0 or traffic["pictures"] < clients or traffic["states"] < clients:
        sys.exit(f"the console's clients have not received states and pictures: {traffic}")


def run(latency, options, folder, with_outputs):
    """Times of all frames in nanoseconds."""
    folder.mkdir()
    command = [latency, "--board", options.board, "--pace", "--duration", str(options.seconds),
               "--csv", str(folder / "times.csv"), "--out", str(folder / "report.json"), *options.options]
    listeners = []
    if options.console_clients:
        command += ["--console-clients", str(options.console_clients if with_outputs else 0)]
    elif with_outputs:
        for name, (group, port) in GROUPS.items():
            command += ["--publish", f"{name}=udp://{group}:{port}%lo"]
        command += ["--publish", f"json=unix://{folder / 'json'}"]
        listeners = [multiprocessing.Process(target=listen, args=(folder, i)) for i in range(LISTENERS)]
    for listener in listeners:
        listener.start()
    try:
        result = subprocess.run(command, capture_output=True, text=True, check=False)
    finally:
        for listener in listeners:
            listener.kill()
            listener.join()
    if result.returncode != 0:
        sys.exit(f"{' '.join(command)} ended with {result.returncode}:\n{result.stdout}{result.stderr}")
    for i in range(len(listeners)):
        received = json.loads((folder / f"listener-{i}").read_text(encoding="utf-8"))
        if 0 in received.values():
            sys.exit(f"listener {i} has not received all outputs: {received}")
    with open(folder / "times.csv", encoding="utf-8") as file:
        times = [int(row[SPAN]) for row in csv.DictReader(file)]
    measured = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    if options.console_clients and with_outputs:
        check_console(measured["console"], options.console_clients)
    return times, measured["allocations"]


def measure(latency, options, folder):
    rounds, allocations = [], 0
    for number in range(options.rounds):
        pair = [[], []]
        # A B B A ...: a steady change of the computer's speed then affects both alike.
        for kind in (0, 1) if number % 2 == 0 else (1, 0):
            pair[kind], allocated = run(latency, options, folder / f"round-{number}-{'with' if kind else 'without'}", kind == 1)
            allocations += allocated or 0
        rounds.append(pair)
        p999 = [percentile(times, 99.9) / 1e6 for times in pair]
        print(f"round {number + 1} of {options.rounds}: p99.9 {p999[0]:.3f} ms without, {p999[1]:.3f} ms with", flush=True)
    return rounds, allocations


def report(rounds, allocations, console_clients=0):
    frames = [sum(len(pair[kind]) for pair in rounds) for kind in (0, 1)]
    lines = [f"{SPAN}, {frames[0]} frames without outputs, {frames[1]} with {len(GROUPS) + 1} outputs and {LISTENERS} listeners"]
    if console_clients:
        lines = [f"{SPAN}, {frames[0]} frames without clients of the console, {frames[1]} with {console_clients}"]
    for percent in (50, 99, 99.9):
        found = Difference(rounds, percent)
        lines.append(f"p{percent:<5g} {found.without / 1e6:.4f} ms without, {found.with_outputs / 1e6:.4f} ms with: "
                     f"{found.value:+.1%}, 95 % interval {found.low:+.1%} to {found.high:+.1%}")
    lines += [f"allocations in the loop: {allocations}", f"the cost at p99.9 is {found.verdict()}"]
    return "\n".join(lines)


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="tools/publishing-cost", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Measures the time from frame to packet with all outputs and three listeners against none, in interleaved\n"
                    "runs in real time, and prints the difference of percentiles with their 95 % intervals.",
        epilog="Example: tools/publishing-cost -- --set realtime.priority=60 --set realtime.cpu=1\n"
               "Exit codes: 0 measured, whatever the result is; 1 a run failed; 64 the command line is wrong.")
    parser.error = lambda message: (parser.print_usage(sys.stderr), print(message, file=sys.stderr), sys.exit(64))
    parser.add_argument("--rounds", type=int, default=20, help="pairs of runs (20)")
    parser.add_argument("--seconds", type=float, default=30, help="length of each run (30)")
    parser.add_argument("--board", default=str(ROOT / "boards/mock/board.toml"), help="board file (the mock arena)")
    parser.add_argument("--console-clients", type=int, default=0, metavar="N",
                        help="measure the cost of N clients of the console at full rate instead, against none")
    parser.add_argument("--keep", type=pathlib.Path, metavar="FOLDER", help="new folder for the times of all frames")
    parser.add_argument("options", nargs="*", metavar="OPTION", help="more options of touchline-latency, after --")
    options = parser.parse_args(arguments)
    if options.rounds < MIN_ROUNDS or options.seconds < 1:
        parser.error(f"at least {MIN_ROUNDS} rounds of 1 s are needed")
    return options


def main():
    options = parse(sys.argv[1:])
    latency = build()
    busy = busy_share(3)
    if busy > 0.05:
        print(f"the processors are busy for {busy:.0%} of the time: other programs disturb the measurement", file=sys.stderr)
    print(f"{options.rounds} rounds take {options.rounds * 2 * (options.seconds + 5) / 60:.0f} minutes", flush=True)
    if options.keep is not None:
        options.keep.mkdir(parents=True)
        print(report(*measure(latency, options, options.keep), options.console_clients))
        return
    with tempfile.TemporaryDirectory() as folder:
        print(report(*measure(latency, options, pathlib.Path(folder)), options.console_clients))


if __name__ == "__main__":
    main()
