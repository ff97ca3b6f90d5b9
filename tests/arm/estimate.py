"""Estimates the time of the whole step on ARM processors (tools/estimate-arm)."""

import argparse
import concurrent.futures
import math
import os
import re
import shutil
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FILES = os.path.join(ROOT, "build", "arm-estimate")
X86 = os.path.join(ROOT, "build", "release", "tests", "benchmark")
ARM = os.path.join(ROOT, "build", "arm64-bookworm", "tests", "benchmark")
SYSROOT = os.path.join(ROOT, "build", "sysroot-bookworm-arm64")
MOCK = os.path.join(ROOT, "boards", "mock")
MCA = "llvm-mca-19"


class Core:
    """A processor. `first`: its first caches, of instructions and data (bytes, associativity, line). `second`: the caches behind them, from
    near to far. `latency`: of a load that each of these serves, in cycles. `mispredicted`: cycles of a mispredicted branch."""

    def __init__(self, name, model, hertz, first, second, latency, memory_ns, mispredicted):
        self.name, self.model, self.hertz = name, model, hertz
        self.first, self.second, self.latency = first, second, latency
        self.memory, self.mispredicted = memory_ns * 1e-9 * hertz, mispredicted


# Cache sizes: of the Raspberry Pi 4 (BCM2711), 5 (BCM2712) and 3 (BCM2837). Cycles of a mispredicted branch: MispredictPenalty in LLVM's
# models of A57, Neoverse N1 and A53. Latencies of caches and memory are assumptions on the side of caution: no board was measured.
CORES = [
    Core("A72, 1.5 GHz", "cortex-a72", 1.5e9, ("49152,3,64", "32768,2,64"), ["1048576,16,64"], [21], 150, 14),
    Core("A76, 2.4 GHz", "neoverse-n1", 2.4e9, ("65536,4,64", "65536,4,64"), ["524288,8,64", "2097152,16,64"], [11, 35], 130, 11),
    Core("A53, 1.0 GHz", "cortex-a53", 1.0e9, ("32768,2,64", "32768,4,64"), ["524288,16,64"], [15], 150, 9),
]

# The rows: name, picture, formats, teams, how many of the last frames count, and the budget of the first core in milliseconds, with all
# misses: docs/performance.md. These pictures of clutter take the most instructions of latency::worst_clutter() with their teams.
CLUTTER, CROWD = "noise on large patches", "crowd on patches"
FORMATS = ["yuyv", "nv12", "rgb24"]
ROWS = [
    ("game, ten robots", "game", FORMATS, "mock", 8, 3.5),
    ("game, bytes of a JPEG to packet", "game", ["mjpg"], "mock", 8, None),
    (CLUTTER + ", ten robots", CLUTTER, FORMATS, "mock", 1, 11.0),
    (CROWD + ", 22 robots of six patches", CROWD, FORMATS, "largest", 1, None),
]

# The simulation of a chunk starts with an empty pipeline; a chunk is long enough to make that negligible.
CHUNK = 4000


def venue_of(pixels):
    """Returns the venue of the mock board for a format. Boxes of full-range YUV, scaled, are those of YUYV and NV12: the scale is linear,
    and bounds are rounded inwards, so that boxes do not overlap."""
    if pixels in ("rgb24", "mjpg"):
        return os.path.join(MOCK, "venue.toml" if pixels == "rgb24" else "venue-mjpg.toml")

    def scaled(found):
        round_to = {"low": math.ceil, "high": math.floor}.get(found[1], round)
        luma, *chroma = map(int, found[2].split(","))
        values = [16 + luma * 219 / 255] + [128 + (value - 128) * 224 / 255 for value in chroma]
        return "%s = %s" % (found[1], [round_to(value) for value in values])

    for name in ("venue-light.png", "venue-mjpg-field.png"):
        shutil.copy(os.path.join(MOCK, name), FILES)
    with open(os.path.join(MOCK, "venue-mjpg.toml")) as full_range:
        text = full_range.read().replace('"yuv_full_range"', '"yuv"')
    path = os.path.join(FILES, "venue-yuv.toml")
    with open(path, "w") as venue:
        venue.write(re.sub(r"(?m)^(background|typical|low|high) = \[(\d+, \d+, \d+)\]", scaled, text))
    return path


def arguments(picture, pixels, kernel, teams, counted):
    """Stores the picture's frames and returns the arguments of profile_step."""
    frames = os.path.join(FILES, "%s-%s" % (picture.replace(" ", "-"), pixels))
    venue = venue_of(pixels)
    subprocess.run([X86 + "/touchline-bench", "--store", picture, pixels, venue, frames], check=True)
    return [frames, pixels, venue, kernel, teams, str(counted)]


def misses(words, core, second):
    """Returns the misses of the first caches and of a second one, the mispredicted branches, and what the program printed (x86)."""
    counts = os.path.join(FILES, "callgrind-%s-%s" % (core.model, second))
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=" + counts, "--toggle-collect=*counted_call*", "--cache-sim=yes",
               "--branch-sim=yes", "--I1=" + core.first[0], "--D1=" + core.first[1], "--LL=" + second, X86 + "/profile_step"]
    run = subprocess.run(command + words, check=True, capture_output=True, text=True)
    with open(counts) as file:
        text = file.read()
    os.remove(counts)
    names = re.search(r"^events: (.*)$", text, re.M)[1].split()
    count = dict(zip(names, map(int, re.search(r"^(?:totals|summary): (.*)$", text, re.M)[1].split())))
    return (sum(count[name] for name in ("I1mr", "D1mr", "D1mw")), sum(count[name] for name in ("ILmr", "DLmr", "DLmw")),
            count["Bcm"] + count["Bim"], run.stdout)


