"""The steps of tools/test-board with a USB camera (the kernel's driver uvcvideo), and their checks."""
import pathlib
import re
import subprocess
import time

import guest

HERE = pathlib.Path(__file__).resolve().parent
CAMERA = "/dev/touchline/camera"  # the name from the package's udev rules
LOG = "usb.log"
BOARD = "/etc/touchline/usb.toml"
CONTROLS = ("camera.gain=40", "camera.white_balance_k=4000", "camera.focus=35", "camera.power_line=50hz")
# A long timeout, because the guest waits for a slow host: only the test may end a stream.
SETTINGS = (f"camera.device={CAMERA}", "camera.rate_hz=15", "gpio.backend=none", "gpio.start_line=-1",
            "faults.camera_timeout_s=30", *CONTROLS)


class UsbCamera:
    """Steps after those of the game, with another arena, whose camera is a USB camera."""

    def __init__(self, board, game, checks, folder, programs):
        self.game, self.checks, self.folder = game, checks, folder / "usb"
        self.run = board.run
        self.arena_program, self.camera_program = programs / "board-arena", programs / "board-usb-camera"
        self.log_position = 0  # characters of the camera's log that were read

    # Parts of the steps.

    def open_arena(self, pixels):
        """Starts arena and camera. `pixels`: yuyv, or rgb24, which the camera compresses."""
        self.folder.mkdir(exist_ok=True)
        for name in ("radio.sock", "usb.sock"):  # the sockets of qemu
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

    def new_requests(self):
        """Returns the lines of the camera's log since the last call: the requests of the driver."""
        text = (self.folder / "camera.log").read_text(encoding="utf-8")
        new, self.log_position = text[self.log_position:], len(text)
        return new.splitlines()

    def command(self, frames, venue, *settings):
        words = " ".join(f"--set {setting}" for setting in (*SETTINGS, *settings))
        return f"touchline run --headless --board {BOARD} --venue {venue} --frames {frames} {words}"

    def start(self, *what):
        self.run(f"rm -f {LOG}; ({self.command(*what)} >{LOG} 2>&1; echo code $? >>{LOG}) &")
        self.wait_for_log("^camera:\\|^code")

    def wait_for_log(self, pattern):
        self.run(f"timeout 60 sh -c 'until grep -q \"{pattern}\" {LOG}; do sleep 0.05; done'", may_fail=True)

    def end(self):
        self.wait_for_log("^code")
        output = self.run(f"cat {LOG}")
        print("\n".join("  " + line for line in output.splitlines() if not re.match(r"\d+ s  ", line)))
        return output

    # The steps.

    def list_camera(self):
        self.game.close_arena()
        self.set_exposure(5000)
        self.run("modprobe xhci_pci")
        self.open_arena("yuyv")
        output = self.run("touchline-devices --camera")
        print(output)
        node, metadata = self.run(f"readlink -f {CAMERA}; readlink -f /dev/v4l/by-path/*-video-index1").split()
        self.checks.expect(f"{node}  Camera of a test (driver uvcvideo" in output,
                           f"udev loads uvcvideo and names the camera; touchline-devices has it: {node}")
        self.checks.expect(metadata not in output, f"its metadata node, {metadata}, is not listed as a camera")
        for what, pattern in (
                ("YUYV, MJPG, sizes and rates", r"yuyv .*\n +640x480 at 15, 10 Hz\n +320x240.*\n +mjpg .*\n +640x480 at 15, 10 Hz"),
                ("a menu with holes", r"Auto Exposure +3 \(Aperture Priority Mode\) 1, 3 "),
                ("a control that is inactive while automatic exposure is on", r"Exposure Time, Absolute .*without effect now")):
            self.checks.expect(re.search(pattern, output), f"touchline-devices has {what}")
        output = self.run(self.command(1, "venue.toml", f"camera.device={metadata}") + " 2>&1", may_fail=True)
        self.checks.expect(re.search(rf"does not capture video; available cameras: .*{node} \(Camera of a test", output),
                           "with the metadata node, touchline reports the node and the camera that exists")
        self.new_requests()

    def play_yuyv(self, frames=30):
        self.start(frames, "venue-yuv.toml", "camera.format=yuyv")
        first = self.arena.ask(f"drive {frames // 2}")
        self.fixed_controls(50, "power line: 1", "exposure mode: 1", "auto-exposure priority: 0", "exposure: 50", "gain: 40",
                            "automatic white balance: 0", "white balance: 4000", "automatic focus: 0", "focus: 35")
        self.tear_a_picture()
        self.set_exposure(8000)
        self.run("kill -HUP $(busybox pidof touchline)")
        second = self.arena.ask(f"drive {frames - frames // 2}")
        output = self.end()
        self.good_frames(frames, (first, second), output, "YUYV")
        self.checks.expect("reload: from frame" in output, "SIGHUP while it streams: another exposure, and no frame lost by it")
        self.fixed_controls(80, "exposure: 80")

    def tear_a_picture(self):
        """Loses one packet on the cable: that picture is incomplete, the others are not affected."""
        self.arena.ask("tear 1")
        self.run("sleep 0.2")

    def good_frames(self, frames, parts, output, what):
        shown = sum(part["shown"] for part in parts)
        letters = "".join(part["frames"] for part in parts)
        found = re.search(rf"frames +{frames} in .* 1 lost, 0 unusable", output)
        self.checks.expect(found and shown == frames and re.fullmatch("[dm]+", letters) and "code 0" in output,
                           f"{what}: {frames} pictures, a packet with speeds for each, the incomplete one counted as lost: {letters}")

    def fixed_controls(self, exposure, *expected):
        """Checks the controls. The camera refuses a control whose automatic mode is on, so no refusal means that the order was right."""
        result = {line for line in self.new_requests() if not line.startswith("format")}
        self.checks.expect(result == set(expected), f"the camera got these controls and refused none: {', '.join(sorted(result))}")
        values = {"auto_exposure": 1, "exposure_time_absolute": exposure, "gain": 40, "white_balance_temperature": 4000,
                  "focus_absolute": 35, "power_line_frequency": 1}
        output = self.run(f"v4l2-ctl -d {CAMERA} -C {','.join(values)}")
        found = {name: int(value) for name, value in re.findall(r"(\w+): (\d+)", output)}
        self.checks.expect(found == values, f"v4l2-ctl reads back: {found}")

    def play_mjpg(self, frames=30):
        """Streams MJPG. The camera is unplugged in between and plugged in again while its old number is in use."""
        self.close_arena()
        self.open_arena("rgb24")
        self.start(2 * frames, "venue-mjpg.toml", "camera.format=mjpg")
        result = self.arena.ask(f"drive {frames}")
        self.checks.expect("format: mjpg" in self.new_requests() and result["shown"] == frames,
                           f"MJPG, every other picture without Huffman tables: {result['frames']}")
        self.checks.expect(result["own_path_m"] > 0.1, f"robots moved {result['own_path_m']:.1f} m")
        before = self.run(f"exec 9<{CAMERA}; readlink -f {CAMERA}")
        self.arena.ask("unplug")
        self.wait_for_log("robots halted")
        stopped = self.arena.ask("blind 1")
        self.checks.expect(stopped["frames"] == "S", f"unplugged: {stopped['stops']} packets, all of them stop the robots")
        self.checks.expect(self.run("ls /dev/video* /dev/touchline/camera 2>&1 | grep -c 'No such'", may_fail=True) != "0",
                           "its device nodes are gone")
        self.arena.ask("plug")
        self.wait_for_log("camera: reopened")
        after = self.run(f"exec 9<&-; readlink -f {CAMERA}")
        again = self.arena.ask(f"drive {frames // 2}")
        self.checks.expect(before != after, f"plugged in again: it was {before}, is {after}, and the game goes on")
        self.tear_a_picture()
        more = self.arena.ask(f"drive {frames - frames // 2}")
        output = self.end()
        self.good_frames(2 * frames, (result, again, more), output, "MJPG")
        self.checks.expect("camera: corrupt frame, 1 times" in output, "the incomplete JPEG was reported")
        self.close_arena()
