#!/usr/bin/python3
"""Compares what a depth camera sees in the synthetic office with real frames: prints hole share, where holes are, noise
against distance and shadows, and draws both side by side.

usage: compare_depth_cameras.py SYNTHETIC kinect|d435 [FIGURE.png] RGB DEPTH [RGB DEPTH ...]
       SYNTHETIC is a folder that `penumbra synth --scene office --depth-sensor ...` wrote; RGB and DEPTH are real
       frames, each two consecutive ones of a moving camera (needs Debian's python3-opencv)
"""
import pathlib
import sys

import cv2
import numpy as np

# f b in pixels times metres, which turns 1/z into the pixels that the sensor itself measures; depth levels a metre.
SENSORS = {"kinect": {"fb": 43.0, "factor": 5000.0}, "d435": {"fb": 19.3, "factor": 1000.0}}


def load(rgb, depth, factor):
    raw = cv2.imread(str(depth), cv2.IMREAD_UNCHANGED)
    grey = cv2.cvtColor(cv2.imread(str(rgb)), cv2.COLOR_BGR2GRAY)
    saturated = raw == 65535
    z = raw.astype(np.float64) / factor
    z[saturated] = 0
    return {"grey": grey, "z": z, "saturated": saturated, "bgr": cv2.imread(str(rgb))}


def band_of(z):
    """Widths of the empty band: left, right, top, bottom; columns and rows with nearly no depth."""
    columns, rows = (z > 0).mean(0) > 0.02, (z > 0).mean(1) > 0.02
    return (int(np.argmax(columns)), int(np.argmax(columns[::-1])), int(np.argmax(rows)), int(np.argmax(rows[::-1])))


def jump_pixels(z, fb, reach=10):
    """Pixels within `reach` of a step of more than 2 px in the sensor's own disparity, holes filled from the right."""
    inverse = np.where(z > 0, fb / np.maximum(z, 1e-3), 0)
    filled = inverse.copy()
    for row in filled:
        last = 0.0
        for i in range(len(row) - 1, -1, -1):
            if row[i] > 0:
                last = row[i]
            else:
                row[i] = last
    step = np.abs(np.diff(filled, axis=1, prepend=filled[:, :1])) > 2.0
    step |= np.abs(np.diff(filled, axis=0, prepend=filled[:1])) > 2.0
    return cv2.dilate(step.astype(np.uint8), np.ones((2 * reach + 1, 2 * reach + 1))) > 0


