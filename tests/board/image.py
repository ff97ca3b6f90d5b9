"""Makes the files that the guest boots from: Debian's kernel, v4l2loopback built for it, a root image, and a RAM disk for each run."""
import hashlib
import os
import pathlib
import re
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SUITE = "bookworm"
# Packages for the test, besides the dependencies of the package under test.
GUEST_PACKAGES = ["systemd", "udev", "kmod", "busybox-static", "v4l-utils", "gpiod"]
FIRST_MODULES = ["virtio_pci", "virtio_blk", "ext4"]
LATER_MODULES = ["virtio_console", "virtio_net", "vivid", "v4l2loopback", "xhci_pci", "uvcvideo", "ftdi_sio"]
IMAGE_SIZE = "3G"  # a sparse file: unused blocks take no disk space

FETCH_KERNEL = """cd "$OUT" && export APT_CONFIG="$MMDEBSTRAP_APT_CONFIG" &&
image=$(apt-cache depends linux-image-arm64:arm64 | sed -n 's/^ *Depends: *//p' | head -n 1) && image=${image%:arm64} &&
version=${image#linux-image-} && kbuild=linux-kbuild-$(echo "$version" | cut -d. -f1,2) &&
apt-get -q -o APT::Sandbox::User=root download "$image:arm64" "linux-headers-$version:arm64" \
  "linux-headers-${version%-arm64}-common" v4l2loopback-dkms "$kbuild:$HOST"
"""

# The bind mount shows the files without the mounts below them: /proc cannot be copied.
FILL_IMAGE = """rm -rf "$1"/var/lib/apt/lists/* && touch "$1"/etc/.updated "$1"/var/.updated && view=$(mktemp -d) &&
mount --bind "$1" "$view" && mke2fs -q -t ext4 -d "$view" "$IMAGE" "$SIZE" && umount "$view" && rmdir "$view"
"""


class Failed(Exception):
    """A command failed; the text has the command and its output."""


def run(*command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **more)
    if done.returncode != 0:
        raise Failed(f"{' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr[-4000:]}")
    return done.stdout


def is_up_to_date(stamp, wanted):
    return stamp.exists() and stamp.read_text() == wanted


def mmdebstrap(architectures, variant, include, hook, environment):
    """Makes a Debian system and calls `hook` in it. mmdebstrap refuses arm64, even if it only downloads, unless the kernel can run it."""
    run(ROOT / "toolchain" / "emulate-arm64")
    mirror = run(ROOT / "toolchain" / "debian-mirror").strip()
    run("mmdebstrap", f"--architectures={architectures}", f"--variant={variant}", "--format=null", "--dpkgopt=force-unsafe-io",
        *([f"--include={','.join(include)}"] if include else []),
        *[f"--dpkgopt=path-exclude=/usr/share/{folder}/*" for folder in ("man", "locale", "doc")],
        f"--customize-hook={hook}", SUITE, "/dev/null", mirror, env={**os.environ, **environment})


