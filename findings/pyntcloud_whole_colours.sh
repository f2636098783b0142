#!/bin/bash
# pyntcloud 0.3.1, PCD files whose packed colour is declared a whole number (TYPE U), as the Point Cloud Library also
# reads it: the colours come back as other colours, without a word; the same bytes declared a float (TYPE F) are right.
# So a file that survives pypcd4's ASCII (pypcd4_ascii_colours.sh) is misread here, and the other way round. With
# numpy from 2.3 on it reads no PCD at all and says so.
set -eu
T=$(mktemp -d); trap 'rm -rf "$T"' EXIT; cd "$T"
python3 -m venv v; v/bin/pip install -q pyntcloud==0.3.1 numpy==1.26.4 pandas==2.2.3
cat > a.py <<'P'
import numpy as np
from pyntcloud import PyntCloud
colours = [[255, 128, 3], [1, 2, 3]]
points = np.zeros(2, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<u4")])
points["rgb"] = [r << 16 | g << 8 | b for r, g, b in colours]
right = {}
for kind in "FU":
    header = (f"# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F {kind}\n"
              "COUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA binary\n")
    open("cloud.pcd", "wb").write(header.encode() + points.tobytes())
    read = PyntCloud.from_file("cloud.pcd").points[["red", "green", "blue"]].values.tolist()
    right[kind] = read == colours
    print(f"pyntcloud 0.3.1, TYPE {kind}: {read} for {colours}")
assert right == {"F": True, "U": False}
P
v/bin/python -W ignore a.py
