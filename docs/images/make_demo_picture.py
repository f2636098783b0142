#!/usr/bin/python3
"""Composes demo.jpg of the README from what ./run demo left in out/demo.

usage: make_demo_picture.py OUT/demo PLOT.png demo.jpg      (needs Debian's python3-opencv)
PLOT.png: penumbra eval --groundtruth OUT/demo/street/poses/00.txt --estimate OUT/demo/slam/trajectory_kitti.txt --plot PLOT.png
"""
import pathlib
import sys

import cv2
import numpy as np

demo, plot_file, target = sys.argv[1:]
shown = sorted(pathlib.Path(f"{demo}/slam/gallery").glob("*.jpg"))
frames = [cv2.imread(str(shown[k * len(shown) // 3])) for k in range(3)]
left = np.vstack([cv2.copyMakeBorder(frame, 0, 6, 0, 10, cv2.BORDER_CONSTANT, value=(255, 255, 255)) for frame in frames])
plot = cv2.imread(plot_file)
scale = left.shape[0] / plot.shape[0]
plot = cv2.resize(plot, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)[: left.shape[0]]
cv2.imwrite(target, np.hstack([left, plot]))
