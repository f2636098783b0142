"""Batches of a packed data set, as detection_losses.py takes them."""
import concurrent.futures
import dataclasses

import numpy as np
import torch

from coco_data import LUMA

STRIDE = 32  # of the coarsest map that is made from images: sides are filled up to its multiples


@dataclasses.dataclass
class Batch:
    """N images, filled up with zeros to H x W; the most objects in one of them are O (1 at least), all of them are M."""
    sides: list            # (height, width) of each image
    light: list            # (gain, offset, whether it becomes grey) of each
    pixels: torch.Tensor   # u8 [N, H, W, 3], RGB, mirrored where they shall be
    classes: torch.Tensor  # u8 [N, H, W]: class of every pixel, 0 where nothing is
    boxes: torch.Tensor    # f32 [N, O, 4]
    labels: torch.Tensor   # i64 [N, O], 0 where there is no object
    mask_of: torch.Tensor  # i64 [N, O]: which of the masks
    masks: torch.Tensor    # u8 [M, H, W]

    def to(self, device):
        if device.type == "cpu":
            return self
        moved = {name: value.pin_memory().to(device, non_blocking=True) for name, value in vars(self).items()
                 if torch.is_tensor(value)}
        return dataclasses.replace(self, **moved)

    def images(self):
        """f32 [N, 3, H, W] in 0..1, of which the channels of a pixel lie beside each other."""
        values = self.pixels.float()
        for image, (gain, offset, grey) in zip(values, self.light):
            image.mul_(gain / 255.0).add_(offset)
            if grey:
                image.copy_((image @ torch.as_tensor(LUMA, device=image.device)).expand_as(image))
        return values.clamp_(0.0, 1.0).permute(0, 3, 1, 2)

    def inside_only(self, images):
        """Sets `images` [N, C, H, W] to 0 where they are filled up."""
        for image, (height, width) in zip(images, self.sides):
            image[:, height:] = 0
            image[:, :, width:] = 0
        return images


class Batches:
    """Endless batches in an order that depends on the seed alone; batch k is the same after any resume. While a step
    is computed, a thread of its own prepares the next one."""

    def __init__(self, data, size, seed, grey=0.15):
        self.data, self.size, self.seed, self.grey = data, size, seed, grey  # grey: share of images without colour
        self.order = (-1, None)
        self.thread, self.next = concurrent.futures.ThreadPoolExecutor(1), (None, None)

    def index(self, position):
        epoch, place = divmod(position, len(self.data))
        order = self.order  # read once: the thread that prepares batches may put another epoch's in its place
        if order[0] != epoch:
            order = self.order = epoch, np.random.default_rng([self.seed, epoch]).permutation(len(self.data))
        return int(order[1][place])

    def changes(self, k):
        """Image, whether it is mirrored, gain, offset and whether it is grey, of every image of batch k."""
        random = np.random.default_rng([self.seed, 1 << 20, k])
        for position in range(k * self.size, (k + 1) * self.size):
            yield (self.index(position), random.random() < 0.5, random.uniform(0.8, 1.25), random.uniform(-0.05, 0.05),
                   random.random() < self.grey)

    def make(self, k):
        chosen = list(self.changes(k))
        sizes = [self.data.size(index) for index, *_ in chosen]
        height, width = (-(-max(side) // STRIDE) * STRIDE for side in zip(*sizes))
        objects = [self.data.objects(index) for index, *_ in chosen]
        counts = [len(labels) for labels, _ in objects]
        n, most = len(chosen), max(1, *counts)
        pixels, classes = np.zeros((n, height, width, 3), np.uint8), np.zeros((n, height, width), np.uint8)
        masks, mask_of = np.zeros((max(1, sum(counts)), height, width), np.uint8), np.zeros((n, most), np.int64)
        boxes, labels = np.zeros((n, most, 4), np.float32), np.zeros((n, most), np.int64)
        first = 0
        for i, ((index, flip, *_), (h, w), (names, corners)) in enumerate(zip(chosen, sizes, objects)):
            step, end, count = -1 if flip else 1, first + len(names), len(names)
            image, things = self.data.pixels(index)
            pixels[i, :h, :w], classes[i, :h, :w] = image[:, ::step], things[:, ::step]
            if flip:
                corners[:, [0, 2]] = w - corners[:, [2, 0]]
            boxes[i, :count], labels[i, :count], mask_of[i, :count] = corners, names, np.arange(first, end)
            self.data.masks_into(index, masks[first:end], flip)
            first = end
        tensors = (pixels, classes, boxes, labels, mask_of, masks)
        return Batch([tuple(side) for side in sizes], [light for _, _, *light in chosen], *map(torch.from_numpy, tensors))

    def __getitem__(self, k):
        prepared, future = self.next
        batch = future.result() if prepared == k else self.make(k)
        self.next = k + 1, self.thread.submit(self.make, k + 1)
        return batch
