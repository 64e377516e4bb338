#!/usr/bin/env python3
"""gpu_check.py [OPTIONS] [PROGRAM]: compares pictures that a GPU draws with those of the software driver.

Draws each world three times: twice with --backend, first with empty shader caches of the driver, and once with
--against. Prints the PSNR of both pictures and the seconds from the start of the program to the picture in its file.
Fails if a picture is missing or differs, or if the processor draws all of them.

    scripts/checks/gpu_check.py                            the demo world and the splats and volumes of ../shared
    scripts/checks/gpu_check.py --world a.wrl --world b.ply --size 3840x2160
    scripts/checks/gpu_check.py --against same:cpu         compares the two paths that draw splats
    scripts/checks/gpu_check.py --against none --keep gpu  draws on a machine without OSMesa, ...
    scripts/checks/gpu_check.py --reference gpu            ... and compares on another one

Needs python3-numpy and python3-pil. PROGRAM is build/release/ghostspace unless named.
"""

import argparse
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SHARED = pathlib.Path(os.environ.get("GHOSTSPACE_SHARED", ROOT.parent / "shared"))
# Worlds, options, and minimum PSNR in dB. It is lower for polygons, because drivers sample their edges differently.
WORLDS = [
    (ROOT / "assets/worlds/demo.wrl", "", 30),
    (SHARED / "data/splats/biker.compressed.ply", "", 45),
    (SHARED / "data/splats/biker.compressed.ply", "--samples 1 --background transparent", 45),
    (SHARED / "data/splats/guitar.compressed.ply", "", 45),
    (SHARED / "data/splats/playcanvas-logo/meta.json", "", 45),
    (SHARED / "data/splats/train-1000.ply", "", 45),
    (SHARED / "data/splats-formats/playbot/lod-meta.json", "", 45),
    (SHARED / "data/volumes/vtkdata/neghip.slc", "", 35),
    (SHARED / "data/volumes/vtkdata/neghip.slc", "--projection maximum", 35),
    (SHARED / "data/volumes/headsq/headsq_quarter.nhdr", "", 35),
    (ROOT / "assets/worlds/demo-bonsai.qnv", "", 30),
    (ROOT / "assets/worlds/demo-pod.qnv", "", 30),
]
CACHES = ("XDG_CACHE_HOME", "MESA_SHADER_CACHE_DIR", "__GL_SHADER_DISK_CACHE_PATH")


def psnr(a, b):
    """Returns the PSNR of two pictures of premultiplied colours in dB, or 0 if their sizes differ."""
    a, b = (numpy.asarray(Image.open(f).convert("RGBA")).astype(float) for f in (a, b))
    for picture in (a, b):
        picture[..., :3] *= picture[..., 3:] / 255
    if a.shape != b.shape:
        return 0.0
    error = ((a - b) ** 2).mean()
    return math.inf if error == 0 else 10 * math.log10(255 ** 2 / error)


def draw(options, world, more, backend, splats, picture, cache):
    """Draws one picture. Returns the measurements of the program, or None, and an error text."""
    stats = picture.with_suffix(".json")
    command = [options.program, "--snapshot", picture, "--stats", stats, "--size", options.size, "--backend", backend,
               "--splats", splats, "--no-config", "--offline", *more.split(), world]
    environment = dict(os.environ, **dict.fromkeys(CACHES, str(cache)))
    picture.unlink(missing_ok=True)
    try:
        run = subprocess.run([str(part) for part in command], env=environment, capture_output=True, text=True, timeout=300)
    except (OSError, subprocess.TimeoutExpired) as error:
        return None, str(error)
    if run.returncode != 0 or not picture.exists():
        return None, run.stderr[-1000:] or f"status {run.returncode}"
    return json.loads(stats.read_text()), ""


def name_of(world, more, number):
    return f"{number:02d}-{world.parent.name}-{world.name}{''.join(more.split())}".replace("/", "_")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default=ROOT / "build/release/ghostspace")
    parser.add_argument("--world", action="append", type=pathlib.Path, help="world to draw instead of the usual ones; repeatable")
    parser.add_argument("--backend", default="auto", help="of the pictures to check [auto]")
    parser.add_argument("--against", default="osmesa",
                        help="backend of the reference, same:cpu for the other path of splats, or none [osmesa]")
    parser.add_argument("--reference", type=pathlib.Path, help="folder with pictures to check, from --keep")
    parser.add_argument("--keep", type=pathlib.Path, help="keep the pictures in this folder")
    parser.add_argument("--size", default="1024x768")
    parser.add_argument("--least", type=float, help="minimum PSNR in dB, instead of that of each world")
    options = parser.parse_args()
    worlds = [(world, "", 30) for world in options.world] if options.world else WORLDS
    against, _, against_splats = options.against.partition(":")
    failures = 0
    renderers = set()
    with tempfile.TemporaryDirectory() as folder:
        kept = options.keep or pathlib.Path(folder) / "pictures"
        kept.mkdir(parents=True, exist_ok=True)
        print("| world | drawn with | splats | cold, s | compile, s | warm, s | second frame, ms | PSNR, dB |")
        print("|---|---|---|--:|--:|--:|--:|--:|", flush=True)
        for number, (world, more, least) in enumerate(worlds):
            if not world.exists():
                print(f"skipped {world}: missing", flush=True)
                continue
            name = name_of(world, more, number)
            own, other = kept / (name + ".png"), kept / (name + ".reference.png")
            cold = warm = None
            problem = ""
            if options.reference:
                own = options.reference / (name + ".png")
            else:
                cache = pathlib.Path(folder) / ("cache" + str(number))
                cache.mkdir()
                cold, problem = draw(options, world, more, options.backend, "auto", own, cache)
                if cold:
                    warm, problem = draw(options, world, more, options.backend, "auto", own, cache)
                renderers.add((warm or {}).get("renderer", ""))
            decibels = math.nan
            good = own.exists() and (warm is not None or options.reference is not None)
            if good and against != "none":
                splats = against_splats or "auto"
                backend = options.backend if against == "same" else against
                reference, problem = draw(options, world, more, backend, splats, other, pathlib.Path(folder))
                decibels = psnr(own, other) if reference else 0.0
                good = decibels >= (options.least or least)
            cells = [""] * 6
            if cold and warm:
                cells = [warm["renderer"] or warm["backend"], warm["splats"], f"{cold['total_s']:.2f}",
                         f"{cold['compile_s']:.2f}", f"{warm['total_s']:.2f}", f"{1000 * warm['frame_s']:.1f}"]
            print("| " + " | ".join([f"{world.name} {more}".strip(), *cells, f"{decibels:.1f}"]) + " |", flush=True)
            if not good:
                failures += 1
                print(f"FAILED  {world} {more}: {problem or 'the pictures differ'}", flush=True)
    software = ("llvmpipe", "softpipe", "swrast", "software", "swiftshader")
    if renderers and all(any(word in name.lower() for word in software) for name in renderers):
        print(f"FAILED  no GPU draws: {', '.join(renderers)}")
        failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
