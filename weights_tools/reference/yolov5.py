"""YOLOv5 (releases 6 and 7) in PyTorch, written from the architecture's description: the oracle for
nn/models/yolov5. Detection and segmentation, batch norm folded or not.

The modules are named so that the published state dicts load as they are: model.0 ... model.24.
"""
import math

import torch
from torch import nn
from torch.nn import functional as F

STRIDES = (8, 16, 32)
PROTOTYPES = 32
# Width and height of three anchors for each stride, pixels: clustered on COCO, YOLOv5's default.
ANCHORS = (((10, 13), (16, 30), (33, 23)), ((30, 61), (62, 45), (59, 119)), ((116, 90), (156, 198), (373, 326)))


class Conv(nn.Module):
    """y = act(batch_norm(W * x)); folded weights have a bias and no norm."""

    def __init__(self, inputs, outputs, kernel=1, stride=1, padding=None, folded=False, act=F.silu):
        super().__init__()
        self.act = act
        padding = kernel // 2 if padding is None else padding
        self.conv = nn.Conv2d(inputs, outputs, kernel, stride, padding, bias=folded)
        if not folded:
            self.bn = nn.BatchNorm2d(outputs, eps=1e-3)

    def forward(self, x):
        x = self.conv(x)
        return self.act(self.bn(x) if hasattr(self, "bn") else x)


class Residual(nn.Module):
    """y = x + cv2(cv1(x)), or without x."""

    def __init__(self, channels, shortcut, folded):
        super().__init__()
        self.cv1 = Conv(channels, channels, 1, folded=folded)
        self.cv2 = Conv(channels, channels, 3, folded=folded)
        self.shortcut = shortcut

    def forward(self, x):
        y = self.cv2(self.cv1(x))
        return x + y if self.shortcut else y


class C3(nn.Module):
    """y = cv3([m(cv1(x)), cv2(x)])"""

    def __init__(self, inputs, outputs, depth, shortcut, folded):
        super().__init__()
        hidden = outputs // 2
        self.cv1 = Conv(inputs, hidden, folded=folded)
        self.cv2 = Conv(inputs, hidden, folded=folded)
        self.cv3 = Conv(2 * hidden, outputs, folded=folded)
        self.m = nn.Sequential(*(Residual(hidden, shortcut, folded) for _ in range(depth)))

    def forward(self, x):
        return self.cv3(torch.cat([self.m(self.cv1(x)), self.cv2(x)], 1))


