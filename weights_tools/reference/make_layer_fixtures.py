#!/usr/bin/python3
"""Writes tests/fixtures/layers: what PyTorch and torchvision compute, layer by layer, for tests/nn/layers/pytorch_test.cpp.

usage: OMP_NUM_THREADS=1 make_layer_fixtures.py OUT        (OUT: tests/fixtures/layers)

  cases.json            every case: its layer, options, and the names and shapes of its inputs
  outputs.safetensors   the output of case k, named "k"

Input number i of case k is stream 100 k + i of counter_random, uniform in [-1, 1), so the fixtures hold outputs only;
the C++ test makes the same inputs itself. Attention and ASFF are written here from the formulas of docs/papers.md, on
PyTorch's operators and independently of nn/layers. Needs Debian's python3-torch (1.13), python3-torchvision (0.14.1) and
python3-numpy.
"""
import json
import os
import struct
import sys

import numpy as np
import torch
import torchvision
from torch.nn import functional as F
from torchvision.models.detection import _utils, anchor_utils, roi_heads

from counter_random import uniform_tensor
from mixed_attention import ChannelAttention, SpatialAttention

ACTIVATIONS = {
    "none": lambda x, slope: x,
    "relu": lambda x, slope: F.relu(x),
    "leaky_relu": F.leaky_relu,
    "sigmoid": lambda x, slope: torch.sigmoid(x),
    "silu": lambda x, slope: F.silu(x),
    "hard_sigmoid": lambda x, slope: F.hardsigmoid(x),
    "hard_swish": lambda x, slope: F.hardswish(x),
}


def activate(x, case):
    return ACTIVATIONS[case.get("activation", "none")](x, case.get("slope", 0.01))


def boxes(u):
    """[R, 4] numbers of [-1, 1) as boxes of up to 40 pixels in and around an image of 60 x 60."""
    first = 30 + 40 * u[:, :2]
    return torch.cat([first, first + 20 * (1 + u[:, 2:])], dim=1)


def conv2d(case, x, weight, bias=None, residual=None):
    y = F.conv2d(x, weight, bias, case.get("stride", 1), case.get("padding", 0), case.get("dilation", 1),
                 case.get("groups", 1))
    return activate(y if residual is None else y + residual, case)


def conv_transpose2d(case, x, weight, bias=None):
    return activate(F.conv_transpose2d(x, weight, bias, case.get("stride", 1), case.get("padding", 0),
                                       case.get("output_padding", 0), 1, case.get("dilation", 1)), case)


def batch_norm(case, x, weight, gamma, beta, mean, variance):
    return F.batch_norm(F.conv2d(x, weight), mean, variance.abs() + 0.1, gamma, beta, eps=case["eps"])


def spatial_attention(case, x, weight):
    layer = SpatialAttention()
    layer.weight.data = weight
    return layer(x)


