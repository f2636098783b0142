#!/usr/bin/python3
"""Draws the pictures of docs/semantics.md: runs `penumbra synth` and `penumbra slam`, and lays keyframes of the runs'
galleries side by side. Masks: red moves, orange is mostly hidden, blue can move but stands, green cannot move.

usage: make_semantics_pictures.py [PENUMBRA]        (needs Debian's python3-opencv)
"""
import pathlib
import subprocess
import sys
import tempfile

import cv2
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
PENUMBRA = sys.argv[1] if len(sys.argv) > 1 else str(HERE.parents[1] / "build" / "penumbra")


def penumbra(*options):
    subprocess.run([PENUMBRA, *map(str, options)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def drive(folder, preset, frames, seed=1):
    penumbra("synth", "--out", folder, "--preset", preset, "--frames", frames, "--seed", seed, "--colour")
    return folder


def run(street, out, *options):
    penumbra("slam", street, "--out", out, "--deterministic", *options)
    return out / "gallery"


def keyframe(gallery, frame, text):
    """The keyframe at `frame` or the last one before it."""
    names = [int(path.stem) for path in gallery.glob("*.jpg")]
    number = max(name for name in names if name <= frame)
    image = cv2.imread(str(gallery / f"{number:06d}.jpg"))
    text = f"{text}, frame {number}"
    cv2.rectangle(image, (0, 0), (14 + 7 * len(text), 18), (0, 0, 0), -1)
    cv2.putText(image, text, (6, 13), cv2.FONT_HERSHEY_SIMPLEX, 0.4, (255, 255, 255), 1, cv2.LINE_AA)
    return image


def sheet(rows):
    return np.vstack([np.hstack(row) for row in rows])


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        crowded = drive(folder / "crowded", "crowded", 60, seed=3)
        masks = ("--masks", crowded / "sequences/00/instances")
        truth = run(crowded, folder / "crowded_truth", *masks)
        classes = run(crowded, folder / "crowded_classes", *masks, "--moving", "class")
        lorry = drive(folder / "lorry", "lorry", 60)
        alone = run(lorry, folder / "lorry_alone")
        close = drive(folder / "close", "lorry-close", 62)
        hidden = run(close, folder / "close_truth", "--masks", close / "sequences/00/instances")
        cv2.imwrite(str(HERE / "semantics-states.jpg"), sheet([
            [keyframe(truth, 25, "geometry decides"), keyframe(truth, 50, "geometry decides")],
            [keyframe(classes, 25, "class alone"), keyframe(classes, 50, "class alone")]]),
            [cv2.IMWRITE_JPEG_QUALITY, 85])
        cv2.imwrite(str(HERE / "semantics-lorry.jpg"), sheet([
            [keyframe(alone, 3, "no masks, before it is found"), keyframe(alone, 40, "no masks")],
            [keyframe(hidden, 48, "exact masks"), keyframe(hidden, 58, "occluded")]]),
            [cv2.IMWRITE_JPEG_QUALITY, 85])


if __name__ == "__main__":
    main()