class SPPF(nn.Module):
    """y = cv2([z, p(z), p(p(z)), p(p(p(z)))]), z = cv1(x), p the 5 x 5 maximum"""

    def __init__(self, channels, folded):
        super().__init__()
        self.cv1 = Conv(channels, channels // 2, folded=folded)
        self.cv2 = Conv(2 * channels, channels, folded=folded)

    def forward(self, x):
        maps = [self.cv1(x)]
        for _ in range(3):
            maps.append(F.max_pool2d(maps[-1], 5, 1, 2))
        return self.cv2(torch.cat(maps, 1))


class Prototypes(nn.Module):
    def __init__(self, inputs, hidden, folded):
        super().__init__()
        self.cv1 = Conv(inputs, hidden, 3, folded=folded)
        self.cv2 = Conv(hidden, hidden, 3, folded=folded)
        self.cv3 = Conv(hidden, PROTOTYPES, 1, folded=folded)

    def forward(self, x):
        x = F.interpolate(self.cv1(x), scale_factor=2, mode="nearest")
        return self.cv3(self.cv2(x))


class Head(nn.Module):
    """Rows of cx, cy, w, h (pixels), objectness, class probabilities (and mask coefficients), strides 8, 16, 32."""

    def __init__(self, classes, channels, prototypes, folded):
        super().__init__()
        self.classes = classes
        outputs = 5 + classes + (PROTOTYPES if prototypes else 0)
        self.m = nn.ModuleList(nn.Conv2d(c, 3 * outputs, 1) for c in channels)
        anchors = torch.tensor(ANCHORS, dtype=torch.float32) / torch.tensor(STRIDES).view(3, 1, 1)
        self.register_buffer("anchors", anchors)  # in cells of their level
        if prototypes:
            self.proto = Prototypes(channels[0], prototypes, folded)

    def forward(self, maps):
        rows = []
        for level, (x, stride) in enumerate(zip(maps, STRIDES)):
            n, _, height, width = x.shape
            y = self.m[level](x).view(n, 3, -1, height, width).permute(0, 1, 3, 4, 2)  # anchor, row, column, value
            columns = torch.arange(width).view(1, 1, 1, width)
            lines = torch.arange(height).view(1, 1, height, 1)
            p = torch.sigmoid(y[..., : 5 + self.classes])
            cx = (2 * p[..., 0] - 0.5 + columns) * stride
            cy = (2 * p[..., 1] - 0.5 + lines) * stride
            size = (2 * p[..., 2:4]) ** 2 * (self.anchors[level] * stride).view(1, 3, 1, 1, 2)
            row = torch.cat([torch.stack([cx, cy], -1), size, p[..., 4:], y[..., 5 + self.classes:]], -1)
            rows.append(row.reshape(n, -1, row.shape[-1]))
        return torch.cat(rows, 1), self.proto(maps[0]) if hasattr(self, "proto") else None


class Yolov5(nn.Module):
    """`width` and `depth` multiply the channels and the repetitions of the largest common description (YOLOv5l)."""

    def __init__(self, classes=80, depth=1 / 3, width=1 / 4, prototypes=False, folded=False):
        super().__init__()
        c = [math.ceil(channels * width / 8) * 8 for channels in (64, 128, 256, 512, 1024)]
        times = lambda n: max(round(n * depth), 1)
        f = dict(folded=folded)
        c3 = lambda inputs, outputs, n, shortcut: C3(inputs, outputs, times(n), shortcut, folded)
        keep = nn.Identity  # upsampling and concatenation have no weights
        self.model = nn.ModuleList([
            Conv(3, c[0], 6, 2, 2, **f), Conv(c[0], c[1], 3, 2, **f), c3(c[1], c[1], 3, True),
            Conv(c[1], c[2], 3, 2, **f), c3(c[2], c[2], 6, True),
            Conv(c[2], c[3], 3, 2, **f), c3(c[3], c[3], 9, True),
            Conv(c[3], c[4], 3, 2, **f), c3(c[4], c[4], 3, True), SPPF(c[4], folded),
            Conv(c[4], c[3], **f), keep(), keep(), c3(2 * c[3], c[3], 3, False),
            Conv(c[3], c[2], **f), keep(), keep(), c3(2 * c[2], c[2], 3, False),
            Conv(c[2], c[2], 3, 2, **f), keep(), c3(2 * c[2], c[3], 3, False),
            Conv(c[3], c[3], 3, 2, **f), keep(), c3(2 * c[3], c[4], 3, False),
            Head(classes, (c[2], c[3], c[4]), math.ceil(256 * width / 8) * 8 if prototypes else 0, folded),
        ])

    def forward(self, x):
        return self.model[24](self.features(x))

    def features(self, x):
        """N3, N4, N5: what the head reads."""
        m = self.model
        up = lambda t: F.interpolate(t, scale_factor=2, mode="nearest")
        p3 = m[4](m[3](m[2](m[1](m[0](x)))))
        p4 = m[6](m[5](p3))
        t5 = m[10](m[9](m[8](m[7](p4))))
        t4 = m[14](m[13](torch.cat([up(t5), p4], 1)))
        n3 = m[17](torch.cat([up(t4), p3], 1))
        n4 = m[20](torch.cat([m[18](n3), t4], 1))
        n5 = m[23](torch.cat([m[21](n4), t5], 1))
        return [n3, n4, n5]


def load(path, depth=1 / 3, width=1 / 4):
    """The network of a published state dict."""
    state = {k: v.float() for k, v in torch.load(path, map_location="cpu").items()}
    segments = any(".proto." in k for k in state)
    outputs = state["model.24.m.0.weight"].shape[0] // 3
    network = Yolov5(outputs - 5 - (PROTOTYPES if segments else 0), depth, width, segments,
                     folded="model.0.conv.bias" in state)
    missing, extra = network.load_state_dict(state, strict=False)
    assert not extra and all(k.endswith("num_batches_tracked") for k in missing), (missing, extra)
    return network.eval()
