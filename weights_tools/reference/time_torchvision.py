#!/usr/bin/python3
"""How long torchvision takes for what `penumbra bench network` does: Mask R-CNN R50-FPN with random weights.

  OMP_NUM_THREADS=2 time_torchvision.py --size 1242x375 --detections 100

Prints one JSON object with the medians in seconds of the backbone with its pyramid and of the whole network, from the
image on (resizing included), and the instances found. Random weights would find nothing: one class gets a large bias, so
that the wanted number of instances goes through the mask head.
"""
import argparse
import json
import statistics
import time

import torch
import torchvision


def median_seconds(work, repeats):
    for _ in range(2):
        work()
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", default="1242x375")
    parser.add_argument("--detections", type=int, default=100)
    parser.add_argument("--min-size", type=int, default=800)
    parser.add_argument("--repeats", type=int, default=7)
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    torch.manual_seed(1)
    model = torchvision.models.detection.maskrcnn_resnet50_fpn(
        weights=None, weights_backbone=None, min_size=options.min_size,
        box_detections_per_img=options.detections).eval()
    with torch.no_grad():
        model.roi_heads.box_predictor.cls_score.bias[1] = 5.0
    image = torch.rand(3, height, width)
    with torch.inference_mode():
        resized, _ = model.transform([image])
        backbone = median_seconds(lambda: model.backbone(resized.tensors), options.repeats)
        full = median_seconds(lambda: model([image]), options.repeats)
        found = len(model([image])[0]["scores"])
    print(json.dumps({"torch": torch.__version__, "threads": torch.get_num_threads(),
                      "input": "x".join(map(str, resized.tensors.shape[:1:-1])), "detections": found,
                      "backbone_fpn_seconds": backbone, "full_seconds": full}))


if __name__ == "__main__":
    main()
