#!/usr/bin/python3
"""Draws the pictures of docs/brain/interest.md: renders a street with rows of lamps and an office, and runs `penumbra brain landmarks` on
one image of each.

usage: make_interest_pictures.py [PENUMBRA]        (needs Debian's python3-opencv)
"""
import pathlib
import subprocess
import sys
import tempfile

import cv2

HERE = pathlib.Path(__file__).resolve().parent
PENUMBRA = sys.argv[1] if len(sys.argv) > 1 else str(HERE.parents[1] / "build" / "penumbra")
WEIGHTS = HERE.parents[1] / "weights_tools" / "models" / "penumbra-interest.safetensors"


def penumbra(*options):
    subprocess.run([PENUMBRA, *map(str, options)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def picture(folder, image, name):
    penumbra("brain", "landmarks", image, "--weights", WEIGHTS, "--out", folder / "found")
    drawn = cv2.imread(str(folder / "found" / f"{image.stem}_overlay.png"))
    cv2.imwrite(str(HERE / name), drawn, [cv2.IMWRITE_JPEG_QUALITY, 75])


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        penumbra("synth", "--out", folder / "street", "--path", "block", "--frames", 60, "--seed", 906, "--lamps", 12, "--colour")
        picture(folder, folder / "street/sequences/00/image_2/000020.png", "interest-street.jpg")
        penumbra("synth", "--out", folder / "office", "--scene", "office", "--frames", 2, "--seed", 906)
        picture(folder, min((folder / "office/rgb").iterdir()), "interest-office.jpg")


if __name__ == "__main__":
    main()
