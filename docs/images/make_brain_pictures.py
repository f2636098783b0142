#!/usr/bin/python3
"""Makes the pictures of docs/brain: runs `penumbra brain train-grid` in each room and makes the maps smaller.

usage: make_brain_pictures.py [PENUMBRA]        (needs Debian's python3-opencv; two minutes)
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

import cv2

HERE = pathlib.Path(__file__).resolve().parent
PENUMBRA = sys.argv[1] if len(sys.argv) > 1 else str(HERE.parents[1] / "build" / "penumbra")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for room in ("square", "hexagon", "L"):
            subprocess.run([PENUMBRA, "brain", "train-grid", "--room", room, "--seed", "900", "--seeds", "20", "--modules", "3",
                            "--out", folder / f"{room}.safetensors"], check=True)
            maps = cv2.imread(str(folder / f"{room}-maps.jpg"))
            size = (960, round(960 * maps.shape[0] / maps.shape[1]))
            cv2.imwrite(str(HERE / f"brain-{room}.jpg"), cv2.resize(maps, size, interpolation=cv2.INTER_AREA),
                        [cv2.IMWRITE_JPEG_QUALITY, 75])
        shutil.copy(folder / "square-growth.svg", HERE / "brain-growth.svg")
        shutil.copy(folder / "square-ring.svg", HERE / "brain-ring.svg")


main()
