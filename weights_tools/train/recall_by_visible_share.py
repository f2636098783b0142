#!/usr/bin/python3
"""Recall of people by how much of them can be seen: where they are cut off by the border, detection is the weakest link.

  recall_by_visible_share.py --data out/office_val --results out/office/results.json

--data is what `make_office.py --presets` wrote, which keeps the true depth. The seen share of a person inside the border is that of
its amodal mask, exactly. Of one that touches the border it is estimated, as masks end there: what is seen of it, in square metres by the depth of
its pixels, over WHOLE, with what others hide added. A person is found where a
detection of it has IoU >= --iou and score >= --score; a detection finds one person. Prints a Markdown table.
"""
import argparse
import collections
import json
import pathlib

import cv2
import numpy as np

from coco_data import decode_mask

BOUNDS = (0.0, 0.25, 0.5, 0.75, 1.0)
WHOLE = 0.36  # square metres of a person who is wholly in view, seated or upright: 0.31 to 0.39


def square_metres(folder, image, a):
    """Of what is seen of an object, facing the camera: every pixel's z^2 / (fx fy)."""
    path = folder / image["file_name"].replace("/rgb/", "/depth_clean/")
    text = (path.parent.parent / "calibration.yaml").read_text()
    values = dict(line.split(":", 1) for line in text.splitlines() if ":" in line and not line.startswith("#"))
    fx, fy, factor = (float(values[name]) for name in ("fx", "fy", "depth_factor"))
    z = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[decode_mask(a["segmentation"], image["height"], image["width"]) > 0] / factor
    return float((z ** 2).sum()) / (fx * fy)


def at_border(image, box):
    x, y, w, h = box
    return x < 1 or y < 1 or x + w > image["width"] - 1 or y + h > image["height"] - 1


def visible_shares(folder, images, people):
    areas = [square_metres(folder, images[a["image_id"]], a) for a in people]
    cut = [at_border(images[a["image_id"]], a["amodal_bbox"]) for a in people]
    shares = []
    for a, area, c in zip(people, areas, cut):
        inside = area / max(1e-6, 1 - a["occlusion"])  # with what others hide
        shares.append(area / max(WHOLE, inside) if c else 1 - a["occlusion"])
    return np.array(shares), np.array(cut)


def overlap(a, b):
    """IoU of boxes x, y, w, h."""
    sides = [min(a[k] + a[k + 2], b[k] + b[k + 2]) - max(a[k], b[k]) for k in (0, 1)]
    common = max(0, sides[0]) * max(0, sides[1])
    return common / (a[2] * a[3] + b[2] * b[3] - common)


def match(people, results, least_iou):
    """Which people are found, and how many detections find nobody: the best scores choose first."""
    found, wrong, by_image = np.zeros(len(people), bool), 0, collections.defaultdict(list)
    for k, a in enumerate(people):
        by_image[a["image_id"]].append(k)
    for result in sorted(results, key=lambda r: -r["score"]):
        ious = {k: overlap(people[k]["bbox"], result["bbox"]) for k in by_image[result["image_id"]] if not found[k]}
        best = max(ious, key=ious.get, default=None)
        if best is not None and ious[best] >= least_iou:
            found[best] = True
        else:
            wrong += 1
    return found, wrong


def share(found, which):
    return f"{100 * found[which].mean():.1f} % of {which.sum()}" if which.any() else "-"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", required=True, type=pathlib.Path)
    parser.add_argument("--results", required=True, type=pathlib.Path)
    parser.add_argument("--iou", type=float, default=0.5)
    parser.add_argument("--score", type=float, default=0.25)
    parser.add_argument("--least-area", type=float, default=100, help="pixels that a person must show to be counted")
    options = parser.parse_args()
    content = json.loads((options.data / "instances.json").read_text())
    person = next(c["id"] for c in content["categories"] if c["name"] == "person")
    images = {image["id"]: image for image in content["images"]}
    everyone = [a for a in content["annotations"] if a["category_id"] == person]
    results = [r for r in json.loads(options.results.read_text()) if r["category_id"] == person and r["score"] >= options.score]
    found, wrong = match(everyone, results, options.iou)
    counted = np.array([a["area"] >= options.least_area for a in everyone])
    shares, cut = visible_shares(options.data, images, everyone)
    print("| people seen to | recall | cut off by the border | inside it |\n| --- | --- | --- | --- |")
    for low, high in [*zip(BOUNDS, BOUNDS[1:]), (0.0, 1.0)]:
        which = counted & (shares > low) & (shares <= high)
        print(f"| {100 * low:.0f}-{100 * high:.0f} % | {share(found, which)} | {share(found, which & cut)} | {share(found, which & ~cut)} |")
    print(f"\n{wrong} of {len(results)} detections find nobody.")


if __name__ == "__main__":
    main()
