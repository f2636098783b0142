#!/usr/bin/python3
"""Writes tests/fixtures/yolov5: what the PyTorch module of yolov5.py finds, for the tests of nn/models/yolov5.

usage: make_yolov5_fixtures.py DATA OUT      (DATA: the folder of the real data; OUT: tests/fixtures/yolov5)

  random.json    raw outputs of small networks with weights from counter_random: some rows and prototype pixels
  trained.json   the published weights on real images: detections above LEAST_SCORE, masks as COCO runs

Needs Debian's python3-torchvision, python3-opencv and python3-numpy.
"""
import json
import os
import sys

import cv2
import numpy as np
import torch
import torchvision
from torch.nn import functional as F

from make_mask_rcnn_fixtures import runs
from afnet import Afnet
from random_state import random_image, random_state
from yolov5 import PROTOTYPES, load

LEAST_SCORE = 0.25
IMAGES = ["coco/images/000000329323.jpg", "coco/images/000000184791.jpg", "coco/images/000000017627.jpg",
          "coco/images/000000006818.jpg", "kitti/sequences/00/image_0/000000.png"]
CHECKPOINTS = ["weights/yolov5n_state_dict_fp16.pth", "weights/yolov5n-seg_fused_state_dict_fp16.pth"]


def gain(name):
    """Keeps activations at about their size, so that no sigmoid saturates."""
    if "model.24.m." in name:
        return 3.0
    return 0.7 if ".m." in name and "cv2" in name else 1.6  # ends a residual branch, or not


def random_case(seed, width, depth, classes, prototypes, folded, size, attention=False, fusion=False):
    network = Afnet(classes, depth, width, attention, fusion, folded, prototypes).eval()
    shapes = {k: v.shape for k, v in network.state_dict().items()
              if not k.endswith("num_batches_tracked") and not k.endswith("anchors")}
    network.load_state_dict(random_state(shapes, gain), strict=False)
    image = random_image(seed, *size)[:, :, ::-1].copy()
    with torch.no_grad():
        rows, proto = network(torch.from_numpy(image).permute(2, 0, 1)[None].float() / 255)
    rows = rows[0].numpy()
    print("random", seed, rows.shape, "objectness", rows[:, 4].min(), rows[:, 4].max())
    picked = range(0, len(rows), 11)
    case = dict(seed=seed, width=width, depth=depth, classes=classes, masks=prototypes, folded=folded, size=size,
                rows={i: [round(float(v), 5) for v in rows[i]] for i in picked})
    if prototypes:
        flat = proto[0].flatten().numpy()
        case["prototypes"] = {i: round(float(flat[i]), 5) for i in range(0, len(flat), 61)}
    return case


def letterbox(image, size=640, stride=32):
    height, width = image.shape[:2]
    scale = min(size / height, size / width)
    w, h = round(width * scale), round(height * scale)
    pad_x, pad_y = -w % stride / 2, -h % stride / 2
    left, top = round(pad_x - 0.1), round(pad_y - 0.1)
    out = np.full((h + -h % stride, w + -w % stride, 3), 114, np.uint8)
    out[top:top + h, left:left + w] = cv2.resize(image, (w, h), interpolation=cv2.INTER_LINEAR)
    return out, scale, left, top, w, h


def detections(network, image, iou=0.6, limit=100):
    boxed, scale, left, top, w, h = letterbox(image)
    height, width = image.shape[:2]
    with torch.no_grad():
        rows, proto = network(torch.from_numpy(boxed[:, :, ::-1].copy()).permute(2, 0, 1)[None].float() / 255)
    classes = network.model[24].classes
    rows = rows[0][rows[0][:, 4] > LEAST_SCORE]
    scores = rows[:, 5:5 + classes] * rows[:, 4:5]
    row, label = (scores > LEAST_SCORE).nonzero().T
    score = scores[row, label]
    centre, size = rows[row, :2], rows[row, 2:4]
    boxes = torch.cat([centre - size / 2, centre + size / 2], 1)
    kept = torchvision.ops.batched_nms(boxes, score, label, iou)[:limit]
    boxes, score, label = boxes[kept], score[kept], label[kept]
    boxes = (boxes - torch.tensor([left, top, left, top])) / scale
    boxes = torch.stack([boxes[:, 0].clamp(0, width), boxes[:, 1].clamp(0, height), boxes[:, 2].clamp(0, width),
                         boxes[:, 3].clamp(0, height)], 1)
    found = dict(boxes=[[round(v, 3) for v in b] for b in boxes.tolist()],
                 scores=[round(v, 5) for v in score.tolist()], labels=label.tolist())
    if proto is None:
        return found
    coefficients = rows[row[kept]][:, 5 + classes:]
    masks = torch.sigmoid(coefficients @ proto[0].view(PROTOTYPES, -1)).view(-1, *proto.shape[2:])
    # Bilinear samples at the image's pixel centres; the prototypes have a quarter of the network's resolution.
    y = ((torch.arange(height) + 0.5) * (h / height) + top) / 4
    x = ((torch.arange(width) + 0.5) * (w / width) + left) / 4
    grid = torch.stack(torch.meshgrid(2 * x / proto.shape[3] - 1, 2 * y / proto.shape[2] - 1, indexing="xy"), -1)
    masks = F.grid_sample(masks[None], grid[None], mode="bilinear", padding_mode="border", align_corners=False)[0] > 0.5
    columns, lines = torch.arange(width).view(1, -1), torch.arange(height).view(-1, 1)
    found["masks"] = [runs((m & (columns >= b[0]) & (columns < b[2]) & (lines >= b[1]) & (lines < b[3])).numpy())
                      for m, b in zip(masks, boxes)]
    return found


def write(path, content):
    with open(path, "w") as file:
        json.dump(content, file, separators=(",", ":"))
        file.write("\n")
    print(path, os.path.getsize(path), "bytes")


def main():
    data, out = sys.argv[1:]
    os.makedirs(out, exist_ok=True)
    write(os.path.join(out, "random.json"), [
        random_case(1, 0.125, 1 / 3, 3, False, False, (96, 64)),
        random_case(2, 0.125, 2 / 3, 5, True, False, (64, 96)),
        random_case(3, 0.25, 1 / 3, 80, True, True, (64, 32)),
        random_case(4, 0.375, 1.0, 1, False, True, (32, 32)),
    ])
    cases = []
    for checkpoint in CHECKPOINTS:
        network = load(os.path.join(data, checkpoint))
        for name in IMAGES:
            found = detections(network, cv2.imread(os.path.join(data, name)))
            print(checkpoint, name, len(found["scores"]), "detections")
            cases.append(dict(checkpoint=checkpoint, image=name, **found))
    write(os.path.join(out, "trained.json"), cases)


if __name__ == "__main__":
    main()
