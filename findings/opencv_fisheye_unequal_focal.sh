#!/bin/bash
# OpenCV 4.10: cv::fisheye.estimateNewCameraMatrixForUndistortRectify with balance 0 promises an image without a pixel
# from outside the original. That holds where fx = fy. With fx 300, fy 240 it returns a view of which 2 % of the pixels lie
# outside (rows -9.9 to 489.5 of an image of 480), black or smeared at the border; with fx 240, fy 300 it cuts away 32 rows
# above and below that the original has, and 95 columns on either side. Nothing is said.
set -eu
T=$(mktemp -d); trap 'rm -rf "$T"' EXIT; cd "$T"
python3 -m venv v; v/bin/pip install -q opencv-python-headless==4.10.0.84 numpy==1.26.4
cat > a.py <<'P'
import cv2, numpy as np
D = np.array([-0.02, 0.005, -0.002, 0.0002])
def view(fx, fy):
    K = np.array([[fx, 0, 320], [0, fy, 240], [0, 0, 1.0]])
    P = cv2.fisheye.estimateNewCameraMatrixForUndistortRectify(K, D, (640, 480), np.eye(3), balance=0.0)
    x, y = cv2.fisheye.initUndistortRectifyMap(K, D, np.eye(3), P, (640, 480), cv2.CV_32FC1)
    outside = ((x < -0.5) | (x > 639.5) | (y < -0.5) | (y > 479.5)).mean()
    print(f"OpenCV {cv2.__version__}, fx {fx:g} fy {fy:g}: {100 * outside:.1f} % of the pixels from outside, columns {x.min():.1f} to {x.max():.1f}, rows {y.min():.1f} to {y.max():.1f}")
    return outside, y.min()
equal, wide, tall = view(300.0, 300.0), view(300.0, 240.0), view(240.0, 300.0)
assert equal[0] == 0.0 and equal[1] < 1.0  # nothing from outside, and it reaches the border
assert wide[0] > 0.015 and wide[1] < -9.0
assert tall[0] == 0.0 and tall[1] > 30.0
P
v/bin/python a.py
