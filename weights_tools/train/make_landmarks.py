#!/usr/bin/python3
"""Makes drives and rooms in which every place is seen more than once, with the number of the thing at each pixel.

  make_landmarks.py --out out/landmarks --drives 16 --rooms 8 --first-seed 100

A drive goes twice round a block of its own, the second time beside its first track; a room is seen from another place
and in another direction at every frame. Writes DRIVE/ as `penumbra synth --sensor rgbd --landmarks` does, of which
rgb/, landmarks/, landmarks.json and groundtruth.txt are kept. What is there already is kept. train_interest.py reads it.
"""
import argparse
import pathlib
import shutil

import numpy as np

from make_office import axis_rotation, product
from make_street import add_arguments, synth

PRESETS = ("street", "easy", "crowded", "street")
LIGHTS = ("sun", "overcast", "sun", "evening")
LAMPS = 8  # on 100 m of each pavement, in every fifth drive: lamps that only their surroundings tell apart


def block(seed, spacing, beside):
    """KITTI poses twice round a block with round corners, `spacing` metres apart; the second round up to `beside`
    metres to the side of the first, and half a step on."""
    random = np.random.default_rng(seed)
    sides, radius = random.uniform(42, 75, 2), random.uniform(9, 13)
    turn = random.choice([-1.0, 1.0])
    pieces = [(side, 0.0) for side in sides]
    corner = (0.5 * np.pi * radius, turn / radius)
    track = [pieces[0], corner, pieces[1], corner] * 2
    length = sum(piece for piece, _ in track)
    step = 0.05
    points, position, heading = [], np.zeros(2), 0.0
    for piece, curvature in track:
        count = round(piece / step)
        for _ in range(count):
            points.append((*position, heading))
            heading += curvature * piece / count
            position = position + piece / count * np.array([np.sin(heading), np.cos(heading)])
    points = np.array(points)
    laps = round(length / spacing)
    sway = random.uniform(0, 2 * np.pi, 4)
    lines = []
    for k in range(2 * laps):
        at = (k + 0.5 * (k >= laps)) * length / laps
        x, z, h = points[int(at / length * len(points)) % len(points)]
        # Smooth, and zero where the rounds meet.
        wave = np.sin(2 * np.pi * at / length) * np.sin(4 * np.pi * at / length + sway[k // laps])
        right = (beside if k >= laps else 0.15) * wave
        x, z, h = x + right * np.cos(h), z - right * np.sin(h), h + 0.03 * wave
        c, s = np.cos(h), np.sin(h)
        lines.append([c, 0, s, x, 0, 1, 0, 0, -s, 0, c, z])
    return "".join(" ".join(f"{v:.6f}" for v in line) + "\n" for line in lines)


def all_round(seed, frames):
    """A pose file of TUM's: half of the views towards what the presets look at, half in any direction."""
    random = np.random.default_rng(seed)
    lines = ["0.000000 0 0 0 0 0 0 1"]
    for k in range(1, frames + 1):
        place = random.uniform((-1.2, -0.4, -0.4), (1.2, 0.4, 0.9))
        turn = random.normal(0, np.radians((7, 25, 5)))
        turn[1] += -np.arctan2(place[0], 2.5) if k % 2 else random.uniform(-np.pi, np.pi)
        q = product(product(axis_rotation(1, turn[1]), axis_rotation(0, turn[0])), axis_rotation(2, turn[2]))
        lines.append(f"{k / 30:.6f} " + " ".join(f"{v:.5f}" for v in (*place, *q)))
    return "\n".join(lines) + "\n"


def record(options, name, poses, *arguments):
    out = options.out / name
    if (out / "landmarks.json").exists() and not (out / "depth").exists():
        return
    shutil.rmtree(out, ignore_errors=True)
    path = out.with_suffix(".poses")
    path.write_text(poses)
    synth(options, "--path", str(path), "--sensor", "rgbd", "--landmarks", *arguments, "--out", str(out))
    for folder in ("instances", "depth"):  # depth last: it says that the rest was not finished
        shutil.rmtree(out / folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_arguments(parser)
    parser.add_argument("--drives", type=int, default=16)
    parser.add_argument("--rooms", type=int, default=8)
    parser.add_argument("--spacing", type=float, default=3.5, help="metres from frame to frame of a drive")
    parser.add_argument("--beside", type=float, default=0.7, help="metres of the second round beside the first")
    parser.add_argument("--views", type=int, default=60, help="frames a room")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for k in range(max(options.drives, options.rooms)):
        seed = options.first_seed + k
        if k < options.drives:
            record(options, f"drive_{seed:04d}", block(seed, options.spacing, options.beside), "--size", "620x188", "--preset",
                   PRESETS[k % 4], "--light", LIGHTS[k // 2 % 4], "--seed", str(seed), *(("--lamps", str(LAMPS)) if k % 5 == 4 else ()))
        if k < options.rooms:
            record(options, f"room_{seed:04d}", all_round(seed, options.views), "--scene", "office", "--size", "400x300",
                   "--depth-sensor", "simple", "--people", ("walking", "none", "sitting")[k % 3], "--seed", str(seed))


if __name__ == "__main__":
    main()
