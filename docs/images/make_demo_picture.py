#!/usr/bin/python3
"""Composes demo.jpg of the README from what ./run demo left in out/demo.

usage: make_demo_picture.py OUT/demo demo.jpg      (needs Debian's python3-opencv)
"""
import pathlib
import sys

import cv2
import numpy as np

demo, target = sys.argv[1:]
shown = sorted(pathlib.Path(f"{demo}/slam/gallery").glob("*.jpg"))
frames = [cv2.imread(str(shown[k * len(shown) // 3])) for k in range(3)]
left = np.vstack([cv2.copyMakeBorder(frame, 0, 6, 0, 10, cv2.BORDER_CONSTANT, value=(255, 255, 255)) for frame in frames])
plot = cv2.imread(f"{demo}/slam/trajectory.png")
scale = left.shape[0] / plot.shape[0]
plot = cv2.resize(plot, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)[: left.shape[0]]
cv2.imwrite(target, np.hstack([left, plot]))
