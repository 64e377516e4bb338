#!/usr/bin/env python3
"""scale_check.py [-k PART] [--seconds N] [--clients N] [--s3rver FILE]: checks serving at scale on loopback.

Runs as an unprivileged user (as root, it first becomes `nobody`), and ends all that it started. Parts:
  nginx     static streams: types, ranges, validators, CORS, caching, HTTP/2; a picture equals that of the local file
  s3        presigned URLs of an S3 stand-in: the signature is in each range, and in no output, log or cache; listing by
            pages; Zarr arrays without listing; an object that changes between two ranges
  lists     lists of the S3 stand-in as folders: a scan of 1,100 DICOM files, a series of 1,100 files, groups of Zarr
  cdn       nginx as a cache in slices before `serve --max-age`: what reaches the origin, and headers that survive
  series    a series in JSON on a web server: steps by number, and a new step
  replicas  two `serve` processes with copies of a folder behind nginx: equal tags and bytes; one is killed under load
  load      serve_load.py with N clients (1000) for N seconds (20)

The S3 stand-in is s3rver 3.7.1 from npm. With --npm, it is installed into a temporary folder; else $S3RVER or --s3rver
names its program. A part is skipped with a message if nginx, npm or curl is missing.

GHOSTSPACE: program instead of build/release/ghostspace.
"""

import argparse
import asyncio
import base64
import datetime
import encodings.idna  # noqa: F401  before the change of users, who may not read the folder of this Python
import hashlib
import hmac
import http.client
import http.server
import json
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = os.path.abspath(os.environ.get("GHOSTSPACE", ROOT / "build/release/ghostspace"))
SECRET = "S3RVER"  # key and secret of s3rver
failures = 0


def check(name, good, detail=""):
    global failures
    print(("ok      " if good else "FAILED  ") + name + ("" if good else f": {str(detail)[-1200:]}"), flush=True)
    failures += not good


def skip(part, why):
    print(f"skipped {part}: {why}", flush=True)


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def wait_for_port(port, process, seconds=20):
    for _ in range(int(seconds * 20)):
        if process.poll() is not None:
            return False
        try:
            socket.create_connection(("127.0.0.1", port), 1).close()
            return True
        except OSError:
            time.sleep(0.05)
    return False


