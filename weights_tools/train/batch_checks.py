"""Checks for self_check.py of what trains on whole batches: targets, draws, losses and gradients against torchvision's,
which go image by image, and packed data against decoded ones."""
import copy
import json
import math
import pathlib
import tempfile

import cv2
import numpy as np
import torch
from torch import nn

from assignment import assign_anchors, assign_proposals, draw, take
from batches import Batch, Batches
from coco_data import LUMA, CocoData
from config import CONFIGS
from detection_losses import DetectionLosses
from model import build
from packed_data import PackedData

TINY = CONFIGS["tiny"]


def random_batch(counts=(5, 1, 9), height=96, width=160):
    """A batch with images of several sizes, and the same as torchvision takes it."""
    torch.manual_seed(7)
    n, most = len(counts), max(counts)
    sides = [(height - 13 * i, width - 7 * i) for i in range(n)]
    boxes, labels, mask_of = torch.zeros(n, most, 4), torch.zeros(n, most, dtype=torch.long), torch.zeros(n, most, dtype=torch.long)
    masks, pixels = torch.zeros(sum(counts), height, width, dtype=torch.uint8), torch.zeros(n, height, width, 3, dtype=torch.uint8)
    targets, images, first = [], [], 0
    for i, ((h, w), count) in enumerate(zip(sides, counts)):
        pixels[i, :h, :w] = torch.randint(256, (h, w, 3))
        corner, size = torch.rand(count, 2) * torch.tensor([w - 45, h - 35]), torch.rand(count, 2) * torch.tensor([40, 30]) + 4
        boxes[i, :count], labels[i, :count] = torch.cat([corner, corner + size], 1), torch.randint(1, 6, (count,))
        mask_of[i, :count] = torch.arange(first, first + count)
        masks[first:first + count, :h, :w] = torch.rand(count, h, w) < 0.6
        targets.append(dict(boxes=boxes[i, :count], labels=labels[i, :count], masks=masks[first:first + count, :h, :w]))
        images.append(pixels[i, :h, :w].permute(2, 0, 1).float() / 255)
        first += count
    light = [(1.0, 0.0, False)] * n
    return Batch(sides, light, pixels, torch.zeros(n, height, width), boxes, labels, mask_of, masks), images, targets


def anchors_belong_to_the_objects_that_torchvision_finds():
    batch, _, targets = random_batch()
    rpn, corner = build(TINY, False).rpn, torch.rand(4000, 2) * 150
    anchors = torch.cat([corner, corner + torch.rand(4000, 2) * 40 + 1], 1)
    anchors[:5] = batch.boxes[0, :5] + 0.1
    labels, which = assign_anchors(batch.boxes, batch.labels > 0, anchors, 0.3, 0.7)
    expected, boxes = rpn.assign_targets_to_anchors([anchors] * 3, targets)
    belongs = labels > 0
    found = batch.boxes.gather(1, which[:, :, None].expand(-1, -1, 4))
    return torch.equal(labels, torch.stack(expected)) and torch.equal(found[belongs], torch.stack(boxes)[belongs]) and belongs.any()


def proposals_belong_to_the_objects_that_torchvision_finds():
    batch, _, targets = random_batch()
    boxes = batch.boxes.repeat(1, 30, 1) + torch.randn(3, 270, 4)
    boxes[..., 2:] = torch.maximum(boxes[..., 2:], boxes[..., :2] + 1)
    labels, which = assign_proposals(batch.boxes, batch.labels > 0, batch.labels, boxes, torch.ones(3, 270, dtype=torch.bool), 0.5)
    index, expected = build(TINY, False).roi_heads.assign_targets_to_proposals(
        list(boxes), [t["boxes"] for t in targets], [t["labels"] for t in targets])
    expected, index = torch.stack(expected), torch.stack(index)
    return torch.equal(labels, expected) and torch.equal(which[labels > 0], index[labels > 0]) and (labels == 0).any()


def draws_have_the_shares_that_are_asked_for():
    labels, random = torch.zeros(4, 500), torch.rand(4, 500)
    for i, (objects, neither) in enumerate(((0, 0), (3, 100), (200, 0), (20, 470))):
        labels[i, :objects], labels[i, objects:objects + neither] = 1, -1
    index, used = draw(labels, 64, 16, random)
    found = labels.gather(1, index)
    if not (found[used] >= 0).all() or any(len(set(i[u].tolist())) != u.sum() for i, u in zip(index, used)):
        return False
    return [(int(((f > 0) & u).sum()), int(u.sum())) for f, u in zip(found, used)] == [(0, 64), (3, 64), (16, 64), (16, 26)]