class Cache:
    """Files in build/board. They are made once, and again when their inputs change."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.kernel = self.folder / "kernel"
        self.image = self.folder / "root.ext4"

    @property
    def version(self):
        return next((self.kernel / "lib" / "modules").iterdir()).name

    @property
    def vmlinuz(self):
        return self.kernel / "boot" / f"vmlinuz-{self.version}"

    def make_kernel(self):
        """Makes Debian's kernel and its modules, with v4l2loopback. Returns False if they are up to date."""
        stamp = self.folder / "kernel.stamp"
        wanted = hashlib.sha256(pathlib.Path(__file__).read_bytes()).hexdigest()
        if is_up_to_date(stamp, wanted):
            return False
        stamp.unlink(missing_ok=True)
        shutil.rmtree(self.kernel, ignore_errors=True)
        packages = self.kernel / "packages"
        packages.mkdir(parents=True)
        host = run("dpkg", "--print-architecture").strip()
        mmdebstrap(f"arm64,{host}", "custom", [], FETCH_KERNEL, {"OUT": str(packages), "HOST": host})
        for package in packages.glob("*.deb"):
            run("dpkg-deb", "-x", package, self.kernel)
        shutil.rmtree(packages)
        headers = self.kernel / "usr" / "src" / f"linux-headers-{self.version}"
        source = next((self.kernel / "usr" / "src").glob("v4l2loopback-*"))
        makefile = headers / "Makefile"
        makefile.write_text(makefile.read_text().replace("/usr/src", str(self.kernel / "usr" / "src")))
        run("make", "-C", headers, f"M={source}", "ARCH=arm64", "CROSS_COMPILE=aarch64-linux-gnu-", "modules")
        extra = self.kernel / "lib" / "modules" / self.version / "extra"
        extra.mkdir()
        shutil.copy(source / "v4l2loopback.ko", extra)
        run("depmod", "-b", self.kernel, self.version)
        shutil.rmtree(self.kernel / "usr")
        stamp.write_text(wanted)
        return True

    def make_image(self, packages):
        """Makes the root image with the dependencies of `packages`, without them. Returns False if it is up to date."""
        depends = ",".join(run("dpkg-deb", "-f", package, "Depends") for package in packages)
        names = sorted({re.match(r"[a-z0-9.+-]+", entry.strip())[0] for entry in depends.split(",")} - {"touchline"})
        stamp = self.folder / "image.stamp"
        wanted = f"{SUITE} {IMAGE_SIZE} {' '.join(GUEST_PACKAGES + names)}\n{FILL_IMAGE}"
        if is_up_to_date(stamp, wanted):
            return False
        stamp.unlink(missing_ok=True)
        self.image.unlink(missing_ok=True)
        mmdebstrap("arm64", "apt", GUEST_PACKAGES + names, FILL_IMAGE, {"IMAGE": str(self.image), "SIZE": IMAGE_SIZE})
        stamp.write_text(wanted)
        return True

    def dependent(self, modules):
        """Returns the files of these modules and of their dependencies, in load order."""
        files = []
        for module in modules:
            listed = run("modprobe", "-S", self.version, "-d", self.kernel, "--show-depends", module)
            files += [line.split()[1] for line in listed.splitlines() if line.startswith("insmod ")]
        return list(dict.fromkeys(pathlib.Path(file) for file in files))

    def make_ramdisk(self, payload, out):
        """Makes the RAM disk `out`. The guest finds the files of `payload` in /run/board."""
        tree = pathlib.Path(out).with_suffix(".tree")
        shutil.rmtree(tree, ignore_errors=True)
        base = self.kernel / "lib" / "modules"
        modules = tree / "payload" / "modules"
        first = self.dependent(FIRST_MODULES)
        for file in dict.fromkeys(first + self.dependent(LATER_MODULES)):
            copy = modules / file.relative_to(base)
            copy.parent.mkdir(parents=True, exist_ok=True)
            run("aarch64-linux-gnu-strip", "-g", "-o", copy, file)
        for name in ("modules.order", "modules.builtin", "modules.builtin.modinfo"):
            shutil.copy(base / self.version / name, modules / self.version)
        (tree / "payload" / "first-modules").write_text(
            "".join(f"modules/{file.relative_to(base)}\n" for file in first))
        (tree / "lib").mkdir()
        (tree / "lib" / "modules").symlink_to("../payload/modules")
        run("depmod", "-b", tree, self.version)
        (tree / "bin").mkdir()
        with open(tree / "bin" / "busybox", "wb") as busybox:  # from the image, hence for the guest's processor
            subprocess.run(["debugfs", "-R", "cat /bin/busybox", str(self.image)], stdout=busybox,
                           stderr=subprocess.DEVNULL, check=True)
        (tree / "bin" / "busybox").chmod(0o755)
        here = pathlib.Path(__file__).parent
        shutil.copy(here / "init", tree / "init")
        for file in payload:
            if pathlib.Path(file).is_dir():
                shutil.copytree(file, tree / "payload" / pathlib.Path(file).name)
            else:
                shutil.copy(file, tree / "payload")
        run("sh", "-c", f"find . | cpio -o -H newc --quiet | gzip -1 >{pathlib.Path(out).resolve()}", cwd=tree)
        shutil.rmtree(tree)
