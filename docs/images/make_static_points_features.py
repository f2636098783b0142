#!/usr/bin/python3
"""Draws static-points-features.jpg of docs/dynamics/static-points.md: one frame with all of people left out, by DBSCAN,
and with what stands given back. Runs `penumbra ablate` on an office where people sit and one where they walk.

usage: make_static_points_features.py [PENUMBRA]        (needs Debian's python3-opencv)
"""
import pathlib
import subprocess
import sys
import tempfile

import cv2
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
PENUMBRA = sys.argv[1] if len(sys.argv) > 1 else "build/penumbra"
PRESETS, MASKS, SEED, FRAMES = ("sitting-xyz", "walking-xyz"), ("dbscan", "static-points"), 140, 60

with tempfile.TemporaryDirectory() as folder:
    subprocess.run([PENUMBRA, "ablate", "--presets", ",".join(PRESETS), "--masks", ",".join(MASKS), "--seeds", str(SEED),
                    "--frames", str(FRAMES), "--out", folder], check=True)
    rows = []
    for preset in PRESETS:
        name = f"{folder}/cells/{preset}_640x480_{FRAMES}_seed{SEED}_{{}}_adaptive.png"
        pictures = [cv2.imread(name.format(masks)) for masks in MASKS]
        rows.append(np.hstack([cv2.resize(p, None, fx=0.75, fy=0.75, interpolation=cv2.INTER_AREA) for p in pictures]))
cv2.imwrite(str(HERE / "static-points-features.jpg"), np.vstack(rows), [cv2.IMWRITE_JPEG_QUALITY, 80])
