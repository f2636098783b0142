"""Which anchors and proposals belong to which objects, and which of them are drawn, for all images of a batch at once.

Objects [N, O, 4] are filled up to the same number in every image; `there` [N, O] says which are real. As torchvision's
box_iou, Matcher, BalancedPositiveNegativeSampler and BoxCoder, which take one image after the other; self_check.py
compares them.
"""
import torch


def area(boxes):
    return (boxes[..., 2] - boxes[..., 0]) * (boxes[..., 3] - boxes[..., 1])


def overlaps(objects, there, boxes):
    """IoU [N, O, K] of objects [N, O, 4] and boxes [N or 1, K, 4]; -1 for objects that are not there."""
    left, top, right, bottom = objects[:, :, None].unbind(3)
    x1, y1, x2, y2 = boxes[:, None].permute(3, 0, 1, 2).contiguous()
    inner = torch.minimum(right, x2).sub_(torch.maximum(left, x1)).clamp_(min=0)
    inner *= torch.minimum(bottom, y2).sub_(torch.maximum(top, y1)).clamp_(min=0)
    union = (((right - left) * (bottom - top)) + ((x2 - x1) * (y2 - y1))).sub_(inner)
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
