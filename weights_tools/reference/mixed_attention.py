"""The mixed-attention feature pyramid as a PyTorch module: docs/papers.md A.1, formulas (1) to (7).

Written from the formulas, independently of nn/models/fpn.cpp; fixtures hold its outputs. It takes the place of
torchvision's FeaturePyramidNetwork and keeps its names, so that a torchvision Mask R-CNN carries it:

    model = torchvision.models.detection.maskrcnn_resnet50_fpn(weights=None, weights_backbone=None)
    add_mixed_attention(model)

Training has gates of 2 sigmoid instead of sigmoid (gain = 2): with weights of zero a gate is then 1, and the network is
the one without attention. fold_gains turns such weights into those of the formulas, for the same outputs.
"""
from collections import OrderedDict

import torch
from torch import nn
from torch.nn import functional as F


class LargestAndMean(torch.autograd.Function):
    """Largest value and mean [N, K] of each of the K rows of maps [N, K, C], or with `columns` [N, C] of their columns.
    As amax and mean, but for the gradient, which is written once instead of in eleven passes, and of equal values the
    first one's. The sum is a matrix product, which does not copy 16-bit maps to 32 bits first."""

    @staticmethod
    def forward(context, maps, columns):
        axis = 1 if columns else 2
        largest, index = maps.max(axis, keepdim=True)
        ones = maps.new_ones(len(maps), *((1, maps.shape[1]) if columns else (maps.shape[2], 1)))
        total = torch.bmm(ones, maps) if columns else torch.bmm(maps, ones)
        context.save_for_backward(index)
        context.shape, context.axis = maps.shape, axis
        return largest.squeeze(axis), (total / maps.shape[axis]).squeeze(axis)

    @staticmethod
    def backward(context, of_largest, of_mean):
        index, axis = context.saved_tensors[0], context.axis
        gradient = (of_mean / context.shape[axis]).unsqueeze(axis).expand(context.shape).contiguous()
        return gradient.scatter_add_(axis, index, of_largest.unsqueeze(axis)), None


def pixels(f):
    """Maps [N, C, H, W] as [N, H W, C]."""
    return f.permute(0, 2, 3, 1).flatten(1, 2)


class Gated(nn.Module):
    """gate(F) * F"""

    def forward(self, f, read=None):
        """`read`: what the gate reads, where that is not `f`."""
        return self.gate(f if read is None else read) * f


class SpatialAttention(Gated):
    """M_s(F) = gain sigmoid(Conv7x7([max_c F ; mean_c F])) * F                                         (4), (5)"""

    def __init__(self, gain=1.0):
        super().__init__()
        self.gain = gain
        self.weight = nn.Parameter(torch.zeros(1, 2, 7, 7))

    def gate(self, f):
        """[N, 1, H, W]"""
        pooled = torch.stack(LargestAndMean.apply(pixels(f), False), 1).unflatten(2, f.shape[2:])
        return self.gain * torch.sigmoid(F.conv2d(pooled, self.weight, padding=3))


