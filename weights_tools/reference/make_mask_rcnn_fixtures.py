#!/usr/bin/python3
"""Writes tests/fixtures/mask_rcnn: what torchvision finds, for the tests of nn/models/mask_rcnn.

usage: make_mask_rcnn_fixtures.py DATA OUT      (DATA: the folder of the real data; OUT: tests/fixtures/mask_rcnn)

  trained.json            the trained checkpoint on real images: every detection, masks as COCO runs
  random_baseline.json    weights from counter_random, small images made from it too
  random_attention.json   the same with mixed attention
  full_baseline.json, full_attention.json    the same at full size: 1242 x 375 and a portrait image

Needs Debian's python3-torchvision (0.14.1), python3-opencv and python3-numpy. The fixtures hold outputs only; the
C++ tests make the same weights and images themselves (tests/support/random_network.h).
"""
import json
import os
import sys

import cv2
import numpy as np
import torch
import torchvision

from counter_random import counter_uniform, uniform_tensor
from mixed_attention import add_mixed_attention

IMAGES = [
    "coco/images/000000329323.jpg", "coco/images/000000184791.jpg", "coco/images/000000192699.jpg",
    "coco/images/000000055299.jpg", "coco/images/000000453634.jpg", "coco/images/000000128598.jpg",
    "kitti/sequences/00/image_0/000000.png",
]


# Of weights whose name holds the key; all others 1.5, about what keeps the size of activations through a ReLU.
GAINS = {
    "conv3": 0.5,  # ends the residual branch: the sum must not grow from block to block
    "inner_blocks": 0.15,  # 0.9 with attention, whose two gates halve the map about twice
    "cls_logits": 0.5,
    "rpn.head.bbox_pred": 0.15,
    "bbox_pred": 1.0,
    "cls_score": 1.0,
    "mask_fcn_logits": 1.0,
    "spatial": 0.5,
    "reduce": 0.5,
    "expand": 0.5,
}


def runs(mask):
    """Column-major run lengths, zeros first: COCO's uncompressed RLE."""
    bits = np.asfortranarray(mask).flatten(order="F").astype(np.uint8)
    changes = np.flatnonzero(np.diff(bits)) + 1
    lengths = np.diff(np.concatenate([[0], changes, [bits.size]])).tolist()
    return lengths if bits[0] == 0 else [0] + lengths


def detections(model, bgr, least_score):
    """What the model finds in a BGR image with at least least_score, in order of falling score."""
    rgb = np.ascontiguousarray(bgr[:, :, ::-1])
    with torch.no_grad():
        found = model([torch.from_numpy(rgb).permute(2, 0, 1).float() / 255.0])[0]
    keep = found["scores"] >= least_score
    return {
        "least_score": least_score,
        "boxes": [[round(v, 4) for v in box] for box in found["boxes"][keep].tolist()],
        "scores": [round(v, 6) for v in found["scores"][keep].tolist()],
        "labels": found["labels"][keep].tolist(),
        "masks": [runs(m[0].numpy() > 0.5) for m in found["masks"][keep]],
    }


def random_state_dict(model):
    """Weights of every tensor from stream 1, 2, ... in the order of the sorted names; scaled so that activations
    keep their size and some scores pass the thresholds. tests/support/random_network.cpp does the same."""
    state = model.state_dict()
    names = sorted(n for n in state if not n.endswith("num_batches_tracked"))
    for stream, name in enumerate(names, start=1):
        shape = tuple(state[name].shape)
        value = uniform_tensor(stream, shape)
        if name.endswith("running_var") or ("bn" in name or "downsample.1" in name) and name.endswith("weight"):
            value = np.float32(1.0) + np.float32(0.25) * value
        elif len(shape) == 1:
            value = np.float32(0.1) * value
        else:
            fan_in = int(np.prod(shape[1:]))
            gain = next((g for part, g in GAINS.items() if part in name), 1.5)
            if "inner_blocks" in name and any("attention" in n for n in names):
                gain = 0.9
            value = np.float32(gain * np.sqrt(3.0 / fan_in)) * value
        state[name] = torch.from_numpy(value)
    model.load_state_dict(state)
    return model


def random_image(seed, width, height):
    """Blocks of random colour, 8 x 8 pixels each, and noise: edges at several scales."""
    coarse = counter_uniform(seed, ((height + 7) // 8) * ((width + 7) // 8) * 3)
    coarse = coarse.reshape((height + 7) // 8, (width + 7) // 8, 3).repeat(8, axis=0).repeat(8, axis=1)
    noise = uniform_tensor(seed + 1000, (height, width, 3))
    value = np.float32(127.5) + np.float32(90.0) * coarse[:height, :width] + np.float32(30.0) * noise
    return value.astype(np.uint8)  # truncated; inside 0..255


def write(path, content):
    with open(path, "w") as file:
        json.dump(content, file, separators=(",", ":"))
        file.write("\n")
    print(path, os.path.getsize(path), "bytes")


def main():
    data, out = sys.argv[1:]
    os.makedirs(out, exist_ok=True)
    build = lambda **settings: torchvision.models.detection.maskrcnn_resnet50_fpn(
        weights=None, weights_backbone=None, num_classes=91, **settings).eval()

    trained = build()
    state = torch.load(os.path.join(data, "weights/maskrcnn_r50fpn.pth"), map_location="cpu")
    trained.load_state_dict({k: v.float() for k, v in state.items()})
    write(os.path.join(out, "trained.json"), [
        dict(image=name, **detections(trained, cv2.imread(os.path.join(data, name)), 0.3)) for name in IMAGES])

    small = dict(sizes=[(96, 64), (50, 121)], least_score=0.3, settings=dict(min_size=128, max_size=224))
    full = dict(sizes=[(1242, 375), (400, 640)], least_score=0.8, settings={})
    for name, attention, cases in (("random_baseline", False, small), ("random_attention", True, small),
                                   ("full_baseline", False, full), ("full_attention", True, full)):
        model = build(**cases["settings"])
        model = random_state_dict(add_mixed_attention(model) if attention else model)
        found = []
        for seed, (width, height) in enumerate(cases["sizes"], start=1):
            case = dict(seed=seed, width=width, height=height,
                        **detections(model, random_image(seed, width, height), cases["least_score"]))
            print(name, width, height, len(case["scores"]), "detections, best", case["scores"][:5])
            found.append(case)
        write(os.path.join(out, name + ".json"), found)


if __name__ == "__main__":
    main()
