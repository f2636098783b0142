#!/usr/bin/python3
"""AP of a weights file on a COCO-format data set: Penumbra's own engine and evaluation, as the weights will be used.

  evaluate.py out/attention_1/weights.safetensors --annotations val/instances.json --images val --out out/attention_1

Writes results.json and ap.json to --out; a detector without masks is judged with --boxes. With --people-seen also ap_people.json: of
people alone, and by which share of them is hidden or out of the image (recall_by_visible_share.py). With --stamp also box_AP and mask_AP into the weights' metadata. train.py does the same at its end where it is given a validation set.
"""
import argparse
import json
import pathlib
import subprocess

import safetensors_file
from recall_by_visible_share import visible_shares

PENUMBRA = str(pathlib.Path(__file__).resolve().parents[2] / "build" / "penumbra")
OCCLUSION = "0,0.3,0.6,0.9"  # bounds of the ranges of hidden share
SEEN = "0,0.25,0.5,0.75,1"     # the same of people, borders counted as well
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


def people_seen(annotations, images, path):
    """Writes the annotations of people, whose "occlusion" becomes all that is not seen of them: hidden or cut off."""
    content = json.loads(only(["person"], annotations, path).read_text())
    people = content["annotations"]
    shares, _ = visible_shares(pathlib.Path(images), {image["id"]: image for image in content["images"]}, people)
    for annotation, share in zip(people, shares):
        annotation["occlusion"] = min(max(1 - float(share), 0.0), 0.999)
    path.write_text(json.dumps(content))
    return path


def judge(penumbra, annotations, results, kinds, ranges, path):
    """`penumbra eval-coco --json`, written to `path`."""
    command = [penumbra, "eval-coco", "--annotations", str(annotations), "--results", str(results), "--json", *kinds]
    if has_occlusion(annotations):
        command += ["--occlusion", ranges]
    numbers = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    path.write_text(json.dumps(numbers, indent=1) + "\n")
    return numbers


def evaluate(penumbra, weights, annotations, images, out, classes=(), boxes=False, seen=False, size=None):
    """`penumbra eval-coco --json` of what `penumbra segment` finds; writes results.json and ap.json to `out`. Of some
    classes or all, of boxes alone or of masks as well; with `seen` also ap_people.json. `size`: --max-size."""
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    if classes:
        annotations = only(classes, annotations, out / "annotations.json")
    subprocess.run([penumbra, "segment", "--coco-images", str(images), "--annotations", str(annotations), "--weights",
                    str(weights), "--out", str(out), *(["--max-size", str(size)] if size else [])], check=True)
    kinds = ["--type", "bbox"] if boxes else []
    if seen:
        people = people_seen(annotations, images, out / "annotations_people.json")
        judge(penumbra, people, out / "results.json", kinds, SEEN, out / "ap_people.json")
    return judge(penumbra, annotations, out / "results.json", kinds, OCCLUSION, out / "ap.json")


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


def parser_of(text):
    """The arguments of whatever judges weights; `text` is its description."""
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weights")
    parser.add_argument("--annotations", required=True)
    parser.add_argument("--images", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--penumbra", default=PENUMBRA)
    return parser


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--classes", default="", help="judge these alone, names separated by commas")
    parser.add_argument("--boxes", action="store_true", help="the network has no masks")
    parser.add_argument("--people-seen", action="store_true", help="also ap_people.json; needs depth_clean/")
    parser.add_argument("--size", type=int, help="longest side at the network")
    parser.add_argument("--stamp", action="store_true")
    options = parser.parse_args()
    numbers = evaluate(options.penumbra, options.weights, options.annotations, options.images, options.out,
                       [name for name in options.classes.split(",") if name], options.boxes, options.people_seen, options.size)
    if options.stamp:
        stamp(options.weights, numbers)
    print(summary(numbers))


if __name__ == "__main__":
    main()
