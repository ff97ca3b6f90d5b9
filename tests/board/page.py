"""The steps of tools/test-board with the console's page: from `dpkg -i` on a board without devices to a game, as a person does it."""
import os
import pathlib
import re
import socket
import subprocess
import threading

import guest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent


def free_port():
    with socket.socket() as any_port:
        any_port.bind(("127.0.0.1", 0))
        return any_port.getsockname()[1]


class Page:
    """`port` of this computer leads to the page in the guest."""

    def __init__(self, board, checks, folder, programs, port):
        self.board, self.run, self.checks, self.port = board, board.run, checks, port
        self.folder, self.arena_program = folder / "pictures", programs / "board-arena"
        self.arena, self.player, self.is_playing = None, None, False
        self.link = self.path_m = None

    def install(self, package):
        self.board.bring_up_network()
        for command in (f"dpkg -i ./{package}", "cp /usr/share/touchline/boards/generic-arm64-v4l2/board.toml /etc/touchline/",
                        "rm /etc/touchline/venue*", "touchline link"):
            print(f"# {command}")
            output = self.run(command)
        print("\n".join(line for line in output.splitlines() if "\033" not in line))
        found = re.search(rf"http://{re.escape(guest.ADDRESS)}:8642/(login\?token=[0-9a-f]{{64}})", output)
        self.checks.expect(found, "`touchline link` prints the login link with the board's address")
        self.link = f"http://127.0.0.1:{self.port}/{found[1]}"
        self.checks.expect(self.run("systemctl is-active touchline touchline-setup") == "active\nactive",
                           "the services run without camera and radio")
        self.checks.expect(self.run("ls /dev/video* /dev/ttyUSB*", may_fail=True).count("No such file") == 2, "there is neither camera nor adapter")

    # Plugging in. The arena's pictures go to v4l2loopback; the radio is a USB serial adapter.

    def plug_camera(self):
        """The pictures come at once; the radio's adapter appears with the arena too, as it is connected to both."""
        self.run("cp board.rules /etc/udev/rules.d/99-board.rules && udevadm control --reload && modprobe -a xhci_pci ftdi_sio")
        self.run("modprobe v4l2loopback video_nr=0 card_label=Arena exclusive_caps=0 max_buffers=4 &&"
                 " udevadm trigger --action=add --subsystem-match=virtio-ports && udevadm settle --timeout=60")
        self.run("(./board-feeder /dev/virtio-ports/arena /dev/arena-camera >feeder.log 2>&1 &)")
        self.folder.mkdir(exist_ok=True)
        for link, socket_of in (("pictures.sock", "pictures.sock"), ("radio.sock", "usbradio.sock")):
            (self.folder / link).symlink_to(f"../{socket_of}")
        self.arena = guest.Arena(self.arena_program, HERE / "board.toml", self.folder,
                                 ["camera.rate_hz=15", "camera.format=yuyv", "arena.opponents=stand"])
        self.arena.ask("plug")
        self.is_playing, self.path_m = True, 0.0
        self.player = threading.Thread(target=self.play, daemon=True)
        self.player.start()
        self.run("timeout 60 sh -c 'until [ -e /dev/serial/by-id ]; do sleep 0.1; done'; udevadm settle")
        print(self.run("ls /dev/video0 /dev/serial/by-id"))

    def play(self):
        while self.is_playing:
            self.path_m += self.arena.ask("watch 5")["own_path_m"]

    def visit(self):
        environment = {**os.environ, "CHROMIUM": os.environ.get("CHROMIUM", "/usr/bin/chromium"), "PATIENCE_MS": "900000",
                       "SCREENSHOTS": str(self.folder)}
        self.folder.mkdir(exist_ok=True)
        browser = subprocess.Popen(["node", str(HERE / "page_visit.mjs"), self.link], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   text=True, env=environment)
        for line in browser.stdout:
            line = line.rstrip("\n")
            if line.startswith("ok "):
                self.checks.expect(True, line[3:])
            elif line.startswith("do "):
                answer = str(getattr(self, line[3:])() or "")
                browser.stdin.write(answer + "\n")
                browser.stdin.flush()
            else:
                print(line, flush=True)
        self.checks.expect(browser.wait() == 0, "the visit ended without an error")

    def path(self):
        return self.path_m

    def end(self):
        self.is_playing = False
        if self.player is not None:
            self.player.join(60)
        if self.arena is not None:
            self.arena.close()
        print(self.run("journalctl -u touchline -o cat --no-pager | grep -v 'robots halted' | tail -n 30"))
        print(self.run("tail -n 4 /etc/touchline/board.toml; ls /etc/touchline; systemctl show -p StatusText --value touchline"))
