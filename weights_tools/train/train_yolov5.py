#!/usr/bin/python3
"""Trains YOLOv5n or AFNET-n, from random weights or others, on a COCO-format data set and writes weights for Penumbra.

  train_yolov5.py --annotations office/instances.json --images office --classes person,chair,tv --out out/office
  train_yolov5.py ... --attention --fusion --init out/office/weights.safetensors --out out/afnet

--attention and --fusion are the two parts of AFNET (coordinate attention and ASFF). Where the weights of --init lack
them, they begin near neutral (yolov5_loss.py, start).

Run again with the same --out, it goes on from the last checkpoint: order of the images and changes to them depend on
the seed and the step alone. Writes to --out:
  checkpoint.pt            everything needed to go on
  log.jsonl                losses and speed
  weights.safetensors      the mean of the weights over the last steps, for `penumbra segment` and `slam`

Needs Debian's python3-torch, python3-torchvision, python3-opencv; on a processor set OMP_NUM_THREADS=2.
"""
import argparse
import collections
import functools
import pathlib
import sys

import cv2
import numpy as np
import torch

import loop
import safetensors_file
from coco_data import LUMA, CocoData, read_rgb
from yolov5_loss import build, losses, start

# Widths and heights of the images, and how often each is drawn: in the first part of the steps and in the second.
# A small image costs a fraction; the last steps see the size at which the network is used as well.
SIZES = ((256, 192), (320, 256), (416, 320), (640, 480))
SHARES = ((0.6, 0.4, 0.0, 0.0), (0.1, 0.35, 0.2, 0.35))
GREY = 114  # of what lies outside an image, as the engine fills it


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    loop.add_arguments(parser)
    parser.add_argument("--classes", required=True, help="names of the categories to learn, separated by commas")
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--batch", type=int, default=12, help="images of 320 x 256 a step; of other sizes as many pixels")
    parser.add_argument("--learning-rate", type=float, default=2e-3)
    parser.add_argument("--weight-decay", type=float, default=0.01)
    parser.add_argument("--mean-over", type=int, default=300, help="steps that the averaged weights reach back")
    parser.add_argument("--first-part", type=float, default=0.5, help="share of the steps with small images alone")
    parser.add_argument("--init", help="weights.safetensors to start from, of a network with the same classes")
    parser.add_argument("--attention", action="store_true", help="coordinate attention in the backbone's residual units")
    parser.add_argument("--fusion", action="store_true", help="ASFF before the head")
    parser.add_argument("--gate-rate", type=float, default=1.0,
                        help="learning rate of attention's gates and ASFF's shares, over that of the other weights")
    parser.add_argument("--checkpoint-every", type=int, default=50, help="steps")
    return parser.parse_args()


