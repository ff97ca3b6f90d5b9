"""The board in software: an arm64 guest under qemu, its console, its pins, and the arena on the host beside it."""
import json
import pathlib
import re
import select
import socket
import subprocess
import time

# The guest's clock counts instructions, two nanoseconds each: a board of 500 MIPS, however slow the emulation is.
ICOUNT = "shift=1,sleep=on"
# Nothing on the console but the shell; devices are announced when the test asks for them, not all at the start.
QUICKLY = ("quiet panic=-1 systemd.show_status=no systemd.mask=systemd-udev-trigger.service "
           "systemd.machine_id=00000000000000000000000000000001")
# Of this machine's time, for anything that the guest does: an emulated board may be a hundred times slower than a real one.
PATIENCE_S = 900
PL061_DATA = 0x90303FC  # data register of the virt board's GPIO chip, all eight lines


class Failed(Exception):
    """The board did not do what it should; the text says what."""


def connect(path, timeout_s=20.0):
    end = time.monotonic() + timeout_s
    while True:
        link = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            link.connect(str(path))
            return link
        except OSError as error:
            link.close()
            if time.monotonic() > end:
                raise Failed(f"{path}: {error.strerror}") from error
            time.sleep(0.05)


class Guest:
    def __init__(self, kernel, initrd, image, folder):
        self.folder = pathlib.Path(folder)
        for old in self.folder.glob("*.sock"):
            old.unlink()
        chardevs = []
        for name in ("console", "radio", "pictures", "usb"):
            chardevs += ["-chardev", f"socket,id={name},path={self.folder}/{name}.sock,server=on,wait=off"]
        command = [
            "qemu-system-aarch64", "-M", "virt", "-cpu", "cortex-a72", "-m", "1024", "-nic", "none", "-display", "none",
            "-no-reboot", "-icount", ICOUNT, "-rtc", "clock=vm", "-kernel", str(kernel), "-initrd", str(initrd),
            "-append", f"console=ttyAMA0 {QUICKLY}",
            "-drive", f"file={image},if=virtio,format=raw,snapshot=on", *chardevs, "-serial", "chardev:console",
            "-device", "pci-serial,chardev=radio", "-device", "virtio-serial-pci",
            "-device", "virtserialport,chardev=pictures,name=arena",
            "-device", "qemu-xhci,id=usb", "-device", "usb-redir,bus=usb.0,chardev=usb",
            "-qmp", f"unix:{self.folder}/qmp.sock,server=on,wait=off",
            "-qtest", f"unix:{self.folder}/qtest.sock,server=on,wait=off", "-qtest-log", "/dev/null"]
        self.log = open(self.folder / "console.log", "wb")
        self.qemu = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=open(self.folder / "qemu.log", "wb"),
                                     stderr=subprocess.STDOUT)
        self.console = connect(self.folder / "console.sock")
        self.qtest = connect(self.folder / "qtest.sock").makefile("rw")
        self.pins = None
        self.qmp = connect(self.folder / "qmp.sock").makefile("rw")
        self.said = b""
        self.marks = 0

    def close(self):
        self.qemu.terminate()
        try:
            self.qemu.wait(10)
        except subprocess.TimeoutExpired:
            self.qemu.kill()
            self.qemu.wait()
        self.log.close()

    # The console.

    def read_until(self, pattern, timeout_s):
        """The match; what was said until its end is used up."""
        end = time.monotonic() + timeout_s
        while not (found := re.search(pattern, self.said)):
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.console], [], [], left)[0]:
                raise Failed(f"the guest's console says nothing like {pattern!r}; last: {self.said[-400:]!r}")
            more = self.console.recv(65536)
            if not more:
                raise Failed(f"the guest ended; see {self.folder}/console.log")
            self.log.write(more)
            self.log.flush()
            self.said += more
        before = self.said[:found.start()]
        self.said = self.said[found.end():]
        return before

    def boot(self, timeout_s=PATIENCE_S):
        self.read_until(rb"[#$] $", timeout_s)
        self.run("PS1=; PS2=; cd /run/board")

    def run(self, command, timeout_s=PATIENCE_S, may_fail=False):
        """What the shell command printed; Failed when its exit code is not 0."""
        self.marks += 1
        mark = f"@@{self.marks}:"
        self.console.sendall(f"{command}\nprintf '\\n%s%d@@\\n' '{mark}' $?\n".encode())
        text = self.read_until(rf"\n?{mark}".encode(), timeout_s).decode(errors="replace").strip()
        code = int(self.read_until(rb"@@\r?\n", timeout_s))
        if code and not may_fail:
            raise Failed(f"in the guest, `{command}` ended with {code}: {text}")
        return text

    # The pins, from outside.

    def ask_qtest(self, line):
        self.qtest.write(line + "\n")
        self.qtest.flush()
        answer = self.qtest.readline().split()
        if not answer or answer[0] != "OK":
            raise Failed(f"qemu, to `{line}`: {answer}")
        return answer[1:]

    def ask_qmp(self, command, **arguments):
        self.qmp.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        self.qmp.flush()
        while True:
            answer = json.loads(self.qmp.readline())
            if "return" in answer:
                return answer["return"]
            if "error" in answer:
                raise Failed(f"qemu, to {command}: {answer['error']['desc']}")

    def find_pins(self):
        self.ask_qmp("qmp_capabilities")
        for child in self.ask_qmp("qom-list", path="/machine/unattached"):
            if child["type"] == "child<pl061>":
                self.pins = "/machine/unattached/" + child["name"]
                return
        raise Failed("this qemu's virt board has no PL061")

    def drive_pin(self, line, high):
        self.ask_qtest(f"set_irq_in {self.pins} unnamed-gpio-in {line} {int(high)}")

    def pins_now(self):
        """All eight, a bit each."""
        return int(self.ask_qtest(f"readl {PL061_DATA:#x}")[0], 16)


class Arena:
    """tests/board/arena_main.cpp"""

    def __init__(self, program, board, folder, overrides):
        self.log = open(pathlib.Path(folder) / "arena.log", "w")
        self.process = subprocess.Popen(
            [str(program), str(board), f"{folder}/pictures.sock", f"{folder}/radio.sock", *overrides],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log, text=True)

    def ask(self, line, meanwhile=None):
        """What came of it, as a dictionary. `meanwhile`: called again and again until there is an answer."""
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        while meanwhile is not None and not select.select([self.process.stdout], [], [], 0)[0]:
            meanwhile()
        answer = self.process.stdout.readline()
        self.log.write(f"{line}: {answer}")
        self.log.flush()
        if not answer:
            raise Failed(f"the arena ended; see {self.log.name}")
        told = json.loads(answer)
        if told["error"]:
            raise Failed(f"arena, {line}: {told['error']}")
        return told

    def close(self):
        self.process.stdin.close()
        self.process.wait(10)
        self.log.close()
