"""Time a frame from Python beside C++, on the same pairs of a KITTI sequence, in turn.

    cmake --build --preset test --target bench_library penumbra_python
    PYTHONPATH=build/python python3 tests/bench/python_beside_cpp.py build/bench_library SEQUENCE [ROUNDS]

Needs Pillow. Both read all images first; what is measured is track() of all frames and finish().
"""

import pathlib
import statistics
import subprocess
import sys
import time

import numpy as np
import penumbra
from PIL import Image


def camera_of(calibration):
    rows = dict(line.split(":", 1) for line in calibration.read_text().splitlines() if ":" in line)
    left, right = (np.array(rows[name].split(), float).reshape(3, 4) for name in ("P0", "P1"))
    return left[0, 0], left[1, 1], left[0, 2], left[1, 2], -right[0, 3] / right[0, 0]


def from_cpp(program, camera, folders):
    command = [program, *(repr(float(number)) for number in camera), *map(str, folders)]
    words = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    return int(words[0]), float(words[1]), float(words[2])


def from_python(camera, pairs):
    fx, fy, cx, cy, baseline = camera
    height, width = pairs[0][0].shape
    slam = penumbra.Slam(penumbra.Rig.stereo(fx=fx, fy=fy, cx=cx, cy=cy, width=width, height=height, baseline=baseline))
    processor, clock = time.process_time(), time.perf_counter()
    for i, (left, right) in enumerate(pairs):
        slam.track(0.1 * i, left, right)
    slam.finish()
    return len(pairs), time.process_time() - processor, time.perf_counter() - clock


def main():
    program, sequence = sys.argv[1], pathlib.Path(sys.argv[2])
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 5
    camera = camera_of(sequence / "calib.txt")
    folders = sequence / "image_0", sequence / "image_1"
    names = sorted(path.name for path in folders[0].iterdir())
    pairs = [tuple(np.array(Image.open(folder / name).convert("L")) for folder in folders) for name in names]
    ratios = {"processor": [], "clock": []}
    for round in range(rounds):
        order = ("C++", "Python") if round % 2 == 0 else ("Python", "C++")
        took = {name: from_cpp(program, camera, folders) if name == "C++" else from_python(camera, pairs) for name in order}
        frames = took["C++"][0]
        for at, kind in ((1, "processor"), (2, "clock")):
            ratios[kind].append(took["Python"][at] / took["C++"][at])
        print(
            f"{frames} frames, processor / clock a frame: C++ {1e3 * took['C++'][1] / frames:.2f} / "
            f"{1e3 * took['C++'][2] / frames:.2f} ms, Python {1e3 * took['Python'][1] / frames:.2f} / "
            f"{1e3 * took['Python'][2] / frames:.2f} ms",
            flush=True,
        )
    for kind, values in ratios.items():
        print(f"Python / C++, {kind}: median {statistics.median(values):.3f} of {min(values):.3f} to {max(values):.3f}")


if __name__ == "__main__":
    main()
