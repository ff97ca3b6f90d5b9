"""The steps of tools/test-board with `touchline-arena serve`, as docs/hil.md describes them."""
import re
import subprocess

import game
import guest
import page

FRAMES = 180
# Through V4L2 the time is the guest's own, and its only processor renders the pictures, too. So they come slowly.
V4L2_FRAMES, V4L2_RATE = 60, 4


class ServedGame:
    def __init__(self, board, checks, folder, program):
        self.board, self.checks, self.program = board, checks, program
        self.log, self.arena = open(folder / "serve.log", "w+"), None

    def install(self, packages):
        self.board.bring_up_network()
        print(self.board.run("dpkg -i " + " ".join(f"./{package}" for package in packages)))

    def play(self):
        port, files = page.free_port(), ["--venue", game.MOCK / "venue.toml", "--team", game.MOCK / "team.toml"]
        self.arena = subprocess.Popen(
            [str(word) for word in (self.program, "serve", "--lockstep", "--board", game.HERE / "board.toml", *files, "--pictures",
                                    f"tcp://127.0.0.1:{port}", "--control", "none", "--robots", self.board.radio, "--patience", 60)],
            stdin=subprocess.DEVNULL, stdout=self.log, stderr=subprocess.STDOUT)
        settings = ("camera.backend=remote", f"camera.address=tcp://{guest.HOST}:{port}", "camera.lockstep=true", "gpio.backend=none",
                    "gpio.start_line=-1")
        output = self.board.run(f"touchline run --headless --board board.toml --frames {FRAMES} "
                                + " ".join(f"--set {setting}" for setting in settings))
        print(output)
        self.close()
        self.log.seek(0)
        text = self.log.read()
        print(text)

        def number(pattern):
            found = re.search(pattern, text)
            return float(found[1]) if found else -1
        self.checks.expect(re.search(rf"frames +{FRAMES} in .* 0 lost", output), f"{FRAMES} pictures arrived by TCP and virtio, none lost")
        self.checks.expect(text.startswith("level: wires, in lock-step"), "the level of the set-up is \"wires\"")
        # The stop packets at the end follow each other faster than the line carries them, so newer ones replace older ones.
        replaced = int(re.search(r"(\d+) dropped for newer ones", output)[1])
        self.checks.expect(number(r"packets received: (\d+)") >= FRAMES and 0 <= number(r", (\d+) missing") <= replaced
                           and number(r"(\d+) bytes of no packet") == 0, "each picture was followed by a packet over the UART, none is damaged")
        self.checks.expect(number(r"without a packet in time: (\d+)") == 0, "no packet was too late for its picture")
        touches = number(r"touched (\d+) times")
        self.checks.expect(touches >= 1 and "HALTED" not in output, f"robots play: the ball was touched {touches:.0f} times")

    def play_through_v4l2(self):
        """Arena and player in the guest, with a v4l2loopback device between them, as in docs/hil.md."""
        self.board.run(f"modprobe v4l2loopback video_nr=7 && {game.SETTLE}")
        share = "/usr/share/touchline/boards/hil/board.toml"
        rate = f"--set camera.rate_hz={V4L2_RATE}"
        self.board.run(f"(touchline-arena serve --board {share} {rate} --pictures none --loopback /dev/video7 --control none >arena.log 2>&1;"
                       " echo code $? >>arena.log) &")
        self.board.run("timeout 60 sh -c 'until grep -q ^level: arena.log; do sleep 0.1; done'")
        output = self.board.run(f"touchline run --headless --board {share} {rate} --set camera.backend=v4l2 --set camera.device=/dev/video7"
                                f" --set faults.stop_after_s={4 / V4L2_RATE} --frames {V4L2_FRAMES} 2>&1")
        print(output)
        text = self.board.run("busybox killall -INT touchline-arena; timeout 60 sh -c 'until grep -q ^code arena.log; do sleep 0.1; done';"
                              " cat arena.log")
        print(text)
        lost = re.search(rf"frames +{V4L2_FRAMES} in .* (\d+) lost", output)
        packets = re.search(r"packets received: (\d+)", text)
        stops = re.search(r"(\d+) of them stop packets", output)
        self.checks.expect(text.startswith("level: wires, in real time") and "code 0" in text, "serve writes into /dev/video7, level \"wires\"")
        self.checks.expect(lost and lost[1] == "0", f"v4l2loopback: {V4L2_FRAMES} frames, {lost[1] if lost else '?'} lost")
        self.checks.expect(packets and int(packets[1]) >= V4L2_FRAMES, f"{packets[1] if packets else 'no'} packets of robots arrived by UDP")
        self.checks.expect(stops and stops[1] == "5", "robots play until the five stop packets at the end")

    def close(self):
        if self.arena is not None and self.arena.poll() is None:
            self.arena.terminate()
            self.arena.wait(20)
