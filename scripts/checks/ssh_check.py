#!/usr/bin/env python3
"""Checks ssh: URLs against OpenSSH's sshd on loopback, run as this user with keys of its own.

usage: ssh_check.py [PROGRAM]      PROGRAM, or $GHOSTSPACE, or build/release/ghostspace

Skips all checks, with a message, if sshd is missing. Opens one port of 127.0.0.1 and ends all that it started.
"""

import getpass
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

PROGRAM = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else os.environ.get("GHOSTSPACE", "build/release/ghostspace"))
WORLD = "#VRML V2.0 utf8\nInline { url \"sub/ball.wrl\" }\nInline { url \"link.wrl\" }\n"
BALL = "#VRML V2.0 utf8\nShape { geometry Sphere { radius 2 } }\n"

failures = 0


def check(name, good, detail=""):
    global failures
    print(("ok      " if good else "FAILED  ") + name + ("" if good else ": " + str(detail)[-1500:]), flush=True)
    failures += not good


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Site:
    """sshd with a wrapper for ssh that knows its keys."""

    def __init__(self, folder):
        self.folder = folder
        self.user = getpass.getuser()
        self.port = free_port()
        self.bin = folder + "/bin"
        self.remote_bin = folder + "/remote-bin"
        for one in (self.bin, self.remote_bin, folder + "/cache", folder + "/data/sub", folder + "/outside"):
            os.makedirs(one)
        for key in ("host", "user"):
            subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", folder + "/" + key], check=True)
        shutil.copy(folder + "/user.pub", folder + "/authorized")
        with open(folder + "/host.pub") as key:
            self.known = "[127.0.0.1]:%d %s\n" % (self.port, " ".join(key.read().split()[:2]))
        self.write("known", self.known)
        self.write("config", "Host *\n  IdentityFile %s/user\n  IdentitiesOnly yes\n  UserKnownHostsFile %s/known\n"
                             "  StrictHostKeyChecking yes\n" % (folder, folder))
        self.write("sshd_config", "Port %d\nListenAddress 127.0.0.1\nHostKey %s/host\nPidFile %s/pid\n"
                                  "AuthorizedKeysFile %s/authorized\nStrictModes no\nUsePAM no\nPermitRootLogin yes\n"
                                  "PasswordAuthentication no\nSubsystem sftp internal-sftp\nAcceptEnv *\n"
                                  "SetEnv PATH=%s:/usr/bin:/bin XDG_CACHE_HOME=%s/cache\n"
                   % (self.port, folder, folder, folder, self.remote_bin, folder))
        self.write("bin/ssh", "#!/bin/sh\necho $$ >> %s/pids\nexec /usr/bin/ssh -F %s/config \"$@\"\n" % (folder, folder))
        os.chmod(folder + "/bin/ssh", 0o755)
        self.install(True)
        if os.geteuid() == 0:
            os.makedirs("/run/sshd", exist_ok=True)
        self.server = None
        self.start()

    def write(self, name, text):
        with open(self.folder + "/" + name, "w") as file:
            file.write(text)

    def install(self, present):
        """Puts a program ghostspace into the path of the remote end, or removes it."""
        path = self.remote_bin + "/ghostspace"
        if os.path.exists(path):
            os.remove(path)
        if present:
            self.write("remote-bin/ghostspace", "#!/bin/sh\nexec %s \"$@\"\n" % PROGRAM)
            os.chmod(path, 0o755)

    def start(self):
        self.server = subprocess.Popen(["/usr/sbin/sshd", "-D", "-e", "-f", self.folder + "/sshd_config"],
                                       stderr=open(self.folder + "/sshd.log", "a"), start_new_session=True)
        for _ in range(100):
            try:
                socket.create_connection(("127.0.0.1", self.port), 1).close()
                return
            except OSError:
                time.sleep(0.05)

    def stop(self):
        try:
            os.killpg(self.server.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.server.wait()

    def url(self, path, user=""):
        return "ssh://%s127.0.0.1:%d%s" % (user, self.port, path)

    def environment(self):
        environment = dict(os.environ, PATH=self.bin + ":/usr/bin:/bin", XDG_CACHE_HOME=self.folder + "/cache")
        for name in ("DISPLAY", "WAYLAND_DISPLAY", "SSH_ASKPASS", "SSH_AUTH_SOCK"):
            environment.pop(name, None)
        return environment

    def run(self, *arguments, timeout=120):
        made = subprocess.run([PROGRAM, *arguments], env=self.environment(), capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, timeout=timeout, start_new_session=True)
        return made.returncode, made.stdout, made.stdout + made.stderr

    def start_program(self, *arguments):
        return subprocess.Popen([PROGRAM, *arguments], env=self.environment(), stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True, start_new_session=True)

    def starts(self):
        try:
            with open(self.folder + "/pids") as file:
                return [int(line) for line in file]
        except FileNotFoundError:
            return []


def servers_of(site):
    """Returns the remote servers that run."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open("/proc/%s/cmdline" % pid, "rb") as file:
                words = file.read().split(b"\0")
            with open("/proc/%s/environ" % pid, "rb") as file:
                ours = (site.remote_bin + ":").encode() in file.read()
        except OSError:
            continue
        if ours and b"--stdio" in words:
            found.append(int(pid))
    return found


def ends_soon(what):
    for _ in range(100):
        if not what():
            return True
        time.sleep(0.05)
    return False


def check_worlds(site):
    data = site.folder + "/data"
    status, out, errors = site.run("check", site.url(data + "/world.wrl"))
    check("a world with its own files", status == 0, errors)
    check("one ssh for all files of a world", len(site.starts()) == 1, site.starts())
    check("no ssh and no server remains", ends_soon(lambda: servers_of(site)), servers_of(site))
    os.remove(data + "/link.wrl")
    os.symlink(site.folder + "/outside/secret.wrl", data + "/link.wrl")
    picture = ("--snapshot", site.folder + "/refused.png")
    status, out, errors = site.run(*picture, site.url(data + "/world.wrl"))
    check("a link out of the world's folder is refused", status == 0 and "404" in errors, errors)
    status, out, errors = site.run("check", site.url(data + "/link.wrl"))
    check("the user may open that link", status == 0, errors)
    status, out, errors = site.run(*picture, site.url(data + "/climbs.wrl"))
    check("a reference out of the folder is refused", status == 0 and "outside of the world's folder" in errors, errors)
    site.write("local.wrl", "#VRML V2.0 utf8\nInline { url \"%s\" }\n" % site.url(data + "/sub/ball.wrl"))
    status, out, errors = site.run(*picture, site.folder + "/local.wrl")
    check("a local file may not refer to ssh", status == 0 and "only the user may open ssh" in errors, errors)
    status, out, errors = site.run("check", "--offline", site.url(data + "/world.wrl"))
    check("--offline refuses ssh", status != 0 and "--offline" in errors, errors)
    status, out, errors = site.run("check", site.url(data + "/none.wrl"))
    check("a missing file", status != 0 and "404" in errors, errors)
    status, out, errors = site.run("check", site.url(data + "/sub/ball.wrl", site.user + "@"))
    check("a URL with a user", status == 0, errors)
    home = os.path.expanduser("~")
    name = ".ghostspace-ssh-check-%d.wrl" % os.getpid()
    with open(home + "/" + name, "w") as file:
        file.write(BALL)
    try:
        status, out, errors = site.run("check", site.url("/~/" + name))
        check("/~/ is the home folder", status == 0, errors)
    finally:
        os.remove(home + "/" + name)


def check_streams(site):
    data = site.folder + "/data"
    made = site.run("encode", data + "/mesh.stl", data + "/mesh.qnv")
    check("encode for the checks", made[0] == 0, made[2])
    status, out, errors = site.run("fetch", "--json", site.url(data + "/mesh.qnv"))
    facts = json.loads(out) if status == 0 else {}
    check("a stream", facts.get("complete") and facts.get("bytes") == os.path.getsize(data + "/mesh.qnv"), errors)
    status, out, errors = site.run("fetch", "--json", site.url(data + "/mesh.stl.qnv"), "--timeout", "100")
    facts = json.loads(out) if status == 0 else {}
    check("a stream that is encoded there", facts.get("complete") and facts.get("triangles", 0) > 0, errors)
    status, out, errors = site.run("--snapshot", site.folder + "/picture.png", site.url(data + "/world.wrl"))
    check("a picture", os.path.exists(site.folder + "/picture.png"), errors)
    status, out, errors = site.run("print", site.url(data + "/sub/ball.wrl"))
    check("print of an ssh: URL", status == 0, errors)
    status, out, errors = site.run("info", "--json", site.url(data + "/mesh.qnv"))
    check("info of an ssh: URL", status == 0 and json.loads(out).get("bytes") == os.path.getsize(data + "/mesh.qnv"), errors)
    status, out, errors = site.run("export", site.url(data + "/mesh.qnv"), site.folder + "/mesh.ply")
    check("export of an ssh: URL", status == 0 and os.path.getsize(site.folder + "/mesh.ply") > 1000, errors)
    status, out, errors = site.run("encode", site.url(data + "/mesh.stl"), site.folder + "/mesh-here.qnv")
    check("encode of an ssh: URL", status == 0 and os.path.getsize(site.folder + "/mesh-here.qnv") > 1000, errors)
    status, out, errors = site.run("check", "--remote-command", "env A='b c' ghostspace", site.url(data + "/world.wrl"))
    check("--remote-command with another program", "env" not in errors, errors)


def check_drops(site):
    """Kills ssh in the middle of a long file; the rest is read by ranges."""
    data = site.folder + "/data"
    before = len(site.starts())
    program = site.start_program("fetch", "--json", "--rate", "8000000", "--timeout", "60", site.url(data + "/long.stl"))
    for _ in range(200):
        if len(site.starts()) > before:
            break
        time.sleep(0.02)
    time.sleep(1.5)
    os.kill(site.starts()[-1], signal.SIGKILL)
    out, errors = program.communicate(timeout=90)
    facts = json.loads(out) if program.returncode == 0 else {}
    check("a killed ssh is started again", len(site.starts()) == before + 2, (site.starts(), errors))
    check("the file is complete, each byte once", facts.get("bytes") == os.path.getsize(data + "/long.stl"),
          (out, errors))
    program = site.start_program("fetch", "--rate", "8000000", "--timeout", "60", site.url(data + "/long.stl"))
    time.sleep(1.5)
    check("a server runs", len(servers_of(site)) == 1, servers_of(site))
    program.kill()
    program.wait()
    check("a killed client ends the remote server", ends_soon(lambda: servers_of(site)), servers_of(site))


def check_errors(site):
    world = site.url(site.folder + "/data/sub/ball.wrl")
    site.write("known", "")
    status, out, errors = site.run("check", world)
    check("an unknown host key", status != 0 and "host key" in errors and "once in a terminal" in errors, errors)
    with open(site.folder + "/user.pub") as key:
        site.write("known", "[127.0.0.1]:%d %s\n" % (site.port, " ".join(key.read().split()[:2])))
    status, out, errors = site.run("check", world)
    check("a changed host key", status != 0 and "has changed" in errors, errors)
    site.write("known", site.known)
    os.rename(site.folder + "/authorized", site.folder + "/none")
    status, out, errors = site.run("check", world)
    check("a refused login", status != 0 and "refuses the login" in errors, errors)
    os.rename(site.folder + "/none", site.folder + "/authorized")
    status, out, errors = site.run("check", "ssh://127.0.0.1:%d/a.wrl" % free_port())
    check("no ssh server", status != 0 and "no ssh server answers" in errors, errors)
    status, out, errors = site.run("check", "ssh://host.invalid/a.wrl")
    check("an unknown host", status != 0 and "no host of this name" in errors, errors)
    status, out, errors = site.run("check", "ssh://-oProxyCommand=touch%20x/a.wrl")
    check("an option as host", status != 0 and "invalid" in errors, errors)
    status, out, errors = site.run("check", "--remote-command", "sh -c 'echo no allocation >&2; exit 4'", world)
    check("a remote command that fails", "status 4: no allocation" in errors, errors)
    site.write("remote-bin/ghostspace", "#!/bin/sh\nprintf '\\0GhostSpace tunnel\\n'\n"
                                        "printf '\\0\\0\\0\\027\\001\\0\\0\\0\\0protocols 7\\nversion 9.1'; sleep 5\n")
    status, out, errors = site.run("check", world)
    check("another protocol", "9.1 does not speak the protocol" in errors, errors)
    for line in errors.splitlines():
        check("one line: " + line[:60], len(line) < 500, line)


def check_sftp(site):
    data = site.folder + "/data"
    site.install(False)
    status, out, errors = site.run("check", site.url(data + "/world2.wrl"))
    check("SFTP reads a world", status == 0, errors)
    check("the message has the command that installs", "install it with: ssh -p %d" % site.port in errors, errors)
    status, out, errors = site.run("fetch", "--json", site.url(data + "/mesh.qnv"))
    facts = json.loads(out) if out.startswith("{") else {}
    check("SFTP reads a stream", facts.get("bytes") == os.path.getsize(data + "/mesh.qnv"), errors)
    status, out, errors = site.run("fetch", "--json", "--timeout", "60", site.url(data + "/long.stl"))
    facts = json.loads(out) if out.startswith("{") else {}
    check("SFTP reads a long file", facts.get("bytes") == os.path.getsize(data + "/long.stl"), errors)
    site.install(True)


def check_install(site):
    """The command of the message, with a home folder of its own."""
    site.install(False)
    status, out, errors = site.run("check", site.url(site.folder + "/data/world2.wrl"))
    found = re.search(r"install it with: (.*?); until then", errors)
    check("the installing command is found", found is not None, errors)
    site.install(True)


def write_mesh(path, triangles):
    import struct
    with open(path, "wb") as file:
        file.write(b"\0" * 80 + struct.pack("<I", triangles))
        side = max(2, int((triangles / 2) ** 0.5))
        for i in range(triangles):
            x, y = (i // 2) % side, (i // 2) // side
            z = ((x * 7 + y * 13) % 11) * 0.05
            corners = [(x, y, z), (x + 1, y, z), (x, y + 1, z)] if i % 2 == 0 else [(x + 1, y, z), (x + 1, y + 1, z), (x, y + 1, z)]
            file.write(struct.pack("<12fH", 0, 0, 1, *[value for corner in corners for value in corner], 0))


def main():
    for needed in ("/usr/sbin/sshd", "/usr/bin/ssh", "/usr/bin/ssh-keygen"):
        if not os.path.exists(needed):
            print("skipped: %s is missing (Debian: openssh-server, openssh-client)" % needed)
            return 0
    folder = tempfile.mkdtemp(prefix="ghostspace-ssh-")
    site = None
    try:
        site = Site(folder)
        for name, text in (("data/world.wrl", WORLD), ("data/sub/ball.wrl", BALL), ("data/link.wrl", BALL),
                           ("outside/secret.wrl", BALL), ("data/climbs.wrl", "#VRML V2.0 utf8\nInline { url \"../outside/secret.wrl\" }\n"),
                           ("data/world2.wrl", "#VRML V2.0 utf8\nInline { url \"sub/ball.wrl\" }\n")):
            site.write(name, text)
        write_mesh(folder + "/data/mesh.stl", 20000)
        write_mesh(folder + "/data/long.stl", 80000)
        check_worlds(site)
        check_streams(site)
        check_drops(site)
        check_errors(site)
        check_sftp(site)
        check_install(site)
        check("no remote server remains", ends_soon(lambda: servers_of(site)), servers_of(site))
    finally:
        if site:
            site.stop()
        shutil.rmtree(folder, ignore_errors=True)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