def channel_attention(case, x, reduce, expand):
    layer = ChannelAttention(expand.shape[0], expand.shape[0] // reduce.shape[0])
    layer.reduce.weight.data, layer.expand.weight.data = reduce, expand
    return layer(x)


def mixed_attention(case, x, spatial, reduce, expand):
    return channel_attention(case, spatial_attention(case, x, spatial), reduce, expand)


def coordinate_attention(case, x, squeeze, gamma, beta, mean, variance, rows, rows_bias, columns, columns_bias):
    height, width = x.shape[2:]
    z = torch.cat([x.mean(dim=3, keepdim=True), x.mean(dim=2, keepdim=True).transpose(2, 3)], dim=2)
    f = F.hardswish(F.batch_norm(F.conv2d(z, squeeze), mean, variance.abs() + 0.1, gamma, beta))
    f_h, f_w = torch.split(f, [height, width], dim=2)
    g_h = torch.sigmoid(F.conv2d(f_h, rows, rows_bias))
    g_w = torch.sigmoid(F.conv2d(f_w.transpose(2, 3), columns, columns_bias))
    return x * g_h * g_w


def asff(case, x1, x2, x3, w1, w2, w3, bias):
    logits = torch.cat([F.conv2d(x, w) for x, w in ((x1, w1), (x2, w2), (x3, w3))], dim=1) + bias[:, None, None]
    shares = F.softmax(logits, dim=1)
    return shares[:, 0:1] * x1 + shares[:, 1:2] * x2 + shares[:, 2:3] * x3


def self_attention(case, x, f, g, h, f_bias, g_bias, h_bias):
    flat = lambda t: t.flatten(start_dim=2)
    keys, queries, values = flat(F.conv2d(x, f, f_bias)), flat(F.conv2d(x, g, g_bias)), flat(F.conv2d(x, h, h_bias))
    beta = F.softmax(torch.bmm(queries.transpose(1, 2), keys), dim=2)  # [N, j, i]
    return case["gamma"] * torch.bmm(values, beta.transpose(1, 2)).reshape(x.shape) + x


def roi_align(case, x, regions):
    return torchvision.ops.roi_align(x, [boxes(regions)], case["size"], case["scale"], case["sampling"],
                                     case["aligned"])


def multi_scale_roi_align(case, p2, p3, p4, p5, regions):
    pool = torchvision.ops.MultiScaleRoIAlign(["0", "1", "2", "3"], case["size"], case["sampling"])
    levels = {str(k): level for k, level in enumerate((p2, p3, p4, p5))}
    return pool(levels, [8 * boxes(regions)], [(512, 512)])


def nms(case, regions, scores, groups):
    return torchvision.ops.batched_nms(boxes(regions), scores, (2 * groups).floor(), case["threshold"]).float()


def decode_box(case, regions, deltas):
    return _utils.BoxCoder(case["weights"]).decode_single(3 * deltas, boxes(regions))


def base_anchors(case):
    return anchor_utils.AnchorGenerator().generate_anchors([case["scale"]], case["ratios"])


def mask_paste(case, masks, regions):
    clipped = torchvision.ops.clip_boxes_to_image(boxes(regions), (50, 60))
    return (roi_heads.paste_masks_in_image(0.5 + 0.5 * masks, clipped, (50, 60)) > 0.5).float()


LAYERS = {
    "conv2d": conv2d,
    "conv_transpose2d": conv_transpose2d,
    "linear": lambda case, x, weight, bias: activate(F.linear(x.flatten(1), weight, bias), case)[:, :, None, None],
    "batch_norm": batch_norm,
    "activate": lambda case, x: activate(6 * x, case),
    "softmax_channels": lambda case, x: F.softmax(6 * x, dim=1),
    "add": lambda case, y, x: y + x,
    "multiply": lambda case, y, x: y * x,
    "concat": lambda case, a, b, c: torch.cat([a, b, c], dim=1),
    "slice_channels": lambda case, x: torch.narrow(x, 1, case["first"], case["count"]),
    "max_pool": lambda case, x: F.max_pool2d(x, case["kernel"], case["stride"], case["padding"]),
    "avg_pool": lambda case, x: F.avg_pool2d(x, case["kernel"], case["stride"], case["padding"],
                                             count_include_pad=case["count_padding"]),
    "adaptive_avg_pool": lambda case, x: F.adaptive_avg_pool2d(x, (case["height"], case["width"])),
    "global_max_pool": lambda case, x: F.adaptive_max_pool2d(x, 1),
    "upsample_nearest": lambda case, x: F.interpolate(x, size=(case["height"], case["width"]), mode="nearest"),
    "upsample_bilinear": lambda case, x: F.interpolate(x, size=(case["height"], case["width"]), mode="bilinear",
                                                       align_corners=case["align_corners"]),
    "spatial_attention": spatial_attention,
    "channel_attention": channel_attention,
    "mixed_attention": mixed_attention,
    "coordinate_attention": coordinate_attention,
    "asff": asff,
    "self_attention": self_attention,
    "roi_align": roi_align,
    "multi_scale_roi_align": multi_scale_roi_align,
    "nms": nms,
    "decode_box": decode_box,
    "base_anchors": base_anchors,
    "mask_paste": mask_paste,
}


def case(layer, inputs, **options):
    return dict(layer=layer, inputs=[[name, shape] for name, shape in inputs.items()], **options)


def convolutions():
    yield case("conv2d", dict(x=[1, 3, 9, 11], weight=[5, 3, 3, 3], bias=[5]), padding=1)
    yield case("conv2d", dict(x=[2, 17, 8, 7], weight=[33, 17, 3, 2], bias=[33]), stride=2, padding=1, activation="relu")
    yield case("conv2d", dict(x=[1, 32, 6, 16], weight=[40, 32, 1, 1], bias=[40]), activation="silu")
    yield case("conv2d", dict(x=[1, 20, 9, 9], weight=[16, 20, 3, 3]), dilation=2, padding=2, activation="leaky_relu",
               slope=0.1)
    yield case("conv2d", dict(x=[1, 16, 5, 5], weight=[16, 16, 3, 3], bias=[16], residual=[1, 16, 5, 5]), padding=1,
               activation="relu")
    yield case("conv2d", dict(x=[1, 18, 9, 8], weight=[18, 1, 3, 3], bias=[18]), padding=1, groups=18,
               activation="hard_swish")
    yield case("conv2d", dict(x=[1, 12, 7, 7], weight=[8, 3, 3, 3], bias=[8]), stride=2, padding=1, groups=4)
    yield case("conv2d", dict(x=[1, 64, 6, 6], weight=[32, 32, 3, 3], bias=[32]), padding=1, groups=2)
    yield case("conv2d", dict(x=[3, 19, 1, 1], weight=[21, 19, 1, 1], bias=[21]), activation="sigmoid")
    yield case("conv_transpose2d", dict(x=[2, 20, 4, 5], weight=[20, 18, 2, 2], bias=[18]), stride=2, activation="relu")
    yield case("conv_transpose2d", dict(x=[1, 7, 5, 4], weight=[7, 9, 3, 3], bias=[9]), stride=2, padding=1,
               output_padding=1)
    yield case("conv_transpose2d", dict(x=[1, 16, 4, 4], weight=[16, 5, 4, 3]), stride=3, padding=2, output_padding=2)
    yield case("conv_transpose2d", dict(x=[1, 5, 4, 4], weight=[5, 17, 2, 3], bias=[17]), stride=1, dilation=2)
    yield case("conv_transpose2d", dict(x=[1, 3, 1, 1], weight=[3, 4, 1, 1], bias=[4]), stride=4, output_padding=3)
    yield case("linear", dict(x=[5, 20, 3, 3], weight=[30, 180], bias=[30]), activation="relu")
    yield case("linear", dict(x=[1, 70, 1, 1], weight=[7, 70], bias=[7]))
    for eps in (1e-5, 0.0):
        yield case("batch_norm", dict(x=[2, 5, 4, 6], weight=[18, 5, 1, 1], gamma=[18], beta=[18], mean=[18],
                                      variance=[18]), eps=eps)


def pointwise():
    for activation in ACTIVATIONS:
        yield case("activate", dict(x=[2, 17, 5, 6]), activation=activation, slope=0.2)
    yield case("softmax_channels", dict(x=[2, 37, 4, 5]))
    yield case("softmax_channels", dict(x=[1, 1, 2, 2]))
    for shape in ([2, 18, 4, 5], [1, 18, 1, 1], [2, 1, 4, 5], [1, 1, 4, 1]):
        yield case("add", dict(y=[2, 18, 4, 5], x=shape))
        yield case("multiply", dict(y=[2, 18, 4, 5], x=shape))
    yield case("concat", dict(a=[2, 5, 3, 4], b=[2, 16, 3, 4], c=[2, 30, 3, 4]))
    yield case("concat", dict(a=[1, 16, 3, 3], b=[1, 32, 3, 3], c=[1, 1, 3, 3]))
    yield case("slice_channels", dict(x=[1, 50, 3, 4]), first=7, count=30)


def resizing():
    for kernel, stride, padding in ((2, 2, 0), (3, 2, 1), (5, 1, 2)):
        options = dict(kernel=kernel, stride=stride, padding=padding)
        yield case("max_pool", dict(x=[1, 18, 9, 10]), **options)
        for count_padding in (False, True):
            yield case("avg_pool", dict(x=[1, 18, 9, 10]), count_padding=count_padding, **options)
    yield case("adaptive_avg_pool", dict(x=[2, 18, 9, 10]), height=4, width=3)
    yield case("adaptive_avg_pool", dict(x=[2, 18, 5, 7]), height=1, width=1)
    yield case("adaptive_avg_pool", dict(x=[1, 3, 3, 2]), height=5, width=7)
    yield case("global_max_pool", dict(x=[3, 20, 5, 7]))
    for shape, height, width in (([1, 5, 6, 7], 12, 14), ([2, 17, 3, 4], 7, 5), ([1, 3, 1, 1], 4, 3), ([1, 2, 11, 9], 5, 1)):
        yield case("upsample_nearest", dict(x=shape), height=height, width=width)
        for align_corners in (False, True):
            yield case("upsample_bilinear", dict(x=shape), height=height, width=width, align_corners=align_corners)


def attention():
    for n, c, h, w in ((1, 32, 6, 7), (2, 48, 1, 1), (2, 16, 9, 5)):
        shape = [n, c, h, w]
        gates = dict(reduce=[c // 16, c], expand=[c, c // 16])
        yield case("spatial_attention", dict(x=shape, weight=[1, 2, 7, 7]))
        yield case("channel_attention", dict(x=shape, **gates))
        yield case("mixed_attention", dict(x=shape, spatial=[1, 2, 7, 7], **gates))
    for n, c, m, h, w in ((1, 20, 4, 6, 7), (2, 33, 8, 1, 1), (1, 16, 17, 3, 9)):
        yield case("coordinate_attention", dict(
            x=[n, c, h, w], squeeze=[m, c, 1, 1], gamma=[m], beta=[m], mean=[m], variance=[m], rows=[c, m, 1, 1],
            rows_bias=[c], columns=[c, m, 1, 1], columns_bias=[c]))
        yield case("asff", dict(x1=[n, c, h, w], x2=[n, c, h, w], x3=[n, c, h, w], w1=[1, c, 1, 1], w2=[1, c, 1, 1],
                                w3=[1, c, 1, 1], bias=[3]))
        yield case("self_attention", dict(x=[n, c, h, w], f=[m, c, 1, 1], g=[m, c, 1, 1], h=[c, c, 1, 1], f_bias=[m],
                                          g_bias=[m], h_bias=[c]), gamma=0.75)


def regions():
    for aligned in (False, True):
        for sampling in (2, 0):
            yield case("roi_align", dict(x=[1, 18, 15, 15], regions=[6, 4]), size=3, sampling=sampling, scale=0.25,
                       aligned=aligned)
    yield case("roi_align", dict(x=[1, 3, 1, 1], regions=[4, 4]), size=2, sampling=2, scale=0.25, aligned=False)
    yield case("multi_scale_roi_align", dict(p2=[1, 5, 128, 128], p3=[1, 5, 64, 64], p4=[1, 5, 32, 32], p5=[1, 5, 16, 16],
                                             regions=[30, 4]), size=3, sampling=2)
    for threshold in (0.2, 0.5):
        yield case("nms", dict(regions=[150, 4], scores=[150], groups=[150]), threshold=threshold)
    for weights in ([1.0, 1.0, 1.0, 1.0], [10.0, 10.0, 5.0, 5.0]):
        yield case("decode_box", dict(regions=[40, 4], deltas=[40, 4]), weights=weights)
    for scale in (32.0, 100.0):
        yield case("base_anchors", {}, scale=scale, ratios=[0.5, 1.0, 2.0])
    yield case("mask_paste", dict(masks=[4, 1, 28, 28], regions=[4, 4]))


def save_safetensors(path, tensors):
    """An 8-byte header length, the header as JSON, the values: all F32, little-endian."""
    header, offset = {}, 0
    for name, value in tensors.items():
        header[name] = dict(dtype="F32", shape=list(value.shape), data_offsets=[offset, offset + value.nbytes])
        offset += value.nbytes
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 8)
    with open(path, "wb") as file:
        file.write(struct.pack("<Q", len(text)) + text)
        for value in tensors.values():
            file.write(np.ascontiguousarray(value, dtype="<f4").tobytes())


def main():
    out = sys.argv[1]
    os.makedirs(out, exist_ok=True)
    cases = [c for part in (convolutions, pointwise, resizing, attention, regions) for c in part()]
    outputs = {}
    for k, c in enumerate(cases):
        inputs = {name: torch.from_numpy(uniform_tensor(100 * k + i, shape)) for i, (name, shape) in enumerate(c["inputs"])}
        with torch.no_grad():
            outputs[str(k)] = LAYERS[c["layer"]](c, **inputs).numpy().astype(np.float32)
    save_safetensors(os.path.join(out, "outputs.safetensors"), outputs)
    with open(os.path.join(out, "cases.json"), "w") as file:
        file.write("[\n" + ",\n".join(json.dumps(c) for c in cases) + "\n]\n")
    print(len(cases), "cases,", sum(v.nbytes for v in outputs.values()), "bytes of outputs")


if __name__ == "__main__":
    main()
