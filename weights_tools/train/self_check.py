#!/usr/bin/python3
"""Checks of the training code that need no data: gates start as the identity, folding and export keep the outputs, layers that are
computed otherwise than torchvision computes them agree with it, masks survive their encoding, YOLOv5's objects go to
the cells that a loop finds, and its head says in training what it says afterwards, attention starts with gates that change nothing,
a batch has the targets, losses and gradients that torchvision finds image by image, packed data are what was decoded.

usage: self_check.py        (prints one line a check; exit code 1 where one fails)
"""
import argparse
import pathlib
import sys
import tempfile

import numpy as np
import torch
from torch import nn
from torch.nn import functional as F

import batch_checks
from coco_data import counts_of, decode_counts, decode_mask
from config import CONFIGS
from export import export
from initial_weights import load_initial
from model import ORDERS, VARIANTS, BoxHead, DoublingConv, LargestAndMean, build, fold_gains, with_both_gates
from train import numbers
from yolov5_loss import STRIDES, assign, complete_iou
from yolov5_loss import build as build_yolov5
from yolov5_loss import start
from afnet import BACKBONE_C3, leaky

TINY = CONFIGS["tiny"]


def seeded(attention, gain=2.0):
    torch.manual_seed(1)
    return build(TINY, attention, gain).eval()


def maps(model):
    torch.manual_seed(2)
    with torch.no_grad():
        return list(model.backbone(torch.rand(1, 3, 192, 320)).values())


def attention_starts_as_the_identity():
    return all(torch.equal(a, b) for kind in VARIANTS for a, b in zip(maps(seeded(False)), maps(seeded(kind))))


def folding_keeps_the_outputs():
    """Of one gate, which becomes both with one at zero, and of both in either order."""
    for order in ORDERS:
        trained = seeded(order)
        torch.manual_seed(3)
        for parameter in trained.backbone.fpn.attention.parameters():
            nn.init.normal_(parameter, std=0.3)
        folded = seeded(order if "-" in order else True, gain=1.0)
        folded.load_state_dict(fold_gains(with_both_gates(trained.state_dict(), TINY.reduction), 2.0, order))
        changed = any(not torch.equal(a, b) for a, b in zip(maps(trained), maps(seeded(order))))
        if not changed or not all(torch.allclose(a, b, rtol=1e-5, atol=1e-6) for a, b in zip(maps(trained), maps(folded))):
            return False
    return True


def loads(model, path):
    try:
        load_initial(model, path)
    except SystemExit:
        return False
    return True


def weights_come_back_from_their_file():
    """Export and --init, for every kind of network; and a gate that was not trained starts as one that can learn."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "weights.safetensors"
        for order in VARIANTS[1:]:
            trained, again, both = seeded(order), seeded(order), build(TINY, True).eval()
            torch.manual_seed(3)
            for parameter in trained.parameters():
                parameter.data = parameter.data.half().float()
            for parameter in trained.backbone.fpn.attention.parameters():
                parameter.data = torch.randn(parameter.shape).mul_(0.3).half().float()
            for buffer in trained.backbone.fpn.attention.buffers():
                if buffer.is_floating_point():
                    buffer.data = torch.rand(buffer.shape).add_(0.5).half().float()
            export(path, trained, TINY, order)
            load_initial(again, path)
            if order == "after-sum" and loads(both, path):  # into the paper's kind, which has the same names
                return False
            if not all(torch.allclose(a, b, rtol=1e-5, atol=1e-6) for a, b in zip(maps(trained), maps(again))):
                return False
            if order in ("spatial", "channel"):
                load_initial(both, path)
                same = all(torch.allclose(a, b, rtol=1e-5, atol=1e-6) for a, b in zip(maps(trained), maps(both)))
                if not same or not all(a.channel.reduce.weight.any() for a in both.backbone.fpn.attention):
                    return False
    return True


def doubling_is_the_transposed_convolution():
    layer, x = DoublingConv(8), torch.randn(3, 8, 5, 5)
    return torch.allclose(layer(x), nn.ConvTranspose2d.forward(layer, x), atol=1e-5)


def box_head_is_linear():
    head, x = BoxHead(8, 16, 1), torch.randn(3, 8, 7, 7)
    return torch.allclose(head(x), F.relu(head.fc6(x.flatten(1))), atol=1e-4)


def encode_counts(counts):
    """COCO's compressed text, as its rleToString writes it."""
    text = ""
    for k, count in enumerate(counts):
        value, more = count - (counts[k - 2] if k > 2 else 0), True
        while more:
            code = value & 31
            value >>= 5
            more = value != (-1 if code & 16 else 0)
            text += chr((code | 32 if more else code) + 48)
    return text


