"""Weights to start a training from."""
import torch


def load_initial(model, path):
    """Loads torchvision's state dict or a checkpoint of train.py. The attention may be missing there: it then starts
    as the identity, so that the network begins with the outputs of those weights. Anything else must fit."""
    saved = torch.load(path, map_location="cpu")
    state = saved["model"] if "optimizer" in saved else saved
    missing, superfluous = model.load_state_dict(
        {name: value.float() if value.is_floating_point() else value for name, value in state.items()}, strict=False)
    missing = [name for name in missing if ".attention." not in name and not name.endswith("num_batches_tracked")]
    if missing or superfluous:
        raise SystemExit(f"{path}: missing {missing}, superfluous {superfluous}")
