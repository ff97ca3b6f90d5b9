"""The steps of tools/test-board that record games on a disk that stands still, is full, or is gone."""
import re

import image

RATE = 5  # the guest decodes a picture in about a tenth of a second
PICTURES = 60
DISK = "/mnt/games"
# Largest p99 of the time from capture to packet, relative to that without a recording. In two runs, the games on all disks had
# 0.8 to 1.15 times it.
WORST = 1.3


def make_disk(path):
    """Makes an empty file system, the guest's second disk."""
    with open(path, "wb") as disk:
        disk.truncate(2 << 30)
    image.run("mke2fs", "-q", "-t", "ext4", "-m", 0, path)


def make_pictures(arena, folder):
    """Renders a game; returns the folder."""
    image.run(arena, "--out", folder, "--count", PICTURES, "--quiet", "match")
    return folder


class Recordings:
    def __init__(self, board, checks, frames):
        self.board, self.checks, self.frames = board, checks, frames
        self.usual = None  # p99 without a recording

    def install(self, packages):
        print(self.board.run("dpkg -i " + " ".join(f"./{package}" for package in packages)))
        self.board.run(f"mkdir pictures && i=0 && while [ $i -lt {self.frames} ]; do for one in match/*.png; do "
                       "ln -s ../$one pictures/$(printf %05d $i).png; i=$((i+1)); done; done")
        device = self.board.run("grep -lx games /sys/block/vd*/serial").split("/")[3]
        self.virtio = self.board.run(f"basename $(readlink -f /sys/block/{device}/device)")
        self.board.run(f"mkdir -p {DISK} && busybox mount -t ext4 /dev/{device} {DISK}")

    def play(self, name, meanwhile="", options=f"--record {DISK}"):
        """Plays the pictures, and returns the output. `meanwhile`: a command that begins some seconds after the first frame."""
        self.board.run(f"(touchline run --headless --board board.toml --set camera.backend=replay --set camera.device=pictures"
                       f" --set camera.rate_hz={RATE} --set radio.backend=none --set gpio.backend=none --set gpio.start_line=-1"
                       f" --set realtime.priority=80 --set realtime.lock_memory=true --set faults.stop_after_s={4 / RATE}"
                       f" --set recording.memory_mb=16 --frames {self.frames} {options} >record.log 2>&1; echo code $? >>record.log) &")
        self.board.run("timeout 60 sh -c 'until grep -q fps record.log; do sleep 0.2; done'; sleep 5")
        if meanwhile:
            print(self.board.run(meanwhile, may_fail=True))
        self.board.run("timeout 1000 sh -c 'until grep -q ^code record.log; do sleep 0.5; done'")
        output = self.board.run("cat record.log")
        self.board.run(f"rm -f {DISK}/*.mcap {DISK}/fill", may_fail=True)
        print(re.sub(r"(?m)^.*fps.*\n", "", output))
        self.check(name, output)
        return output

    def check(self, name, output):
        found = re.search(rf"frames +{self.frames} in .* 0 lost, 0 unusable", output)
        packets = int(re.search(r"packets +(\d+) sent", output)[1])
        self.checks.expect(found and packets >= self.frames and "code 0" in output, f"{name}: {self.frames} frames, {packets} packets, none lost")
        self.checks.expect("robots halted" not in output, f"{name}: the loop never stops the robots")
        summary = re.search("capture to send: .*", output)[0]
        p50, p99, p999 = (float(re.search(rf"{word} +([\d.]+)", summary)[1]) for word in ("p50", "p99", r"p99\.9"))
        self.usual = self.usual or p99
        self.checks.expect(p99 <= WORST * self.usual, f"{name}: capture to packet p99 {p99:.1f} ms, without a recording {self.usual:.1f} ms")
        self.checks.numbers.append(f"{name}: capture to packet p50 {p50:.2f}, p99 {p99:.2f}, p99.9 {p999:.2f} ms of the guest's clock")

    def play_all(self):
        self.play("no recording", options="")
        output = self.play("healthy disk")
        self.checks.expect(f" {self.frames} pictures" in output and "pictures lost" not in output, "all pictures are recorded")
        # The kernel holds back all writes to a frozen file system.
        output = self.play("disk that stands still for 5 s, three times",
                           "; ".join([f"fsfreeze -f {DISK}; sleep 5; fsfreeze -u {DISK}; sleep 2"] * 3))
        lost = re.search(r"(\d+) pictures, .* (\d+) pictures lost", output)
        self.checks.expect(lost and int(lost[1]) + int(lost[2]) == self.frames, "pictures that did not fit into the memory are counted")
        left = f"$(($(stat -f -c %a*%S {DISK}) - (8 << 20)))"
        output = self.play("full disk", f"fallocate -l {left} {DISK}/fill", f"--record {DISK} --set recording.reserve_mb=0")
        self.checks.expect(re.search(r"recording .*it ended early: .*No space left", output), "the end of the recording is reported")
        output = self.play("disk that is gone", f"echo {self.virtio} >/sys/bus/virtio/drivers/virtio_blk/unbind")
        self.checks.expect(re.search(r"recording .*it ended early: .*Input/output error", output), "the end of the recording is reported")
