"""What YOLOv5 (release 7) minimises: which cells answer for an object, and the error of their outputs. The networks
are weights_tools/reference/yolov5.py and afnet.py."""
import math
import pathlib
import sys

import torch
from torch.nn import functional as F

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "reference"))
from afnet import Afnet, AttentionResidual, Fusion  # noqa: E402
from yolov5 import STRIDES, Head  # noqa: E402

BOX, OBJECT, CLASS = 0.05, 1.0, 0.5  # weights of the three losses, for images of 640 x 640 and 80 classes
BALANCE = (4.0, 1.0, 0.4)            # of the objectness at strides 8, 16, 32
FARTHEST_RATIO = 4.0                 # an anchor answers for sides up to so many times its own, or its own so many times


class TrainedHead(Head):
    """In training the outputs before the sigmoid, a tensor [image, anchor, row, column, value] a level."""

    def forward(self, maps):
        if not self.training:
            return super().forward(maps)
        return [m(x).unflatten(1, (3, -1)).permute(0, 1, 3, 4, 2) for m, x in zip(self.m, maps)]


def build(classes, attention=False, fusion=False):
    """YOLOv5n, or AFNET-n, with random weights. The biases say that objects are rare: about 8 an image of 640 x 640."""
    network = Afnet(classes, attention=attention, fusion=fusion)
    head = network.model[24] = TrainedHead(classes, [m.in_channels for m in network.model[24].m], 0, False)
    for m, stride in zip(head.m, STRIDES):
        bias = m.bias.detach().view(3, -1)
        bias[:, 4] = math.log(8 / (640 / stride) ** 2)
        bias[:, 5:] = math.log(0.6 / (classes - 0.99))
    return network


def start(network, state):
    """Loads `state`; parts of AFNET that it lacks begin near neutral. Gates of attention are 1/2 each, and the norm before
    them gives four times as much: LeakyReLU lets the factor through. A level's share in its own mixture is
    e^2 / (e^2 + 2) = 0.79, that of the others 0.11, and the head multiplies by 1 / 0.79. What differs from the network
    of `state` is LeakyReLU for SiLU in the units with attention, and what the other levels bring at random."""
    own = network.state_dict()
    superfluous = [name for name in state if name not in own]
    if superfluous:
        raise SystemExit(f"weights that the network does not have: {', '.join(superfluous[:5])}")
    network.load_state_dict({**own, **state})
    new = {name for name in own if name not in state}
    with torch.no_grad():
        for name, module in network.named_modules():
            if isinstance(module, AttentionResidual) and f"{name}.attention.expand_rows.weight" in new:
                attention = module.attention
                for part in (attention.expand_rows, attention.expand_columns):
                    part.weight.zero_()
                    part.bias.zero_()
                module.cv2.bn.weight.mul_(4)
                module.cv2.bn.bias.mul_(4)
            if isinstance(module, Fusion) and f"{name}.weight.0.weight" in new:
                for k, weight in enumerate(module.weight):
                    weight.weight.zero_()
                    weight.bias.fill_(2.0 if k == module.level else 0.0)
                network.model[24].m[module.level].weight.mul_(1 + 2 * math.exp(-2))


def assign(targets, anchors, height, width):
    """The cells of a level that answer for objects. `targets` [n, 6]: image, class, centre and size in cells; `anchors`
    [3, 2] in cells. An object is answered for by every anchor whose ratio fits, in the cell of its centre and in the
    nearest cell beside and the nearest one above or below. Returns rows of targets, and for each anchor, row, column."""
    n = len(targets)
    ratio = targets[:, None, 4:6] / anchors[None]
    object_, anchor = (torch.max(ratio, 1 / ratio).amax(2) < FARTHEST_RATIO).nonzero().T
    centre = targets[object_, 2:4]
    cell, part = centre.floor(), centre % 1
    toward = torch.where(part < 0.5, -1.0, 1.0)
    cells = torch.stack([cell, cell + toward * torch.tensor([1.0, 0.0]), cell + toward * torch.tensor([0.0, 1.0])])
    inside = (cells >= 0).all(2) & (cells[..., 0] < width) & (cells[..., 1] < height)
    column, row = cells[inside].long().T
    return targets[object_.expand(3, -1)[inside]], anchor.expand(3, -1)[inside], row, column


def complete_iou(a, b):
    """CIoU of boxes (centre, size), Zheng et al. 2020: IoU - d^2 / c^2 - alpha v."""
    low_a, high_a, low_b, high_b = a[:, :2] - a[:, 2:] / 2, a[:, :2] + a[:, 2:] / 2, b[:, :2] - b[:, 2:] / 2, b[:, :2] + b[:, 2:] / 2
    common = (torch.min(high_a, high_b) - torch.max(low_a, low_b)).clamp(0).prod(1)
    iou = common / (a[:, 2:].prod(1) + b[:, 2:].prod(1) - common + 1e-7)
    diagonal = (torch.max(high_a, high_b) - torch.min(low_a, low_b)).pow(2).sum(1) + 1e-7
    distance = (a[:, :2] - b[:, :2]).pow(2).sum(1)
    angle = lambda box: torch.atan(box[:, 2] / (box[:, 3] + 1e-7))
    v = 4 / math.pi ** 2 * (angle(a) - angle(b)).pow(2)
    with torch.no_grad():
        alpha = v / (1 - iou + v + 1e-7)
    return iou - distance / diagonal - alpha * v


def losses(outputs, targets, anchors):
    """`outputs` of TrainedHead; `targets` [n, 6]: image, class, centre and size in pixels; `anchors` [3, 3, 2] in cells."""
    box = obj = cls = outputs[0].new_zeros(())
    for level, (y, stride) in enumerate(zip(outputs, STRIDES)):
        height, width, classes = y.shape[2], y.shape[3], y.shape[4] - 5
        scale = torch.tensor([1, 1] + [1 / stride] * 4)
        chosen, anchor, row, column = assign(targets * scale, anchors[level], height, width)
        objectness = torch.zeros(y.shape[:4])
        if len(chosen):
            image = chosen[:, 0].long()
            found = y[image, anchor, row, column]
            p = found[:, :4].sigmoid()
            centre = 2 * p[:, :2] - 0.5 + torch.stack([column, row], 1)
            iou = complete_iou(torch.cat([centre, (2 * p[:, 2:]) ** 2 * anchors[level][anchor]], 1), chosen[:, 2:])
            box = box + (1 - iou).mean()
            objectness[image, anchor, row, column] = iou.detach().clamp(0)
            cls = cls + F.binary_cross_entropy_with_logits(found[:, 5:], F.one_hot(chosen[:, 1].long(), classes).float())
        obj = obj + BALANCE[level] * F.binary_cross_entropy_with_logits(y[..., 4], objectness)
    pixels = outputs[0].shape[2] * outputs[0].shape[3] * STRIDES[0] ** 2
    return dict(box=BOX * box, object=OBJECT * pixels / 640 ** 2 * obj, cls=CLASS * classes / 80 * cls)
