# SPDX-License-Identifier: GPL-3.0-or-later
"""MeshLab's window on a display of its own, driven by keys and clicks as a person does it."""

import gzip
import os
import shutil
import signal
import subprocess
import time

import hosts
import numpy as np

WIDTH, HEIGHT = 1600, 1200
SCREENSHOTS = hosts.BUILD / "screenshots"

# Debian releases that have a MeshLab with the newer plugin interface, by its version; with what its
# package forgets to depend on (without which the window starts with a box full of errors).
FORGOTTEN = "libgomp1,libmuparser2v5,libqhull-r8.0,lib3ds-1-3,libopenctm1"
SUITES = {
    "2022.02": ("trixie", f"{FORGOTTEN},libmpfr6,libxerces-c3.2t64", []),
    "2025.07": ("sid", FORGOTTEN, ['--aptopt=Acquire::Check-Valid-Until "false"']),
}


def need(*programs):
    for program in programs:
        if shutil.which(program) is None:
            raise hosts.Missing(f"GUI: {program} is not installed")


def foreign_root(version):
    """A release's MeshLab with all its libraries, unpacked once into the cache."""
    suite, forgotten, options = SUITES[version]
    root = hosts.CACHE / f"meshlab-{suite}"
    if not (root / "usr/bin/meshlab").is_file():
        need("mmdebstrap")
        part = root.with_suffix(".part")
        shutil.rmtree(part, ignore_errors=True)
        part.parent.mkdir(parents=True, exist_ok=True)
        made = subprocess.run(
            # Nothing is run in it, so it needs neither root nor a user namespace.
            ["mmdebstrap", *options, "--mode=chrootless", "--variant=extract",
             f"--include=meshlab,{forgotten}", suite, part],
            capture_output=True, text=True, timeout=900,
        )
        if made.returncode != 0 or not (part / "usr/bin/meshlab").is_file():
            shutil.rmtree(part, ignore_errors=True)
            raise hosts.Missing(
                f"GUI {version}: mmdebstrap cannot get Debian {suite}: {made.stderr.strip()[-300:]}"
            )
        part.rename(root)
    with gzip.open(root / "usr/share/doc/meshlab/changelog.Debian.gz", "rt") as changelog:
        found = changelog.readline().split("(")[1]
    if not found.startswith(version):
        raise hosts.Missing(f"GUI {version}: Debian {suite} has MeshLab {found.split(')')[0]} now")
    return root


def start_2020(_, folder, display, arguments):
    binary = hosts.private_tree(folder / "tree") / "meshlab"
    return start([binary, *arguments], folder, display, {})


def start_suite(version, folder, display, arguments):
    plugin = hosts.plugin_for(f"meshlab-{version}")
    root = foreign_root(version)
    libraries = next(root.glob("usr/lib/*/meshlab"))
    triplet = libraries.parent
    link = triplet / "plugins"
    if not link.is_symlink():
        link.symlink_to("meshlab/plugins")
    own = folder / "home/.local/share/VCG/MeshLab_64bit_fp/MeshLabExtraPlugins" / version
    own.mkdir(parents=True)
    shutil.copy2(plugin, own)
    loader = next(triplet.glob("ld-linux*.so.*"))
    command = [loader, "--library-path", f"{libraries}:{triplet}", root / "usr/bin/meshlab"]
    return start(
        [*command, *arguments], folder, display, {"QT_PLUGIN_PATH": str(triplet / "qt5/plugins")}
    )


def start(command, folder, display, extra):
    home = folder / "home"
    (home / "run").mkdir(parents=True, exist_ok=True)
    (home / "run").chmod(0o700)
    environment = {
        name: value for name, value in os.environ.items()
        if not name.startswith(("XDG_", "QT_")) and name != "LD_LIBRARY_PATH"
    }
    environment.update(
        DISPLAY=display, HOME=str(home), XDG_RUNTIME_DIR=str(home / "run"), LC_ALL="C.UTF-8",
        LIBGL_ALWAYS_SOFTWARE="1", QT_LOGGING_TO_CONSOLE="1", **extra,
    )
    with open(folder / "log", "wb") as log:
        return subprocess.Popen(
            [str(word) for word in command], env=environment, stdout=log, stderr=log,
            start_new_session=True,
        )


class Window:
    """One run of MeshLab: its menus, its dialogs, its log, its picture."""

    def __init__(self, version, process, folder, display):
        self.version, self.process, self.folder = version, process, folder
        self.environment = {**os.environ, "DISPLAY": display}

    def xdotool(self, *words):
        done = subprocess.run(
            ["xdotool", *map(str, words)], env=self.environment, capture_output=True, text=True,
            timeout=30,
        )
        return done.stdout.split()

    def log(self):
        return (self.folder / "log").read_text(errors="replace")

    def wait(self, condition, what, seconds=60):
        """Waits until condition() is true; fails with a screenshot otherwise."""
        end = time.monotonic() + seconds
        while True:
            found = condition()
            if found:
                time.sleep(0.5)
                return found
            if self.process.poll() is not None:
                raise AssertionError(f"MeshLab ended with {self.process.returncode}:\n{self.log()}")
            if time.monotonic() > end:
                self.screenshot("failed")
                raise AssertionError(f"{what} in vain; see {SCREENSHOTS}\n{self.log()}")
            time.sleep(0.2)

    def wait_for_log(self, words, times=1):
        return self.wait(lambda: self.log().count(words) >= times, f"waited for '{words}' in the log")

    def wait_for_window(self, title):
        return self.wait(
            lambda: self.xdotool("search", "--onlyvisible", "--name", f"^{title}"),
            f"waited for the window '{title}'",
        )[-1]

    def key(self, *keys):
        for key in keys:
            self.xdotool("key", key)
            time.sleep(0.05)

    def click(self, x, y):
        self.xdotool("mousemove", x, y, "click", 1)
        time.sleep(0.5)

    def open_menu(self, menu, entry):
        """Opens Filters, goes down `menu` times, into the submenu, down `entry` times."""
        main = self.wait_for_window(f"MeshLab {self.version} - ")
        self.xdotool("windowactivate", "--sync", main)
        self.key("alt+l")
        time.sleep(0.5)
        self.key(*["Down"] * menu, "Right")
        time.sleep(0.5)
        self.key(*["Down"] * entry)
        time.sleep(0.5)

    def geometry(self, window):
        pairs = dict(
            word.split("=") for word in self.xdotool("getwindowgeometry", "--shell", window) if "=" in word
        )
        return [int(pairs[name]) for name in ("X", "Y", "WIDTH", "HEIGHT")]

    def screenshot(self, name):
        """Keeps a picture of the whole screen; returns it as an array height x width x 3."""
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
        path = SCREENSHOTS / f"{self.version}-{name}.png"
        subprocess.run(
            ["import", "-window", "root", path], env=self.environment, check=True, timeout=60
        )
        done = subprocess.run(
            ["convert", path, "-depth", "8", "rgb:-"], capture_output=True, check=True, timeout=60
        )
        return np.frombuffer(done.stdout, "u1").reshape(HEIGHT, WIDTH, 3).astype(int)

    def close(self):
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
