#!/usr/bin/python3
"""compare_worlds.py [LIST [OUT]]: compares our pictures of worlds with those of two other browsers.

LIST names worlds below --worlds, one per line (default: scripts/compare/compare_worlds.txt). OUT (default: build/compare) gets
figures.tsv, the pictures and sheet-N.png. All browsers get the same file. If a world has no Viewpoint or Background, a
copy gets a Viewpoint that frames it, or a black Background; links next to the copy lead to the files of its folder. The
worlds can be VRML97, X3D in XML or classic VRML, VRML 1.0 or Inventor; worlds of the last two get only a camera. Needs
python3-numpy and python3-pil of Debian. The other browsers need the script peer-snapshot.sh next to the worlds (or
--peer-snapshot) and its requirements.
"""
import argparse
import gzip
import json
import math
import os
import re
import subprocess
import sys

import numpy
from PIL import Image, ImageDraw, ImageOps

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SHARED = os.environ.get("GHOSTSPACE_SHARED", os.path.join(os.path.dirname(ROOT), "shared"))
WIDTH, HEIGHT = 1024, 768
FIELD_OF_VIEW = 0.785398  # VRML97 6.53: the default


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("list", nargs="?", default=os.path.join(ROOT, "scripts", "compare", "compare_worlds.txt"))
    parser.add_argument("out", nargs="?", default=os.path.join(ROOT, "build", "compare"))
    parser.add_argument("--worlds", default=os.path.join(SHARED, "worlds"))
    parser.add_argument("--program", default=os.path.join(ROOT, "build", "release", "ghostspace"))
    parser.add_argument("--peers", default="view3dscene,x_ite")
    parser.add_argument("--peer-snapshot", default=os.path.join(SHARED, "peers", "peer-snapshot.sh"))
    parser.add_argument("--limit", default="90", help="seconds for a picture")
    parser.add_argument("--rows", type=int, default=6, help="worlds on a sheet")
    parser.add_argument("--keep", action="store_true", help="draw only what has no picture yet")
    return parser.parse_args()


def framing(box, back=(0.5, 0.4, 1.0)):
    """Returns position and orientation of a camera that sees all of a box. `back` leads from the box to the camera."""
    lower, upper = numpy.array(box["lower"]), numpy.array(box["upper"])
    centre, radius = (lower + upper) / 2, max(float(numpy.linalg.norm(upper - lower)) / 2, 1e-6)
    back = numpy.array(back) / numpy.linalg.norm(back)
    right = numpy.cross([0, 1, 0], back)
    right /= numpy.linalg.norm(right)
    matrix = numpy.column_stack([right, numpy.cross(back, right), back])
    angle = math.acos((numpy.trace(matrix) - 1) / 2)
    axis = numpy.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]])
    axis = axis / numpy.linalg.norm(axis) if angle > 1e-6 else numpy.array([0.0, 0.0, 1.0])
    position = centre + back * (radius / math.sin(FIELD_OF_VIEW / 2) * 1.02)
    return " ".join(f"{v:.9g}" for v in position), " ".join(f"{v:.9g}" for v in [*axis, angle])


def links_to(folder, to):
    """Makes a tree of links to all files of a folder."""
    if not os.path.isdir(to):
        os.makedirs(os.path.dirname(to), exist_ok=True)
        subprocess.run(["cp", "-rs", folder, to], check=True)


CAMERAS = rb"(Viewpoint|GeoViewpoint|OrthoViewpoint|ViewpointGroup|PerspectiveCamera|OrthographicCamera)"
BACKGROUNDS = rb"(Background|TextureBackground|LayerSet)"


def grammar_of(text):
    """Returns the grammar of a world: "vrml1", "xml", "classic" or "vrml97"."""
    if re.match(rb"#(VRML V1|Inventor)", text):
        return "vrml1"
    if text.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        return "xml"
    return "classic" if text.startswith(b"#X3D") else "vrml97"


