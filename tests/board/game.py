"""The steps of tools/test-board with the game's camera and vivid, and their checks."""
import json
import math
import pathlib
import re

import guest

HERE = pathlib.Path(__file__).resolve().parent
MOCK = HERE.parent.parent / "boards" / "mock"
LED, STROBE, EMERGENCY, START = 1, 2, 3, 5  # as in board.toml
FORMATS = {"yuyv": "YUYV", "uyvy": "UYVY", "nv12": "NV12", "rgb24": "RGB3", "bgr24": "BGR3"}
SETTLE = "udevadm settle --timeout=60"
LOG = "journalctl -u touchline -o cat --no-pager"


def payload():
    """Returns the files that are copied to /run/board in the guest."""
    return [HERE / "board.toml", HERE / "board.rules", HERE / "board-shell.service",
            *(MOCK / name for name in ("venue.toml", "venue-light.png", "venue-field.png", "venue-mjpg.toml", "venue-mjpg-field.png",
                                   "team.toml"))]


class Checks:
    def __init__(self):
        self.passed = self.failed = 0
        self.numbers = []

    def expect(self, holds, text):
        print(f"{'  ok    ' if holds else '  FAILED'}  {text}", flush=True)
        self.passed += bool(holds)
        self.failed += not holds

    def summary(self, logs):
        print(f"{self.passed} checks passed, {self.failed} failed; logs in {logs}")
        for line in self.numbers:
            print("  " + line)
        return 1 if self.failed else 0


