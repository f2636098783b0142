#!/usr/bin/python3
"""Makes a drive whose disparities are all too large by SHIFT pixels, for docs/benchmarks.md, "A calibration that is a
little wrong": the right images of a drive of `penumbra synth` are moved to the left by that much. Needs Debian's
python3-opencv.

  shift_right_images.py out/block 0.2 out/shifted
"""
import pathlib
import shutil
import sys

import cv2
import numpy as np


def main(source, shift, out):
    source, out = pathlib.Path(source), pathlib.Path(out)
    shutil.copytree(source, out, ignore=shutil.ignore_patterns("image_1"))
    right = pathlib.Path("sequences/00/image_1")
    (out / right).mkdir()
    motion = np.float32([[1, 0, -float(shift)], [0, 1, 0]])
    for path in sorted((source / right).iterdir()):
        image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
        moved = cv2.warpAffine(image, motion, image.shape[::-1], flags=cv2.INTER_LANCZOS4, borderMode=cv2.BORDER_REPLICATE)
        cv2.imwrite(str(out / right / path.name), moved)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
