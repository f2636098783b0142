#!/usr/bin/python3
"""AP of a weights file as evaluate.py gives it, but with PyTorch's forward instead of Penumbra's engine: for networks that
the engine refuses (kinds that are for comparison only), or to compare the two. Judged by `penumbra eval-coco`.

  evaluate_in_python.py out/channel-spatial_1/weights.safetensors --annotations val/instances.json --images val --out out/python
"""
import json
import pathlib

import torch

import evaluate as engine
import safetensors_file
from coco_data import counts_of, labels_of, read_rgb
from config import CONFIGS
from initial_weights import load_initial
from model import build


def network(weights, config):
    _, metadata = safetensors_file.load(weights)
    model = build(config, metadata.get("attention", "spatial-channel"))
    load_initial(model, weights)
    return model.eval()


@torch.no_grad()
def results(model, entries, images, categories):
    """COCO's results of every image; `categories`: id of every label. Labels of no category are left out, as the engine
    leaves them out: of the 91 outputs of a network for COCO, eleven have none."""
    for entry in entries:
        image = torch.from_numpy(read_rgb(pathlib.Path(images) / entry["file_name"])).permute(2, 0, 1)
        found = model([image.float() / 255.0])[0]
        for box, label, score, mask in zip(found["boxes"], found["labels"].tolist(), found["scores"], found["masks"]):
            if label in categories:
                x1, y1, x2, y2 = box.tolist()
                runs = counts_of((mask[0] >= 0.5).numpy())
                yield dict(image_id=entry["id"], category_id=categories[label], bbox=[x1, y1, x2 - x1, y2 - y1],
                           score=float(score), segmentation=dict(size=list(mask.shape[1:]), counts=runs))


def evaluate(penumbra, weights, annotations, images, out, config):
    """Writes results.json and ap.json to `out`; `config`: which of CONFIGS the network is."""
    out, config = pathlib.Path(out), CONFIGS[config]
    out.mkdir(parents=True, exist_ok=True)
    content = json.loads(pathlib.Path(annotations).read_text())
    labels = labels_of(content["categories"], config.classes, annotations)
    categories = {label: category for category, label in labels.items()}
    found = list(results(network(weights, config), content["images"], images, categories))
    (out / "results.json").write_text(json.dumps(found))
    return engine.judge(penumbra, annotations, out / "results.json", [], engine.OCCLUSION, out / "ap.json")


def main():
    parser = engine.parser_of(__doc__)
    parser.add_argument("--config", choices=CONFIGS, default="tiny")
    options = parser.parse_args()
    print(engine.summary(evaluate(options.penumbra, options.weights, options.annotations, options.images, options.out, options.config)))


if __name__ == "__main__":
    main()
