"""Mask R-CNN's training losses of a whole batch at once: those of torchvision's RegionProposalNetwork and RoIHeads.

torchvision goes image by image, level by level and object by object, with tensors of another size each time, on which a
GPU waits for Python and a processor for memory. Here every tensor has the batch in it and a size that the configuration
sets; slots that are not used have weight 0. Three things make it quick besides:

  gradient of the proposal network   only the sampled anchors have one, 128 of 30 000 an image. The dense maps that
      proposals are chosen from are computed without a gradient; sampled anchors once more, from their 3 x 3 pixels
  reading the pyramid at points      RoIAlign of boxes and of masks and those 3 x 3 pixels are one sum over weighted rows
      of all levels' pixels (embedding_bag): one call, and one gradient map instead of eleven
  masks                              only those that a sampled proposal belongs to become floats

The weights are the model's own, so checkpoints, export and evaluation with torchvision's forward stay as they are.
self_check.py compares losses and gradients with torchvision's for the same draws.
"""
import dataclasses
import functools
import math

import torch
from torch.nn import functional as F
from torchvision.models.detection.image_list import ImageList
from torchvision.ops import nms, roi_align

SAMPLES = 2  # a side of a RoIAlign bin, as MaskRCNN sets them
PATCH = [(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1)]


def area(boxes):
    return (boxes[..., 2] - boxes[..., 0]) * (boxes[..., 3] - boxes[..., 1])


def overlaps(objects, there, boxes):
    """IoU [N, O, K] of objects [N, O, 4] and boxes [N or 1, K, 4]; -1 for objects that are not there."""
    a, b = objects[:, :, None], boxes[:, None]
    inner = (torch.minimum(a[..., 2], b[..., 2]).sub_(torch.maximum(a[..., 0], b[..., 0]))).clamp_(min=0)
    inner *= (torch.minimum(a[..., 3], b[..., 3]).sub_(torch.maximum(a[..., 1], b[..., 1]))).clamp_(min=0)
    union = (area(a) + area(b)).sub_(inner)
    return inner.div_(union).masked_fill_(~there[:, :, None], -1.0)


def assign_anchors(objects, there, anchors, low, high):
    """Label [N, A] of every anchor (1 object, 0 background, -1 neither) and the object it belongs to. As torchvision's
    Matcher with allow_low_quality_matches: an object's best anchors belong to the object that they overlap most."""
    quality = overlaps(objects, there, anchors[None])
    best, which = quality.max(1)
    highest = quality.amax(2, keepdim=True)
    rescued = ((quality == highest) & there[:, :, None]).any(1)
    labels = (best >= high).float() - ((best >= low) & (best < high)).float()
    return torch.where(rescued, torch.ones_like(labels), labels), which


def assign_proposals(objects, there, classes, boxes, valid, least):
    """Class [N, K] of every proposal (0 background, -1 where none is) and the object it belongs to."""
    best, which = overlaps(objects, there, boxes).max(1)
    labels = torch.where(best >= least, classes.gather(1, which), torch.zeros_like(which))
    return labels.masked_fill(~valid, -1), which


def draw(labels, count, most_positive, keys):
    """Draws `count` of K an image: at most `most_positive` with a label above 0, the others of label 0, those with the
    largest of the random `keys` [N, K] of 0..1. Returns their indices [N, count], objects first, and which slots are used."""
    outside = torch.full_like(keys, -1.0)
    k = keys.shape[1]
    objects = torch.where(labels > 0, keys, outside).topk(min(most_positive, k), 1)
    others = torch.where(labels == 0, keys, outside).topk(min(count, k), 1)
    value = torch.cat([torch.where(objects.values >= 0, objects.values + 2, objects.values), others.values], 1)
    index = torch.cat([objects.indices, others.indices], 1)
    value, place = value.topk(min(count, value.shape[1]), 1)
    return index.gather(1, place), value >= 0


def encode(coder, reference, boxes, valid):
    """Regression targets; 0 where they are not valid."""
    targets = coder.encode_single(reference.reshape(-1, 4), boxes.reshape(-1, 4)).reshape(boxes.shape)
    return torch.where(valid[..., None], targets, torch.zeros_like(targets))


def take(values, index):
    """values [N, K, C] at index [N, S]."""
    return values.gather(1, index[:, :, None].expand(-1, -1, values.shape[2]))


