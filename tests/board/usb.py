"""A USB camera: the kernel's driver for them, uvcvideo, and what tools/test-board asks of it."""
import pathlib
import re
import subprocess
import time

import guest

HERE = pathlib.Path(__file__).resolve().parent
CAMERA = "/dev/touchline/camera"  # as the package's udev rules name it
LOG = "usb.log"
BOARD = "/etc/touchline/usb.toml"
CONTROLS = ("camera.gain=40", "camera.white_balance_k=4000", "camera.focus=35", "camera.power_line=50hz")
# Hosts may be slow and the guest waits: only what the test does ends a stream.
SETTINGS = (f"camera.device={CAMERA}", "camera.rate_hz=15", "gpio.backend=none", "gpio.start_line=-1",
            "faults.camera_timeout_s=30", *CONTROLS)


class UsbCamera:
    """Steps after the game's; the arena is another one, whose camera is at the USB port."""

    def __init__(self, board, game, checks, folder, programs):
        self.game, self.checks, self.folder = game, checks, folder / "usb"
        self.run = board.run
        self.arena_program, self.camera_program = programs / "board-arena", programs / "board-usb-camera"
        self.heard = 0  # of the camera's log

    # What the steps are made of.

    def open_arena(self, pixels):
        """The arena draws in the format that the camera sends, or compresses."""
        self.folder.mkdir(exist_ok=True)
        for name in ("radio.sock", "usb.sock"):  # qemu's
            (self.folder / name).unlink(missing_ok=True)
            (self.folder / name).symlink_to(f"../{name}")
        pictures = self.folder / "pictures.sock"
        pictures.unlink(missing_ok=True)
        self.log = open(self.folder / "camera.log", "a", encoding="utf-8")
        self.camera = subprocess.Popen([str(self.camera_program), str(pictures), str(self.folder / "usb.sock")],
                                       stdout=self.log, stderr=self.log)
        while not pictures.exists() and self.camera.poll() is None:
            time.sleep(0.01)
        self.arena = guest.Arena(self.arena_program, HERE / "board.toml", self.folder,
                                 ["camera.rate_hz=15", f"camera.format={pixels}"])
        self.arena.ask("plug")
        self.run(f"timeout 60 sh -c 'until [ -e {CAMERA} ]; do sleep 0.05; done'; udevadm settle")

    def close_arena(self):
        self.arena.close()
        self.camera.wait(10)
        self.log.close()

    def set_exposure(self, exposure_us):
        self.run(f"sed 's/^exposure_us = .*/exposure_us = {exposure_us}/' /etc/touchline/board.toml >{BOARD}")

    def was_set(self):
        """What the camera was told since the last look, in its own words."""
        text = (self.folder / "camera.log").read_text(encoding="utf-8")
        new, self.heard = text[self.heard:], len(text)
        return new.splitlines()

    def command(self, frames, venue, *settings):
        words = " ".join(f"--set {setting}" for setting in (*SETTINGS, *settings))
        return f"touchline run --headless --board {BOARD} --venue {venue} --frames {frames} {words}"

    def start(self, *what):
        self.run(f"rm -f {LOG}; ({self.command(*what)} >{LOG} 2>&1; echo code $? >>{LOG}) &")
        self.tell("^camera:\\|^code")

    def tell(self, pattern):
        self.run(f"timeout 60 sh -c 'until grep -q \"{pattern}\" {LOG}; do sleep 0.05; done'", may_fail=True)

    def end(self):
        self.tell("^code")
        said = self.run(f"cat {LOG}")
        print("\n".join("  " + line for line in said.splitlines() if not re.match(r"\d+ s  ", line)))
        return said

    # The steps.

    def list_camera(self):
        self.game.close_arena()
        self.set_exposure(5000)
        self.run("modprobe xhci_pci")
        self.open_arena("yuyv")
        said = self.run("touchline-devices --camera")
        print(said)
        node, metadata = self.run(f"readlink -f {CAMERA}; readlink -f /dev/v4l/by-path/*-video-index1").split()
        self.checks.expect(f"{node}  Camera of a test (driver uvcvideo" in said,
                           f"udev loads uvcvideo and names the camera; touchline-devices has it: {node}")
        self.checks.expect(metadata not in said, f"its node for metadata, {metadata}, is not offered as a camera")
        for what, pattern in (
                ("YUYV, MJPG, sizes and rates", r"yuyv .*\n +640x480 at 15, 10 Hz\n +320x240.*\n +mjpg .*\n +640x480 at 15, 10 Hz"),
                ("a menu with holes", r"Auto Exposure +3 \(Aperture Priority Mode\) 1, 3 "),
                ("a control that an automatic keeps", r"Exposure Time, Absolute .*without effect now")):
            self.checks.expect(re.search(pattern, said), f"touchline-devices has {what}")
        said = self.run(self.command(1, "venue.toml", f"camera.device={metadata}") + " 2>&1", may_fail=True)
        self.checks.expect(re.search(rf"does not capture video; cameras here: .*{node} \(Camera of a test", said),
                           "asked for the metadata, touchline says what it is and which camera there is")
        self.was_set()

    def play_yuyv(self, frames=30):
        self.start(frames, "venue-yuv.toml", "camera.format=yuyv")
        first = self.arena.ask(f"drive {frames // 2}")
        self.fixed_controls(50, "power line: 1", "exposure mode: 1", "exposure before rate: 0", "exposure: 50", "gain: 40",
                            "automatic white balance: 0", "white balance: 4000", "automatic focus: 0", "focus: 35")
        self.tear_a_picture()
        self.set_exposure(8000)
        self.run("kill -HUP $(busybox pidof touchline)")
        second = self.arena.ask(f"drive {frames - frames // 2}")
        said = self.end()
        self.good_frames(frames, (first, second), said, "YUYV")
        self.checks.expect("reload: from frame" in said, "SIGHUP while it streams: another exposure, and no frame lost by it")
        self.fixed_controls(80, "exposure: 80")

    def tear_a_picture(self):
        """A packet is lost on the cable, as happens: the picture is of no use, and no other one suffers."""
        self.arena.ask("tear 1")
        self.run("sleep 0.2")

    def good_frames(self, frames, parts, said, what):
        shown = sum(part["shown"] for part in parts)
        letters = "".join(part["frames"] for part in parts)
        found = re.search(rf"frames +{frames} in .* 1 lost on the way, 0 not good", said)
        self.checks.expect(found and shown == frames and re.fullmatch("[dm]+", letters) and "code 0" in said,
                           f"{what}: {frames} pictures, a packet with speeds for each, and the torn one counted as lost: {letters}")

    def fixed_controls(self, exposure, *expected):
        """The camera refuses what an automatic keeps, so the order is right when nothing was."""
        told = {line for line in self.was_set() if not line.startswith("format")}
        self.checks.expect(told == set(expected), f"the camera was told, and refused nothing: {', '.join(sorted(told))}")
        values = {"auto_exposure": 1, "exposure_time_absolute": exposure, "gain": 40, "white_balance_temperature": 4000,
                  "focus_absolute": 35, "power_line_frequency": 1}
        said = self.run(f"v4l2-ctl -d {CAMERA} -C {','.join(values)}")
        found = {name: int(value) for name, value in re.findall(r"(\w+): (\d+)", said)}
        self.checks.expect(found == values, f"and has it, as v4l2-ctl reads back: {found}")

    def play_mjpg(self, frames=30):
        """Unplugged in the middle, and plugged in again with its old number taken."""
        self.close_arena()
        self.open_arena("mjpg")
        self.start(2 * frames, "venue.toml", "camera.format=mjpg")
        told = self.arena.ask(f"drive {frames}")
        self.checks.expect("format: mjpg" in self.was_set() and told["shown"] == frames,
                           f"MJPG, every other picture without Huffman tables: {told['frames']}")
        self.checks.expect(told["own_path_m"] > 0.1, f"robots moved {told['own_path_m']:.1f} m")
        before = self.run(f"exec 9<{CAMERA}; readlink -f {CAMERA}")
        self.arena.ask("unplug")
        self.tell("robots halted")
        stopped = self.arena.ask("blind 1")
        self.checks.expect(stopped["frames"] == "S", f"unplugged: {stopped['stops']} packets, all of them stop the robots")
        self.checks.expect(self.run("ls /dev/video* /dev/touchline/camera 2>&1 | grep -c 'No such'", may_fail=True) != "0",
                           "its nodes are gone")
        self.arena.ask("plug")
        self.tell("camera: is back")
        after = self.run(f"exec 9<&-; readlink -f {CAMERA}")
        again = self.arena.ask(f"drive {frames // 2}")
        self.checks.expect(before != after, f"plugged in again: it was {before}, is {after}, and the game goes on")
        self.tear_a_picture()
        more = self.arena.ask(f"drive {frames - frames // 2}")
        said = self.end()
        self.good_frames(2 * frames, (told, again, more), said, "MJPG")
        self.checks.expect("camera: corrupt frame, 1 times" in said, "the torn JPEG was seen to be damaged")
        self.close_arena()
