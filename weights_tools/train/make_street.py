#!/usr/bin/python3
"""Makes a COCO-format data set of many short drives through synthetic streets, each on a road of its own.

  make_street.py --out out/street_train --drives 50 --first-seed 100
  make_street.py --out out/street_val --drives 6 --first-seed 900

Every drive has a random road with a bend to either side, 40 frames three metres apart, and every other one is crowded.
Writes DRIVE/ as `penumbra synth` does (right and grey images are removed: training needs the left colour image) and
instances.json, whose file names are relative to --out. Drives that are there already are kept.
"""
import argparse
import json
import pathlib
import shutil
import subprocess

import numpy as np

PENUMBRA = str(pathlib.Path(__file__).resolve().parents[2] / "build" / "penumbra")


def road(seed, frames, spacing):
    """KITTI poses along a straight, a bend of 20 to 90 degrees, a straight, and the bend undone."""
    random = np.random.default_rng(seed)
    side = random.choice([-1.0, 1.0])
    angle, radius = side * np.radians(random.uniform(20, 90)), random.uniform(12, 30)
    first, middle = random.uniform(5, 60), random.uniform(20, 60)
    turn = abs(angle) * radius
    position, heading, lines = np.zeros(2), 0.0, []
    for k in range(frames):
        c, s = np.cos(heading), np.sin(heading)
        lines.append([c, 0, s, position[0], 0, 1, 0, 0, -s, 0, c, position[1]])
        for step in range(10):  # small steps along the curve
            at = (k + step / 10) * spacing - first
            curvature = 0.0
            if 0 <= at < turn:
                curvature = angle / turn
            elif turn + middle <= at < 2 * turn + middle:
                curvature = -angle / turn
            heading += curvature * spacing / 10
            position = position + spacing / 10 * np.array([np.sin(heading), np.cos(heading)])
    return lines


def synth(options, *arguments):
    subprocess.run([*options.prefix.split(), options.penumbra, "synth", *arguments], check=True, stdout=subprocess.DEVNULL)


def drive(options, out, seed):
    if (out / "annotations" / "instances.json").exists():
        return
    shutil.rmtree(out, ignore_errors=True)
    path = out.with_suffix(".poses")
    path.write_text("".join(" ".join(f"{v:.6f}" for v in line) + "\n"
                            for line in road(seed, options.frames, options.spacing)))
    preset = "crowded" if seed % 2 else "street"
    synth(options, "--path", path, "--preset", preset, "--seed", str(seed), "--colour", "--annotations", "--size", options.size,
          "--out", out)
    for folder in ("image_0", "image_1", "image_3"):
        shutil.rmtree(out / "sequences" / "00" / folder)


def merge(out, names):
    """One instances.json with ids of its own."""
    images, annotations, categories = [], [], None
    for name in names:
        content = json.loads((out / name / "annotations" / "instances.json").read_text())
        categories = content["categories"]
        first = len(images)
        new_id = {image["id"]: first + k for k, image in enumerate(content["images"])}
        images += [dict(i, id=new_id[i["id"]], file_name=f"{name}/{i['file_name']}") for i in content["images"]]
        annotations += [dict(a, id=len(annotations) + k + 1, image_id=new_id[a["image_id"]])
                        for k, a in enumerate(content["annotations"])]
    (out / "instances.json").write_text(json.dumps(dict(images=images, annotations=annotations, categories=categories)))
    print(f"{len(images)} images, {len(annotations)} objects in {out}")


def add_arguments(parser):
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--first-seed", type=int, default=100)
    parser.add_argument("--penumbra", default=PENUMBRA)
    parser.add_argument("--prefix", default="", help="command to run synth with, such as 'nice -n 10'")


def make_all(options, kind, count, make):
    """`count` recordings, make(options, folder, seed) each, as one data set."""
    options.out.mkdir(parents=True, exist_ok=True)
    seeds = range(options.first_seed, options.first_seed + count)
    for seed in seeds:
        make(options, options.out / f"{kind}_{seed:04d}", seed)
    merge(options.out, [f"{kind}_{seed:04d}" for seed in seeds])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_arguments(parser)
    parser.add_argument("--drives", type=int, default=50)
    parser.add_argument("--frames", type=int, default=40, help="frames a drive")
    parser.add_argument("--spacing", type=float, default=3.0, help="metres from frame to frame")
    parser.add_argument("--size", default="620x188")
    options = parser.parse_args()
    make_all(options, "drive", options.drives, drive)


if __name__ == "__main__":
    main()