class GivenDraws:
    """torchvision's sampler, with given keys instead of random ones: of every image [K], for the places that it has."""

    def __init__(self, sampler, keys):
        self.count, self.share, self.keys = sampler.batch_size_per_image, sampler.positive_fraction, keys

    def __call__(self, labels):
        found = []
        for label, keys in zip(labels, self.keys(labels)):
            index, used = draw(label[None], self.count, int(self.count * self.share), keys[None])
            for wanted in (label[index[0]] > 0, label[index[0]] <= 0):
                found.append(torch.zeros_like(label, dtype=torch.uint8))
                found[-1][index[0][used[0] & wanted]] = 1
        return found[::2], found[1::2]


def order_of(boxes, valid):
    """An order of boxes [..., K, 4] that does not depend on their scores, which rounding may swap; those used first."""
    key = boxes.detach() @ torch.tensor([1.0, 3.14159, 2.71828, 1.41421])
    return key.masked_fill(~valid, math.inf).argsort(-1)


class OrderedLosses(DetectionLosses):
    def proposals(self, *inputs):
        boxes, valid = super().proposals(*inputs)
        order = order_of(boxes, valid)
        return take(boxes, order), valid.gather(1, order)


def a_batch_has_the_losses_that_torchvision_finds():
    batch, images, targets = random_batch()
    torch.manual_seed(8)
    model = build(TINY, True).train()
    for parameter in model.backbone.fpn.attention.parameters():
        nn.init.normal_(parameter, std=0.3)
    model.transform.min_size, model.transform.max_size = (1,), 160  # the largest image as it is, the others as well
    model.transform.resize = lambda image, target: (image, target)
    given, drawn = copy.deepcopy(model), []
    given.transform.resize = model.transform.resize

    def random(shape, device):
        drawn.append(torch.rand(shape, device=device))
        return drawn[-1]

    def ordered(*inputs, filtered=given.rpn.filter_proposals):
        boxes, scores = filtered(*inputs)
        return [b[order_of(b, torch.ones(len(b), dtype=torch.bool))] for b in boxes], scores

    same_images = []

    def batch_images(images, made=given.transform.batch_images, size_divisible=32):
        normalized = OrderedLosses(model).normalized(batch)
        same_images.append(torch.allclose(normalized, made(images, size_divisible), atol=1e-5))
        return normalized  # the same bits: rounding would send gradients through other pixels of max pooling

    given.rpn.filter_proposals, given.transform.batch_images = ordered, batch_images
    losses = OrderedLosses(model)(batch, random)
    anchor_keys, keys = drawn
    slots = keys.shape[1] - batch.boxes.shape[1]  # proposals first, then objects
    of_image = lambda k, label, count: torch.cat([k[:len(label) - count], k[slots:slots + count]])
    given.rpn.fg_bg_sampler = GivenDraws(given.rpn.fg_bg_sampler, lambda labels: anchor_keys)
    given.roi_heads.fg_bg_sampler = GivenDraws(given.roi_heads.fg_bg_sampler, lambda labels: [
        of_image(k, label, len(t["labels"])) for k, label, t in zip(keys, labels, targets)])
    expected = given(images, targets)
    if same_images != [True] or set(losses) != set(expected) or not all(torch.allclose(losses[n], expected[n], rtol=1e-4, atol=1e-6) for n in losses):
        return False
    sum(losses.values()).backward()
    sum(expected.values()).backward()
    for (name, a), b in zip(model.named_parameters(), given.parameters()):
        if (a.grad is None) != (b.grad is None) or a.grad is not None and (a.grad - b.grad).norm() > 1e-3 * b.grad.norm() + 1e-6:
            return False
    return True


