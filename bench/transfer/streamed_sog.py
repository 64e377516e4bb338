#!/usr/bin/env python3
"""Makes a streamed SOG (lod-meta.json) of copies of a scene, in several levels of detail.

  streamed_sog.py GHOSTSPACE SCENE FOLDER [--copies N] [--spacing D] [--levels BYTES,BYTES,...]

GHOSTSPACE is the program. SCENE is a file of splats. FOLDER gets N x N copies that are D units apart. Level 0 has all splats; each
other level is a stream of at most BYTES bytes, as splats. Every level of every copy is a SOG of its own.
"""
import argparse
import json
import os
import subprocess
import tempfile
import zipfile


def run(*words):
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("folder")
    parser.add_argument("--copies", type=int, default=3)
    parser.add_argument("--spacing", type=float, default=3)
    parser.add_argument("--levels", default="400k,100k,25k")
    chosen = parser.parse_args()
    names, leaves = [], []
    with tempfile.TemporaryDirectory() as scratch:
        sources = [chosen.scene]
        for level, size in enumerate(chosen.levels.split(",")):
            sources.append(os.path.join(scratch, f"level{level + 1}.qnv"))
            run(chosen.program, "encode", "--max-bytes", size, chosen.scene, sources[-1])
        for copy in range(chosen.copies**2):
            place = (copy % chosen.copies * chosen.spacing, 0, -(copy // chosen.copies) * chosen.spacing)
            leaf = {"lods": {}}
            for level, source in enumerate(sources):
                packed = os.path.join(scratch, "part.sog")
                run(chosen.program, "export", "--move", ",".join(map(str, place)), source, packed)
                name = f"{level}_{copy}"
                with zipfile.ZipFile(packed) as archive:
                    archive.extractall(os.path.join(chosen.folder, name))
                with open(os.path.join(chosen.folder, name, "meta.json"), encoding="utf-8") as file:
                    meta = json.load(file)
                leaf["lods"][str(level)] = {"file": len(names), "offset": 0, "count": meta["count"]}
                names.append(f"{name}/meta.json")
                if level == 1:
                    leaf["bound"] = {end: [round(unlog(v), 6) for v in meta["means"][end + "s"]] for end in ("min", "max")}
            leaves.append(leaf)
    whole = {"version": 1, "lodLevels": len(sources), "environment": None, "filenames": names, "tree": {"children": leaves}}
    with open(os.path.join(chosen.folder, "lod-meta.json"), "w", encoding="utf-8") as file:
        json.dump(whole, file)


def unlog(value):
    """Returns the coordinate that SOG stores as sign(x) * log(1 + |x|)."""
    return (2.718281828459045 ** abs(value) - 1) * (1 if value >= 0 else -1)


if __name__ == "__main__":
    main()
