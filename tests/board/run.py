"""Runs tools/test-board: boots the guest, runs the chosen parts and reports the checks."""
import argparse
import contextlib
import os
import pathlib
import shutil
import subprocess
import sys
import time

sys.dont_write_bytecode = True
import game  # noqa: E402
import guest  # noqa: E402
import image  # noqa: E402
import page  # noqa: E402
import recording  # noqa: E402
import serve  # noqa: E402
import usb  # noqa: E402

BOARD = pathlib.Path(__file__).resolve().parent
ROOT = BOARD.parent.parent
BUILD = ROOT / "build" / "board"
PROGRAMS = ROOT / "build" / "release" / "tests" / "board"
ARENA = ROOT / "build" / "release" / "tools" / "programs" / "arena" / "touchline-arena"
PARTS = ("formats", "game", "led", "radio", "usb", "page", "serve", "recording")


def parse():
    parser = argparse.ArgumentParser(prog="tools/test-board")
    parser.add_argument("part", nargs="*", choices=[[], *PARTS], help="what to test (default: all)")
    parser.add_argument("--package", type=pathlib.Path, metavar="DEB", help="package to install, with touchline-tools beside it (default: new ones)")
    parser.add_argument("--frames", type=int, default=300, help="frames of undisturbed play, and of each recorded game (default: 300)")
    arguments = parser.parse_args()
    if arguments.package is not None and not arguments.package.is_file():
        parser.error(f"--package {arguments.package}: no such file")
    return arguments


def step(text):
    print(f"\n== {text} ({time.monotonic() - BEGIN:.0f} s so far)", flush=True)


def run_visibly(*command):
    """Runs a command with its output on the terminal. An error ends the test."""
    environment = {**os.environ, "CMAKE_CXX_COMPILER_LAUNCHER": "ccache", "CMAKE_C_COMPILER_LAUNCHER": "ccache",
                   "CCACHE_SLOPPINESS": "pch_defines,time_macros"}
    if subprocess.run([str(word) for word in command], cwd=ROOT, env=environment, check=False).returncode != 0:
        raise image.Failed(f"{' '.join(map(str, command))} failed, see above")


def newest_package():
    run_visibly("tools/package", "arm64-bookworm")
    return max((ROOT / "build" / "packages" / "bookworm").glob("touchline_*_arm64.deb"), key=lambda f: f.stat().st_mtime)


def make_programs():
    BUILD.mkdir(parents=True, exist_ok=True)
    run_visibly("cmake", "--preset", "release", "--log-level=WARNING")
    run_visibly("cmake", "--build", "--preset", "release", "-j", os.cpu_count(), "--target", "board-arena", "board-usb-camera",
                "touchline-arena")
    feeder = BUILD / "board-feeder"
    run_visibly("aarch64-linux-gnu-g++", "-std=c++20", "-O2", "-Wall", "-Wextra", "-Werror", "-static", "-I", ROOT,
                BOARD / "feeder.cpp", "-o", feeder)
    return feeder


@contextlib.contextmanager
def own_guest(cache, ramdisk, folder, **more):
    """Boots a guest for a part that needs other devices than the common one, and closes it at the end."""
    board = guest.Guest(cache.vmlinuz, ramdisk, cache.image, folder, **more)
    try:
        step(f"{folder.name}: boot")
        board.boot()
        yield board
    finally:
        board.close()


def visit(cache, ramdisk, folder, checks, package):
    """The page needs a board on which nothing was set up, and a network."""
    run_visibly("tools/console/build", "--install")  # playwright
    port = page.free_port()
    # No other connection: the guest's network ends at this port.
    with own_guest(cache, ramdisk, folder, network=f"restrict=on,hostfwd=tcp:127.0.0.1:{port}-:8642") as board:
        bare = page.Page(board, checks, folder, PROGRAMS, port)
        for text, do in (("installation on a bare board", lambda: bare.install(package)),
                         ("page: from no device to a game", bare.visit), ("page: what was written", bare.end)):
            step(text)
            do()