def sample(data, index, flip, gain, offset, grey):
    """Image [3, H, W] in 0..1, RGB, and its target as torchvision's detectors take it, straight from a CocoData; mirrored,
    brightened (gain, offset) or grey."""
    image, masks, boxes, labels = data.decode(index)
    if flip:
        image, masks = image[:, ::-1], masks[:, :, ::-1]
        boxes[:, [0, 2]] = image.shape[1] - boxes[:, [2, 0]]
    pixels = image.astype(np.float32) * (gain / 255.0) + offset
    if grey:
        pixels = np.repeat(pixels @ LUMA, 3, 2)
    pixels = np.clip(pixels, 0.0, 1.0)
    target = dict(boxes=torch.from_numpy(boxes), labels=torch.tensor(labels), masks=torch.from_numpy(masks.copy()))
    return torch.from_numpy(np.ascontiguousarray(pixels.transpose(2, 0, 1))), target


def packed_data_are_what_was_decoded():
    with tempfile.TemporaryDirectory() as folder:
        folder, random, content = pathlib.Path(folder), np.random.default_rng(9), dict(images=[], annotations=[])
        for i, (height, width) in enumerate(((37, 61), (64, 50), (40, 96))):
            cv2.imwrite(str(folder / f"{i}.png"), random.integers(256, size=(height, width, 3), dtype=np.uint8))
            content["images"].append(dict(id=i, file_name=f"{i}.png", height=height, width=width))
            for k in range(3):
                x, y = random.uniform(0, 20, 2)
                corners = [x, y, x + 25, y + 1, x + 20, y + 14]
                full = dict(size=[height, width], counts=[height * k + 5, height * width - height * k - 5])
                content["annotations"].append(dict(
                    id=3 * i + k, image_id=i, category_id=k + 1, area=100, bbox=[x, y, 25.0, 14.0],
                    segmentation=full if k == 2 else [corners]))
        content["categories"] = [dict(id=k + 1, name=f"thing {k}") for k in range(3)]
        annotations = folder / "instances.json"
        annotations.write_text(json.dumps(content))
        data = CocoData(annotations, folder, sides=(40, 90))  # one stays as it is, one grows, one shrinks
        packed = PackedData(data, annotations, folder / "packed")
        written = (folder / "packed").stat().st_mtime_ns
        batches = Batches(packed, 3, seed=4, grey=0.5)
        for k in range(8):
            batch = batches[k]
            images = batch.inside_only(batch.images())
            for i, change in enumerate(batches.changes(k)):
                image, target = sample(data, *change)
                height, width = image.shape[1:]
                rest = images[i].clone()
                rest[:, :height, :width] = 0
                classes = torch.zeros(height, width, dtype=torch.uint8)
                for label, mask in zip(target["labels"], target["masks"]):
                    classes[mask.bool()] = int(label)
                same = (torch.allclose(images[i, :, :height, :width], image, atol=1e-6), not rest.any(),
                        torch.equal(batch.classes[i, :height, :width], classes),
                        torch.equal(batch.boxes[i], target["boxes"]), torch.equal(batch.labels[i], target["labels"]),
                        torch.equal(batch.masks[batch.mask_of[i]][:, :height, :width], target["masks"]))
                if not all(same):
                    return False
        PackedData(data, annotations, folder / "packed")
        if (folder / "packed").stat().st_mtime_ns != written:  # nothing has changed, so it is kept
            return False
        whole = (folder / "packed").read_bytes()
        for other in (b"", b"{}", b"\xff" * 99, b"[]" + (2).to_bytes(8, "little"), whole[:-1], whole[:5000]):
            (folder / "packed").write_bytes(other)  # cut short, or not a packed file at all: it is made again
            PackedData(data, annotations, folder / "packed")
            if (folder / "packed").read_bytes() != whole:
                return False
        content["annotations"].pop()
        content["annotations"].append(dict(content["annotations"][0], image_id=99))  # of an image that is not listed
        annotations.write_text(json.dumps(content))
        data = CocoData(annotations, folder, sides=(40, 90))
        if PackedData(data, annotations, folder / "packed").images[2][3][2:]:
            return False
        (folder / "2.png").write_bytes(b"")
        try:
            PackedData(data, annotations, folder / "packed")
        except SystemExit:  # interrupted, it leaves no part of a file
            return sorted(p.name for p in folder.iterdir()) == ["0.png", "1.png", "2.png", "instances.json", "packed"]
        return False


CHECKS = (anchors_belong_to_the_objects_that_torchvision_finds, proposals_belong_to_the_objects_that_torchvision_finds,
          draws_have_the_shares_that_are_asked_for, a_batch_has_the_losses_that_torchvision_finds,
          packed_data_are_what_was_decoded)