def get(port, target, headers=None, method="GET"):
    """Returns (status, headers in lower case, body)."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request(method, target, headers=headers or {})
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer.status, {name.lower(): value for name, value in answer.getheaders()}, body


def ball(edge, shift=0.0):
    values = bytearray()
    for z in range(edge):
        for y in range(edge):
            for x in range(edge):
                far = ((x - edge / 2 - shift) ** 2 + (y - edge / 2) ** 2 + (z - edge / 2) ** 2) ** 0.5
                noise = (x * 7919 + y * 104729 + z * 1299709) % 31
                values += int(max(0, 4000 - 4000 * far / edge * 1.6) + noise).to_bytes(2, "little")
    head = f"NRRD0004\ntype: uint16\ndimension: 3\nsizes: {edge} {edge} {edge}\nendian: little\nencoding: raw\n\n"
    return head.encode() + bytes(values)


class Work:
    """Folder and processes of this run."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.started = []
        self.site = self.folder / "site"
        self.site.mkdir()
        # Only programs that every user may run.
        self.environment = {"PATH": "/usr/local/bin:/usr/bin:/bin:/usr/sbin", "HOME": str(self.folder / "home"),
                            "LC_ALL": "C.UTF-8"}
        (self.folder / "home").mkdir()

    def start(self, command, name, environment=None, **more):
        log = open(self.folder / f"{name}.log", "ab")
        environment = {**self.environment, **(environment or {})}
        process = subprocess.Popen([str(part) for part in command], stdout=log, stderr=log, env=environment,
                                   cwd=self.folder, start_new_session=True, **more)
        self.started.append(process)
        return process

    def log(self, name):
        return (self.folder / f"{name}.log").read_text(errors="replace")

    def run(self, *arguments, cache=None, home=None):
        environment = dict(self.environment)
        if cache:
            environment["XDG_CACHE_HOME"] = str(cache)
        if home:
            environment["HOME"] = str(home)
        return subprocess.run([PROGRAM, *[str(a) for a in arguments]], env=environment, cwd=self.folder, text=True,
                              capture_output=True, timeout=300)

    def picture(self, source, *options, cache=None):
        """Returns (bytes of a small picture or None, completed process)."""
        path = self.folder / f"picture-{time.monotonic_ns()}.png"
        done = self.run("--snapshot", path, "--size", "96x72", "--timeout", "120", *options, source, cache=cache)
        return (path.read_bytes() if path.exists() else None), done

    def nginx(self, name, port, servers, http=""):
        at = self.folder / name
        at.mkdir(exist_ok=True)
        folders = "".join(f"{kind}_temp_path {at}/{kind};\n" for kind in
                          ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        (at / "nginx.conf").write_text(
            f"daemon off;\npid {at}/pid;\nerror_log {at}/errors.log;\nworker_processes 1;\nworker_rlimit_nofile 8192;\n"
            f"events {{ worker_connections 4096; }}\nhttp {{\naccess_log {at}/access.log;\n{folders}{http}\n{servers}\n}}\n")
        process = self.start(["nginx", "-c", at / "nginx.conf", "-p", at, "-e", at / "errors.log"], name)
        if not wait_for_port(port, process):
            raise RuntimeError("nginx does not start: " + self.log(name))
        return process

    def end(self):
        for process in reversed(self.started):
            if process.poll() is None:
                try:
                    os.killpg(process.pid, signal.SIGTERM)
                    process.wait(5)
                except (OSError, subprocess.TimeoutExpired):
                    process.kill()
                    process.wait()


def documented_block():
    text = (ROOT / "docs/serving.md").read_text()
    begin = text.index("```nginx\n") + 9
    return text[begin:text.index("```", begin)]


def check_ranges(port, target, data, part, headers=None):
    """Checks what the loader needs of a server. Returns the tag."""
    status, fields, body = get(port, target, headers)
    tag = fields.get("etag", "")
    check(f"{part}: whole file, strong tag, ranges announced", status == 200 and body == data and tag.startswith('"') and
          fields.get("accept-ranges") == "bytes" and "content-encoding" not in fields, (status, fields))
    status, fields, body = get(port, target, {**(headers or {}), "Range": "bytes=100-299", "If-Range": tag})
    check(f"{part}: range with If-Range", status == 206 and body == data[100:300] and fields.get("etag") == tag and
          fields.get("content-range") == f"bytes 100-299/{len(data)}", (status, fields))
    status, _, _ = get(port, target, {**(headers or {}), "Range": f"bytes={len(data)}-"})
    check(f"{part}: range after the end", status == 416, status)
    status, _, _ = get(port, target, {**(headers or {}), "If-None-Match": tag})
    check(f"{part}: unchanged file", status == 304, status)
    status, fields, body = get(port, target, {**(headers or {}), "Accept-Encoding": "gzip"})
    check(f"{part}: no compression of streams", status == 200 and "content-encoding" not in fields and body == data)
    return tag


def check_nginx(work, options):
    if not shutil.which("nginx", path=work.environment["PATH"]):
        return skip("nginx", "nginx is not installed (Debian: nginx-light)")
    port = free_port()
    work.nginx("static", port, f"server {{ listen 127.0.0.1:{port}; root {work.site};\n{documented_block()}\n}}")
    data = (work.site / "ball.qnv").read_bytes()
    check_ranges(port, "/ball.qnv", data, "nginx")
    _, fields, _ = get(port, "/ball.qnv", {"Origin": "https://example.org"})
    check("nginx: CORS with exposed headers", fields.get("access-control-allow-origin") == "*" and
          all(name in fields.get("access-control-expose-headers", "") for name in ("Content-Range", "ETag")), fields)
    check("nginx: type, and no-cache without versions", fields.get("content-type") == "model/x-qnv" and
          fields.get("cache-control") == "no-cache", fields)
    status, fields, _ = get(port, "/immutable/ball.qnv")
    check("nginx: immutable streams", status == 200 and "immutable" in fields.get("cache-control", "") and
          fields.get("access-control-allow-origin") == "*", (status, fields))
    local, _ = work.picture(work.site / "ball.qnv")
    remote, done = work.picture(f"http://127.0.0.1:{port}/ball.qnv")
    check("nginx: a picture equals that of the local file", local and local == remote, done.stderr)
    if not shutil.which("curl", path=work.environment["PATH"]):
        return skip("nginx, HTTP/2", "curl is not installed")
    second = free_port()
    work.nginx("second", second, f"server {{ listen 127.0.0.1:{second} http2; root {work.site};\n{documented_block()}\n}}")
    done = subprocess.run(["curl", "-s", "--http2-prior-knowledge", "-r", "100-299", "-o", work.folder / "h2.bin", "-w",
                           "%{http_version} %{http_code}", f"http://127.0.0.1:{second}/ball.qnv"], capture_output=True,
                          text=True, timeout=60)
    check("nginx: ranges over HTTP/2", done.stdout == "2 206" and (work.folder / "h2.bin").read_bytes() == data[100:300],
          done.stdout + done.stderr)


def presigned(port, path, seconds=900, query=(), when=None, secret=SECRET, method="GET"):
    """Returns a URL with a signature of version 4, and the signature.

    https://docs.aws.amazon.com/AmazonS3/latest/API/sigv4-query-string-auth.html
    """
    when = when or datetime.datetime.now(datetime.timezone.utc)
    stamp, day = when.strftime("%Y%m%dT%H%M%SZ"), when.strftime("%Y%m%d")
    scope = f"{day}/us-east-1/s3/aws4_request"
    host = f"127.0.0.1:{port}"
    fields = sorted([("X-Amz-Algorithm", "AWS4-HMAC-SHA256"), ("X-Amz-Credential", f"S3RVER/{scope}"), ("X-Amz-Date", stamp),
                     ("X-Amz-Expires", str(seconds)), ("X-Amz-SignedHeaders", "host"), *query])
    text = "&".join(f"{urllib.parse.quote(name, safe='')}={urllib.parse.quote(value, safe='')}" for name, value in fields)
    request = f"{method}\n{urllib.parse.quote(path)}\n{text}\nhost:{host}\n\nhost\nUNSIGNED-PAYLOAD"
    to_sign = f"AWS4-HMAC-SHA256\n{stamp}\n{scope}\n{hashlib.sha256(request.encode()).hexdigest()}"
    key = ("AWS4" + secret).encode()
    for part in (day, "us-east-1", "s3", "aws4_request"):
        key = hmac.new(key, part.encode(), hashlib.sha256).digest()
    signature = hmac.new(key, to_sign.encode(), hashlib.sha256).hexdigest()
    return f"http://{host}{urllib.parse.quote(path)}?{text}&X-Amz-Signature={signature}", signature


def presigned_v2(port, path, seconds=900):
    """Returns a URL with a signature of version 2, which s3rver itself verifies, and the signature."""
    expires = str(int(time.time()) + seconds)
    place = urllib.parse.quote(path)
    signature = base64.b64encode(hmac.new(SECRET.encode(), f"GET\n\n\n{expires}\n{place}".encode(), hashlib.sha1).digest())
    query = urllib.parse.urlencode({"AWSAccessKeyId": "S3RVER", "Expires": expires, "Signature": signature.decode()})
    return f"http://127.0.0.1:{port}{place}?{query}", urllib.parse.quote(signature.decode(), safe="")


def target_of(url):
    parts = urllib.parse.urlsplit(url)
    return f"{parts.path}?{parts.query}"


class Gate(http.server.ThreadingHTTPServer):
    """Proxy that records the requests of a store. It refuses each target that is not in `issued`, unless `open`: s3rver
    does not verify signatures of version 4. With `cut`, it ends the next answer halfway, and calls `cut`."""

    daemon_threads = True
    open = False
    cut = None

    def __init__(self, store):
        self.seen, self.store, self.issued = [], store, set()

        class Handler(http.server.BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def log_message(self, *_):
                pass

            def do_GET(self):
                gate = self.server
                gate.seen.append((self.command, self.path, self.headers.get("Range", "")))
                if not gate.open and self.path not in gate.issued:
                    self.send_response(403)
                    self.send_header("Content-Length", "0")
                    self.end_headers()
                    return
                connection = http.client.HTTPConnection("127.0.0.1", gate.store, timeout=60)
                connection.request(self.command, self.path, headers=dict(self.headers.items()))
                answer = connection.getresponse()
                body = answer.read()
                self.send_response(answer.status)
                for name, value in answer.getheaders():
                    if name.lower() not in ("transfer-encoding", "connection", "keep-alive", "content-length", "date"):
                        self.send_header(name, value)
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                connection.close()
                cut, gate.cut = gate.cut, None
                self.wfile.write(body[:len(body) // 2] if cut else body)
                if cut:
                    cut()
                    self.close_connection = True

            do_HEAD = do_GET

        super().__init__(("127.0.0.1", 0), Handler)
        self.port = self.server_address[1]
        threading.Thread(target=self.serve_forever, daemon=True).start()


def find_s3rver(work, options):
    program = options.s3rver or os.environ.get("S3RVER")
    if program:
        return program
    if not options.npm or not shutil.which("npm", path=work.environment["PATH"]):
        return None
    settings = {name: value for name, value in os.environ.items() if name.lower().startswith(("node_", "npm_"))}
    done = subprocess.run(["npm", "install", "--loglevel=error", "--no-audit", "--no-fund", "--prefix", work.folder / "npm",
                           "s3rver@3.7.1"], env={**work.environment, **settings},
                          capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        print(done.stderr[-500:], end="")
    program = work.folder / "npm/node_modules/.bin/s3rver"
    return program if done.returncode == 0 and program.exists() else None


def put(store, path, data, kind="application/octet-stream"):
    connection = http.client.HTTPConnection("127.0.0.1", store, timeout=60)
    connection.request("PUT", path, body=data, headers={"Content-Type": kind})
    answer = connection.getresponse()
    answer.read()
    connection.close()
    return answer.status == 200


def files_with(folder, text):
    return [str(path) for path in pathlib.Path(folder).rglob("*") if path.is_file() and text.encode() in path.read_bytes()]


def zarr_array(folder):
    """Writes an array of Zarr 2 with 1,100 chunks of 4 x 4 x 4 values."""
    shape = (40, 44, 40)
    folder.mkdir(parents=True)
    (folder / ".zarray").write_text(json.dumps({
        "zarr_format": 2, "shape": shape, "chunks": [4, 4, 4], "dtype": "|u1", "compressor": None, "fill_value": 0,
        "order": "C", "filters": None}))
    (folder / ".zattrs").write_text("{}")
    for z in range(10):
        for y in range(11):
            for x in range(10):
                far = ((z - 5) ** 2 + (y - 5) ** 2 + (x - 5) ** 2) ** 0.5
                (folder / f"{z}.{y}.{x}").write_bytes(bytes([max(0, int(220 - 40 * far))]) * 64)


def start_store(work, options, part):
    """Returns a Gate before a new store, and the port of the store; or (None, None)."""
    program = find_s3rver(work, options)
    if not program:
        skip(part, "no s3rver; pass --npm to install it from npm, or --s3rver FILE")
        return None, None
    store = free_port()
    # s3rver encrypts the tokens of lists with DES.
    process = work.start([program, "-d", work.folder / part, "-a", "127.0.0.1", "-p", store, "--no-vhost-buckets",
                          "--configure-bucket", "bucket"], part, {"NODE_OPTIONS": "--openssl-legacy-provider"})
    if not wait_for_port(store, process, 60):
        check(f"{part}: s3rver starts", False, work.log(part))
        return None, None
    return Gate(store), store


def element(tag, kind, value):
    """Returns an element of a DICOM file in explicit little endian (PS3.5, 7.1.2)."""
    value = value if isinstance(value, bytes) else value.encode()
    value += (b"\0" if kind in ("UI", "OB", "OW") else b" ") * (len(value) % 2)
    long = kind in ("OB", "OW")
    head = bytes([tag >> 16 & 255, tag >> 24, tag & 255, tag >> 8 & 255]) + kind.encode()
    return head + (b"\0\0" + len(value).to_bytes(4, "little") if long else len(value).to_bytes(2, "little")) + value


def slice_of_scan(number):
    """Returns a CT image of 8 x 8 pixels."""
    meta = element(0x00020010, "UI", "1.2.840.10008.1.2.1")
    words = [(0x00280002, 1), (0x00280010, 8), (0x00280011, 8), (0x00280100, 16), (0x00280101, 16), (0x00280102, 15),
             (0x00280103, 0)]
    pixels = b"".join((number % 97 * 10 + x * y).to_bytes(2, "little") for y in range(8) for x in range(8))
    body = (element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2") + element(0x00080018, "UI", f"1.2.3.{number}") +
            element(0x00080060, "CS", "CT") + element(0x0020000D, "UI", "1.2.3") + element(0x0020000E, "UI", "1.2.3.0") +
            element(0x00200013, "IS", str(number)) + element(0x00200032, "DS", f"0\\0\\{number}") +
            element(0x00200037, "DS", "1\\0\\0\\0\\1\\0"))
    for tag, value in words:
        if tag == 0x00280100:
            body += element(0x00280030, "DS", "1\\1")
        body += element(tag, "US", value.to_bytes(2, "little"))
    body += element(0x7FE00010, "OW", pixels)
    length = element(0x00020000, "UL", len(meta).to_bytes(4, "little"))
    return bytes(128) + b"DICM" + length + meta + body


def check_lists(work, options):
    gate, store = start_store(work, options, "lists")
    if not gate:
        return
    gate.open = True
    count = 1100
    scan, group = work.folder / "scan", work.folder / "group.zarr"
    scan.mkdir()
    for number in range(count):
        (scan / f"{number:05}.dcm").write_bytes(slice_of_scan(number))
    for number in range(count):
        lines = f"#VRML V2.0 utf8\nShape {{ geometry Box {{ size 1 {1 + number / 100} 1 }} }}\n"
        (work.folder / f"step{number:04}.wrl").write_text(lines)
    zarr_array(group / "inner" / "t")
    (group / ".zgroup").write_text('{"zarr_format": 2}')
    (group / "inner" / ".zgroup").write_text('{"zarr_format": 2}')
    files = {f"scan/{path.name}": path for path in scan.iterdir()}
    files |= {f"run/{path.name}": path for path in work.folder.glob("step*.wrl")}
    files |= {str(path.relative_to(work.folder)): path for path in group.rglob("*") if path.is_file()}
    check(f"lists: upload of {len(files)} objects",
          all(put(store, f"/bucket/{name}", path.read_bytes()) for name, path in files.items()))
    host = f"http://127.0.0.1:{gate.port}/bucket"

    def compare(name, local, remote, *arguments):
        gate.seen.clear()
        expected, near = work.picture(*local)
        picture, far = work.picture(remote, *arguments, cache=work.folder / "lists-cache")
        lists = [path for _, path, _ in gate.seen if "list-type=2" in path]
        check(f"lists: {name}: equals the local one; {len(gate.seen)} requests, {len(lists)} of them for lists",
              expected and expected == picture and lists, near.stderr + far.stderr)
        return lists

    pages = compare(f"a scan of {count} DICOM files in a bucket", [scan], f"{host}/scan/")
    check("lists: its list has several pages", any("continuation-token=" in path for path in pages), pages)
    compare("the URL of a list", [scan], f"{host}?list-type=2&prefix=scan/")
    step = work.folder / f"step{count - 1:04}.wrl"
    compare(f"the last of {count} numbered files", [step], f"{host}/run/step%04d.wrl", "--time", "1099")
    compare("a group of Zarr without consolidated metadata", [group], f"{host}/group.zarr")
    _, done = work.picture(f"{host}/none/", cache=work.folder / "lists-cache")
    check("lists: an empty prefix gives one line", done.returncode == 1 and done.stderr.count("\n") == 1, done.stderr)
    gate.shutdown()


def check_s3(work, options):
    gate, store = start_store(work, options, "s3")
    if not gate:
        return
    data = (work.site / "ball.qnv").read_bytes()
    check("s3: upload", put(store, "/bucket/run%207/ball.qnv", data, "model/x-qnv"))
    local, _ = work.picture(work.site / "ball.qnv")
    for version, (url, signature) in (("2", presigned_v2(gate.port, "/bucket/run 7/ball.qnv")),
                                      ("4", presigned(gate.port, "/bucket/run 7/ball.qnv"))):
        target = target_of(url)
        gate.issued.add(target)
        status, fields, body = get(gate.port, target, {"Range": "bytes=100-299"})
        check(f"s3: ranges of a presigned URL of version {version}", status == 206 and body == data[100:300] and
              fields.get("content-range") == f"bytes 100-299/{len(data)}" and fields.get("etag", "").startswith('"'),
              (status, fields, body[:300]))
        bad = target.replace(signature, signature[:-6] + "0" * 6)
        if version == "2":
            gate.issued.add(bad)  # s3rver refuses it
        check(f"s3: a wrong signature of version {version} is refused", get(gate.port, bad)[0] == 403)
        gate.seen.clear()
        remote, done = work.picture(url, "--stats", work.folder / "stats.json", cache=work.folder / f"s3-cache{version}")
        check("s3: its picture equals that of the local file", local and local == remote, done.stderr)
        ranges = [one for one in gate.seen if one[2]]
        check(f"s3: the signature is in all {len(gate.seen)} requests, {len(ranges)} of them ranges",
              gate.seen and all(path == target for _, path, _ in gate.seen), gate.seen[:3])
        texts = done.stdout + done.stderr + (work.folder / "stats.json").read_text()
        info = work.run("info", url, cache=work.folder / f"s3-cache{version}")
        fetched = work.run("fetch", "--json", url, cache=work.folder / f"s3-cache{version}")
        texts += info.stdout + info.stderr + fetched.stdout + fetched.stderr
        check("s3: snapshot, info and fetch print no signature", info.returncode == fetched.returncode == 0 and
              signature not in texts and "X-Amz" not in texts and "Signature" not in texts, texts)
        found = files_with(work.folder / f"s3-cache{version}", "ignature")
        check("s3: the cache has no signature", (work.folder / f"s3-cache{version}").exists() and not found, found)
    # Another signature of the same object: the cache has its bytes.
    again, _ = presigned(gate.port, "/bucket/run 7/ball.qnv", seconds=901)
    gate.issued.add(target_of(again))
    gate.seen.clear()
    before = sum(1 for _ in (work.folder / "s3-cache4").rglob("*"))
    remote, done = work.picture(again, cache=work.folder / "s3-cache4")
    check("s3: another signature of the object finds it in the cache", local == remote and
          sum(1 for _ in (work.folder / "s3-cache4").rglob("*")) == before, done.stderr)
    past = datetime.datetime.now(datetime.timezone.utc) - datetime.timedelta(hours=2)
    old, old_signature = presigned(gate.port, "/bucket/run 7/ball.qnv", seconds=60, when=past)
    gate.issued.add(target_of(old))
    _, done = work.picture(old, cache=work.folder / "s3-empty-cache")
    check("s3: an expired URL gives one line without the signature", done.returncode == 1 and "403" in done.stderr and
          old_signature not in done.stderr and "X-Amz" not in done.stderr and done.stderr.count("\n") == 1, done.stderr)
    # An object that changes during the transfer. s3rver ignores If-Range, as other stores do.
    changed = (work.site / "other.qnv").read_bytes()
    expected, _ = work.picture(work.site / "other.qnv")
    gate.seen.clear()
    gate.cut = lambda: put(store, "/bucket/run%207/ball.qnv", changed, "model/x-qnv")
    mixed, done = work.picture(again, cache=work.folder / "s3-third-cache")
    check("s3: a changed object is never mixed with its former version", gate.cut is None and
          (mixed == expected or (done.stderr and mixed != expected)), done.stderr)
    later, done = work.picture(again, cache=work.folder / "s3-third-cache")
    check("s3: afterwards, the new version is shown", later == expected, done.stderr)
    # Listing by pages, and an array that needs no listing.
    zarr_array(work.folder / "t.zarr")
    names = sorted(path.name for path in (work.folder / "t.zarr").iterdir())
    check(f"s3: upload of {len(names)} chunks and metadata",
          all(put(store, f"/bucket/t.zarr/{name}", (work.folder / "t.zarr" / name).read_bytes()) for name in names))
    # Version 1 of the list; the part "lists" reads version 2.
    found, pages = [], 0
    while pages < 10:
        query = [("prefix", "t.zarr/")] + ([("marker", "t.zarr/" + found[-1])] if found else [])
        url, _ = presigned(gate.port, "/bucket", query=query)
        gate.issued.add(target_of(url))
        status, _, body = get(gate.port, target_of(url))
        text = body.decode()
        found += re.findall(r"<Key>t\.zarr/([^<]*)</Key>", text)
        pages += 1
        if status != 200 or "<IsTruncated>true" not in text:
            break
    check(f"s3: {pages} pages list all objects", sorted(found) == names and pages >= 2, (status, len(found), text))
    gate.open = True
    gate.seen.clear()
    local, done = work.picture(work.folder / "t.zarr")
    remote, away = work.picture(f"http://127.0.0.1:{gate.port}/bucket/t.zarr", cache=work.folder / "s3-zarr-cache")
    check(f"s3: a Zarr array with {len(names)} objects, {len(gate.seen)} requests, no listing", local and local == remote and
          not any("prefix=" in path or path.endswith("/") for _, path, _ in gate.seen), done.stderr + away.stderr)
    gate.shutdown()


def serve(work, folder, name, port, *options):
    cache = work.folder / f"{name}-cache"
    cache.mkdir(exist_ok=True)
    process = work.start([PROGRAM, "serve", folder, "--http", port, "--cache", cache, "--log",
                          work.folder / f"{name}.access", *options], name)
    if not wait_for_port(port, process):
        raise RuntimeError("serve does not start: " + work.log(name))
    return process


def sent_bytes(port):
    _, _, body = get(port, "/metrics", {"Host": f"127.0.0.1:{port}"})
    return int(re.search(rb"ghostspace_http_sent_bytes_total (\d+)", body).group(1))


def check_cdn(work, options):
    if not shutil.which("nginx", path=work.environment["PATH"]):
        return skip("cdn", "nginx is not installed (Debian: nginx-light)")
    origin, port = free_port(), free_port()
    serve(work, work.site, "origin", origin, "--max-age", "31536000", "--cors", "*")
    work.nginx("cdn", port, f"""
server {{ listen 127.0.0.1:{port};
  location / {{
    slice 256k;
    proxy_cache cdn; proxy_cache_key $uri$slice_range; proxy_set_header Range $slice_range;
    proxy_http_version 1.1; proxy_cache_valid 200 206 1h; proxy_set_header Host $host;
    add_header X-Cache-Status $upstream_cache_status;
    proxy_pass http://127.0.0.1:{origin};
  }}
}}""", f"proxy_cache_path {work.folder}/cdn/store levels=1 keys_zone=cdn:1m max_size=100m;")
    data = (work.site / "ball.qnv").read_bytes()
    before = sent_bytes(origin)
    tag = check_ranges(port, "/ball.qnv", data, "cdn")
    first = sent_bytes(origin) - before
    _, fields, _ = get(port, "/ball.qnv", {"Range": "bytes=0-9", "Origin": "https://example.org"})
    check("cdn: headers survive", "immutable" in fields.get("cache-control", "") and fields.get("etag") == tag and
          fields.get("access-control-allow-origin") == "*" and "Content-Range" in
          fields.get("access-control-expose-headers", ""), fields)
    before = sent_bytes(origin)
    for number in range(40):
        begin = number * 977 % (len(data) - 500)
        status, _, body = get(port, "/ball.qnv", {"Range": f"bytes={begin}-{begin + 499}"})
        if status != 206 or body != data[begin:begin + 500]:
            check("cdn: ranges", False, (status, len(body)))
            break
    again = sent_bytes(origin) - before
    check(f"cdn: the origin sent {first} bytes of a file of {len(data)} for 6 requests, then {again} for 40 ranges",
          first < 2 * len(data) and again < 4000)  # the metrics themselves
    local, _ = work.picture(work.site / "ball.qnv")
    remote, done = work.picture(f"http://127.0.0.1:{port}/ball.qnv", cache=work.folder / "cdn-cache")
    check("cdn: a picture equals that of the local file", local and local == remote, done.stderr)


def check_series(work, options):
    if not shutil.which("nginx", path=work.environment["PATH"]):
        return skip("series", "nginx is not installed (Debian: nginx-light)")
    folder = work.folder / "run"
    folder.mkdir()
    steps = []

    def add(number):
        source = folder / "step.nrrd"
        source.write_bytes(ball(20, number * 3.0))
        work.run("encode", source, folder / f"step{number}.qnv")
        source.unlink()
        steps.append({"name": f"step{number}.qnv", "time": 0.25 * number})
        new = folder / "run.series.new"
        new.write_text(json.dumps({"file-series-version": "1.0", "files": steps}))
        new.rename(folder / "run.qnv.series")

    port = free_port()
    for number in range(3):
        add(number)
    work.nginx("series", port, f"server {{ listen 127.0.0.1:{port}; root {folder};\n{documented_block()}\n}}")
    url = f"http://127.0.0.1:{port}/run.qnv.series"
    pictures = []
    for number in range(3):
        local, _ = work.picture(folder / f"step{number}.qnv")
        remote, done = work.picture(url, "--time", number, cache=work.folder / "series-cache")
        check(f"series: step {number} on a web server", local and local == remote, done.stderr)
        pictures.append(remote)
    check("series: the steps differ", len(set(pictures)) == 3)
    remote, _ = work.picture(url, "--time", "0.3", cache=work.folder / "series-cache")
    check("series: a step by its time", remote == pictures[1])
    add(3)
    local, _ = work.picture(folder / "step3.qnv")
    remote, done = work.picture(url, "--time", 3, cache=work.folder / "series-cache")
    check("series: a new step", local and local == remote, done.stderr)


async def read_through(port, number, target, data, tag, state):
    """Reads ranges of a file through the proxy until state["running"] is False. Repeats a failed range."""
    reader = writer = None
    piece = 256 << 10
    begin = number * 7919 % (len(data) - piece)
    while state["running"]:
        try:
            if writer is None:
                reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=1 << 20)
            writer.write(f"GET {target} HTTP/1.1\r\nHost: localhost\r\nX-Forwarded-For: 10.{number // 250}.0.{1 + number % 250}"
                         f"\r\nRange: bytes={begin}-{begin + piece - 1}\r\nIf-Range: {tag}\r\n\r\n".encode())
            head = await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), 60)
            status = int(head.split(b" ", 2)[1])
            length = int(re.search(rb"(?i)content-length: (\d+)", head).group(1))
            body = await asyncio.wait_for(reader.readexactly(length), 60)
            if status != 206:
                state["statuses"][status] = state["statuses"].get(status, 0) + 1
                state["failed"].add(number)
                await asyncio.sleep(0.1)
                continue
            if body != data[begin:begin + piece]:
                state["wrong"] += 1
            state["right"] += 1
            state["after"][number] = time.monotonic()
            begin = (begin + piece * 13) % (len(data) - piece)
        except (OSError, asyncio.IncompleteReadError, asyncio.TimeoutError) as problem:
            state["broken"] += 1
            state["failed"].add(number)
            state["problem"] = repr(problem)
            if writer:
                writer.close()
            writer = None
            await asyncio.sleep(0.05)
    if writer:
        writer.close()


async def kill_one(port, target, data, tag, victim, clients, seconds, at_kill):
    state = {"running": True, "right": 0, "wrong": 0, "broken": 0, "statuses": {}, "failed": set(), "after": {}}
    tasks = [asyncio.create_task(read_through(port, number, target, data, tag, state)) for number in range(clients)]
    await asyncio.sleep(seconds / 2)
    at_kill()
    await asyncio.sleep(1)
    state["before"] = state["right"], state["broken"]
    os.kill(victim.pid, signal.SIGKILL)
    killed = time.monotonic()
    await asyncio.sleep(seconds / 2)
    state["running"] = False
    await asyncio.wait(tasks, timeout=70)
    state["served"] = sum(at > killed for at in state["after"].values())
    return state


def check_replicas(work, options):
    if not shutil.which("nginx", path=work.environment["PATH"]):
        return skip("replicas", "nginx is not installed (Debian: nginx-light)")
    folders = [work.folder / name for name in ("one", "two")]
    for folder in folders:
        subprocess.run(["cp", "-a", work.site, folder], check=True)
    ports, port = [free_port(), free_port()], free_port()
    rate = ("--proxies", "127.0.0.1", "--rate", "200000000")
    processes = [serve(work, folder, f"replica{i}", ports[i], *rate) for i, folder in enumerate(folders)]
    upstream = "".join(f"server 127.0.0.1:{one} max_fails=1 fail_timeout=5s;\n" for one in ports)
    work.nginx("front", port, f"""
server {{ listen 127.0.0.1:{port};
  location / {{
    proxy_pass http://replicas; proxy_http_version 1.1; proxy_set_header Connection "";
    proxy_set_header Host localhost; proxy_set_header X-Forwarded-For $proxy_add_x_forwarded_for;
    proxy_next_upstream error timeout; proxy_connect_timeout 2s; proxy_buffering off;
  }}
}}""", f"upstream replicas {{\n{upstream}keepalive 64;\n}}")
    for target in ("/ball.qnv", "/volume.nrrd"):
        answers = [get(one, target, {"Host": "localhost"}) for one in ports]
        check(f"replicas: equal tags of {target}", answers[0][1]["etag"] == answers[1][1]["etag"] and
              answers[0][2] == answers[1][2], [answer[1] for answer in answers])
    made = [get(one, "/volume.nrrd.qnv", {"Host": "localhost"}) for one in ports]
    check("replicas: a stream made on demand has equal bytes and tags on both", made[0][0] == made[1][0] == 200 and
          made[0][2] == made[1][2] and made[0][1]["etag"] == made[1][1]["etag"], [(m[0], m[1]) for m in made])
    kept = [hashlib.sha256(path.read_bytes()).hexdigest() + path.name
            for i in range(2) for path in sorted((work.folder / f"replica{i}-cache").glob("*.qnv"))]
    check("replicas: one stream each in their caches", len(kept) == 2 and kept[0][:64] == kept[1][:64], kept)
    big = (work.site / "big.bin").read_bytes()
    tag = get(ports[0], "/big.bin", {"Host": "localhost"})[1]["etag"]
    clients = min(options.clients, 400)
    # Transfers of the loader itself, with a share of the rate.
    fetches = []

    def fetch():
        for _ in range(4):
            command = [PROGRAM, "fetch", "--json", f"http://127.0.0.1:{port}/volume.nrrd.qnv"]
            fetches.append(subprocess.Popen(command, env=work.environment, text=True, stdout=subprocess.PIPE,
                                            stderr=subprocess.STDOUT))

    state = asyncio.run(kill_one(port, "/big.bin", big, tag, processes[0], clients, options.seconds, fetch))
    outputs = [one.communicate(timeout=120)[0] for one in fetches]
    check("replicas: four transfers of the loader are complete", all(
        '"complete": true' in output and f'"bytes": {len(made[0][2])}' in output for output in outputs), outputs)
    check(f"replicas: {state['right']} right ranges of {clients} clients, {state['before'][0]} of them before the kill; "
          f"{state['broken']} cut transfers, other answers {state['statuses']}", state["wrong"] == 0 and state["right"] > 0 and
          state["before"][1] == 0, state)
    check(f"replicas: all {clients} clients are served after the kill", state["served"] == clients, state["served"])
    check("replicas: the kill costs each client at most one request", state["broken"] + sum(state["statuses"].values()) <=
          clients, state)
    local, _ = work.picture(work.site / "ball.qnv")
    remote, done = work.picture(f"http://127.0.0.1:{port}/ball.qnv", cache=work.folder / "front-cache")
    check("replicas: a picture by the one that is left", local and local == remote, done.stderr)


def check_load(work, options):
    command = [shutil.which("python3", path=work.environment["PATH"]), ROOT / "scripts/checks/serve_load.py",
               "--clients", options.clients, "--seconds", options.seconds]
    done = subprocess.run([str(part) for part in command], text=True, capture_output=True, timeout=600,
                          env={**work.environment, "GHOSTSPACE": PROGRAM})
    print(done.stdout, end="")
    check(f"load: {options.clients} clients", done.returncode == 0, done.stderr)


PARTS = {"nginx": check_nginx, "s3": check_s3, "lists": check_lists, "cdn": check_cdn, "series": check_series, "replicas": check_replicas,
         "load": check_load}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-k", choices=PARTS, action="append")
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--clients", type=int, default=1000)
    parser.add_argument("--s3rver")
    parser.add_argument("--npm", action="store_true")
    parser.add_argument("--keep", action="store_true", help="keep the folder")
    options = parser.parse_args()
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))  # a descriptor per client
    if os.geteuid() == 0:
        os.setgroups([])
        os.setgid(65534)
        os.setuid(65534)
    for name in [name for name in os.environ if name.lower().endswith("_proxy")]:
        del os.environ[name]
    folder = tempfile.mkdtemp(prefix="ghostspace-scale-")
    work = Work(folder)
    try:
        (work.site / "volume.nrrd").write_bytes(ball(80))
        (work.site / "big.bin").write_bytes(random.Random(1).randbytes(24 << 20))
        (work.folder / "other.nrrd").write_bytes(ball(44, 5.0))
        for source, stream in ((work.site / "volume.nrrd", "ball.qnv"), (work.folder / "other.nrrd", "other.qnv")):
            done = work.run("encode", "--lossless", source, work.site / stream)
            if done.returncode != 0:
                print(done.stderr, file=sys.stderr)
                return 2
        (work.site / "immutable").mkdir()
        shutil.copy(work.site / "ball.qnv", work.site / "immutable/ball.qnv")
        for part in options.k or PARTS:
            try:
                PARTS[part](work, options)
            except Exception as problem:  # a part that fails must not stop the others
                check(part, False, repr(problem))
    finally:
        work.end()
        if options.keep:
            print(folder)
        else:
            shutil.rmtree(folder, ignore_errors=True)
    print(f"{failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
