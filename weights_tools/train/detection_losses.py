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
import torch
from torch.nn import functional as F
from torchvision.models.detection.image_list import ImageList
from torchvision.ops import nms, roi_align

from assignment import assign_anchors, assign_proposals, draw, encode, take
from pyramid_points import Levels, read


def sample(sampler, labels, random):
    """Indices that torchvision's `sampler` would draw, which of them are used, and how many of them can be objects."""
    most = int(sampler.batch_size_per_image * sampler.positive_fraction)
    return *draw(labels, sampler.batch_size_per_image, most, random(labels.shape, device=labels.device)), most


class DetectionLosses:
    """Losses of `model`, a MaskRCNN of model.py in training mode, for a Batch."""

    def __init__(self, model):
        self.model, self.rpn, self.heads = model, model.rpn, model.roi_heads
        self.per_position = self.rpn.anchor_generator.num_anchors_per_location()[0]
        self.known = {}  # levels and anchors of the last shapes of batches

    def levels(self, sizes, sides, images, device):
        """Levels and anchors [A, 4] of a batch of so many images of these sides, whose maps have these sizes."""
        key = sizes, sides, images, device
        if key not in self.known:
            if len(self.known) == 16:  # where images have many sizes, anchors of all would fill the memory
                self.known.pop(next(iter(self.known)))
            empty = [torch.empty(1, 1, *size, device=device) for size in (sides, *sizes)]
            anchors = self.rpn.anchor_generator(ImageList(empty[0], [sides]), empty[1:])[0]
            self.known[key] = Levels(list(sizes), sides, images, device), anchors
        return self.known[key]

    def normalized(self, batch):
        """f32 [N, 3, H, W] as GeneralizedRCNNTransform makes it; zero where an image is filled up."""
        images, transform = batch.images(), self.model.transform
        for values, mean, std in zip(images.unbind(1), transform.image_mean, transform.image_std):
            values.sub_(mean).div_(std)
        return batch.inside_only(images)

    def dense(self, maps):
        """Objectness [N, A] and box changes [N, A, 4] of every anchor, without a gradient."""
        with torch.no_grad():
            objectness, changes = self.rpn.head(maps)
        flat = lambda parts, k: torch.cat([p.float().permute(0, 2, 3, 1).reshape(len(p), -1, k) for p in parts], 1)
        return flat(objectness, 1)[..., 0], flat(changes, 4)

    @torch.no_grad()
    def proposals(self, objectness, changes, anchors, levels, sides):
        """Boxes [N, P, 4] that the proposal network finds, and which slots are used; as filter_proposals."""
        chosen, begin = [], 0
        for height, width in levels.sizes:
            count = height * width * self.per_position
            top = objectness[:, begin:begin + count].topk(min(count, self.rpn.pre_nms_top_n()), 1).indices
            chosen.append(top + begin)
            begin += count
        chosen = torch.cat(chosen, 1)
        n, k = chosen.shape
        level = levels.position_level[torch.div(chosen, self.per_position, rounding_mode="floor")]
        boxes = self.rpn.box_coder.decode_single(take(changes, chosen).reshape(-1, 4), anchors[chosen.reshape(-1)])
        limits = torch.tensor([[[w, h, w, h]] for h, w in sides], dtype=boxes.dtype, device=boxes.device)
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

    def __call__(self, batch, random=torch.rand):
        """Losses by torchvision's names; `random` makes the keys of the draws."""
        images = self.normalized(batch)
        maps = list(self.model.backbone(images).values())
        return self.of_maps(maps, images.shape[2:], batch, random)

    def of_maps(self, maps, sides, batch, random):
        rpn, heads = self.rpn, self.heads
        n, there = len(batch.boxes), batch.labels > 0
        levels, anchors = self.levels(tuple(tuple(m.shape[2:]) for m in maps), tuple(sides), n, maps[0].device)
        picture = torch.arange(n, device=anchors.device)[:, None]
        objectness, changes = self.dense(maps)

        matcher = rpn.proposal_matcher
        with torch.no_grad():
            labels, which = assign_anchors(batch.boxes, there, anchors, matcher.low_threshold, matcher.high_threshold)
            seen, seen_used, _ = sample(rpn.fg_bg_sampler, labels, random)
            seen_object = (labels.gather(1, seen) > 0) & seen_used
            seen_target = encode(rpn.box_coder, take(batch.boxes, which.gather(1, seen)), anchors[seen], seen_object)

            boxes, valid = self.proposals(objectness, changes, anchors, levels, batch.sides)
            boxes, valid = torch.cat([boxes, batch.boxes], 1), torch.cat([valid, there], 1)
            labels, which = assign_proposals(batch.boxes, there, batch.labels, boxes, valid, heads.proposal_matcher.high_threshold)
            chosen, used, most = sample(heads.fg_bg_sampler, labels, random)
            boxes, which = take(boxes, chosen), which.gather(1, chosen)
            labels = torch.where(used, labels.gather(1, chosen), torch.zeros_like(chosen))
            target = encode(heads.box_coder, take(batch.boxes, which), boxes, labels > 0)
            mask_boxes, mask_labels = boxes[:, :most].reshape(-1, 4), labels[:, :most].reshape(-1)
            mask_which = batch.mask_of.gather(1, which[:, :most]).reshape(-1)

            level = levels.of_boxes(boxes.reshape(-1, 4), heads.box_roi_pool)
            image = picture.expand_as(labels)
            first = lambda values: values.view(n, -1)[:, :most].reshape(-1)
            box_bins, mask_bins = heads.box_roi_pool.output_size[0], heads.mask_roi_pool.output_size[0]
            place = torch.div(seen, self.per_position, rounding_mode="floor").reshape(-1)
            around, weight = levels.around(place, picture.expand_as(seen).reshape(-1))
            reads = [levels.aligned(boxes.reshape(-1, 4), image.reshape(-1), level, box_bins),
                     levels.aligned(mask_boxes, first(image), first(level), mask_bins),
                     (around[..., None], weight[..., None])]
        box_maps, mask_maps, patches = read(levels.rows(maps), reads)
        return {**self.box_losses(box_maps.unflatten(1, (box_bins, box_bins)), labels, used, target),
                **self.mask_loss(mask_maps.unflatten(1, (mask_bins, mask_bins)), mask_labels, mask_boxes, mask_which, batch.masks),
                **self.proposal_losses(patches, (seen % self.per_position).reshape(-1), seen_object, seen_used, seen_target)}

    def proposal_losses(self, patches, shape, is_object, used, target):
        """Of sampled anchors, from the 3 x 3 pixels [S, 9, C] of each; `shape` [S]: which of a position's anchors it is."""
        head = self.rpn.head
        conv = head.conv[0][0]
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
        """Of the mask of each box's own class alone. The predictor's transposed convolution, whose 2 x 2 windows do not
        overlap, gives every pixel [row, column] four outputs beside each other; the target is put into that order."""
        predictor, logits = self.heads.mask_predictor, self.heads.mask_predictor.mask_fcn_logits
        deconvolution, side = predictor.conv5_mask, maps.shape[1]
        with torch.no_grad():
            kept, rows = which.unique(return_inverse=True)
            target = roi_align(masks[kept][:, None].float(), torch.cat([rows[:, None].float(), boxes], 1), (2 * side, 2 * side), 1.0)
            target = target.view(-1, side, 2, side, 2).permute(0, 1, 3, 2, 4).reshape(len(labels), -1)
        hidden = self.heads.mask_head(maps.permute(0, 3, 1, 2)).permute(0, 2, 3, 1)
        weight = deconvolution.weight.permute(2, 3, 1, 0)
        hidden = F.relu(F.linear(hidden, weight.flatten(0, 2), deconvolution.bias.repeat(4))).reshape(len(labels), -1, weight.shape[2])
        scores = (hidden @ logits.weight[labels].flatten(1)[:, :, None])[..., 0] + logits.bias[labels][:, None]
        losses = F.binary_cross_entropy_with_logits(scores.float(), target, reduction="none").mean(1)
        is_object = (labels > 0).float()
        return dict(loss_mask=(losses * is_object).sum() / is_object.sum().clamp(min=1))
