"""From a trained PyTorch network to a weights file that Penumbra reads."""
import safetensors_file
from model import OF_ENGINE, ORDERS, fold_gains, with_both_gates


def export(path, model, config, variant, **facts):
    """Writes `path`; `facts` (training data, seed, AP, ...) go into its metadata beside what the engine must know.
    The engine knows spatial, then channel. One gate alone is that with the other one's weights at zero. Other kinds get
    names that the engine refuses; evaluate_in_python.py judges them."""
    state = model.state_dict()
    if variant in ORDERS:
        state = fold_gains(with_both_gates(state, config.reduction), 2.0, variant)
    if variant not in OF_ENGINE:
        state = {name.replace(".attention.", f".attention_{variant}."): value for name, value in state.items()}
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
        "attention": variant,
        **facts}
    if config.classes:
        metadata["classes"] = ",".join(config.classes)
    safetensors_file.save(path, state, metadata)
