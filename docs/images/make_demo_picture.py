#!/usr/bin/python3
"""Composes demo.jpg of the README from what ./run demo left in out/demo.

usage: make_demo_picture.py OUT/demo demo.jpg      (needs Debian's python3-opencv)
"""
import sys

import cv2
import numpy as np

demo, target = sys.argv[1:]
frames = [cv2.imread(f"{demo}/street/sequences/00/image_0/{i:06d}.png") for i in (10, 30, 50)]
left = np.vstack([cv2.copyMakeBorder(frame, 0, 6, 0, 10, cv2.BORDER_CONSTANT, value=(255, 255, 255)) for frame in frames])
plot = cv2.imread(f"{demo}/slam/trajectory.png")
scale = left.shape[0] / plot.shape[0]
plot = cv2.resize(plot, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)[: left.shape[0]]
cv2.imwrite(target, np.hstack([left, plot]))
