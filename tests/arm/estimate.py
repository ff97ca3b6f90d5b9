"""Estimates the cost of the scan on Raspberry Pi 4 and 5 (tools/estimate-arm)."""

import argparse
import concurrent.futures
import os
import re
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.join(ROOT, "build", "arm64")
PROGRAM = os.path.join(BUILD, "tests", "arm", "scan_field")
MCA = "llvm-mca-19"
PIXELS = 640 * 480
FRAME_BYTES = {"rgb24": 3 * PIXELS, "yuyv": 2 * PIXELS, "nv12": PIXELS * 3 // 2}

# LLVM's model of each core; assumed clock in Hz and memory bandwidth of one core in bytes/s.
CORES = {"A72": "cortex-a72", "A76": "neoverse-n1"}
BOARDS = [("Pi 4, 1.5 GHz", "A72", 1.5e9, 4e9), ("Pi 4, 1.8 GHz", "A72", 1.8e9, 4e9), ("Pi 5, 2.4 GHz", "A76", 2.4e9, 8e9)]

# The simulation of a chunk starts with an empty pipeline; a chunk is long enough to make that negligible.
CHUNK = 4000


def core_ranges():
    """Returns the address ranges of the functions that may run between the marks; qemu logs only these."""
    names = subprocess.run(["aarch64-linux-gnu-nm", "-C", "-n", PROGRAM], capture_output=True, text=True, check=True)
    ranges = []
    inside = False
    for line in names.stdout.splitlines():
        address, kind, name = line.split(maxsplit=2)
        if kind not in "tTwWi":
            continue
        wanted = re.search(r"trace_|mem(cpy|set|move)", name) or ("touchline::" in name and "testing" not in name)
        if wanted and not inside:
            ranges.append(["0x" + address, None])
        if not wanted and inside:
            ranges[-1][1] = "0x%x" % (int(address, 16) - 1)
        inside = bool(wanted)
    return ",".join("..".join(one) for one in ranges if one[1])


def trace(words, ranges):
    """Returns the instructions that ran between the marks, in order."""
    command = ["qemu-aarch64-static", "-cpu", "cortex-a72", "-d", "exec,in_asm,nochain", "-dfilter", ranges]
    run = subprocess.Popen(command + [PROGRAM] + words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
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
    if run.wait() != 0 or not ran:
        sys.exit("tools/estimate-arm: %s found nothing to trace" % " ".join(words))
    return [instruction for address in ran for instruction in blocks[address]]


# The assembler expects a distance where the log has an address; the distance does not matter, since the trace has the next instruction.
# llvm-mca counts a hundred cycles for a call, because it does not see the called function; in the trace it follows.
CALL = re.compile(r"^(bl|blr|br|ret)\b.*$")
BRANCH = re.compile(r"^(b|b\.\w+|cbn?z|tbn?z|adrp?)(\s.*)#0x[0-9a-f]+$|^(b|b\.\w+)(\s+)#0x[0-9a-f]+$")


def assembly(instruction):
    instruction = CALL.sub("b #0", instruction)
    return BRANCH.sub(lambda found: (found[1] or found[3]) + (found[2] or found[4]) + "#0", instruction)


def cycles(chunk, core):
    text = "\n".join(map(assembly, chunk)) + "\n"
    command = [MCA, "-mtriple=aarch64-linux-gnu", "-mcpu=" + CORES[core], "-iterations=1", "-instruction-info=0",
               "-resource-pressure=0"]
    said = subprocess.run(command, input=text, capture_output=True, text=True)
    counted = re.search(r"Instructions: +(\d+)\nTotal Cycles: +(\d+)", said.stdout)
    if not counted or int(counted[1]) != len(chunk):
        sys.exit("tools/estimate-arm: %s could not read the instructions:\n%s" % (MCA, said.stderr[:2000]))
    return int(counted[2])


def cycles_of(instructions, sample):
    """Returns the cycles of all instructions by core, extrapolated from every sample-th chunk."""
    chunks = [instructions[i:i + CHUNK] for i in range(0, len(instructions), CHUNK)]
    chosen = chunks[sample // 2::sample] or chunks
    part = sum(map(len, chosen)) / len(instructions)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return {core: sum(pool.map(lambda chunk: cycles(chunk, core), chosen)) / part for core in CORES}


def at_least_one(text):
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError("%r is no whole number of at least 1" % text)
    return int(text)


def main():
    options = argparse.ArgumentParser(prog="tools/estimate-arm")
    options.add_argument("--sample", type=at_least_one, default=8, metavar="N", help="simulate every N-th 4,000 instructions (8)")
    sample = options.parse_args().sample

    with open(os.devnull, "w") as nowhere:
        subprocess.run(["cmake", "--preset", "arm64"], cwd=ROOT, check=True, stdout=nowhere)
        subprocess.run(["cmake", "--build", BUILD, "--target", "scan_field"], check=True, stdout=nowhere)
    ranges = core_ranges()

    print("Cycles a pixel (llvm-mca) if one step of the NEON kernel decides every pixel\n")
    print("| step | light map | instructions | %s |" % " | ".join("Cortex-" + core for core in CORES))
    print("|---|---|---|" + "---|" * len(CORES))
    for pixels in FRAME_BYTES:
        for step, name in (("background", "background box"), ("nibbles", "high nibbles"), ("colors", "exact, 13 classes")):
            for light in ("none", "map") if step == "background" else ("none",):
                ran = trace([pixels, step, "neon", light, "classify"], ranges)
                spent = cycles_of(ran, max(1, len(ran) // (5 * CHUNK)))
                figures = " | ".join("%.2f" % (spent[core] / PIXELS) for core in CORES)
                print("| %s, %s | %s | %.2f | %s |" % (pixels, name, "yes" if light == "map" else "no", len(ran) / PIXELS,
                                                      figures), flush=True)

    print("\nA field, classification and regions: estimated milliseconds a frame, + to fetch it from memory\n")
    print("| field 640x480 | instructions, million | %s |" % " | ".join(board for board, *_ in BOARDS))
    print("|---|---|" + "---|" * len(BOARDS))
    for pixels, kernel, light in [(pixels, "neon", light) for pixels in FRAME_BYTES for light in ("none", "map")] + \
                                 [("rgb24", "portable", "none")]:
        ran = trace([pixels, "field", kernel, light, "scan"], ranges)
        spent = cycles_of(ran, sample)
        figures = ["%.2f + %.2f" % (1e3 * spent[core] / hertz, 1e3 * FRAME_BYTES[pixels] / read)
                   for _, core, hertz, read in BOARDS]
        name = pixels + (", light map" if light == "map" else "") + (", portable kernel" if kernel != "neon" else "")
        print("| %s | %.2f | %s |" % (name, len(ran) / 1e6, " | ".join(figures)), flush=True)


main()