class Game:
    def __init__(self, board, checks, arena, folder):
        self.board, self.checks, self.folder = board, checks, folder
        self.arena_program, self.arena = arena, None
        self.frames = self.packets = 0

    def run(self, command, **more):
        return self.board.run(command, **more)

    def wait_for_log(self, pattern, seconds=60):
        """Waits until the service's log contains the pattern; `seconds` of the guest's clock at most."""
        self.run(f"timeout {seconds} sh -c 'until {LOG} | grep -q \"{pattern}\"; do sleep 0.05; done'")

    def ask(self, line, meanwhile=None):
        result = self.arena.ask(line, meanwhile)
        self.frames += result["shown"]
        self.packets += result["packets"]
        return result

    def close_arena(self):
        """Ends the arena, so that another one can connect to the radio."""
        if self.arena is not None:
            self.arena.close()
        self.arena = None

    # The steps.

    def boot(self):
        self.board.boot()
        self.board.find_pins()
        print(self.run("uname -srm; systemctl is-system-running || true"))
        self.checks.expect(self.run("uname -m") == "aarch64", "an aarch64 kernel of Debian runs")

    def install(self, packages):
        print(self.run("dpkg -i " + " ".join(f"./{package}" for package in packages)))
        self.checks.expect(self.run("dpkg-query -W -f '${db:Status-Status} ' touchline touchline-tools") == "installed installed",
                           f"{' and '.join(packages)} are installed by dpkg, in the guest")
        self.run("mkdir -p /etc/touchline && cp board.toml venue.toml venue-light.png venue-field.png team.toml /etc/touchline/ &&"
                 " sed 's/^space = .*/space = \"yuv\"/' venue.toml >venue-yuv.toml")
        output = self.run("touchline check --board /etc/touchline/board.toml")
        self.checks.expect("are valid" in output and "neon" in output, "touchline check: files are valid, NEON kernel")

    def list_devices(self):
        self.run("cp board.rules /etc/udev/rules.d/99-board.rules && udevadm control --reload")
        # Two devices that only capture, the second one multi-planar.
        self.run("modprobe vivid n_devs=2 node_types=0x1,0x1 num_inputs=1,1 input_types=0,0 multiplanar=1,2")
        self.load_loopback(0)
        self.run("modprobe virtio_console")
        self.run("udevadm trigger --action=add --subsystem-match=video4linux --subsystem-match=gpio --subsystem-match=virtio-ports &&"
                 f" udevadm trigger --action=add --sysname-match=ttyS0 && {SETTLE}")
        self.start_feeder()
        overrides = ["camera.rate_hz=30"]
        self.arena = guest.Arena(self.arena_program, HERE / "board.toml", self.folder, overrides)
        self.arena.ask("plug")
        print(self.run("ls -l /dev/video* /dev/arena-camera /dev/gpiochip* /dev/ttyS0 | cut -c1-60,80-"))
        for device in self.run("ls /dev/video*").split():
            name = self.run(f"cat /sys/class/video4linux/{device.removeprefix('/dev/')}/name").strip()
            if name.startswith("vivid"):
                self.vivid = getattr(self, "vivid", []) + [device]
        self.checks.expect(len(self.vivid) == 2, f"vivid's cameras: {', '.join(self.vivid)}")
        output = self.run("touchline-devices", may_fail=True)
        print("\n".join(line for line in output.splitlines() if re.match(r"\S|  /", line)))
        for name in ("Arena", "vivid", "/dev/ttyS0", "gpiochip0"):
            self.checks.expect(name in output, f"touchline-devices names {name}")

    def start_feeder(self, led=""):
        self.run(f"(./board-feeder /dev/virtio-ports/arena /dev/arena-camera {led} >feeder.log 2>&1 & echo $! >feeder.pid)")

    def load_loopback(self, number):
        # As many buffers as the program requests: with fewer, the module confuses its first frames.
        self.run(f"modprobe v4l2loopback video_nr={number} card_label=Arena exclusive_caps=0 max_buffers=4 && {SETTLE}")

    def watch_vivid(self, device, frames, *settings):
        return self.run(f"{self.vivid_command(device, frames, *settings)} 2>&1", may_fail=True)

    def vivid_command(self, device, frames, *settings):
        """Returns a command that streams from vivid. Its color boxes only need the color space of the format."""
        venue = "venue.toml" if any("rgb24" in s or "bgr24" in s for s in settings) else "venue-yuv.toml"
        words = " ".join(f"--set {setting}" for setting in (
            f"camera.device={device}", "radio.backend=none", "gpio.backend=none", "camera.rate_hz=15", *settings))
        return f"touchline run --headless --board /etc/touchline/board.toml --venue {venue} --frames {frames} {words}"

    def try_formats(self):
        for device, planes in zip(self.vivid, ("one plane", "several planes")):
            for word, fourcc in FORMATS.items():
                output = self.watch_vivid(device, 5, f"camera.format={word}")
                found = re.search(r"frames +(\d+) in .* (\d+) lost", output)
                pixels = self.run(f"v4l2-ctl -d {device} --get-fmt-video", may_fail=True)
                self.checks.expect(found is not None and found[1] == "5" and f"'{fourcc}'" in pixels,
                                   f"{device} ({planes}), {word}: 5 frames" if found else f"{device} {word}: {output[-600:]}")
        self.read_back_controls()

    def read_back_controls(self):
        device = self.vivid[0]
        for value in (40, 200):
            output = self.watch_vivid(device, 2, "camera.format=yuyv", f"camera.gain={value}")
            is_set = self.run(f"v4l2-ctl -d {device} -C gain,gain_automatic")
            self.checks.expect(f"gain: {value}" in is_set and "gain_automatic: 0" in is_set,
                               f"gain {value} is set and automatic gain is off (read back by v4l2-ctl)")
        output = self.watch_vivid(device, 2, "camera.format=yuyv", "camera.gain=9999")
        self.checks.expect("gain = 9999: set to 255" in output, "gain 9999: 255 is set and reported")

    def unplug_vivid(self):
        name = "vivid.0"
        device = f"/dev/v4l/by-path/platform-{name}-video-index0"
        command = self.vivid_command(device, 40, "camera.format=yuyv")
        self.run(f"({command} >vivid.log 2>&1; echo code $? >>vivid.log) &")
        wait = "timeout 60 sh -c 'until grep -q \"{}\" vivid.log; do sleep 0.1; done'"
        self.run(wait.format("fps"), may_fail=True)
        self.run(f"echo {name} >/sys/bus/platform/drivers/vivid/unbind")
        self.run(wait.format("reopening it"), may_fail=True)
        self.run(f"echo {name} >/sys/bus/platform/drivers/vivid/bind")
        self.run(wait.format("^code"), may_fail=True)
        output = self.run("cat vivid.log")
        print(output)
        self.checks.expect("code 0" in output and re.search(r"frames +40 in", output),
                           "unplugged and plugged in again while it streams: 40 frames, exit code 0")

    def play(self, frames):
        self.run("systemctl start --no-block touchline")
        self.wait_for_log("^camera\\|^board")
        begin = self.ask("play 10")
        self.checks.expect(begin["stops"] == begin["packets"] == 10, f"robots do not move before the start button is pressed: {begin['frames']}")
        self.board.drive_pin(START, True)
        begin = self.ask("play 20")
        self.board.drive_pin(START, False)
        self.checks.expect(re.fullmatch("s{0,3}m?d+", begin["frames"]), f"pressed: robots move: {begin['frames']}")
        self.checks.expect(self.run("systemctl is-active touchline") == "active",
                           "systemd counts the service as started, after its first good frame")
        parts, own = [], 0
        for part in (frames // 4, frames // 4, frames - frames // 4 * 2):
            parts.append(self.ask(f"play {part}"))
            own = max(own, self.own_seen())
        result = {**parts[-1], **{key: sum(part[key] for part in parts)
                                for key in ("shown", "packets", "stops", "late", "own_path_m")}}
        self.checks.expect(own == 5, f"robots seen, the best of three samples: {own} of 5")
        self.checks.expect(result["shown"] == frames == result["packets"] and result["stops"] == 0,
                           f"{frames} frames: {result['packets']} packets with speeds, none missing")
        self.checks.expect(result["damaged_bytes"] == 0 and result["sequence_gaps"] == 0,
                           "no packet damaged and none missing in the sequence on the UART")
        self.checks.expect(result["own_path_m"] > 1.0, f"robots moved {result['own_path_m']:.1f} m")
        self.checks.expect(result["touches"] > 0, f"the ball was touched {result['touches']} times")
        self.compare(result)
        self.numbers(result)

    def status(self):
        return self.run("systemctl show -p StatusText --value touchline")

    def own_seen(self):
        found = re.search(r"own (\d)/5", self.status())
        return int(found[1]) if found else 0

    def compare(self, result):
        """Compares the reported position of the ball with its true path."""
        status = self.status()
        print("  " + status)
        found = re.search(r"ball \((-?[\d.]+), (-?[\d.]+)\)", status)
        if found is None:
            self.checks.expect(False, "the ball is seen")
            return
        seen = float(found[1]), float(found[2])
        # The status is at most one second old and rounded to centimeters.
        off = min(math.dist(seen, place) for place in result["ball"][-40:])
        self.checks.expect(off < 0.015, f"the ball is seen {1000 * off:.0f} mm from its path")

    def numbers(self, result):
        print(f"  {result['shown']} frames: {result['packets']} packets ({result['stops']} stops), own robots moved "
              f"{result['own_path_m']:.2f} m, ball {result['ball_path_m']:.2f} m, {result['late']} frames late")

    def watch_pins(self):
        """Samples the pins during 40 frames: the status light blinks once a second, the strobe is high from a frame to its packet."""
        seen = []
        self.ask("play 40", lambda: seen.append(self.board.pins_now()))
        for line, name in ((LED, "status light"), (STROBE, "strobe")):
            levels = [pins >> line & 1 for pins in seen]
            changes = sum(a != b for a, b in zip(levels, levels[1:]))
            self.checks.expect(changes >= 2, f"{name}: {changes} changes in {len(seen)} samples from outside, 40 frames")

    def pull_emergency_stop(self):
        self.watch_pins()
        self.board.drive_pin(EMERGENCY, True)
        result = self.ask("play 10")
        pulled = result["frames"]
        # The loop reads the line after it has processed a frame, which takes longer here than the debounce time.
        self.checks.expect(re.fullmatch("s+", pulled), f"pulled: stopped with the next frame's packet: {pulled}")
        self.board.drive_pin(EMERGENCY, False)
        released = self.ask("play 15")["frames"]
        self.checks.expect(re.fullmatch("s+", released), f"released: robots stay until the start button is pressed: {released}")
        self.board.drive_pin(START, True)
        started = self.ask("play 20")["frames"]
        self.board.drive_pin(START, False)
        self.checks.expect(re.fullmatch("s{0,3}m?d+", started), f"pressed: robots move again: {started}")
        self.ask("play 20")

    def reload_module(self):
        self.arena.ask("unplug")
        result = self.ask("blind 40")
        self.checks.expect("S" in result["frames"], f"no frames: stop packets: {result['frames']}")
        # Repeats until the program has closed the device.
        self.run("timeout 60 sh -c 'until rmmod v4l2loopback 2>/dev/null; do sleep 0.02; done'")
        self.checks.expect(self.run("ls /dev/video7 /dev/arena-camera 2>&1 | grep -c 'No such'", may_fail=True) == "2",
                           "the module is unloaded, the camera is gone")
        self.ask("blind 20")
        self.load_loopback(7)
        self.arena.ask("plug")
        self.wait_for_log("camera: reopened")
        result = self.ask("play 60")
        self.checks.expect(re.fullmatch("s{0,3}d+", result["frames"]) and result["shown"] == 60,
                           f"the camera is /dev/video7 now, and the game goes on: {result['frames']}")
        self.compare(result)  # not the robots' paths: they may already be at their targets

    def stop(self):
        self.run("systemctl stop --no-block touchline")
        result = self.ask("watch 20")
        more = self.ask("listen 2")
        self.checks.expect(re.fullmatch(r"[dm]*m?s+\.*", result["frames"] + more["frames"]) and result["stops"] + more["stops"] >= 5,
                           f"SIGTERM: {result['stops'] + more['stops']} stop packets and no other: {result['frames']}")
        self.run("timeout 30 sh -c 'while systemctl is-active -q touchline; do sleep 0.1; done'", may_fail=True)
        result = self.run("systemctl show -p ExecMainStatus -p Result touchline")
        self.checks.expect("Result=success" in result and "ExecMainStatus=0" in result, "exit code 0")
        self.checks.expect(not self.board.pins_now() & (1 << LED | 1 << STROBE), "status light and strobe are off")
        output = self.run(f"{LOG} | tail -n 20")
        print(output)
        self.checks.expect(" 0 lost, 0 unusable" in output, "no gap in the frames' sequence from begin to end")
        self.checks.numbers.append(f"{self.frames} frames shown, {self.packets} packets received")

    def roll_wheels(self):
        """touchline-radio sends a pattern over the UART to a robot that runs tools/robot/touchline_robot.h."""
        robot, speed = 3, 150
        self.run(f"(touchline-radio --board /etc/touchline/board.toml --robot {robot} --pattern left-wheel --speed {speed / 1000} "
                 "--duration 2 --yes >radio.log 2>&1; echo code $? >>radio.log) &")
        result = self.ask(f"robot {robot}")
        self.run("timeout 60 sh -c 'until grep -q ^code radio.log; do sleep 0.1; done'")
        output = self.run("cat radio.log")
        print(output)
        told, sent = result["told"], re.search(r"sent (\d+) packets, received (\d+) bytes", output)
        self.checks.expect(told == [[speed, 0], [0, 0]] and "code 0" in output,
                           f"the robot is told {told} mm/s: the left wheel rolls, then it stops")
        self.checks.expect(sent is not None and result["packets"] == int(sent[1]) + 5,
                           f"{result['packets']} packets obeyed: those that were sent, and five stop packets")
        self.checks.expect(f"left of robot {robot}: {speed} = {speed / 1000:.3f} m/s" in output, "the sent bytes are shown, field by field")
        self.checks.expect(sent is not None and int(sent[2]) == 10 * result["reports"] > 0 and "battery: 7412 = 7.412 V" in output,
                           f"{result['reports']} reports of the robot are received and shown")

    def measure_drive(self):
        """touchline-radio drives a robot of the arena and measures it, through V4L2 and the UART."""
        robot, delay_s = 1, 0.08
        self.close_arena()
        self.arena = guest.Arena(self.arena_program, HERE / "board.toml", self.folder,
                                 ["camera.rate_hz=30", "arena.opponents=stand", f"arena.radio.delay_s={delay_s}",
                                  "arena.radio.jitter_s=0", "arena.physics.wheel_error=0.15"])
        self.arena.ask("plug")
        self.run(f"(touchline-radio --board /etc/touchline/board.toml --robot {robot} --measure --duration 20 --yes >drive.log 2>&1; "
                 "echo code $? >>drive.log) &")
        while not self.ask("watch 5")["packets"]:
            pass
        self.board.drive_pin(START, True)
        self.ask("watch 20")
        self.board.drive_pin(START, False)
        for _ in range(40):
            result = self.ask("watch 50")
            if self.run("grep -c '^code' drive.log", may_fail=True) == "1":
                break
        output = self.run("cat drive.log")
        print(output)
        print(f"  {result['late']} of the last {result['shown']} frames late, by {result['latest_us']} us at most")
        self.checks.expect("code 0" in output and "right: left and right wheel, forward" in output,
                           "the wiring is found by the camera's pictures")
        for side, truth in zip(("left", "right"), result["gains"][robot]):
            found = re.search(rf"gain of the {side} wheel +([\d.]+) \+- ([\d.]+)", output)
            # The arena's clock stands while the guest is late, so a second of the guest is a little longer.
            # The uncertainty after 20 s at 30 Hz is 0.8 %.
            self.checks.expect(found is not None and abs(float(found[1]) - truth) < 0.03,
                               f"gain of the {side} wheel {found and found[1]}, truly {truth:.4f}")
        lag = re.search(r"\n  lag +([\d.]+) \+- ", output)
        self.checks.expect(lag is not None and abs(float(lag[1]) - 80) < 10, f"lag {lag and lag[1]} ms, truly 80")

    def measure_led(self):
        """Light of an LED at the status light's line to packet, and the driver's stamp, which is the exposure's end here."""
        u, v, radius, exposure_us, frames = 600, 30, 6, 10000, 600
        self.run("kill $(cat feeder.pid) && while kill -0 $(cat feeder.pid) 2>/dev/null; do sleep 0.05; done")
        self.start_feeder(f"{LED} {u} {v} {radius} {exposure_us}")
        self.arena.ask("plug")
        self.run(f"(touchline-latency --board /etc/touchline/board.toml --led {u},{v},{radius} --warm-up 20 --frames {frames} "
                 "--out led.json >led.log 2>&1; echo code $? >>led.log) &")
        for _ in range(2 * frames // 50):
            self.ask("watch 50")
            if self.run("grep -c '^code' led.log", may_fail=True) == "1":
                break
        print(self.run("cat led.log"))
        report = json.loads(self.run("cat led.json"))["led"]
        feeder = re.findall(r"written (\d+) us", self.run("cat feeder.log"))
        self.checks.expect(report["refusal"] == "" and report["edges"] >= 40 and report["partial"] >= 5,
                           f"{report['edges']} edges of the LED seen, {report['partial']} within an exposure {report['refusal']}")
        # The driver stamps a picture while it is written, and the board file names no exposure.
        middle_us, written_us = exposure_us / 2, int(feeder[-1])
        error_us, resolution_us = report["stamp_error_ns"] / 1000, report["stamp_resolution_ns"] / 1000
        self.checks.expect(middle_us - resolution_us <= error_us <= middle_us + written_us + resolution_us,
                           f"driver's time stamp {error_us:.0f} us later than the middle of the exposure, +- {resolution_us:.0f}; it is "
                           f"{middle_us:.0f} to {middle_us + written_us:.0f}")
        light, packet = report["light_to_packet_ns"]["p50"] / 1e6, report["capture_to_packet_ns"]["p50"] / 1e6
        self.checks.expect(0 < light - packet < 1000 / 30 + 5, f"LED to packet {light:.1f} ms, capture to packet {packet:.1f} ms (medians)")
