#!/usr/bin/python3
"""Makes a COCO-format data set of many short recordings of synthetic offices, each a room with people of its own.

  make_office.py --out out/office_train --rooms 64 --first-seed 100
  make_office.py --out out/office_val --presets --rooms 6 --first-seed 900

A camera on its preset's path sees much the same for seconds, so a room for training is filmed from another place and in
another direction at every frame, near people and far from them, upright and tilted; every eighth room is filmed as its
preset does, of which every --every-th frame is kept. With --presets all are, for validation. Writes ROOM/ as `penumbra synth`
does (of its images only rgb/, for validation depth_clean/ too) and instances.json, whose file names are relative to --out. Rooms that are there already are kept.
"""
import argparse
import json
import pathlib
import shutil

import numpy as np

from make_street import add_arguments, make_all, synth

PRESETS = ("walking-xyz", "walking-halfsphere", "walking-rpy", "sitting-xyz", "walking-static", "sitting-rpy",
           "twolaps", "sitting-halfsphere", "desk", "sitting-static")
# What a room for training shows: people and frames. They sit at first and have risen after two seconds.
ROOMS = (("walking", 100), ("walking", 20), ("sitting", 30), ("walking", 100), ("none", 12), ("walking", 20), ("walking", 100))


def axis_rotation(axis, angle):
    """The quaternion x, y, z, w of a rotation about a coordinate axis."""
    q = np.zeros(4)
    q[axis], q[3] = np.sin(angle / 2), np.cos(angle / 2)
    return q


def product(a, b):
    """Of two quaternions x, y, z, w."""
    return np.append(a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3]), a[3] * b[3] - a[:3] @ b[:3])


def views(seed, frames):
    """A pose file of TUM's: a view a frame, in the frame of the presets' first camera (x right, y down, z forward)."""
    random = np.random.default_rng(seed)
    lines = ["0.000000 0 0 0 0 0 0 1"]
    for k in range(1, frames + 1):  # one more: the last lies between two
        place = random.uniform((-1.2, -0.5, -0.4), (1.2, 0.5, 0.9))
        turn = random.normal(0, np.radians((10, 22, 12)))  # pitch, yaw, roll
        turn[1] -= np.arctan2(place[0], 2.5)  # towards what the presets look at
        q = product(product(axis_rotation(1, turn[1]), axis_rotation(0, turn[0])), axis_rotation(2, turn[2]))
        lines.append(f"{k / 30:.6f} " + " ".join(f"{v:.5f}" for v in (*place, *q)))
    return "\n".join(lines) + "\n"


def keep_every(out, every):
    """Leaves every so many-th frame of a recording."""
    path = out / "annotations" / "instances.json"
    content = json.loads(path.read_text())
    content["images"] = content["images"][::every]
    kept = {image["id"] for image in content["images"]}
    content["annotations"] = [a for a in content["annotations"] if a["image_id"] in kept]
    names = {pathlib.Path(image["file_name"]).name for image in content["images"]}
    for image in [*(out / "rgb").iterdir(), *(out / "depth_clean").iterdir()]:
        if image.name not in names:
            image.unlink()
    path.write_text(json.dumps(content))


def room(options, out, seed):
    if (out / "annotations" / "instances.json").exists():
        return
    work = out.with_suffix(".part")
    number = seed - options.first_seed
    as_preset = options.presets or number % 8 == 7
    if as_preset:
        preset = PRESETS[(number if options.presets else number // 8) % len(PRESETS)]
        what = ["--preset", preset, "--frames", str(options.preset_frames)]
        if preset == "twolaps":
            what += ["--people", "walking"]
    else:
        people, frames = ROOMS[number % 8]
        path = out.with_suffix(".poses")
        path.write_text(views(seed, frames))
        noise = np.random.default_rng([seed, 1]).uniform(0.5, 4)
        what = ["--people", people, "--path", str(path), "--frames", str(frames), "--noise", f"{noise:.2f}"]
    synth(options, "--scene", "office", *what, "--seed", str(seed), "--annotations", "--depth-sensor", "simple", "--overwrite",
          "--out", work)
    if as_preset:
        keep_every(work, options.every)
    for folder in ("depth", "instances") if options.presets else ("depth", "instances", "depth_clean"):
        shutil.rmtree(work / folder)
    work.rename(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_arguments(parser)
    parser.add_argument("--rooms", type=int, default=64)
    parser.add_argument("--presets", action="store_true", help="film all rooms on the presets' paths, a preset a room")
    parser.add_argument("--preset-frames", type=int, default=240, help="frames of a preset's path")
    parser.add_argument("--every", type=int, default=8, help="the frames kept of a preset's path")
    options = parser.parse_args()
    make_all(options, "room", options.rooms, room)


if __name__ == "__main__":
    main()
