"""The two networks that the training script builds, and how it trains them unless told otherwise."""
import dataclasses


@dataclasses.dataclass(frozen=True)
class Config:
    name: str
    classes: tuple             # names without the background; empty: COCO's numbers 1..90
    width: int                 # channels of the ResNet-50 stem; 64 is the full network
    pyramid_channels: int
    box_layers: int            # hidden fully connected layers of the box head, 1 or 2
    box_width: int             # their outputs
    mask_layers: int           # 3 x 3 convolutions of the mask head
    reduction: int             # r of the channel attention
    anchor_sizes: tuple        # pixels, one a pyramid level P2..P6
    min_size: int              # image sides at the network, pixels, as torchvision defines them
    max_size: int
    batch_norm_eps: float
    frozen_norm: bool          # batch norms keep their statistics, as is usual for networks trained before
    candidates: int            # of the region proposal network: candidates a level, proposals an image
    proposals: int
    boxes_per_image: int       # proposals an image that the box head trains on
    anchors_per_image: int     # anchors an image that the proposal network trains on
    batch: int                 # images a step
    learning_rate: float
    semantic_weight: float     # of the auxiliary loss, see model.py; 0: none

    @property
    def outputs(self):
        """Classes of the network, background included."""
        return len(self.classes) + 1 if self.classes else 91


CONFIGS = {
    "tiny": Config(
        name="tiny", classes=("person", "cyclist", "car", "truck", "sign"), width=16, pyramid_channels=64, box_layers=1,
        box_width=256, mask_layers=2, reduction=4, anchor_sizes=(12, 24, 48, 96, 192), min_size=188, max_size=620,
        batch_norm_eps=1e-5, frozen_norm=False, candidates=200, proposals=150, boxes_per_image=32, anchors_per_image=128,
        batch=4, learning_rate=1.5e-3, semantic_weight=1.0),
    "full": Config(
        name="full", classes=(), width=64, pyramid_channels=256, box_layers=2, box_width=1024, mask_layers=4, reduction=16,
        anchor_sizes=(32, 64, 128, 256, 512), min_size=800, max_size=1333, batch_norm_eps=0.0, frozen_norm=True,
        candidates=1000, proposals=1000, boxes_per_image=512, anchors_per_image=256, batch=2,
        learning_rate=1e-4, semantic_weight=0.0),
}