def has_node(text, grammar, types):
    """Reports whether a world has a node of one of the types."""
    pattern = rb"<%s\b" if grammar == "xml" else rb"\b%s\s*\{"
    return re.search(pattern % types, text)


def insert(text, grammar, added):
    """Returns the text with nodes inserted before its first node."""
    if grammar == "xml":
        end = re.search(rb"<Scene\b[^>]*>", text).end()
        return text[:end] + added + text[end:]
    if grammar == "vrml1":
        header, _, rest = text.partition(b"\n")
        return header + b"\nSeparator {\n" + added + rest + b"\n}\n"
    # Statements of the head of classic VRML come before all nodes (ISO/IEC 19776-2, 4.3.1).
    head = rb"#[^\n]*\n|\s+|(PROFILE|COMPONENT|META|UNIT)\b[^\n]*\n" if grammar == "classic" else rb"#[^\n]*\n"
    end = 0
    while match := re.compile(head).match(text, end):
        end = match.end()
        if grammar == "vrml97":
            break
    return text[:end] + added + text[end:]


def completed(options, world):
    """Returns the path of the world with a Viewpoint and a Background, because browsers have different defaults."""
    source = os.path.join(options.worlds, world)
    with open(source, "rb") as file:
        text = file.read()
    if text.startswith(b"\x1f\x8b"):
        text = gzip.decompress(text)
    grammar = grammar_of(text)
    bare = text if grammar == "xml" else re.sub(rb"#[^\n]*", b"", text)
    added = b""
    if not has_node(bare, grammar, CAMERAS):
        facts = subprocess.run([options.program, "info", "--json", source], capture_output=True, check=False).stdout
        box = json.loads(facts).get("box")
        back = (0, 0, 1) if grammar == "vrml1" else (0.5, 0.4, 1.0)
        position, orientation = framing(box, back) if box else ("0 0 10", "0 0 1 0")
        size = float(numpy.linalg.norm(numpy.array(box["upper"]) - numpy.array(box["lower"]))) if box else 10.0
        if grammar == "xml":
            added += f"<Viewpoint position='{position}' orientation='{orientation}'/>".encode()
        else:
            # Coin clips between the distances 1 and 10 if a camera of VRML 1.0 has none of the fields of Inventor.
            node = f"PerspectiveCamera {{ nearDistance {size / 100:.9g} farDistance {size * 10:.9g}" if grammar == "vrml1" else "Viewpoint {"
            added += f"{node} position {position} orientation {orientation} }}\n".encode()
    if grammar != "vrml1" and not has_node(bare, grammar, BACKGROUNDS):
        added += b"<Background skyColor='0 0 0'/>" if grammar == "xml" else b"Background { skyColor 0 0 0 }\n"
    if not added:
        return source
    tree = os.path.join(options.out, "worlds")
    links_to(os.path.join(options.worlds, world.split("/")[0]), os.path.join(tree, world.split("/")[0]))
    stem, extension = os.path.splitext(os.path.join(tree, world))
    with open(stem + "-completed" + extension, "wb") as file:
        file.write(insert(text, grammar, added))
    return stem + "-completed" + extension


def draw(options, path, world, name):
    """Returns the pictures of a world by browser. Omits browsers that could not draw it."""
    pictures = {}
    for browser in ["ghostspace", *options.peers.split(",")]:
        out = os.path.join(options.out, "pictures", f"{name}-{browser}.png")
        if not (options.keep and os.path.exists(out)):
            if browser == "ghostspace":
                allowed = os.path.join(options.worlds, world.split("/")[0])
                command = [options.program, "--backend", "osmesa", "--allow", allowed, "--offline", "--snapshot", out, path]
            else:
                command = [options.peer_snapshot, browser, path, out]
            try:
                subprocess.run(command, env={**os.environ, "LIMIT": options.limit}, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL, timeout=float(options.limit) + 60, check=False)
            except subprocess.TimeoutExpired:
                pass
        if os.path.exists(out):
            with Image.open(out) as image:
                pictures[browser] = image.convert("RGB").resize((WIDTH, HEIGHT))
    return pictures