def play_with_serve(cache, ramdisk, folder, checks, packages):
    """The set-ups of docs/hil.md. The network leads to this computer."""
    with own_guest(cache, ramdisk, folder, network="ipv6=off", radio_is_pty=True) as board, contextlib.closing(
            serve.ServedGame(board, checks, folder, ARENA)) as served:
        served.install(packages)
        step("touchline-arena serve: a game in lock-step, pictures by TCP, packets over the UART")
        served.play()
        step("touchline-arena serve: pictures through v4l2loopback")
        served.play_through_v4l2()


def record(cache, ramdisk, folder, checks, packages, frames):
    """Games that are recorded on a second disk."""
    disk = folder / "games.ext4"
    recording.make_disk(disk)
    with own_guest(cache, ramdisk, folder, disk=disk) as board:
        games = recording.Recordings(board, checks, frames)
        games.install(packages)
        step("recording: games on disks that fail")
        games.play_all()


def main():
    arguments = parse()
    step("programs for this test")
    feeder = make_programs()
    step("package")
    package = (arguments.package or newest_package()).resolve()
    # touchline-latency is in the package beside it.
    packages = [package, package.with_name(package.name.replace("touchline_", "touchline-tools_", 1))]
    print(" and ".join(file.name for file in packages))
    cache = image.Cache(BUILD)
    step("kernel and modules")
    is_new = cache.make_kernel()  # cache.version needs the kernel
    print(f"Linux {cache.version}, {'made' if is_new else 'kept'}")
    step("root image")
    print(f"Debian {image.SUITE}, {'made' if cache.make_image(packages) else 'kept'}")
    run = BUILD / "run"
    shutil.rmtree(run, ignore_errors=True)
    run.mkdir()
    ramdisk = run / "ramdisk.gz"
    chosen = set(arguments.part or PARTS)
    payload = [*packages, feeder, *game.payload()]
    if "recording" in chosen:
        payload.append(recording.make_pictures(ARENA, run / "match"))
    cache.make_ramdisk(payload, ramdisk)

    checks = game.Checks()
    has_devices = chosen & {"formats", "game", "led", "radio", "usb"}
    names = [file.name for file in packages]
    for part, do in (("page", lambda folder: visit(cache, ramdisk, folder, checks, package.name)),
                     ("serve", lambda folder: play_with_serve(cache, ramdisk, folder, checks, names)),
                     ("recording", lambda folder: record(cache, ramdisk, folder, checks, names, arguments.frames))):
        if part in chosen:
            (run / part).mkdir()
            do(run / part)
    if not has_devices:
        step("summary")
        return checks.summary(run)
    board = guest.Guest(cache.vmlinuz, ramdisk, cache.image, run)
    try:
        play = game.Game(board, checks, PROGRAMS / "board-arena", run)
        camera = usb.UsbCamera(board, play, checks, run, PROGRAMS)
        for parts, text, do in (
                (chosen, "boot", play.boot), (chosen, "installation", lambda: play.install(names)),
                ({"formats", "game", "led", "radio"}, "devices", play.list_devices),
                ({"formats"}, "vivid: formats and controls", play.try_formats),
                ({"formats"}, "vivid: unplugged while it streams", play.unplug_vivid),
                ({"game"}, "game", lambda: play.play(arguments.frames)),
                ({"game"}, "emergency stop", play.pull_emergency_stop),
                ({"game"}, "camera module unloaded and loaded again", play.reload_module), ({"game"}, "end", play.stop),
                ({"led"}, "LED: from light to packet", play.measure_led),
                ({"radio"}, "touchline-radio: a pattern over the UART", play.roll_wheels),
                ({"radio"}, "touchline-radio: the drive of a robot", play.measure_drive),
                ({"usb"}, "USB camera", camera.list_camera), ({"usb"}, "USB camera: YUYV", camera.play_yuyv),
                ({"usb"}, "USB camera: MJPG, unplugged while it streams", camera.play_mjpg)):
            if parts & chosen:
                step(text)
                do()
    finally:
        board.close()
    step("summary")
    return checks.summary(run)


BEGIN = time.monotonic()
try:
    sys.exit(main())
except (guest.Failed, image.Failed, StopIteration) as error:
    sys.exit(f"tools/test-board: {error}\nlogs: {BUILD / 'run'}")
