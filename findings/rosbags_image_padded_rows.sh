#!/bin/bash
# rosbags-image 0.10.4 (message_to_cvimage): an image message whose rows are padded, step being larger than a row's
# pixels, as cameras that align their rows send, comes back sheared without a word: the padding is taken for pixels,
# and the last rows are lost. Rows without padding are right. And mono8 converted to mono16 is an array of float64.
set -eu
T=$(mktemp -d); trap 'rm -rf "$T"' EXIT; cd "$T"
python3 -m venv v
v/bin/pip install -q rosbags-image==0.10.4 rosbags==0.11.9 opencv-python-headless==4.12.0.88 numpy==2.2.6
cat > a.py <<'P'
import numpy as np
from rosbags.image import message_to_cvimage
from rosbags.typesys import Stores, get_typestore
types = get_typestore(Stores.ROS2_HUMBLE).types
header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](0, 0), "camera")
picture = np.arange(1, 13, dtype=np.uint8).reshape(3, 4)
right = {}
for padding in (0, 2):
    rows = np.hstack([picture, np.full((3, padding), 255, np.uint8)])
    message = types["sensor_msgs/msg/Image"](header, 3, 4, "mono8", 0, rows.shape[1], rows.ravel())
    read = message_to_cvimage(message)
    right[padding] = bool((read == picture).all())
    print(f"rosbags-image 0.10.4, step {rows.shape[1]} of 4 pixels: {read.tolist()} for {picture.tolist()}")
kind = message_to_cvimage(types["sensor_msgs/msg/Image"](header, 3, 4, "mono8", 0, 4, picture.ravel()), "mono16").dtype
print(f"rosbags-image 0.10.4, mono8 as mono16: {kind}")
assert right == {0: True, 2: False} and kind == np.float64
P
v/bin/python a.py