def masks_survive_their_encoding():
    random = np.random.default_rng(1)
    for share in (0.02, 0.5, 0.98):
        mask = (random.random((37, 61)) < share).astype(np.uint8)
        counts = counts_of(mask)
        if decode_counts(encode_counts(counts)) != counts:
            return False
        for stored in (counts, encode_counts(counts)):
            if not np.array_equal(decode_mask({"counts": stored}, 37, 61), mask):
                return False
    return True


def cells_are_those_of_a_loop():
    torch.manual_seed(4)
    width, height, anchors = 9, 7, torch.tensor([[1.0, 2.0], [4.0, 3.0], [9.0, 8.0]])
    targets = torch.rand(40, 6) * torch.tensor([4, 3, width, height, 12, 12]) + torch.tensor([0, 0, 0, 0, 0.2, 0.2])
    expected = set()
    for t, (_, _, x, y, w, h) in enumerate(targets.tolist()):
        for a, (p, q) in enumerate(anchors.tolist()):
            if max(w / p, p / w, h / q, q / h) >= 4:
                continue
            for row in range(height):
                for column in range(width):
                    dx, dy = abs(x - column - 0.5), abs(y - row - 0.5)  # from the cell's centre
                    if (dx <= 0.5 and dy <= 1) or (dx <= 1 and dy <= 0.5):
                        expected.add((t, a, row, column))
    chosen, anchor, row, column = assign(targets, anchors, height, width)
    rows = {tuple(values): t for t, values in enumerate(targets.tolist())}
    found = [(rows[tuple(c)], *others) for c, *others in zip(chosen.tolist(), anchor.tolist(), row.tolist(), column.tolist())]
    return len(found) == len(set(found)) and set(found) == expected


def the_iou_of_a_box_with_itself_is_one():
    boxes = torch.rand(20, 4) * 50 + 1
    return torch.allclose(complete_iou(boxes, boxes), torch.ones(20), atol=1e-5)


def the_trained_head_says_what_the_reference_says():
    network, image = build_yolov5(3).eval(), torch.rand(1, 3, 64, 96)
    with torch.no_grad():
        rows = network(image)[0][0]
        network.model[24].train()
        y = network(image)[0].flatten(1, 3)[0].sigmoid()
    first = rows[:len(y)]
    anchors = (network.model[24].anchors[0] * STRIDES[0]).repeat_interleave(len(y) // 3, 0)
    return torch.allclose(first[:, 4:], y[:, 4:]) and torch.allclose(first[:, 2:4], (2 * y[:, 2:4]) ** 2 * anchors)


def coordinate_attention_starts_as_the_identity():
    torch.manual_seed(5)
    plain, gated, image = build_yolov5(3).eval(), build_yolov5(3, attention=True).eval(), torch.rand(1, 3, 64, 96)
    start(gated, plain.state_dict())
    for k in BACKBONE_C3:
        for unit in plain.model[k].m:
            unit.cv1.act = unit.cv2.act = leaky
    with torch.no_grad():
        return torch.allclose(plain(image)[0], gated(image)[0], rtol=1e-4, atol=1e-5)


def largest_and_mean_are_those_of_pytorch():
    f = torch.randn(3, 35, 8, dtype=torch.float64, requires_grad=True)
    for columns in (False, True):
        weights, found, axis = torch.randn(2, 3, 8 if columns else 35), [], 1 if columns else 2
        for a, b in (LargestAndMean.apply(f, columns), (f.amax(axis), f.mean(axis))):
            gradient, = torch.autograd.grad((a * weights[0] + b * weights[1]).sum(), f)
            found.append((a, b, gradient))
        if not all(torch.allclose(p, q) for p, q in zip(*found)):
            return False
    return True


def ranges_are_read():
    for refused in ("1,5-1", "1-", "-3", "a"):
        try:
            numbers(refused)
            return False
        except (argparse.ArgumentTypeError, ValueError):
            pass
    return numbers("1-3,7") == [1, 2, 3, 7]


def main():
    failed = False
    for check in (attention_starts_as_the_identity, folding_keeps_the_outputs, doubling_is_the_transposed_convolution,
                  box_head_is_linear, masks_survive_their_encoding, cells_are_those_of_a_loop,
                  the_iou_of_a_box_with_itself_is_one, the_trained_head_says_what_the_reference_says,
                  coordinate_attention_starts_as_the_identity, weights_come_back_from_their_file,
                  largest_and_mean_are_those_of_pytorch, ranges_are_read, *batch_checks.CHECKS):
        good = check()
        failed |= not good
        print("ok    " if good else "FAILED", check.__name__.replace("_", " "))
    sys.exit(failed)


if __name__ == "__main__":
    main()
