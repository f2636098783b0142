#!/usr/bin/python3
"""AP of a weights file on a COCO-format data set: Penumbra's own engine and evaluation, as the weights will be used.

  evaluate.py out/attention_1/weights.safetensors --annotations val/instances.json --images val --out out/attention_1

Writes results.json and ap.json to --out; a detector without masks is judged with --boxes. With --stamp also box_AP and mask_AP into the weights' metadata. train.py does the same at its end where it is given a validation set.
"""
import argparse
import json
import pathlib
import subprocess

import safetensors_file

PENUMBRA = str(pathlib.Path(__file__).resolve().parents[2] / "build" / "penumbra")
OCCLUSION = "0,0.3,0.6,0.9"  # bounds of the ranges of hidden share
NAMES = ("AP", "AP50", "AP75", "APs", "APm", "APl")


def has_occlusion(annotations):
    return any("occlusion" in a for a in json.loads(pathlib.Path(annotations).read_text())["annotations"])


def only(classes, annotations, path):
    """Writes the annotations of some classes, by their names."""
    content = json.loads(pathlib.Path(annotations).read_text())
    content["categories"] = [c for c in content["categories"] if c["name"] in classes]
    ids = {c["id"] for c in content["categories"]}
    content["annotations"] = [a for a in content["annotations"] if a["category_id"] in ids]
    path.write_text(json.dumps(content))
    return path


def evaluate(penumbra, weights, annotations, images, out, classes=(), boxes=False):
    """`penumbra eval-coco --json` of what `penumbra segment` finds; writes results.json and ap.json to `out`. Of some
    classes or all, of boxes alone or of masks as well."""
    pathlib.Path(out).mkdir(parents=True, exist_ok=True)
    if classes:
        annotations = only(classes, annotations, pathlib.Path(out) / "annotations.json")
    subprocess.run([penumbra, "segment", "--coco-images", str(images), "--annotations", str(annotations),
                    "--weights", str(weights), "--out", str(out)], check=True)
    command = [penumbra, "eval-coco", "--annotations", str(annotations), "--results", str(out) + "/results.json", "--json"]
    if boxes:
        command += ["--type", "bbox"]
    if has_occlusion(annotations):
        command += ["--occlusion", OCCLUSION]
    numbers = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    (pathlib.Path(out) / "ap.json").write_text(json.dumps(numbers, indent=1) + "\n")
    return numbers


def stamp(weights, numbers):
    """Writes the AP into the metadata of the weights file."""
    state, metadata = safetensors_file.load(weights)
    metadata.update({f"{name}_AP": f"{numbers[kind]['AP']:.4f}" for kind, name in (("bbox", "box"), ("segm", "mask")) if kind in numbers})
    safetensors_file.save(weights, state, metadata)


def percent(value):
    return "-" if value is None else f"{100 * value:.1f}"


def summary(numbers):
    return "\n".join(f"{kind}: " + "  ".join(f"{n} {percent(numbers[kind][n])}" for n in NAMES)
                     for kind in ("bbox", "segm") if kind in numbers)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weights")
    parser.add_argument("--annotations", required=True)
    parser.add_argument("--images", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--penumbra", default=PENUMBRA)
    parser.add_argument("--classes", default="", help="judge these alone, names separated by commas")
    parser.add_argument("--boxes", action="store_true", help="the network has no masks")
    parser.add_argument("--stamp", action="store_true")
    options = parser.parse_args()
    numbers = evaluate(options.penumbra, options.weights, options.annotations, options.images, options.out,
                       [name for name in options.classes.split(",") if name], options.boxes)
    if options.stamp:
        stamp(options.weights, numbers)
    print(summary(numbers))


if __name__ == "__main__":
    main()
