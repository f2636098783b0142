"""The networks of nn/models as PyTorch modules, with torchvision's names: Mask R-CNN on a ResNet-50 FPN of any width,
with or without mixed attention (weights_tools/reference/mixed_attention.py)."""
import pathlib
import sys

import torch
from torch import nn
from torch.nn import functional as F
from torchvision.models.detection import MaskRCNN
from torchvision.models.detection.anchor_utils import AnchorGenerator
from torchvision.models.detection.backbone_utils import BackboneWithFPN
from torchvision.models.detection.faster_rcnn import FastRCNNPredictor
from torchvision.models.detection.mask_rcnn import MaskRCNNHeads, MaskRCNNPredictor
from torchvision.models.resnet import Bottleneck, ResNet
from torchvision.ops.misc import FrozenBatchNorm2d

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "reference"))
from mixed_attention import ORDERS, PLACES, LargestAndMean, add_mixed_attention, fold_gains, with_both_gates  # noqa: E402,F401

VARIANTS = ("baseline", *ORDERS, *PLACES)
OF_ENGINE = ("baseline", "spatial", "channel", "spatial-channel")  # which `penumbra` runs


class NarrowResNet(ResNet):
    """ResNet-50 whose stem has `width` channels instead of 64, and every layer in proportion."""

    def __init__(self, width, norm):
        nn.Module.__init__(self)
        self._norm_layer, self.inplanes, self.dilation = norm, width, 1
        self.groups, self.base_width = 1, 64
        self.conv1 = nn.Conv2d(3, width, 7, stride=2, padding=3, bias=False)
        self.bn1 = norm(width)
        self.relu = nn.ReLU(inplace=True)
        self.maxpool = nn.MaxPool2d(3, stride=2, padding=1)
        for stage, blocks in enumerate((3, 4, 6, 3)):
            setattr(self, f"layer{stage + 1}",
                    self._make_layer(Bottleneck, width << stage, blocks, stride=1 if stage == 0 else 2))
        for module in self.modules():
            if isinstance(module, nn.Conv2d):
                nn.init.kaiming_normal_(module.weight, mode="fan_out", nonlinearity="relu")
            elif isinstance(module, Bottleneck) and isinstance(module.bn3, nn.BatchNorm2d):
                nn.init.zeros_(module.bn3.weight)  # residual branches start at zero: a deep network trains at once


class BoxHead(nn.Module):
    """torchvision's TwoMLPHead with one or two layers. The first, which has nearly all the weights, is computed as a
    convolution: where PyTorch comes without a fast BLAS, as Debian's does, that is several times as fast."""

    def __init__(self, channels, outputs, layers):
        super().__init__()
        self.fc6 = nn.Linear(channels * 7 * 7, outputs)
        self.fc7 = nn.Linear(outputs, outputs) if layers == 2 else None

    def forward(self, x):
        x = F.relu(F.conv2d(x, self.fc6.weight.view(-1, *x.shape[1:]), self.fc6.bias).flatten(start_dim=1))
        return x if self.fc7 is None else F.relu(self.fc7(x))


class DoublingConv(nn.ConvTranspose2d):
    """A transposed convolution 2 x 2 of stride 2, whose windows do not overlap, as a 1 x 1 convolution to four times the
    channels and a shuffle; for the same reason."""

    def __init__(self, channels):
        super().__init__(channels, channels, 2, stride=2)

    def forward(self, x):
        weight = self.weight.permute(1, 2, 3, 0).reshape(-1, self.in_channels, 1, 1)
        return F.pixel_shuffle(F.conv2d(x, weight, self.bias.repeat_interleave(4)), 2)


class SemanticHead(nn.Module):
    """Auxiliary training task: the class of every pixel from P2, one 1 x 1 convolution. Objects teach the pyramid
    at every pixel that they cover and not only where an anchor or a proposal is drawn; inference has no use for it."""

    def __init__(self, pyramid, channels, classes):
        super().__init__()
        self.logits = nn.Conv2d(channels, classes, 1)
        self.features = None
        pyramid.register_forward_hook(self.keep)

    def keep(self, module, inputs, outputs):
        self.features = outputs["0"]

    def loss(self, classes):
        """`classes` [N, H, W]: class numbers at the resolution of the images, H and W those of the batch."""
        logits = self.logits(self.features).float()
        target = F.interpolate(classes[:, None].float(), size=logits.shape[-2:], mode="nearest")[:, 0].long()
        return F.cross_entropy(logits, target)


def build(config, attention, gain=2.0):
    """The network of `config` with random weights, ready to train; `attention`: whether it has the paper's, or one of
    VARIANTS. A gain of 1 for weights that export.py wrote."""
    if config.frozen_norm:
        norm = lambda channels: FrozenBatchNorm2d(channels, eps=config.batch_norm_eps)
    else:
        norm = lambda channels: nn.BatchNorm2d(channels, eps=config.batch_norm_eps)
    body = NarrowResNet(config.width, norm)
    backbone = BackboneWithFPN(body, {f"layer{k + 1}": str(k) for k in range(4)},
                               [4 * config.width << k for k in range(4)], config.pyramid_channels)
    channels = config.pyramid_channels
    mask_predictor = MaskRCNNPredictor(channels, channels, config.outputs)
    mask_predictor.conv5_mask = DoublingConv(channels)
    model = MaskRCNN(
        backbone, min_size=config.min_size, max_size=config.max_size,
        rpn_anchor_generator=AnchorGenerator(tuple((s,) for s in config.anchor_sizes), ((0.5, 1.0, 2.0),) * 5),
        rpn_pre_nms_top_n_train=config.candidates, rpn_pre_nms_top_n_test=config.candidates,
        rpn_post_nms_top_n_train=config.proposals, rpn_post_nms_top_n_test=config.proposals,
        rpn_batch_size_per_image=config.anchors_per_image, box_batch_size_per_image=config.boxes_per_image,
        box_head=BoxHead(channels, config.box_width, config.box_layers), box_predictor=FastRCNNPredictor(config.box_width, config.outputs),
        mask_head=MaskRCNNHeads(channels, (channels,) * config.mask_layers, 1),
        mask_predictor=mask_predictor)
    kind = {True: "spatial-channel", False: "baseline"}.get(attention, attention)
    if kind != "baseline":
        add_mixed_attention(model, config.reduction, gain, kind)
    return model
