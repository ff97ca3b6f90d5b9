"""The emulated board: an arm64 guest under qemu with its console and GPIO pins, and the arena on the host."""
import json
import pathlib
import re
import select
import socket
import subprocess
import time

# The guest's clock counts instructions of 2 ns each, like a board with 500 MIPS, at any speed of the emulation.
ICOUNT = "shift=1,sleep=on"
# The console shows only the shell. udev announces devices when the test triggers it, not all at the start.
KERNEL_OPTIONS = ("quiet panic=-1 systemd.show_status=no systemd.mask=systemd-udev-trigger.service "
           "systemd.machine_id=00000000000000000000000000000001 "
           # The feeder reads the pins of a chip that the kernel drives.
           "iomem=relaxed")
# Longest time for a step of the guest, in the host's time: an emulated board can be a hundred times slower than a real one.
TIMEOUT_S = 900
ADDRESS, HOST = "10.0.2.15", "10.0.2.2"  # the guest and this computer, in qemu's network
PL061_DATA = 0x90303FC  # data register of the virt board's GPIO chip, all eight lines


class Failed(Exception):
    """The board failed in a step; the text describes it."""


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
    """`network`: how the guest's network ends, in the words of qemu's `-netdev user`; None: there is none. `radio_is_pty`: the UART's other
    end is a pseudo terminal, `self.radio`, and no socket. `disk`: image of a second disk, whose serial number is "games"."""

    def __init__(self, kernel, initrd, image, folder, network=None, radio_is_pty=False, disk=None):
        self.folder = pathlib.Path(folder)
        for old in self.folder.glob("*.sock"):
            old.unlink()
        chardevs = []
        for name in ("console", "radio", "usbradio", "pictures", "usb"):
            if name == "radio" and radio_is_pty:
                chardevs += ["-chardev", "pty,id=radio"]
                continue
            chardevs += ["-chardev", f"socket,id={name},path={self.folder}/{name}.sock,server=on,wait=off"]
        devices = ["-nic", "none"] if network is None else ["-netdev", f"user,id=net,{network}", "-device", "virtio-net-pci,netdev=net"]
        if disk is not None:
            devices += ["-drive", f"file={disk},if=none,id=games,format=raw", "-device", "virtio-blk-pci,drive=games,serial=games"]
        command = [
            "qemu-system-aarch64", "-M", "virt", "-cpu", "cortex-a72", "-m", "1024", "-display", "none",
            "-no-reboot", "-icount", ICOUNT, "-rtc", "clock=vm", "-kernel", str(kernel), "-initrd", str(initrd),
            "-append", f"console=ttyAMA0 {KERNEL_OPTIONS}",
            "-drive", f"file={image},if=none,id=root,format=raw,snapshot=on", "-device", "virtio-blk-pci,drive=root",
            *devices, *chardevs, "-serial", "chardev:console",
            "-device", "pci-serial,chardev=radio", "-device", "virtio-serial-pci",
            "-device", "virtserialport,chardev=pictures,name=arena",
            "-device", "qemu-xhci,id=usb", "-device", "usb-redir,bus=usb.0,chardev=usb",
            # Plugged in while somebody is connected to its socket.
            "-device", "usb-serial,bus=usb.0,chardev=usbradio,serial=A1",
            "-qmp", f"unix:{self.folder}/qmp.sock,server=on,wait=off",
            "-qtest", f"unix:{self.folder}/qtest.sock,server=on,wait=off", "-qtest-log", "/dev/null"]
        self.log = open(self.folder / "console.log", "wb")
        self.qemu = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=open(self.folder / "qemu.log", "wb"),
                                     stderr=subprocess.STDOUT)
        self.console = connect(self.folder / "console.sock")
        self.qtest = connect(self.folder / "qtest.sock").makefile("rw")
        self.pins = None
        self.qmp = connect(self.folder / "qmp.sock").makefile("rw")
        self.console_text = b""
        self.marks = 0
        if radio_is_pty:
            self.radio = re.search(r"(/dev/pts/\d+) \(label radio\)", (self.folder / "qemu.log").read_text())[1]

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
        """Waits for the pattern on the console. Returns the text before it and removes both from the buffer."""
        end = time.monotonic() + timeout_s
        while not (found := re.search(pattern, self.console_text)):
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.console], [], [], left)[0]:
                raise Failed(f"the guest's console shows no {pattern!r}; its last text: {self.console_text[-400:]!r}")
            more = self.console.recv(65536)
            if not more:
                raise Failed(f"the guest ended; see {self.folder}/console.log")
            self.log.write(more)
            self.log.flush()
            self.console_text += more
        before = self.console_text[:found.start()]
        self.console_text = self.console_text[found.end():]
        return before

    def boot(self, timeout_s=TIMEOUT_S):
        self.read_until(rb"[#$] $", timeout_s)
        self.run("PS1=; PS2=; cd /run/board")

    def run(self, command, timeout_s=TIMEOUT_S, may_fail=False):
        """Runs a shell command in the guest and returns its output. Raises Failed if its exit code is not 0."""
        self.marks += 1
        mark = f"@@{self.marks}:"
        self.console.sendall(f"{command}\nprintf '\\n%s%d@@\\n' '{mark}' $?\n".encode())
        text = self.read_until(rf"\n?{mark}".encode(), timeout_s).decode(errors="replace").strip()
        code = int(self.read_until(rb"@@\r?\n", timeout_s))
        if code and not may_fail:
            raise Failed(f"in the guest, `{command}` ended with {code}: {text}")
        return text

    def bring_up_network(self):
        self.run("modprobe -a virtio_net virtio_console && udevadm settle && interface=$(ls /sys/class/net | grep -v lo) &&"
                 " busybox ip link set $interface up &&"
                 f" busybox ip addr add {ADDRESS}/24 dev $interface && busybox ip route add default via {HOST}")

    # The GPIO pins, driven and read from outside the guest.

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
        """Returns the levels of all eight pins, one bit each."""
        return int(self.ask_qtest(f"readl {PL061_DATA:#x}")[0], 16)


class Arena:
    """The program tests/board/arena_main.cpp, which takes one command per line."""

    def __init__(self, program, board, folder, overrides):
        self.log = open(pathlib.Path(folder) / "arena.log", "w")
        self.process = subprocess.Popen(
            [str(program), str(board), f"{folder}/pictures.sock", f"{folder}/radio.sock", *overrides],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log, text=True)

    def ask(self, line, meanwhile=None):
        """Sends a command and returns its result as a dictionary. Calls `meanwhile` repeatedly until the answer arrives."""
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        while meanwhile is not None and not select.select([self.process.stdout], [], [], 0)[0]:
            meanwhile()
        answer = self.process.stdout.readline()
        self.log.write(f"{line}: {answer}")
        self.log.flush()
        if not answer:
            raise Failed(f"the arena ended; see {self.log.name}")
        result = json.loads(answer)
        if result["error"]:
            raise Failed(f"arena, {line}: {result['error']}")
        return result

    def close(self):
        self.process.stdin.close()
        self.process.wait(10)
        self.log.close()
