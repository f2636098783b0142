"""Weights to start a training from."""
import re

import torch

import safetensors_file
from model import ORDERS, PLACES, fold_gains


def read_state(path):
    """A state dict of train.py's checkpoint.pt, of its weights.safetensors, or torchvision's; and the kind of its attention,
    one of VARIANTS, where the file says it."""
    if str(path).endswith(".safetensors"):
        state, metadata = safetensors_file.load(path)
        state = {re.sub(r"\.attention_[a-z_-]+\.", ".attention.", name): value for name, value in state.items()}
        kind = metadata.get("attention", "spatial-channel")
        if kind in ORDERS and any(".attention." in name for name in state):  # back to gates of 2 sigmoid
            state = fold_gains(state, 0.5, kind)
        return state, kind
    saved = torch.load(path, map_location="cpu")
    return (saved["model"], saved.get("attention")) if "optimizer" in saved else (saved, None)


def load_initial(model, path):
    """Loads weights. The attention may be missing there: it then starts as the identity, so that the network begins
    with the outputs of those weights. Gates of zero, which export.py adds, count as missing: channel attention whose two
    layers were both zero would have no gradient and stay so. Anything else must fit, the place of the gates, too."""
    found, kind = read_state(path)
    own = getattr(model.backbone.fpn, "kind", "baseline")
    if kind != own and {kind, own} & set(PLACES) and any(".attention." in name for name in found):
        raise SystemExit(f"{path}: attention of the kind {kind}; expected {own}")
    state = {name: value.float() if value.is_floating_point() else value for name, value in found.items()}
    state = {name: value for name, value in state.items() if ".attention." not in name or value.any()}
    missing, superfluous = model.load_state_dict(state, strict=False)
    missing = [name for name in missing if ".attention." not in name and not name.endswith("num_batches_tracked")]
    if missing or superfluous:
        raise SystemExit(f"{path}: missing {missing}, superfluous {superfluous}")
