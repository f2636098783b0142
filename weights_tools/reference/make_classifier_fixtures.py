#!/usr/bin/python3
"""Writes tests/fixtures/classifier: what torchvision and Pillow make of random networks and images.

usage: make_classifier_fixtures.py OUT      (OUT: tests/fixtures/classifier)

  random_resnets.json   logits of ResNets of all depths with random weights, narrow ones but for one ResNet-18
  pillow_resize.json    Pillow's antialiased bilinear resize of small random images, whole and cropped

Needs Debian's python3-torchvision (0.14.1), python3-pil (9.4) and python3-numpy. Weights and images come from
counter_random; the C++ tests make the same ones.
"""
import json
import os
import sys

import numpy as np
import torch
import torchvision
from PIL import Image
from torchvision import transforms
from torchvision.models.resnet import BasicBlock, Bottleneck, ResNet

from random_state import random_image, random_state

VARIANTS = {18: (BasicBlock, (2, 2, 2, 2)), 34: (BasicBlock, (3, 4, 6, 3)), 50: (Bottleneck, (3, 4, 6, 3)),
            101: (Bottleneck, (3, 4, 23, 3)), 152: (Bottleneck, (3, 8, 36, 3))}
CLASSES = 10


class NarrowResNet(ResNet):
    """torchvision's ResNet with every channel count divided by `divisor`."""

    def __init__(self, block, layers, divisor):
        super().__init__(block, layers, num_classes=CLASSES)
        self.inplanes = 64 // divisor
        self.conv1 = torch.nn.Conv2d(3, self.inplanes, 7, 2, 3, bias=False)
        self.bn1 = torch.nn.BatchNorm2d(self.inplanes)
        for stage, count in enumerate(layers):
            layer = self._make_layer(block, (64 << stage) // divisor, count, stride=1 if stage == 0 else 2)
            setattr(self, f"layer{stage + 1}", layer)
        self.fc = torch.nn.Linear(512 // divisor * block.expansion, CLASSES)


def gain(depth):
    last = "conv3" if depth >= 50 else "conv2"  # ends the residual branch: the sum must not grow from block to block
    return lambda name: 0.5 if last in name else 1.0 if name.startswith("fc") else 1.5


def resnet_case(depth, width, seed, image_size):
    network = NarrowResNet(*VARIANTS[depth], 64 // width).eval()
    shapes = {k: v.shape for k, v in network.state_dict().items() if not k.endswith("num_batches_tracked")}
    network.load_state_dict(random_state(shapes, gain(depth)), strict=False)
    transform = transforms.Compose([
        transforms.Resize(72), transforms.CenterCrop(64), transforms.ToTensor(),
        transforms.Normalize([0.485, 0.456, 0.406], [0.229, 0.224, 0.225])])
    image = Image.fromarray(random_image(seed, *image_size)[:, :, ::-1].copy())
    with torch.no_grad():
        logits = network(transform(image)[None])[0].tolist()
    print("ResNet", depth, "width", width, ["%.3f" % v for v in logits])
    return dict(depth=depth, width=width, seed=seed, image=image_size, logits=[round(v, 6) for v in logits])


def pillow_case(seed, image_size, size, window):
    image = Image.fromarray(random_image(seed, *image_size))
    x, y, width, height = window
    part = np.asarray(image.resize(size, Image.BILINEAR))[y:y + height, x:x + width]
    return dict(seed=seed, image=image_size, size=size, window=window, pixels=part.flatten().tolist())


def write(path, content):
    with open(path, "w") as file:
        json.dump(content, file, separators=(",", ":"))
        file.write("\n")
    print(path, os.path.getsize(path), "bytes")


def main():
    out = sys.argv[1]
    os.makedirs(out, exist_ok=True)
    write(os.path.join(out, "random_resnets.json"), [
        resnet_case(depth, 64 if depth == 18 and seed == 1 else 8, seed, size)
        for seed, (depth, size) in enumerate(
            [(18, (90, 120)), (18, (200, 100)), (34, (64, 64)), (50, (150, 99)), (101, (73, 211)), (152, (80, 72))],
            start=1)])
    write(os.path.join(out, "pillow_resize.json"), [
        pillow_case(1, (100, 60), (17, 11), (0, 0, 17, 11)),   # smaller
        pillow_case(2, (19, 13), (40, 31), (10, 5, 20, 20)),   # larger, a part
        pillow_case(3, (64, 200), (30, 94), (3, 40, 24, 24)),  # a part from the middle
        pillow_case(4, (37, 16), (37, 9), (0, 0, 37, 9)),      # one direction only
        pillow_case(5, (1, 7), (5, 3), (0, 0, 5, 3)),
    ])


if __name__ == "__main__":
    main()