@dataclasses.dataclass
class Levels:
    """The pyramid's maps as rows: level after level, of each all images, of each all pixels."""
    sizes: list           # (height, width) of each
    images: int
    device: torch.device

    def __post_init__(self):
        areas = [h * w for h, w in self.sizes]
        starts = [sum(areas[:k]) for k in range(len(areas))]
        table = lambda values: torch.tensor(values, device=self.device)
        self.height, self.width = table([h for h, _ in self.sizes]), table([w for _, w in self.sizes])
        self.area, self.start = table(areas), table([s * self.images for s in starts])
        level = torch.cat([torch.full((a,), k) for k, a in enumerate(areas)]).to(self.device)
        self.position_level = level
        self.position = torch.cat([torch.arange(a) for a in areas]).to(self.device)

    def rows(self, maps):
        return torch.cat([m.float().permute(0, 2, 3, 1).reshape(-1, m.shape[1]) for m in maps])

    def first_row(self, level, image):
        return self.start[level] + image * self.area[level]

    def around(self, position, image):
        """Rows [S, 9] and weights of the 3 x 3 pixels around positions [S] of images [S]; weight 0 outside the map."""
        level, place = self.position_level[position], self.position[position]
        width, height = self.width[level], self.height[level]
        steps = torch.tensor(PATCH, device=self.device)
        y = torch.div(place, width, rounding_mode="floor")[:, None] + steps[:, 0]
        x = (place % width)[:, None] + steps[:, 1]
        inside = (y >= 0) & (y < height[:, None]) & (x >= 0) & (x < width[:, None])
        rows = self.first_row(level, image)[:, None] + y * width[:, None] + x
        return torch.where(inside, rows, torch.zeros_like(rows)), inside.float()

    def aligned(self, boxes, image, level, scale, bins):
        """Rows [R, bins * bins, 16] and weights of RoIAlign of boxes [R, 4]: the mean of 2 x 2 samples a bin, each of
        four pixels. As torchvision's with aligned=False and sampling_ratio=2."""
        boxes = boxes * scale[:, None]
        steps = torch.arange(bins, device=self.device)[:, None] + (torch.arange(SAMPLES, device=self.device) + 0.5) / SAMPLES
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


