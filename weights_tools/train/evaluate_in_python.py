#!/usr/bin/python3
"""AP of a weights file as evaluate.py gives it, but with PyTorch's forward instead of Penumbra's engine: for networks that
the engine refuses (channel attention before spatial), or to compare the two. Judged by `penumbra eval-coco`.

  evaluate_in_python.py out/channel-spatial_1/weights.safetensors --annotations val/instances.json --images val --out out/python
"""
import argparse
import json
import pathlib

import cv2
import numpy as np
import torch

import evaluate as engine
import safetensors_file
from config import CONFIGS
from initial_weights import load_initial
from model import build

LEAST_SCORE = 0.05


def counts(mask):
    """Run lengths of a mask, column by column, first of zeros."""
    flat = np.concatenate([[0], mask.T.ravel(), [2]])
    ends = np.flatnonzero(np.diff(flat))
    return np.diff(np.concatenate([[0], ends])).tolist()


def network(weights, config="tiny"):
    _, metadata = safetensors_file.load(weights)
    model = build(CONFIGS[config], metadata.get("attention", "spatial-channel"))
    load_initial(model, weights)
    return model.eval()


@torch.no_grad()
def results(model, annotations, images, categories):
    """COCO's results of every image."""
    for entry in json.loads(pathlib.Path(annotations).read_text())["images"]:
        image = cv2.imread(str(pathlib.Path(images) / entry["file_name"]), cv2.IMREAD_COLOR)[:, :, ::-1]
        found = model([torch.from_numpy(np.ascontiguousarray(image.transpose(2, 0, 1))).float() / 255.0])[0]
        for box, label, score, mask in zip(found["boxes"], found["labels"], found["scores"], found["masks"]):
            if score < LEAST_SCORE:
                continue
            x1, y1, x2, y2 = box.tolist()
            runs = counts((mask[0] >= 0.5).numpy().astype(np.int8))
            yield dict(image_id=entry["id"], category_id=categories[int(label)], bbox=[x1, y1, x2 - x1, y2 - y1],
                       score=float(score), segmentation=dict(size=list(mask.shape[1:]), counts=runs))


def evaluate(penumbra, weights, annotations, images, out, config="tiny"):
    """Writes results.json and ap.json to `out`."""
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    ids = {c["name"]: c["id"] for c in json.loads(pathlib.Path(annotations).read_text())["categories"]}
    classes = CONFIGS[config].classes
    categories = {k: ids[name] for k, name in enumerate(classes, 1)} if classes else {i: i for i in ids.values()}
    found = list(results(network(weights, config), annotations, images, categories))
    (out / "results.json").write_text(json.dumps(found))
    return engine.judge(penumbra, annotations, out / "results.json", [], engine.OCCLUSION, out / "ap.json")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weights")
    parser.add_argument("--annotations", required=True)
    parser.add_argument("--images", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--config", choices=CONFIGS, default="tiny")
    parser.add_argument("--penumbra", default=engine.PENUMBRA)
    options = parser.parse_args()
    print(engine.summary(evaluate(options.penumbra, options.weights, options.annotations, options.images, options.out, options.config)))


if __name__ == "__main__":
    main()
