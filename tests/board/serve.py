"""The steps of tools/test-board with `touchline-arena serve`, as docs/hil.md describes them."""
import re
import subprocess

import game
import guest
import page

FRAMES = 180


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

    def close(self):
        if self.arena is not None and self.arena.poll() is None:
            self.arena.terminate()
            self.arena.wait(20)
