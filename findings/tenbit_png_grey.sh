#!/bin/bash
# A 10-bit camera's image in a 16-bit grey PNG (values 0 to 1023), read as 8-bit grey. OpenCV 4.13 (IMREAD_GRAYSCALE) keeps
# the upper byte: all pixels become 0 to 3, a black picture. Pillow 12 (convert("L")) cuts at 255: three quarters of
# the levels become white. Neither warns, neither looks at the PNG's sBIT chunk, which says 10.
set -eu
T=$(mktemp -d); trap 'rm -rf "$T"' EXIT; cd "$T"
python3 -m venv v; v/bin/pip install -q opencv-python-headless==4.13.0.92 pillow==12.1.1 numpy==2.2.6
cat > a.py <<'P'
import struct, zlib, numpy as np, cv2, PIL
from PIL import Image
a = np.tile(np.arange(1024, dtype=">u2"), (4, 1))
def chunk(kind, data): return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
rows = b"".join(b"\0" + row.tobytes() for row in a)
open("a.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1024, 4, 16, 0, 0, 0, 0)) +
                          chunk(b"sBIT", b"\x0a") + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
whole = cv2.imread("a.png", cv2.IMREAD_UNCHANGED); grey = cv2.imread("a.png", cv2.IMREAD_GRAYSCALE); pillow = np.asarray(Image.open("a.png").convert("L"))
assert (whole == a).all()
white = float((pillow == 255).mean())
print(f"OpenCV {cv2.__version__}: 0..1023 becomes {grey.min()}..{grey.max()}; Pillow {PIL.__version__}: {pillow.min()}..{pillow.max()}, {100 * white:.0f} % white")
assert (grey.min(), grey.max()) == (0, 3) and 0.74 < white < 0.76
P
v/bin/python a.py