class ChannelAttention(Gated):
    """M_c(F) = gain sigmoid(MLP(max_hw F) + MLP(mean_hw F)) * F, MLP: C -> C/r -> ReLU -> C             (6), (7)"""

    def __init__(self, channels=256, reduction=16, gain=1.0):
        super().__init__()
        self.gain = gain
        self.reduce = nn.Linear(channels, channels // reduction, bias=False)
        self.expand = nn.Linear(channels // reduction, channels, bias=False)

    def mlp(self, v):
        return self.expand(torch.relu(self.reduce(v)))

    def gate(self, f):
        """[N, C, 1, 1]"""
        largest, mean = LargestAndMean.apply(pixels(f), True)
        return self.gain * torch.sigmoid(self.mlp(largest) + self.mlp(mean))[:, :, None, None]


ORDERS = ("spatial", "channel", "spatial-channel", "channel-spatial")  # one gate alone, the paper's order, the other one
# The paper's order elsewhere: on the sum of lateral and upper map; and gates that read maps of mean 0 and deviation 1.
PLACES = ("after-sum", "normed")


class MixedAttention(nn.Module):
    """W'_n = CA(SA(W)): spatial first, then channel                                                     (1), (2)

    Other kinds, of ORDERS or PLACES, are for comparison; with one gate alone it is the network whose other gate is 1."""

    def __init__(self, channels=256, reduction=16, gain=1.0, kind="spatial-channel"):
        super().__init__()
        self.order = (kind if kind in ORDERS else "spatial-channel").split("-")
        self.norms = nn.ModuleDict({name: nn.BatchNorm2d(channels, affine=False) for name in self.order if kind == "normed"})
        for name in self.order:
            setattr(self, name, SpatialAttention(gain) if name == "spatial" else ChannelAttention(channels, reduction, gain))

    def forward(self, f):
        for name in self.order:
            attention = getattr(self, name)
            f = attention(f, self.norms[name](f)) if self.norms else attention(f)
        return f


class MixedAttentionPyramid(nn.Module):
    """torchvision's FeaturePyramidNetwork with mixed attention behind every lateral convolution, or after-sum: behind
    every sum."""

    def __init__(self, pyramid, reduction=16, gain=1.0, kind="spatial-channel"):
        super().__init__()
        self.kind, self.after_sum = kind, kind == "after-sum"
        self.inner_blocks = pyramid.inner_blocks
        self.layer_blocks = pyramid.layer_blocks
        self.extra_blocks = pyramid.extra_blocks
        self.attention = nn.ModuleList(MixedAttention(block[0].out_channels, reduction, gain, kind)
                                       for block in pyramid.inner_blocks)

    def forward(self, x):
        names, stages = list(x.keys()), list(x.values())
        lateral = [inner(c) for inner, c in zip(self.inner_blocks, stages)]
        if not self.after_sum:
            lateral = [a(w) for a, w in zip(self.attention, lateral)]
        top_down = [lateral[-1]]
        for w in reversed(lateral[:-1]):                                                              # (3)
            top_down.insert(0, w + F.interpolate(top_down[0], size=w.shape[-2:], mode="nearest"))
        if self.after_sum:
            top_down = [a(t) for a, t in zip(self.attention, top_down)]
        outputs = [layer(t) for layer, t in zip(self.layer_blocks, top_down)]
        outputs, names = self.extra_blocks(outputs, stages, names)
        return OrderedDict(zip(names, outputs))


def add_mixed_attention(model, reduction=16, gain=1.0, kind="spatial-channel"):
    """With a gain of 2, also makes the gates start at 1: the network computes what it did without attention."""
    model.backbone.fpn = MixedAttentionPyramid(model.backbone.fpn, reduction, gain, kind)
    if gain != 1.0:
        for attention in model.backbone.fpn.attention:
            if "channel" in attention.order:
                nn.init.zeros_(attention.channel.expand.weight)  # the spatial weights are zero already
    return model


def with_both_gates(state, reduction, prefix="backbone.fpn."):
    """Adds the gate that a network of one gate lacks, with weights of zero: 2 sigmoid(0) = 1 changes nothing. The network
    is then one of spatial-channel."""
    state = dict(state)
    for k in range(4):
        attention, lateral = f"{prefix}attention.{k}.", state[f"{prefix}inner_blocks.{k}.0.weight"]
        channels = len(lateral)
        for name, shape in (("spatial.weight", (1, 2, 7, 7)), ("channel.reduce.weight", (channels // reduction, channels)),
                            ("channel.expand.weight", (channels, channels // reduction))):
            state.setdefault(attention + name, lateral.new_zeros(shape))
    return state


def fold_gains(state, gain, order, prefix="backbone.fpn."):
    """Weights for gates of sigmoid from weights for gates of gain sigmoid; the outputs stay the same.

    The lateral convolution takes both gains: g s_c(..) g s_s(..) W = s_c(..) s_s(..) (g^2 W). The first gate then reads
    maps that are g^2 times as large and the second one, behind a gate without its g, maps that are g times as large,
    which their first weights undo; the MLP has no bias, so its ReLU lets g pass. Both gates must be there
    (with_both_gates); which is the first one depends on `order`, one of ORDERS: spatial, save for channel-spatial.
    """
    state = dict(state)
    first, second = "spatial.weight", "channel.reduce.weight"
    if order == "channel-spatial":
        first, second = second, first
    for k in range(4):
        attention = f"{prefix}attention.{k}."
        for name, factor in ((f"{prefix}inner_blocks.{k}.0.weight", gain * gain),
                             (f"{prefix}inner_blocks.{k}.0.bias", gain * gain),
                             (attention + first, 1 / (gain * gain)),
                             (attention + second, 1 / gain)):
            state[name] = state[name] * factor
    return state