def cycles_of_misses(words, core):
    """Returns the cycles if no miss overlaps with anything and nothing is prefetched: an upper bound."""
    spent, missed = 0, None
    for second, latency in zip(core.second, core.latency):
        of_first, of_second, mispredicted, found = misses(words, core, second)
        spent += latency * (of_first if missed is None else missed)
        missed = of_second
    return spent + missed * core.memory + mispredicted * core.mispredicted, found


def trace(words):
    """Returns the instructions that ran between the marks, in order, and what the program printed."""
    command = ["qemu-aarch64-static", "-cpu", "cortex-a72", "-L", SYSROOT, "-d", "exec,in_asm,nochain", ARM + "/profile_step"]
    run = subprocess.Popen(command + words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    blocks, block, ran, on = {}, None, [], False
    for line in run.stderr:
        if line.startswith("Trace 0"):
            if line.endswith("trace_begins\n"):
                on = True
            elif line.endswith("trace_ends\n"):
                on = False
            elif on:
                ran.append(int(line[line.index("/") + 1:].split("/", 1)[0], 16))
        elif line.startswith("0x"):
            address, _, text = line.split(maxsplit=2)
            if block is None:
                block = blocks[int(address[:-1], 16)] = []
            block.append(text.strip())
        else:
            block = None
    found = run.stdout.read()
    if run.wait() != 0 or not ran:
        sys.exit("tools/estimate-arm: profile_step %s found nothing to trace" % " ".join(words))
    return [instruction for address in ran for instruction in blocks[address]], found


# The assembler expects a distance where the log has an address; the distance does not matter, since the trace has the next instruction.
# llvm-mca counts a hundred cycles for a call, because it does not see the called function; in the trace it follows.
CALL = re.compile(r"^(bl|blr|br|ret)\b.*$")
BRANCH = re.compile(r"^(b|b\.\w+|cbn?z|tbn?z|adrp?)(\s.*)#0x[0-9a-f]+$|^(b|b\.\w+)(\s+)#0x[0-9a-f]+$")


def assembly(instruction):
    instruction = CALL.sub("b #0", instruction)
    return BRANCH.sub(lambda found: (found[1] or found[3]) + (found[2] or found[4]) + "#0", instruction)


def cycles(chunk, core):
    text = "\n".join(map(assembly, chunk)) + "\n"
    command = [MCA, "-mtriple=aarch64-linux-gnu", "-mcpu=" + core.model, "-iterations=1", "-instruction-info=0",
               "-resource-pressure=0"]
    said = subprocess.run(command, input=text, capture_output=True, text=True)
    counted = re.search(r"Instructions: +(\d+)\nTotal Cycles: +(\d+)", said.stdout)
    if not counted or int(counted[1]) != len(chunk):
        sys.exit("tools/estimate-arm: %s could not read the instructions:\n%s" % (MCA, said.stderr[:2000]))
    return int(counted[2])


def computing_cycles(instructions, chunks):
    """Returns the cycles of all instructions by core, extrapolated from about `chunks` of them."""
    count = max(1, len(instructions) // CHUNK)
    chosen = [instructions[CHUNK * i:CHUNK * (i + 1)] for i in range(0, count, max(1, count // chunks))]
    part = sum(map(len, chosen)) / len(instructions)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return [sum(pool.map(lambda chunk, core=core: cycles(chunk, core), chosen)) / part for core in CORES]


def estimate(picture, pixels, teams, counted, chunks):
    """Returns a step's instructions, and for each core the milliseconds without and with all misses."""
    words = arguments(picture, pixels, "fastest", teams, counted)
    with concurrent.futures.ThreadPoolExecutor(len(CORES)) as pool:
        simulated = [pool.submit(cycles_of_misses, words, core) for core in CORES]
        ran, found = trace(words)
    times = []
    for core, computing, of_core in zip(CORES, computing_cycles(ran, chunks), simulated):
        missing, found_on_x86 = of_core.result()
        if found != found_on_x86:
            sys.exit("tools/estimate-arm: %s, %s: ARM found %s, x86 %s" % (picture, pixels, found.strip(), found_on_x86.strip()))
        times.append(tuple(1e3 * spent / core.hertz / counted for spent in (computing, computing + missing)))
    return len(ran) / counted, times


def at_least_one(text):
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError("%r is no whole number of at least 1" % text)
    return int(text)


def main():
    options = argparse.ArgumentParser(prog="tools/estimate-arm")
    options.add_argument("--chunks", type=at_least_one, default=40, metavar="N", help="4,000 instructions each, of a row (40)")
    chunks = options.parse_args().chunks

    os.makedirs(FILES, exist_ok=True)
    for preset, targets in (("release", ["profile_step", "touchline-bench"]), ("arm64-bookworm", ["profile_step"])):
        subprocess.run(["cmake", "--preset", preset, "-DTOUCHLINE_TESTS=ON"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["cmake", "--build", "--preset", preset, "--target", *targets], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)

    print("Milliseconds of a step: computing .. with all misses\n")
    print("| step | format | instructions, million | %s | budget |" % " | ".join("Cortex-" + core.name for core in CORES))
    print("|---|---|---|" + "---|" * len(CORES) + "---|")
    kept = True
    for name, picture, formats, teams, counted, budget in ROWS:
        for pixels in formats:
            instructions, times = estimate(picture, pixels, teams, counted, chunks)
            within = budget is None or times[0][1] <= budget
            kept = kept and within
            said = "" if budget is None else "%s: %.1f ms" % ("kept" if within else "NOT KEPT", budget)
            figures = " | ".join("%.2f .. %.2f" % both for both in times)
            print("| %s | %s | %.2f | %s | %s |" % (name, pixels, instructions / 1e6, figures, said), flush=True)
    sys.exit(0 if kept else 1)


main()
