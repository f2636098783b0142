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


class SpatialAttention(nn.Module):
    """M_s(F) = gain sigmoid(Conv7x7([max_c F ; mean_c F])) * F                                         (4), (5)"""

    def __init__(self, gain=1.0):
        super().__init__()
        self.gain = gain
        self.weight = nn.Parameter(torch.zeros(1, 2, 7, 7))

    def forward(self, f):
        pooled = torch.cat([f.amax(dim=1, keepdim=True), f.mean(dim=1, keepdim=True)], dim=1)
        return self.gain * torch.sigmoid(F.conv2d(pooled, self.weight, padding=3)) * f


class ChannelAttention(nn.Module):
    """M_c(F) = gain sigmoid(MLP(max_hw F) + MLP(mean_hw F)) * F, MLP: C -> C/r -> ReLU -> C             (6), (7)"""

    def __init__(self, channels=256, reduction=16, gain=1.0):
        super().__init__()
        self.gain = gain
        self.reduce = nn.Linear(channels, channels // reduction, bias=False)
        self.expand = nn.Linear(channels // reduction, channels, bias=False)

    def mlp(self, v):
        return self.expand(torch.relu(self.reduce(v)))

    def forward(self, f):
        gate = self.gain * torch.sigmoid(self.mlp(f.amax(dim=(2, 3))) + self.mlp(f.mean(dim=(2, 3))))
        return gate[:, :, None, None] * f


class MixedAttention(nn.Module):
    """W'_n = CA(SA(W)): spatial first, then channel                                                     (1), (2)"""

    def __init__(self, channels=256, reduction=16, gain=1.0):
        super().__init__()
        self.spatial = SpatialAttention(gain)
        self.channel = ChannelAttention(channels, reduction, gain)

    def forward(self, f):
        return self.channel(self.spatial(f))


class MixedAttentionPyramid(nn.Module):
    """torchvision's FeaturePyramidNetwork with mixed attention behind every lateral convolution."""

    def __init__(self, pyramid, reduction=16, gain=1.0):
        super().__init__()
        self.inner_blocks = pyramid.inner_blocks
        self.layer_blocks = pyramid.layer_blocks
        self.extra_blocks = pyramid.extra_blocks
        self.attention = nn.ModuleList(MixedAttention(block[0].out_channels, reduction, gain)
                                       for block in pyramid.inner_blocks)

    def forward(self, x):
        names, stages = list(x.keys()), list(x.values())
        lateral = [a(inner(c)) for a, inner, c in zip(self.attention, self.inner_blocks, stages)]
        top_down = [lateral[-1]]
        for w in reversed(lateral[:-1]):                                                              # (3)
            top_down.insert(0, w + F.interpolate(top_down[0], size=w.shape[-2:], mode="nearest"))
        outputs = [layer(t) for layer, t in zip(self.layer_blocks, top_down)]
        outputs, names = self.extra_blocks(outputs, stages, names)
        return OrderedDict(zip(names, outputs))


def add_mixed_attention(model, reduction=16, gain=1.0):
    """With a gain of 2, also makes the gates start at 1: the network computes what it did without attention."""
    model.backbone.fpn = MixedAttentionPyramid(model.backbone.fpn, reduction, gain)
    if gain != 1.0:
        for attention in model.backbone.fpn.attention:
            nn.init.zeros_(attention.channel.expand.weight)  # the spatial weights are zero already
    return model


def fold_gains(state, gain, prefix="backbone.fpn."):
    """Weights for gates of sigmoid from weights for gates of gain sigmoid; the outputs stay the same.

    The lateral convolution takes both gains: g s_c(..) g s_s(..) W = s_c(..) s_s(..) (g^2 W). The gates then read maps
    that are g^2 and g times as large, which their first weights undo; the MLP has no bias, so its ReLU lets g pass.
    """
    state = dict(state)
    for k in range(4):
        attention = f"{prefix}attention.{k}."
        for name, factor in ((f"{prefix}inner_blocks.{k}.0.weight", gain * gain),
                             (f"{prefix}inner_blocks.{k}.0.bias", gain * gain),
                             (attention + "spatial.weight", 1 / (gain * gain)),
                             (attention + "channel.reduce.weight", 1 / gain)):
            state[name] = state[name] * factor
    return state
