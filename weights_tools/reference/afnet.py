"""AFNET in PyTorch: YOLOv5 with coordinate attention and ASFF, written from docs/papers.md B.1. The oracle for what
nn/models/yolov5_attention and yolov5_fusion add to YOLOv5; each of the two may be left out.

  attention   every residual unit of the backbone's C3 (the paper's CSP1_X):
              y = x + H( leaky(bn(Conv3x3( leaky(bn(Conv1x1(x))) ))) ),  H: coordinate attention
  fusion      the levels N3, N4, N5 that the head reads, each a mixture of all three (ASFF)

Weights are named as YOLOv5's; what is added is model.K.m.I.attention and asff.L.
"""
import functools

import torch
from torch import nn
from torch.nn import functional as F

from yolov5 import Conv, Yolov5

BACKBONE_C3 = (2, 4, 6, 8)
SLOPE = 0.1      # of LeakyReLU, as in darknet and YOLOv5 before release 4
REDUCTION = 32   # Hou et al. 2021
LEAST_WIDTH = 8  # of the squeezed map

leaky = functools.partial(F.leaky_relu, negative_slope=SLOPE)


class CoordinateAttention(nn.Module):
    """y[c, i, j] = x[c, i, j] g^h[c, i] g^w[c, j]"""

    def __init__(self, channels, folded=False):
        super().__init__()
        middle = max(LEAST_WIDTH, channels // REDUCTION)
        self.squeeze = Conv(channels, middle, folded=folded, act=F.hardswish)
        self.expand_rows = nn.Conv2d(middle, channels, 1)
        self.expand_columns = nn.Conv2d(middle, channels, 1)

    def forward(self, x):
        height, width = x.shape[2:]
        rows, columns = x.mean(3, keepdim=True), x.mean(2, keepdim=True).transpose(2, 3)
        f = self.squeeze(torch.cat([rows, columns], 2))
        gate_rows = torch.sigmoid(self.expand_rows(f[:, :, :height]))
        gate_columns = torch.sigmoid(self.expand_columns(f[:, :, height:])).transpose(2, 3)
        return x * gate_rows * gate_columns


class AttentionResidual(nn.Module):
    """The paper's CA residual unit."""

    def __init__(self, channels, folded=False):
        super().__init__()
        self.cv1 = Conv(channels, channels, 1, folded=folded, act=leaky)
        self.cv2 = Conv(channels, channels, 3, folded=folded, act=leaky)
        self.attention = CoordinateAttention(channels, folded)

    def forward(self, x):
        return x + self.attention(self.cv2(self.cv1(x)))


class Fusion(nn.Module):
    """y = sum_k alpha_k F_k for one level, alpha = softmax_k( w_k . F_k + b_k ), F_k the levels resized to this one:
    coarser ones by a 1 x 1 Conv and repetition, finer ones by a 3 x 3 Conv of stride 2, by 4 with a maximum before."""

    def __init__(self, level, channels, folded=False):
        super().__init__()
        self.level, width = level, channels[level]
        self.resize = nn.ModuleList(
            nn.Identity() if k == level else
            Conv(c, width, 1, folded=folded) if k > level else
            Conv(c, width, 3, 2, folded=folded) for k, c in enumerate(channels))
        self.weight = nn.ModuleList(nn.Conv2d(width, 1, 1) for _ in channels)

    def forward(self, maps):
        resized = []
        for k, x in enumerate(maps):
            if k == self.level - 2:
                x = F.max_pool2d(x, 3, 2, 1)
            x = self.resize[k](x)
            if k > self.level:
                x = F.interpolate(x, scale_factor=2 ** (k - self.level), mode="nearest")
            resized.append(x)
        shares = torch.softmax(torch.cat([w(x) for w, x in zip(self.weight, resized)], 1), 1)
        return sum(shares[:, k:k + 1] * x for k, x in enumerate(resized))


class Afnet(Yolov5):
    def __init__(self, classes=80, depth=1 / 3, width=1 / 4, attention=True, fusion=True, folded=False, prototypes=False):
        super().__init__(classes, depth, width, prototypes, folded)
        if attention:
            for k in BACKBONE_C3:
                block = self.model[k].m
                self.model[k].m = nn.Sequential(*(AttentionResidual(unit.cv1.conv.in_channels, folded) for unit in block))
        if fusion:
            channels = [m.in_channels for m in self.model[24].m]
            self.asff = nn.ModuleList(Fusion(level, channels, folded) for level in range(3))

    def features(self, x):
        maps = super().features(x)
        return [fuse(maps) for fuse in self.asff] if hasattr(self, "asff") else maps


def of_state(state, depth=1 / 3, width=1 / 4):
    """The network that a state dict of these names belongs to, YOLOv5 as well; for judging."""
    network = Afnet(state["model.24.m.0.weight"].shape[0] // 3 - 5, depth, width,
                    attention=any(".attention." in name for name in state),
                    fusion=any(name.startswith("asff.") for name in state),
                    folded="model.0.conv.bias" in state)
    missing, extra = network.load_state_dict(state, strict=False)
    assert not extra and all(k.endswith("num_batches_tracked") for k in missing), (missing, extra)
    return network.eval()
