"""From a trained PyTorch network to a weights file that Penumbra reads."""
import safetensors_file
from model import fold_gains


def export(path, model, config, attention, **facts):
    """Writes `path`; `facts` (training data, seed, AP, ...) go into its metadata beside what the engine must know."""
    state = model.state_dict()
    if attention:
        state = fold_gains(state, 2.0)
    metadata = {
        "network": "mask_rcnn",
        "batch_norm_eps": config.batch_norm_eps,
        "box_head_layers": config.box_layers,
        "mask_head_layers": config.mask_layers,
        "anchor_sizes": ",".join(str(s) for s in config.anchor_sizes),
        "min_size": config.min_size,
        "max_size": config.max_size,
        "rpn_candidates": config.candidates,
        "rpn_proposals": config.proposals,
        **facts}
    if config.classes:
        metadata["classes"] = ",".join(config.classes)
    safetensors_file.save(path, state, metadata)
