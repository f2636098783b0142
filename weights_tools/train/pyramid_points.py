"""Reading all levels of a feature pyramid at points, for all images of a batch at once.

Whatever reads the pyramid at points, RoIAlign as well as the pixels around an anchor, is a sum of weighted pixels, and
pixels of all levels are rows of one matrix: one call reads them all, and their gradient is one matrix.
"""
import dataclasses
import math

import torch
from torch.nn import functional as F

from assignment import area

SAMPLES = 2  # a side of a RoIAlign bin, as MaskRCNN sets them


@dataclasses.dataclass
class Levels:
    """The pyramid's maps as rows: level after level, of each all images, of each all pixels."""
    sizes: list           # (height, width) of each
    sides: tuple          # height and width of the images, filled up
    images: int
    device: torch.device

    def __post_init__(self):
        areas = [h * w for h, w in self.sizes]
        starts = [sum(areas[:k]) for k in range(len(areas))]
        table = lambda values: torch.tensor(values, device=self.device)
        self.height, self.width = table([h for h, _ in self.sizes]), table([w for _, w in self.sizes])
        self.area, self.start = table(areas), table([s * self.images for s in starts])
        self.exponents = [round(math.log2(h / self.sides[0])) for h, _ in self.sizes]
        self.scale = table([2.0 ** e for e in self.exponents])
        self.patch = table([(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1)])
        self.samples = (torch.arange(SAMPLES, device=self.device) + 0.5) / SAMPLES
        level = torch.cat([torch.full((a,), k) for k, a in enumerate(areas)]).to(self.device)
        self.position_level = level
        self.position = torch.cat([torch.arange(a) for a in areas]).to(self.device)

    def rows(self, maps):
        return torch.cat([m.float().permute(0, 2, 3, 1).reshape(-1, m.shape[1]) for m in maps])

    def first_row(self, level, image):
        return self.start[level] + image * self.area[level]

    def of_boxes(self, boxes, pool):
        """Level [R] that each box is read from; as torchvision's MultiScaleRoIAlign `pool`."""
        finest, coarsest = (-self.exponents[k] for k in (0, len(pool.featmap_names) - 1))
        level = pool.canonical_level + torch.log2(area(boxes).clamp(min=0).sqrt() / pool.canonical_scale)
        return (torch.floor(level + 1e-6).clamp(min=finest, max=coarsest) - finest).long()

    def around(self, position, image):
        """Rows [S, 9] and weights of the 3 x 3 pixels around positions [S] of images [S]; weight 0 outside the map."""
        level, place = self.position_level[position], self.position[position]
        width, height = self.width[level], self.height[level]
        y = torch.div(place, width, rounding_mode="floor")[:, None] + self.patch[:, 0]
        x = (place % width)[:, None] + self.patch[:, 1]
        inside = (y >= 0) & (y < height[:, None]) & (x >= 0) & (x < width[:, None])
        rows = self.first_row(level, image)[:, None] + y * width[:, None] + x
        return torch.where(inside, rows, torch.zeros_like(rows)), inside.float()

    def aligned(self, boxes, image, level, bins):
        """Rows [R, bins * bins, 16] and weights of RoIAlign of boxes [R, 4]: the mean of 2 x 2 samples a bin, each of
        four pixels. As torchvision's with aligned=False and sampling_ratio=2."""
        boxes = boxes * self.scale[level][:, None]
        steps = torch.arange(bins, device=self.device)[:, None] + self.samples
        corners = []
        for axis, size in ((0, self.width[level]), (1, self.height[level])):
            begin = boxes[:, axis]
            bin_size = (boxes[:, axis + 2] - begin).clamp(min=1.0) / bins
            at = begin[:, None, None] + bin_size[:, None, None] * steps
            last = (size - 1)[:, None, None]
            inside = (at >= -1.0) & (at <= last + 1)
            at = torch.minimum(at.clamp(min=0.0), last.float())
            low = at.floor()
            share = at - low
            low = low.long()
            pixels = torch.stack([low, torch.minimum(low + 1, last)], 3)
            weights = torch.stack([1 - share, share], 3) * (inside / SAMPLES)[..., None]
            corners.append((pixels.flatten(2), weights.flatten(2)))  # [R, bins, samples x 2]
        (x, wx), (y, wy) = corners
        first = self.first_row(level, image)[:, None, None, None, None]
        rows = first + y[:, :, None, :, None] * self.width[level][:, None, None, None, None] + x[:, None, :, None, :]
        weights = wy[:, :, None, :, None] * wx[:, None, :, None, :]
        return rows.reshape(-1, bins * bins, 4 * SAMPLES * SAMPLES), weights.reshape(-1, bins * bins, 4 * SAMPLES * SAMPLES)


def read(rows, reads):
    """Sums of weighted rows for every (index, weight) [..., points]: one tensor [..., C] each."""
    index = torch.cat([i.reshape(-1) for i, _ in reads])
    weight = torch.cat([w.reshape(-1) for _, w in reads])
    offsets, begin = [], 0
    for i, _ in reads:
        offsets.append(torch.arange(begin, begin + i.numel(), i.shape[-1], device=rows.device))
        begin += i.numel()
    sums = F.embedding_bag(index, rows, torch.cat(offsets), mode="sum", per_sample_weights=weight)
    parts = sums.split([o.numel() for o in offsets])
    return [p.view(*i.shape[:-1], -1) for p, (i, _) in zip(parts, reads)]
