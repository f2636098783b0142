#!/usr/bin/python3
"""Draws the pictures of docs/synthetic-street.md: runs `penumbra synth` and lays frames and ground truth side by side.

usage: make_street_pictures.py [PENUMBRA]        (needs Debian's python3-opencv)
"""
import pathlib
import subprocess
import sys
import tempfile

import cv2
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
PENUMBRA = sys.argv[1] if len(sys.argv) > 1 else str(HERE.parents[1] / "build" / "penumbra")


def read(path):
    return cv2.imread(str(path), cv2.IMREAD_UNCHANGED)


def colour_of(instance):
    return np.random.default_rng(instance * 7 + 1).integers(70, 256, 3)


def label(image, text):
    image = image.copy()
    cv2.rectangle(image, (0, 0), (14 + 8 * len(text), 20), (0, 0, 0), -1)
    cv2.putText(image, text, (6, 14), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (255, 255, 255), 1, cv2.LINE_AA)
    return image


def drive(folder, *options):
    subprocess.run([PENUMBRA, "synth", "--out", str(folder), *options], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    return folder / "sequences" / "00"


def visible_and_whole(sequence, name, image):
    """Masks over the darkened image: what is seen of every object, and the whole of it with the hidden part striped."""
    ids = read(sequence / "instances" / name)
    visible, whole = image // 3, image // 3
    stripes = (np.add.outer(np.arange(image.shape[0]), np.arange(image.shape[1])) % 6) < 3
    for instance in np.unique(ids[ids > 0]):
        visible[ids == instance] = colour_of(int(instance))
        whole[ids == instance] = colour_of(int(instance))
    for path in sorted((sequence / "amodal" / name.removesuffix(".png")).iterdir()):
        instance = int(path.stem)
        whole[(read(path) > 0) & (ids != instance) & stripes] = colour_of(instance)
    return visible, whole


def flow_picture(path):
    """Direction as hue, length as saturation."""
    raw = read(path).astype(np.float32)
    valid, dv, du = raw[..., 0], (raw[..., 1] - 32768) / 64, (raw[..., 2] - 32768) / 64
    hue = (np.degrees(np.arctan2(dv, du)) % 360) / 2
    length = np.clip(np.hypot(du, dv) / 20, 0, 1)
    hsv = np.stack([hue, 255 * length, np.where(valid > 0, 255, 40)], 2).astype(np.uint8)
    return cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR)


def truth_sheet(folder):
    sequence = drive(folder, "--preset", "crowded", "--seed", "3", "--frames", "14", "--colour", "--amodal", "--depth", "--flow")
    name = "000012.png"
    image = read(sequence / "image_2" / name)
    visible, whole = visible_and_whole(sequence, name, image)
    depth = read(sequence / "depth" / name).astype(np.float32) / 256
    near = np.where(depth > 0, np.clip(4 / np.maximum(depth, 1), 0, 1) ** 0.6, 0)
    near = cv2.applyColorMap((255 * near).astype(np.uint8), cv2.COLORMAP_INFERNO)
    rows = [label(image, "image"), label(visible, "visible masks"), label(whole, "whole objects, hidden parts striped"),
            label(near, "inverse depth"), label(flow_picture(sequence / "flow" / name), "optical flow")]
    return np.vstack(rows)


def preset_sheet(folder):
    def frame(text, number, *options):
        sequence = drive(folder / text.replace(" ", "_"), "--frames", str(number + 1), "--colour", *options)
        return label(read(sequence / "image_2" / f"{number:06d}.png"), text)
    left = [frame("easy", 20, "--preset", "easy"), frame("crowded", 20, "--preset", "crowded", "--seed", "5"),
            frame("lorry", 40, "--preset", "lorry")]
    right = [frame("lorry-close", 60, "--preset", "lorry-close"), frame("evening, glare 0.7", 20, "--light", "evening", "--glare", "0.7"),
             frame("overcast, motion blur 0.03", 20, "--light", "overcast", "--motion-blur", "0.03")]
    return np.hstack([np.vstack(left), np.vstack(right)])


def rgbd_sheet(folder):
    subprocess.run([PENUMBRA, "synth", "--sensor", "rgbd", "--frames", "8", "--size", "480x360", "--out", str(folder)],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    name = sorted(p.name for p in (folder / "rgb").iterdir())[-1]
    depth = read(folder / "depth" / name).astype(np.float32) / 5000
    picture = cv2.applyColorMap((255 * np.clip(1.2 - depth / 12, 0, 1)).astype(np.uint8), cv2.COLORMAP_INFERNO)
    picture[depth == 0] = 0
    return np.hstack([label(read(folder / "rgb" / name), "rgb"), label(picture, "depth as sensed, holes black")])


def alike_sheet(folder):
    return read(drive(folder, "--preset", "alike", "--frames", "6", "--colour") / "image_2" / "000005.png")


def main():
    for name, sheet in (("street-truth", truth_sheet), ("street-presets", preset_sheet), ("street-rgbd", rgbd_sheet),
                        ("street-alike", alike_sheet)):
        with tempfile.TemporaryDirectory() as folder:
            cv2.imwrite(str(HERE / f"{name}.jpg"), sheet(pathlib.Path(folder) / "drive"), [cv2.IMWRITE_JPEG_QUALITY, 82])


if __name__ == "__main__":
    main()
