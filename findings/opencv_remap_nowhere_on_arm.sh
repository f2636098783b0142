#!/bin/bash
# OpenCV 4.10, the same release for x86-64 and for 64-bit ARM: where a map of cv::remap says NaN (a pixel that sees nothing),
# x86-64 gives the border's value, ARM a pixel of the image, in its column 0 (or row 0), as if it had been seen. In maps that are
# narrower than a vector -infinity is seen there, too. With a replicated border, +infinity and 1e10 are the left edge on x86-64, and
# the right one on ARM.
# Needs qemu-user and mmdebstrap; the emulation runs the ARM package's own code.
set -eu
for tool in qemu-aarch64 mmdebstrap; do command -v $tool >/dev/null || { echo "$0: needs $tool" >&2; exit 1; }; done
T=$(mktemp -d); trap 'rm -rf "$T"' EXIT; cd "$T"
packages="opencv-python-headless==4.10.0.84 numpy==1.26.4"
python3 -m venv v; v/bin/pip install -q $packages
v/bin/pip download -q -d wheels --no-deps --only-binary=:all: --platform manylinux2014_aarch64 --python-version 3.11 $packages
for wheel in wheels/*; do python3 -m zipfile -e "$wheel" arm; done
mmdebstrap --quiet --variant=extract --architectures=arm64 --include=python3-minimal,libpython3.11-stdlib,libstdc++6 bookworm root
cat > a.py <<'P'
import platform, cv2, numpy as np
image = np.arange(1, 101, dtype=np.uint8).reshape(10, 10)  # row 5: 51 to 60
places = [3, np.nan, np.inf, -np.inf, 1e10, -1e10]  # columns, one a row of the map
def take(width, **border):
    x = np.repeat(np.array(places, np.float32).reshape(-1, 1), width, axis=1)
    return cv2.remap(image, x, np.full_like(x, 5), cv2.INTER_NEAREST, **border)[:, 0].tolist()
wide, narrow, edges = take(16, borderValue=0), take(3, borderValue=0), take(16, borderMode=cv2.BORDER_REPLICATE)
machine = platform.machine()
print(f"OpenCV {cv2.__version__}, {machine}, columns {places}: border 0 {wide}, in a narrow map {narrow}, border replicated {edges}")
if machine == "x86_64":
    assert wide == narrow == [54, 0, 0, 0, 0, 0] and edges == [54, 51, 51, 51, 51, 51]
else:
    assert wide == [54, 51, 0, 0, 0, 0] and narrow == [54, 51, 0, 51, 0, 0] and edges == [54, 51, 60, 51, 60, 51]
P
v/bin/python a.py
PYTHONPATH=arm PYTHONHOME=root/usr qemu-aarch64 -L root root/usr/bin/python3.11 a.py