def half(image):
    """Returns the image at half its size, so that anti-aliased and other edges differ less."""
    return numpy.asarray(image.resize((WIDTH // 2, HEIGHT // 2), Image.Resampling.BOX), dtype=numpy.int16)


def silhouette(pixels):
    """Returns the pixels that differ from the border pixels of their row: the objects in front of most skies."""
    sides = numpy.stack([numpy.abs(pixels - pixels[:, column : column + 1]).max(axis=2) > 8 for column in (2, -3)])
    return sides.all(axis=0)


def figures(ours, theirs):
    """Returns mean difference (of 255), share of pixels with a channel off by more than 24, and overlap of silhouettes."""
    difference = numpy.abs(ours - theirs)
    a, b = silhouette(ours), silhouette(theirs)
    union = (a | b).sum()
    return {"mean": float(difference.mean()), "share": float((difference.max(axis=2) > 24).mean()),
            "overlap": float((a & b).sum() / union) if union else 1.0}


def sheet(rows, browsers, path):
    """Draws sheets with one row per world: the pictures, and their differences from ours."""
    width, height, label = 256, 192, 14
    page = Image.new("RGB", (width * (2 * len(browsers) - 1), (height + label) * len(rows)), (40, 40, 40))
    pen = ImageDraw.Draw(page)
    for row, (number, world, pictures, numbers) in enumerate(rows):
        top = row * (height + label)
        text = f"{number} {world}"
        for browser, one in numbers.items():
            text += f"   {browser}: {one['mean']:.1f} {100 * one['share']:.1f}% {one['overlap']:.2f}"
        pen.text((3, top + 1), text, fill=(255, 255, 255))
        for column, browser in enumerate(browsers):
            if browser not in pictures:
                continue
            page.paste(pictures[browser].resize((width, height), Image.Resampling.BOX), (column * width, top + label))
            if browser in numbers:
                difference = numpy.abs(half(pictures[browsers[0]]) - half(pictures[browser])).max(axis=2)
                grey = ImageOps.invert(Image.fromarray(numpy.clip(difference * 3, 0, 255).astype(numpy.uint8)))
                page.paste(grey.resize((width, height), Image.Resampling.BOX).convert("RGB"),
                           ((len(browsers) + column - 1) * width, top + label))
    page.save(path)


def main():
    options = arguments()
    options.out = os.path.abspath(options.out)
    os.makedirs(os.path.join(options.out, "pictures"), exist_ok=True)
    with open(options.list, encoding="utf-8") as file:
        worlds = [line.strip() for line in file if line.strip() and not line.startswith("#")]
    browsers = ["ghostspace", *options.peers.split(",")]
    rows = []
    with open(os.path.join(options.out, "figures.tsv"), "w", encoding="utf-8") as table:
        print("number", "world", *(f"{peer} {what}" for peer in browsers[1:] for what in ("mean", "share", "overlap")),
              sep="\t", file=table)
        for number, world in enumerate(worlds, 1):
            pictures = draw(options, completed(options, world), world, f"{number:02}")
            numbers = {}
            if browsers[0] in pictures:
                ours = half(pictures[browsers[0]])
                numbers = {peer: figures(ours, half(pictures[peer])) for peer in browsers[1:] if peer in pictures}
            cells = [f"{numbers[peer][what]:.3f}" if peer in numbers else "-" for peer in browsers[1:]
                     for what in ("mean", "share", "overlap")]
            print(number, world, *cells, sep="\t", file=table, flush=True)
            print(number, world, *cells, flush=True)
            rows.append((number, world, pictures, numbers))
            if len(rows) == options.rows or number == len(worlds):
                sheet(rows, browsers, os.path.join(options.out, f"sheet-{(number - 1) // options.rows + 1:02}.png"))
                rows = []
    return 0


if __name__ == "__main__":
    sys.exit(main())
