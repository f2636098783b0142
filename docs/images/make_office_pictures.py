#!/usr/bin/python3
"""Draws the pictures of docs/synthetic-office.md: runs `penumbra synth --scene office` and lays frames side by side.

usage: make_office_pictures.py [PENUMBRA]        (needs Debian's python3-opencv)
"""
import pathlib
import sys
import tempfile

import cv2
import numpy as np

import make_street_pictures as street

HERE = pathlib.Path(__file__).resolve().parent
if len(sys.argv) > 1:
    street.PENUMBRA = sys.argv[1]


def record(folder, *options):
    street.drive(folder, "--scene", "office", "--overwrite", *options)
    return folder, sorted((p.name for p in (folder / "rgb").iterdir()), key=lambda name: float(name[:-4]))


def depth_picture(path, factor):
    raw = street.read(path)
    picture = cv2.applyColorMap(np.clip(255.0 * raw.astype(np.float32) / factor / 6, 0, 255).astype(np.uint8), cv2.COLORMAP_TURBO)
    picture[raw == 0] = 0
    picture[raw == 65535] = 255
    return picture


def half(image):
    return cv2.resize(image, None, fx=0.625, fy=0.625, interpolation=cv2.INTER_AREA)


def preset_sheet(folder):
    frames = []
    for preset, seed, number in (("walking-xyz", 2, 75), ("walking-rpy", 5, 60), ("walking-halfsphere", 3, 75),
                                 ("sitting-xyz", 4, 10), ("desk", 6, 40), ("twolaps", 7, 8)):
        sequence, names = record(folder / preset, "--preset", preset, "--seed", str(seed), "--frames", str(number + 1))
        frames.append(half(street.label(street.read(sequence / "rgb" / names[-1]), f"{preset}, seed {seed}")))
    return np.vstack([np.hstack(frames[:3]), np.hstack(frames[3:])])


def truth_sheet(folder):
    sequence, names = record(folder, "--preset", "walking-xyz", "--seed", "2", "--frames", "72", "--flow", "--amodal")
    name = names[-2]
    image = street.read(sequence / "rgb" / name)
    ids = street.read(sequence / "instances" / name)
    visible, whole = image // 3, image // 3
    stripes = (np.add.outer(np.arange(480), np.arange(640)) % 8) < 4
    for instance in np.unique(ids[ids > 0]):
        visible[ids == instance] = street.colour_of(int(instance))
        whole[ids == instance] = street.colour_of(int(instance))
    for path in sorted((sequence / "amodal" / name.removesuffix(".png")).iterdir()):
        instance = int(path.stem)
        whole[(street.read(path) > 0) & (ids != instance) & stripes] = street.colour_of(instance)
    clean = depth_picture(sequence / "depth_clean" / name, 5000)
    sensed = depth_picture(sequence / "depth" / name, 5000)
    rows = [[(image, "image"), (visible, "visible masks"), (whole, "whole objects, hidden parts striped")],
            [(clean, "clean depth"), (sensed, "depth as sensed"), (street.flow_picture(sequence / "flow" / name), "optical flow")]]
    return np.vstack([np.hstack([half(street.label(*pair)) for pair in row]) for row in rows])


def sensor_sheet(folder):
    pictures = []
    for kind, factor in (("kinect", 5000), ("d435", 1000)):
        sequence, names = record(folder / kind, "--preset", "sitting-xyz", "--seed", "9", "--frames", "8", "--depth-sensor", kind)
        if not pictures:
            pictures.append(half(street.label(street.read(sequence / "rgb" / names[-1]), "image")))
        pictures.append(half(street.label(depth_picture(sequence / "depth" / names[-1], factor), kind)))
    return np.hstack(pictures)


def main():
    for name, sheet in (("office-presets", preset_sheet), ("office-truth", truth_sheet), ("office-sensors", sensor_sheet)):
        with tempfile.TemporaryDirectory() as folder:
            cv2.imwrite(str(HERE / f"{name}.jpg"), sheet(pathlib.Path(folder)), [cv2.IMWRITE_JPEG_QUALITY, 82])


if __name__ == "__main__":
    main()
