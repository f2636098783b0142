#!/usr/bin/python3
"""Where attention looks: draws the spatial gates of a trained network over hidden objects, and prints what both gates do
on average over a data set.

  draw_gates.py out/table/spatial-channel_1/weights.safetensors --annotations val/instances.json --images val --out gates.png

A gate is 2 sigmoid(..) here, as in training: 1 leaves a map as it is (docs/training.md, How the gates start). What dims
a whole map alike can be made good by the layers behind it, so the picture shows a gate divided by its mean over the image
and level: blue dims, red stresses; the scale's ends are printed. Each row of the picture is an image with the most half-hidden objects of its
drive, these outlined, then the gates of P2 to P5.
"""
import argparse
import collections
import json
import pathlib

import cv2
import numpy as np
import torch

from coco_data import decode_mask, read_rgb
from config import CONFIGS
from evaluate import OCCLUSION
from evaluate_in_python import network

STRIDES = {"P2": 4, "P3": 8, "P4": 16, "P5": 32}
BOUNDS = [float(bound) for bound in OCCLUSION.split(",")]


class Gates:
    """Keeps the gates of a network's last image: per level what a pixel and what a channel is multiplied by."""

    def __init__(self, model):
        self.spatial, self.channel = {}, {}
        for level, attention in zip(STRIDES, model.backbone.fpn.attention):
            for kind in attention.order:
                getattr(attention, kind).register_forward_hook(self.keep(getattr(self, kind), level))

    @staticmethod
    def keep(where, level):
        def hook(module, inputs, _):
            where[level] = module.gate(inputs[-1])[0].squeeze().numpy()
        return hook

    def over(self, height, width):
        """The spatial gates of an image of this size, without what it was filled up with."""
        return {level: gate[:-(-height // STRIDES[level]), :-(-width // STRIDES[level])] for level, gate in self.spatial.items()}


def hidden(annotation):
    return annotation.get("occlusion", 0.0)


def colours(gate, reach):
    """[H, W, 3] of bytes, BGR: white where a gate is 1, red above, blue below, full `reach` away from 1."""
    share = np.clip((gate - 1.0) / reach, -1.0, 1.0)[..., None]
    ends = np.where(share > 0, (40.0, 40.0, 220.0), (220.0, 80.0, 30.0))
    return (255.0 + np.abs(share) * (ends - 255.0)).astype(np.uint8)


def picture(rows, reach):
    lines = []
    for image, objects, gates in rows:
        height, width = image.shape[:2]
        shown = np.ascontiguousarray(image[:, :, ::-1])
        for annotation in objects:
            x, y, w, h = (round(v) for v in annotation["bbox"])
            cv2.rectangle(shown, (x, y), (x + w, y + h), (0, 220, 255), 1)
        lines.append(shown)
        grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)[..., None].astype(np.float32)
        for level, gate in gates.items():
            drawn = cv2.resize(colours(gate, reach), (width, height), interpolation=cv2.INTER_NEAREST)
            drawn = (0.65 * drawn + 0.35 * grey).astype(np.uint8)
            cv2.putText(drawn, level, (4, 14), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (0, 0, 0), 1, cv2.LINE_AA)
            lines.append(drawn)
    per_row = 1 + len(rows[0][2])
    return np.vstack([np.hstack(lines[k:k + per_row]) for k in range(0, len(lines), per_row)])


class Means:
    """Mean spatial gate, per level, of pixels of objects by hidden share and of all others."""

    def __init__(self):
        self.sums = collections.defaultdict(lambda: [0.0, 0])

    def add(self, gates, objects, height, width):
        for level, gate in gates.items():
            to_level = lambda mask: cv2.resize(mask.astype(np.float32), gate.shape[::-1], interpolation=cv2.INTER_AREA) >= 0.5
            rest = np.ones(gate.shape, bool)
            for annotation in objects:
                mask = to_level(decode_mask(annotation["segmentation"], height, width))
                rest &= ~mask
                for low, high in zip(BOUNDS, BOUNDS[1:]):
                    if low <= hidden(annotation) < high:
                        self.note((level, f"{100 * low:.0f}-{100 * high:.0f} % hidden"), gate[mask])
            self.note((level, "no object"), gate[rest])

    def note(self, key, values):
        self.sums[key][0] += float(values.sum())
        self.sums[key][1] += values.size

    def table(self):
        names = list(dict.fromkeys(name for _, name in self.sums))
        yield "| spatial gate, mean | " + " | ".join(sorted(names)) + " |"
        yield "|" + " --- |" * (len(names) + 1)
        for level in STRIDES:
            cells = [self.sums[level, name] for name in sorted(names)]
            yield f"| {level} | " + " | ".join(f"{s / n:.3f}" if n else "-" for s, n in cells) + " |"


@torch.no_grad()
def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weights")
    parser.add_argument("--annotations", required=True, type=pathlib.Path)
    parser.add_argument("--images", required=True, type=pathlib.Path)
    parser.add_argument("--out", required=True, help="the picture")
    parser.add_argument("--rows", type=int, default=4, help="images in the picture")
    parser.add_argument("--config", choices=CONFIGS, default="tiny")
    options = parser.parse_args()

    content, model = json.loads(options.annotations.read_text()), network(options.weights, CONFIGS[options.config])
    if not content["images"]:
        raise SystemExit(f"{options.annotations}: no images")
    if not hasattr(model.backbone.fpn, "attention"):
        raise SystemExit(f"{options.weights}: a network without attention has no gates")
    gates, means, channels, shown = Gates(model), Means(), collections.defaultdict(list), {}
    objects = collections.defaultdict(list)
    for annotation in content["annotations"]:
        objects[annotation["image_id"]].append(annotation)
    half = lambda entry: [a for a in objects[entry["id"]] if 0.3 <= hidden(a) < 0.9 and a["area"] >= 400]
    best = {}  # of every drive, the image with the most half-hidden objects
    for entry in content["images"]:
        drive = pathlib.Path(entry["file_name"]).parts[0]
        if drive not in best or len(half(entry)) > len(half(best[drive])):
            best[drive] = entry
    wanted = {e["id"] for e in sorted(best.values(), key=lambda e: -len(half(e)))[:options.rows]}
    for entry in content["images"]:
        image = read_rgb(options.images / entry["file_name"])
        model([torch.from_numpy(image).permute(2, 0, 1).float() / 255.0])
        height, width = image.shape[:2]
        spatial = gates.over(height, width)
        means.add(spatial, objects[entry["id"]], height, width)
        for level, gate in gates.channel.items():
            channels[level].append(gate)
        if entry["id"] in wanted:
            shown[entry["id"]] = image, half(entry), {level: gate / gate.mean() for level, gate in spatial.items()}
    if gates.spatial:
        every = np.concatenate([np.abs(g - 1).ravel() for _, _, of_image in shown.values() for g in of_image.values()])
        reach = float(np.quantile(every, 0.98)) or 1.0
        cv2.imwrite(options.out, picture(list(shown.values()), reach))
        print(f"{options.out}: full blue {1 - reach:.2f}, full red {1 + reach:.2f}\n")
        print("\n".join(means.table()) + "\n")
    if channels:
        print("| channel gate | least, largest mean of a channel | largest deviation of a channel over images |\n| --- | --- | --- |")
        for level, found in channels.items():
            found = np.array(found)
            print(f"| {level} | {found.mean(0).min():.3f}, {found.mean(0).max():.3f} | {found.std(0).max():.3f} |")


if __name__ == "__main__":
    main()
