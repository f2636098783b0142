#!/bin/bash
# pypcd4 1.5.1, point clouds with the colour packed into a float, as the Point Cloud Library has it: saved as ASCII, all
# colours become black without a word, for the float is printed with ten digits behind the point and a colour is a
# number of about 1e-38. The binary forms are right, and so is ASCII where the file declares the colour a whole number
# (TYPE U).
set -eu
T=$(mktemp -d); trap 'rm -rf "$T"' EXIT; cd "$T"
python3 -m venv v; v/bin/pip install -q pypcd4==1.5.1 numpy==2.2.6
cat > a.py <<'P'
import numpy as np
from pypcd4 import Encoding, PointCloud
colours = np.array([[255, 128, 3], [1, 2, 3]], dtype=np.uint8)
places = np.array([[1, 2, 3], [4, 5, 6]], dtype=np.float32)
packed = PointCloud.encode_rgb(colours).reshape(-1, 1)
as_float = PointCloud.from_xyzrgb_points(np.hstack([places, packed]))
as_whole = PointCloud.from_points([*places.T, packed.ravel().view(np.uint32)], ("x", "y", "z", "rgb"),
                                  (np.float32, np.float32, np.float32, np.uint32))
right = {}
for kind, cloud in (("TYPE F", as_float), ("TYPE U", as_whole)):
    for encoding in (Encoding.BINARY, Encoding.BINARY_COMPRESSED, Encoding.ASCII):
        cloud.save("cloud.pcd", encoding=encoding)
        read = PointCloud.decode_rgb(PointCloud.from_path("cloud.pcd").pc_data["rgb"])
        right[kind, encoding.value] = bool((read == colours).all())
        print(f"pypcd4 1.5.1, {kind}, {encoding.value}: wrote {colours.tolist()}, read {read.tolist()}")
assert right == {(kind, encoding.value): (kind, encoding) != ("TYPE F", Encoding.ASCII)
                 for kind in ("TYPE F", "TYPE U")
                 for encoding in (Encoding.BINARY, Encoding.BINARY_COMPRESSED, Encoding.ASCII)}
P
v/bin/python a.py
