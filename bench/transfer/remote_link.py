"""Links through shaping_proxy.py, displays of Xvfb and an sshd on loopback, for remote_session.py and remote_peers.py."""
import getpass
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
LINKS = {"10": (10e6, 50), "1": (1e6, 200)}  # bits/s and milliseconds for both ways, by Mbit/s


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def await_port(port, seconds=30):
    """Waits until a program listens. Reads the table of the system, because a connection would start clocks of proxies."""
    until = time.monotonic() + seconds
    wanted = f"0100007F:{port:04X}", f"00000000:{port:04X}"
    while time.monotonic() < until:
        for table in ("/proc/net/tcp", "/proc/net/tcp6"):
            for line in pathlib.Path(table).read_text().splitlines()[1:]:
                words = line.split()
                if words[3] == "0A" and (words[1] in wanted or words[1].endswith(f":{port:04X}")):
                    return
        time.sleep(0.05)
    raise RuntimeError(f"nothing listens on port {port}")


def end(process):
    """Ends a process that leads its session, and its children."""
    if process is None:
        return
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
    process.wait()


class Link:
    """Shaping proxy before a port of this machine."""

    def __init__(self, folder, name, port):
        rate, delay = LINKS[name]
        self.port = free_port()
        self.log = pathlib.Path(folder) / f"link-{self.port}.log"
        self.process = subprocess.Popen([sys.executable, HERE / "shaping_proxy.py", str(self.port), f"127.0.0.1:{port}",
                                         "--rate", str(rate), "--rtt", str(delay), "--log", str(self.log)],
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, start_new_session=True)
        await_port(self.port)

    def received(self):
        """Returns the bytes that clients received so far; exact to a tenth of a second."""
        try:
            lines = self.log.read_text().splitlines()
        except FileNotFoundError:
            return 0
        for line in reversed(lines):
            words = line.split()
            if len(words) == 2:
                return int(words[1])
        return 0

    def end(self):
        end(self.process)


class Display:
    """Xvfb. Its pixels are read from a file, which costs the programs under it no time."""

    def __init__(self, folder, width, height):
        self.folder = pathlib.Path(folder) / "display"
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        read, write = os.pipe()
        arguments = ["-displayfd", str(write), "-screen", "0", f"{width}x{height}x24", "-noreset", "-fbdir", str(self.folder)]
        self.process = subprocess.Popen(["Xvfb", *arguments], pass_fds=[write], stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        os.close(write)
        with os.fdopen(read) as number:
            self.name = ":" + number.readline().strip()

    def picture(self):
        """Returns the pixels as height x width x 3 bytes."""
        data = (self.folder / "Xvfb_screen0").read_bytes()
        # Fields of the header of XWD, version 7, are big-endian words.
        words = np.frombuffer(data[:100], ">u4")
        start, width, height, row, colours = int(words[0]), int(words[4]), int(words[5]), int(words[12]), int(words[19])
        start += 12 * colours
        pixels = np.frombuffer(data, np.uint8, row * height, start).reshape(height, row // 4, 4)
        return pixels[:, :width, 2::-1].copy()

    def end(self):
        end(self.process)


def psnr(one, other):
    """Returns the PSNR of two pictures in dB; infinite if they are equal."""
    error = np.mean((one.astype(np.float32) - other.astype(np.float32)) ** 2)
    return float("inf") if error == 0 else 10 * np.log10(255**2 / error)


class Account:
    """sshd with keys of its own, with a program `ghostspace` in the path of its account."""

    def __init__(self, folder, program):
        self.folder = str(folder)
        os.makedirs(self.folder + "/bin")
        os.makedirs(self.folder + "/remote-bin")
        self.user = getpass.getuser()
        self.port = free_port()
        for key in ("host", "user"):
            subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", f"{self.folder}/{key}"], check=True)
        shutil.copy(self.folder + "/user.pub", self.folder + "/authorized")
        self.write("config", f"Host *\n  IdentityFile {self.folder}/user\n  IdentitiesOnly yes\n"
                             "  StrictHostKeyChecking no\n  UserKnownHostsFile /dev/null\n  LogLevel ERROR\n")
        self.write("sshd_config", f"Port {self.port}\nListenAddress 127.0.0.1\nHostKey {self.folder}/host\n"
                                  f"PidFile {self.folder}/pid\nAuthorizedKeysFile {self.folder}/authorized\nStrictModes no\n"
                                  "UsePAM no\nPermitRootLogin yes\nPasswordAuthentication no\n"
                                  f"SetEnv PATH={self.folder}/remote-bin:/usr/bin:/bin XDG_CACHE_HOME={self.folder}/cache\n")
        for name, text in (("bin/ssh", f'#!/bin/sh\nexec /usr/bin/ssh -F {self.folder}/config "$@"\n'),
                           ("remote-bin/ghostspace", f'#!/bin/sh\nexec {program} "$@"\n')):
            self.write(name, text)
            os.chmod(f"{self.folder}/{name}", 0o755)
        if os.geteuid() == 0:
            os.makedirs("/run/sshd", exist_ok=True)
        self.process = subprocess.Popen(["/usr/sbin/sshd", "-D", "-e", "-f", self.folder + "/sshd_config"],
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        stderr=open(self.folder + "/sshd.log", "a"), start_new_session=True)
        await_port(self.port)

    def write(self, name, text):
        with open(f"{self.folder}/{name}", "w") as file:
            file.write(text)

    def forget(self):
        """Removes the streams that the remote end has made."""
        shutil.rmtree(self.folder + "/cache", ignore_errors=True)

    def end(self):
        end(self.process)