class Samples:
    """Batches in an order that depends on the seed alone; batch k is the same after any resume."""

    def __init__(self, data, batch, small, seed):
        self.data, self.batch, self.small, self.seed = data, batch, small, seed  # small: steps of the first part
        self.read = functools.lru_cache(maxsize=8000)(self.read)  # 1 MB each; decoding takes a third of a step

    def read(self, name):
        return read_rgb(self.data.folder / name)

    def view(self, entry, width, height, random):
        """A window of an image, from wider than it to half of it, so that objects are often cut off; maybe mirrored,
        tinted, grey or blurred. Returns the window and its objects as class, centre and size."""
        about, objects = entry
        image = self.read(about["file_name"])
        zoom = np.exp(random.uniform(np.log(0.8), np.log(1.7)))
        scale = zoom * np.array([width / image.shape[1]] * 2) * np.exp(random.uniform(-0.1, 0.1, 2))
        free = np.array([width, height]) - scale * (image.shape[1], image.shape[0])
        shift = free * random.uniform(size=2)
        reduction = image.shape[1] / width / zoom
        if reduction > 1.5:
            image = cv2.resize(image, None, fx=1 / reduction, fy=1 / reduction, interpolation=cv2.INTER_AREA)
        fit = about["width"] / image.shape[1]
        boxes = np.array([[x, y, x + w, y + h] for _, (x, y, w, h), _ in objects]) * np.tile(scale, 2) + np.tile(shift, 2)
        matrix = np.array([[scale[0] * fit, 0, shift[0]], [0, scale[1] * fit, shift[1]]])
        window = cv2.warpAffine(image, matrix, (width, height), flags=cv2.INTER_LINEAR, borderValue=(GREY,) * 3)
        if random.random() < 0.5:
            window, boxes[:, [0, 2]] = window[:, ::-1], width - boxes[:, [2, 0]]
        whole = np.prod(boxes[:, 2:] - boxes[:, :2], 1)
        boxes = boxes.clip(0, (width, height, width, height))
        sides = boxes[:, 2:] - boxes[:, :2]
        good = (sides.min(1) >= 4) & (np.prod(sides, 1) > 0.08 * whole)
        labels = np.array([label - 1 for label, _, _ in objects])
        pixels = self.coloured(window, random)
        return pixels, np.column_stack([labels, (boxes[:, :2] + boxes[:, 2:]) / 2, sides])[good]

    @staticmethod
    def coloured(window, random):
        if random.random() < 0.15:
            window = cv2.blur(window, (1, int(random.integers(2, 6)))[::random.choice([-1, 1])])
        pixels = window.astype(np.float32) / 255
        if random.random() < 0.1:
            pixels = np.repeat(pixels @ LUMA, 3, 2)
        elif random.random() < 0.3:  # clothes and things in other colours
            pixels = pixels[:, :, random.permutation(3)]
        gain = random.uniform(0.65, 1.35) * random.uniform(0.85, 1.15, 3)
        return np.clip(pixels * gain + random.uniform(-0.06, 0.06), 0, 1).astype(np.float32)

    def __getitem__(self, k):
        """Images [N, 3, H, W] and targets [n, 6]: image, class, centre and size in pixels."""
        random = np.random.default_rng([self.seed, k])
        width, height = SIZES[random.choice(len(SIZES), p=SHARES[k >= self.small])]
        images, targets = [], []
        for n in range(max(2, round(self.batch * 320 * 256 / (width * height)))):
            entry = self.data.entries[random.integers(len(self.data))]
            pixels, found = self.view(entry, width, height, random)
            images.append(pixels.transpose(2, 0, 1))
            targets.append(np.column_stack([np.full(len(found), n), found]))
        return torch.from_numpy(np.stack(images)), torch.from_numpy(np.concatenate(targets).astype(np.float32))


def is_gate(name):
    """Of the weights that say how much of a feature passes."""
    return ".attention." in name or name.startswith("asff.") and ".weight." in name


class Training(loop.MeanLoop):
    def __init__(self, options):
        super().__init__(options, digits=5)
        self.classes = options.classes.split(",")
        data = CocoData(options.annotations, options.images, self.classes, least_area=40)
        print(f"{len(data)} images with {data.instances} objects", file=sys.stderr)
        self.samples = Samples(data, options.batch, options.first_part * options.steps, options.seed)
        torch.manual_seed(options.seed)
        model = build(len(self.classes), options.attention, options.fusion)
        if options.init:
            start(model, safetensors_file.load(options.init)[0])
        self.follow(model)
        groups = collections.defaultdict(list)
        for name, parameter in self.model.named_parameters():
            groups[parameter.dim() > 1, is_gate(name)].append(parameter)
        self.optimizer = torch.optim.AdamW(
            [dict(params=parameters, weight_decay=options.weight_decay * decaying, rate=options.gate_rate if gate else 1.0)
             for (decaying, gate), parameters in groups.items()], lr=options.learning_rate)
        self.resume()

    def one_step(self):
        images, targets = self.samples[self.step]
        for group in self.optimizer.param_groups:
            group["lr"] = group["rate"] * loop.learning_rate(self.step, self.options.steps, self.options.learning_rate)
        parts = losses(self.model(images.contiguous(memory_format=torch.channels_last)), targets, self.model.model[24].anchors)
        self.descend(parts, 10.0)
        return {name: float(value) for name, value in parts.items()}

    def export(self):
        options = self.options
        facts = dict(training_data=options.data_name or pathlib.Path(options.annotations).parent.name, seed=options.seed,
                     steps=self.step, images_per_step=options.batch)
        safetensors_file.save(options.out / "weights.safetensors", self.mean,
                              dict(network="afnet" if options.attention or options.fusion else "yolov5", batch_norm_eps=1e-3, classes=",".join(self.classes), **facts))


def main():
    options = arguments()
    options.out.mkdir(parents=True, exist_ok=True)
    Training(options).run()


if __name__ == "__main__":
    main()