class DetectionLosses:
    """Losses of `model`, a MaskRCNN of model.py in training mode, for a Batch."""

    def __init__(self, model):
        self.model, self.rpn, self.heads = model, model.rpn, model.roi_heads
        self.levels = functools.lru_cache(16)(self.new_levels)

    def new_levels(self, shapes, sides, device):
        """Levels and anchors [A, 4] of a batch whose maps have these shapes and whose images these sides."""
        maps = [torch.empty(shape, device=device) for shape in shapes]
        images = ImageList(torch.empty(1, 3, *sides, device=device), [sides])
        anchors = self.rpn.anchor_generator(images, [m[:1] for m in maps])[0]
        return Levels([tuple(m.shape[2:]) for m in maps], shapes[0][0], device), anchors

    def normalized(self, images, batch):
        mean, std = (torch.tensor(v, device=images.device)[:, None, None]
                     for v in (self.model.transform.image_mean, self.model.transform.image_std))
        return batch.inside((images - mean) / std).contiguous(memory_format=torch.channels_last)

    def dense(self, maps):
        """Objectness [N, A] and box changes [N, A, 4] of every anchor, without a gradient."""
        with torch.no_grad():
            objectness, changes = self.rpn.head(maps)
        flat = lambda parts, k: torch.cat([p.float().permute(0, 2, 3, 1).reshape(len(p), -1, k) for p in parts], 1)
        return flat(objectness, 1)[..., 0], flat(changes, 4)

    @torch.no_grad()
    def proposals(self, objectness, changes, anchors, levels, sizes):
        """Boxes [N, P, 4] that the proposal network finds, and which slots are used; as filter_proposals."""
        per_position, chosen, begin = len(anchors) // len(levels.position), [], 0
        for height, width in levels.sizes:
            count = height * width * per_position
            top = objectness[:, begin:begin + count].topk(min(count, self.rpn.pre_nms_top_n()), 1).indices
            chosen.append(top + begin)
            begin += count
        chosen = torch.cat(chosen, 1)
        n, k = chosen.shape
        level = levels.position_level[torch.div(chosen, per_position, rounding_mode="floor")]
        boxes = self.rpn.box_coder.decode_single(take(changes, chosen).reshape(-1, 4), anchors[chosen.reshape(-1)])
        limits = sizes[:, [1, 0, 1, 0]][:, None]
        boxes = torch.minimum(boxes.reshape(n, k, 4).clamp(min=0), limits)
        scores = objectness.gather(1, chosen).sigmoid()
        large = ((boxes[..., 2:] - boxes[..., :2]) >= self.rpn.min_size).all(2)
        scores = scores.masked_fill(~large, -1.0)
        apart = boxes.max() + 1  # boxes of other levels and images never meet
        if boxes.is_cuda:
            group = level + len(levels.sizes) * torch.arange(n, device=boxes.device)[:, None]
            kept = nms((boxes + (group * apart)[..., None]).reshape(-1, 4), scores.reshape(-1), self.rpn.nms_thresh)
        else:  # comparing all pairs of all images takes a processor longer
            moved = boxes + (level * apart)[..., None]
            kept = torch.cat([nms(moved[i], scores[i], self.rpn.nms_thresh) + i * k for i in range(n)])
        survives = torch.zeros(n * k, dtype=torch.bool, device=boxes.device)
        survives[kept] = True
        scores = scores.masked_fill(~survives.view(n, k), -1.0)
        best = scores.topk(min(k, self.rpn.post_nms_top_n()), 1)
        return take(boxes, best.indices), best.values > 0

    def roi_levels(self, boxes, height, width, levels):
        """Level [R] and its scale for every box; as MultiScaleRoIAlign."""
        pool = self.heads.box_roi_pool
        names = len(pool.featmap_names)
        scales = torch.tensor([2.0 ** round(math.log2(h / height)) for h, _ in levels.sizes[:names]], device=boxes.device)
        finest, coarsest = (-int(torch.log2(scales[k]).item()) for k in (0, -1))
        level = torch.floor(pool.canonical_level + torch.log2(area(boxes).clamp(min=0).sqrt() / pool.canonical_scale) + 1e-6)
        level = (level.clamp(min=finest, max=coarsest) - finest).long()
        return level, scales[level]

    def __call__(self, batch, random=torch.rand):
        """Losses by torchvision's names; `random` makes the keys of the draws."""
        images = self.normalized(batch.images(), batch)
        maps = list(self.model.backbone(images).values())
        return self.of_maps(maps, images.shape[2:], batch, random)

    def of_maps(self, maps, sides, batch, random):
        rpn, heads = self.rpn, self.heads
        levels, anchors = self.levels(tuple(tuple(m.shape) for m in maps), tuple(sides), maps[0].device)
        n, there = len(batch.boxes), batch.labels > 0
        picture = torch.arange(n, device=anchors.device)[:, None]
        objectness, changes = self.dense([m.detach() for m in maps])

        sampler, matcher = rpn.fg_bg_sampler, rpn.proposal_matcher
        with torch.no_grad():
            labels, which = assign_anchors(batch.boxes, there, anchors, matcher.low_threshold, matcher.high_threshold)
            seen, seen_used = draw(labels, sampler.batch_size_per_image,
                                   int(sampler.batch_size_per_image * sampler.positive_fraction),
                                   random(labels.shape, device=labels.device))
            seen_object = (labels.gather(1, seen) > 0) & seen_used
            seen_target = encode(rpn.box_coder, take(batch.boxes, which.gather(1, seen)), anchors[seen], seen_object)

            boxes, valid = self.proposals(objectness, changes, anchors, levels, batch.sizes)
            boxes, valid = torch.cat([boxes, batch.boxes], 1), torch.cat([valid, there], 1)
            labels, which = assign_proposals(batch.boxes, there, batch.labels, boxes, valid, heads.proposal_matcher.high_threshold)
            sampler = heads.fg_bg_sampler
            most = int(sampler.batch_size_per_image * sampler.positive_fraction)
            chosen, used = draw(labels, sampler.batch_size_per_image, most, random(labels.shape, device=labels.device))
            boxes, which = take(boxes, chosen), which.gather(1, chosen)
            labels = torch.where(used, labels.gather(1, chosen), torch.zeros_like(chosen))
            target = encode(heads.box_coder, take(batch.boxes, which), boxes, labels > 0)
            mask_boxes, mask_labels = boxes[:, :most].reshape(-1, 4), labels[:, :most].reshape(-1)
            mask_which = batch.mask_of.gather(1, which[:, :most]).reshape(-1)

            level, scale = self.roi_levels(boxes.reshape(-1, 4), *sides, levels)
            image = picture.expand_as(labels)
            first = lambda values: values.view(n, -1)[:, :most].reshape(-1)
            box_bins, mask_bins = heads.box_roi_pool.output_size[0], heads.mask_roi_pool.output_size[0]
            per_position = len(anchors) // len(levels.position)
            place = torch.div(seen, per_position, rounding_mode="floor").reshape(-1)
            around, weight = levels.around(place, picture.expand_as(seen).reshape(-1))
            reads = [levels.aligned(boxes.reshape(-1, 4), image.reshape(-1), level, scale, box_bins),
                     levels.aligned(mask_boxes, first(image), first(level), first(scale), mask_bins),
                     (around[..., None], weight[..., None])]
        box_maps, mask_maps, patches = read(levels.rows(maps), reads)
        return {**self.box_losses(box_maps.unflatten(1, (box_bins, box_bins)), labels, used, target),
                **self.mask_loss(mask_maps.unflatten(1, (mask_bins, mask_bins)), mask_labels, mask_boxes, mask_which, batch.masks),
                **self.proposal_losses(patches, (seen % per_position).reshape(-1), seen_object, seen_used, seen_target)}

    def proposal_losses(self, patches, shape, is_object, used, target):
        """Of sampled anchors, from the 3 x 3 pixels [S, 9, C] of each; `shape` [S]: which of a position's anchors it is."""
        head = self.rpn.head
        conv = head.conv[0][0] if isinstance(head.conv[0], torch.nn.Sequential) else head.conv[0]
        hidden = F.relu(F.linear(patches.flatten(1), conv.weight.permute(0, 2, 3, 1).flatten(1), conv.bias))
        rows = torch.arange(len(shape), device=shape.device)
        scores = F.linear(hidden, head.cls_logits.weight.flatten(1), head.cls_logits.bias)[rows, shape]
        changes = F.linear(hidden, head.bbox_pred.weight.flatten(1), head.bbox_pred.bias).unflatten(1, (-1, 4))[rows, shape]
        is_object, used, target = is_object.reshape(-1).float(), used.reshape(-1).float(), target.reshape(-1, 4)
        count = used.sum().clamp(min=1)
        losses = F.binary_cross_entropy_with_logits(scores, is_object, reduction="none")
        moved = F.smooth_l1_loss(changes, target, beta=1 / 9, reduction="none").sum(1)
        return dict(loss_objectness=(losses * used).sum() / count, loss_rpn_box_reg=(moved * is_object).sum() / count)

    def box_losses(self, maps, labels, used, target):
        logits, changes = self.heads.box_predictor(self.heads.box_head(maps.permute(0, 3, 1, 2)))
        labels, used, target = labels.reshape(-1), used.reshape(-1).float(), target.reshape(-1, 4)
        count = used.sum().clamp(min=1)
        changes = changes.float().unflatten(1, (-1, 4))[torch.arange(len(labels), device=labels.device), labels]
        moved = F.smooth_l1_loss(changes, target, beta=1 / 9, reduction="none").sum(1)
        named = F.cross_entropy(logits.float(), labels, reduction="none")
        return dict(loss_classifier=(named * used).sum() / count, loss_box_reg=(moved * (labels > 0)).sum() / count)

    def mask_loss(self, maps, labels, boxes, which, masks):
        logits = self.heads.mask_predictor(self.heads.mask_head(maps.permute(0, 3, 1, 2))).float()
        rows = torch.arange(len(labels), device=labels.device)
        side = logits.shape[-1]
        with torch.no_grad():
            target = roi_align(masks[which][:, None].float(), torch.cat([rows[:, None].float(), boxes], 1), (side, side), 1.0)[:, 0]
        losses = F.binary_cross_entropy_with_logits(logits[rows, labels], target, reduction="none").mean((1, 2))
        is_object = (labels > 0).float()
        return dict(loss_mask=(losses * is_object).sum() / is_object.sum().clamp(min=1))
