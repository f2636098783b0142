"""The interest network in PyTorch: the oracle for nn/models/interest_network (docs/brain/interest.md).

  image -> encoder to stride 8 (E8) and 16 (E16) -> self-attention at stride 16 -> decoder back to stride 8
        -> per cell of 8 x 8 pixels: logits of the classes, an embedding

    Conv(x)  = relu(batch_norm(W * x)),  W 3 x 3            Unit(x) = relu(x + batch_norm(W * x))
    E8       = Unit(Unit(Conv_2(Unit(Conv_2(Conv_2(x))))))  Conv_s: stride s
    E16      = Unit(Conv_2(E8)),   A = E16 + gamma attention(E16)          docs/papers.md (13) to (15)
    D        = Conv(E8 + up(W_l A + b_l)),   up: nearest, by 2
    logits   = W_c D + b_c,   embedding = W_e D + b_e        made unit length where it is used
"""
import torch
from torch import nn
from torch.nn import functional as F

CLASSES = ("nothing", "person", "vehicle", "sign", "lamp", "plant", "facade", "screen", "poster", "furniture", "small thing")
CHANNELS = (16, 32, 64, 96)  # at strides 2, 4, 8, 16
EMBEDDING = 32
STRIDE = 16                  # the image's extents are multiples of it; the outputs have stride 8
EPS = 1e-5


class Conv(nn.Module):
    """relu(batch_norm(W * x)); folded weights have a bias and no norm. With `shortcut` relu(x + batch_norm(W * x))."""

    def __init__(self, inputs, outputs, stride=1, shortcut=False, folded=False):
        super().__init__()
        self.shortcut = shortcut
        self.conv = nn.Conv2d(inputs, outputs, 3, stride, 1, bias=folded)
        if not folded:
            self.bn = nn.BatchNorm2d(outputs, eps=EPS)

    def forward(self, x):
        y = self.conv(x)
        if hasattr(self, "bn"):
            y = self.bn(y)
        return F.relu(x + y if self.shortcut else y)


class SelfAttention(nn.Module):
    """SAGAN's; gamma starts at 0, where it changes nothing."""

    def __init__(self, channels, width):
        super().__init__()
        self.f = nn.Conv2d(channels, width, 1)
        self.g = nn.Conv2d(channels, width, 1)
        self.h = nn.Conv2d(channels, channels, 1)
        self.gamma = nn.Parameter(torch.zeros(1))

    def forward(self, x):
        f, g, h = (layer(x).flatten(2) for layer in (self.f, self.g, self.h))
        beta = torch.softmax(g.transpose(1, 2) @ f, 2)  # [N, j, i]: how much j looks at i
        return x + self.gamma * (h @ beta.transpose(1, 2)).reshape(x.shape)


class InterestNetwork(nn.Module):
    def __init__(self, channels=CHANNELS, classes=len(CLASSES), embedding=EMBEDDING, attention=True, folded=False):
        super().__init__()
        c2, c4, c8, c16 = channels

        def conv(inputs, outputs, stride=1):
            return Conv(inputs, outputs, stride, folded=folded)

        def unit(width):
            return Conv(width, width, shortcut=True, folded=folded)

        self.encoder = nn.Sequential(conv(3, c2, 2), conv(c2, c4, 2), unit(c4), conv(c4, c8, 2), unit(c8), unit(c8))
        self.coarse = nn.Sequential(conv(c8, c16, 2), unit(c16))
        self.attention = SelfAttention(c16, max(8, c16 // 8)) if attention else None
        self.lateral = nn.Conv2d(c16, c8, 1)
        self.decoder = conv(c8, c8)
        self.classes = nn.Conv2d(c8, classes, 1)
        self.embedding = nn.Conv2d(c8, embedding, 1)

    def forward(self, x):
        """x: [N, 3, H, W] in 0..1. Logits and embeddings at stride 8."""
        fine = self.encoder(x)
        coarse = self.coarse(fine)
        if self.attention is not None:
            coarse = self.attention(coarse)
        y = self.decoder(fine + F.interpolate(self.lateral(coarse), scale_factor=2, mode="nearest"))
        return self.classes(y), self.embedding(y)


def of_state(state):
    """The network that a state dict of these names belongs to."""
    channels = [state[f"{name}.conv.weight"].shape[0] for name in ("encoder.0", "encoder.1", "encoder.3", "coarse.0")]
    network = InterestNetwork(channels, state["classes.weight"].shape[0], state["embedding.weight"].shape[0],
                              "attention.gamma" in state, "encoder.0.conv.bias" in state)
    missing, extra = network.load_state_dict(state, strict=False)
    assert not extra and all(k.endswith("num_batches_tracked") for k in missing), (missing, extra)
    return network.eval()