def noise_of(z, fb, window=24):
    """(depth, residuals in pixels of disparity) of windows that a plane in 1/z explains."""
    found = []
    v, u = np.mgrid[0:window, 0:window]
    basis = np.stack([np.ones(window * window), u.ravel(), v.ravel()], 1)
    for top in range(0, z.shape[0] - window, window // 2):
        for left in range(0, z.shape[1] - window, window // 2):
            patch = z[top:top + window, left:left + window]
            if (patch <= 0).any():
                continue
            d = fb / patch
            fit = np.linalg.lstsq(basis, d.ravel(), rcond=None)[0]
            residual = d - (basis @ fit).reshape(window, window)
            if np.abs(residual).max() > 0.35:
                continue
            # Bent surfaces leave a residual of low order.
            quarters = residual.reshape(2, window // 2, 2, window // 2).mean((1, 3))
            if np.abs(quarters).max() > 0.06:
                continue
            found.append((np.median(patch), residual))
    return found


def correlation(residuals, lag):
    num = sum((r[:, lag:] * r[:, :-lag]).mean() for r in residuals)
    return num / sum((r * r).mean() for r in residuals)


def shadows(z, fb):
    """Width of holes left of near things against the step of 1/z on both sides: (step, width, side)."""
    rows = []
    for row in z[40:-40:3]:
        holes = row <= 0
        i, n = 0, len(row)
        while i < n:
            if not holes[i]:
                i += 1
                continue
            k = i
            while k < n and holes[k]:
                k += 1
            if 15 < i and k < n - 35 and 2 <= k - i < 60:
                a, b = row[i - 1], row[k]
                if a > 0 and b > 0 and abs(1 / a - 1 / b) > 0.08:
                    rows.append((abs(1 / a - 1 / b), k - i, "left" if b < a else "right"))
            i = k
    return rows


def report(name, frames, fb):
    holes = np.mean([(f["z"] <= 0).mean() for f in frames])
    print(f"{name}: {len(frames)} frames")
    print(f"  holes {100 * holes:.1f} %, at 65535 {100 * np.mean([f['saturated'].mean() for f in frames]):.2f} %")
    bands = np.array([band_of(f["z"]) for f in frames])
    left, right, top, bottom = np.median(bands, 0).astype(int)
    print(f"  empty band left, right, top, bottom: {left} {right} {top} {bottom} px")
    parts = {"band": 0, "jumps": 0, "dark": 0, "bright": 0, "other": 0}
    dark = np.zeros(2)
    middle = np.zeros(2)
    bright = np.zeros(2)
    for f in frames:
        hole = f["z"] <= 0
        h, w = hole.shape
        inside = np.zeros_like(hole)
        inside[top:h - bottom, left:w - right] = True
        jump = jump_pixels(f["z"], fb)
        rest = hole & inside
        parts["band"] += (hole & ~inside).sum()
        parts["jumps"] += (rest & jump).sum()
        rest &= ~jump
        parts["dark"] += (rest & (f["grey"] < 40)).sum()
        parts["bright"] += (rest & (f["grey"] > 230)).sum()
        parts["other"] += (rest & (f["grey"] >= 40) & (f["grey"] <= 230)).sum()
        calm = inside & ~jump
        dark += [(calm & hole & (f["grey"] < 40)).sum(), (calm & (f["grey"] < 40)).sum()]
        middle += [(calm & hole & (f["grey"] > 80) & (f["grey"] < 200)).sum(), (calm & (f["grey"] > 80) & (f["grey"] < 200)).sum()]
        bright += [(calm & hole & (f["grey"] > 230)).sum(), (calm & (f["grey"] > 230)).sum()]
    total = max(1, sum(parts.values()))
    print("  where: " + ", ".join(f"{k} {100 * v / total:.0f} %" for k, v in parts.items()))
    share = lambda s: f"{100 * s[0] / max(1, s[1]):.1f} % of {int(s[1] / len(frames))} px"
    print(f"  holes away from jumps: dark {share(dark)}, middle {share(middle)}, above 230 {share(bright)}")
    patches = [p for f in frames for p in noise_of(f["z"], fb)]
    for low, high in ((0.4, 0.9), (0.9, 1.4), (1.4, 2.2), (2.2, 3.0), (3.0, 4.5), (4.5, 7.0)):
        chosen = [(d, r) for d, r in patches if low <= d < high]
        if len(chosen) < 8:
            continue
        sigma = np.median([r.std() for _, r in chosen])
        rho = " ".join(f"{correlation([r for _, r in chosen], lag):.2f}" for lag in (1, 2, 4, 8))
        z = np.median([d for d, _ in chosen])
        print(f"  at {z:.2f} m: {sigma:.3f} px ({1000 * sigma * z * z / fb:.1f} mm), correlation at 1 2 4 8 px: {rho}  ({len(chosen)} windows)")
    edges = [e for f in frames for e in shadows(f["z"], fb)]
    for side in ("left", "right"):
        chosen = np.array([(s, w) for s, w, which in edges if which == side])
        if len(chosen) < 10:
            continue
        wide = chosen[chosen[:, 0] > 0.15]
        if side == "left" and len(wide) > 10:
            slope = np.median(wide[:, 1] / wide[:, 0])
            print(f"  {side} of near things: {len(chosen)} gaps, median width / step of 1/z {slope:.0f} px m")
        else:
            print(f"  {side} of near things: {len(chosen)} gaps, median {np.median(chosen[:, 1]):.0f} px")
    valid_to_hole, hole_to_valid = [], []
    for a, b in zip(frames[:-1], frames[1:]):
        va, vb = a["z"] > 0, b["z"] > 0
        valid_to_hole.append((va & ~vb).sum() / va.sum())
        hole_to_valid.append((~va & vb).sum() / max(1, (~va).sum()))
    if valid_to_hole:
        print(f"  frame to frame: valid to hole {100 * np.mean(valid_to_hole):.1f} %, hole to valid {100 * np.mean(hole_to_valid):.1f} %")


def picture(frame, far):
    z = frame["z"]
    shown = cv2.applyColorMap(np.clip(255 * z / far, 0, 255).astype(np.uint8), cv2.COLORMAP_TURBO)
    shown[z <= 0] = 0
    shown[frame["saturated"]] = 255
    return np.hstack([frame["bgr"], shown])


def main():
    arguments = sys.argv[1:]
    folder, kind = pathlib.Path(arguments[0]), arguments[1]
    rest = arguments[2:]
    figure = rest.pop(0) if rest and len(rest) % 2 == 1 else None
    sensor = SENSORS[kind]
    real = [load(rgb, depth, sensor["factor"]) for rgb, depth in zip(rest[0::2], rest[1::2])]
    names = sorted((p.name for p in (folder / "rgb").iterdir()), key=lambda n: float(n[:-4]))
    start = len(names) // 3
    made = [load(folder / "rgb" / n, folder / "depth" / n, sensor["factor"]) for n in names[start:start + max(6, len(real))]]
    if real:
        report("real", real, sensor["fb"])
    report("synthetic", made, sensor["fb"])
    if figure and real:
        far = 6.0 if kind == "kinect" else 4.0
        cv2.imwrite(figure, np.vstack([picture(real[0], far), picture(made[0], far)]))


if __name__ == "__main__":
    main()
