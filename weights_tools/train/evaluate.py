"""AP of a weights file on a COCO-format data set: Penumbra's own engine and evaluation, as the weights will be used."""
import json
import pathlib
import subprocess

OCCLUSION = "0,0.3,0.6,0.9"  # bounds of the ranges of hidden share
NAMES = ("AP", "AP50", "AP75", "APs", "APm", "APl")


def has_occlusion(annotations):
    return any("occlusion" in a for a in json.loads(pathlib.Path(annotations).read_text())["annotations"])


def evaluate(penumbra, weights, annotations, images, out):
    """`penumbra eval-coco --json` of what `penumbra segment` finds; leaves results.json in `out`."""
    subprocess.run([penumbra, "segment", "--coco-images", str(images), "--annotations", str(annotations),
                    "--weights", str(weights), "--out", str(out)], check=True)
    command = [penumbra, "eval-coco", "--annotations", str(annotations), "--results", str(out) + "/results.json", "--json"]
    if has_occlusion(annotations):
        command += ["--occlusion", OCCLUSION]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def percent(value):
    return "-" if value is None else f"{100 * value:.1f}"


def summary(numbers):
    return "\n".join(f"{kind}: " + "  ".join(f"{n} {percent(numbers[kind][n])}" for n in NAMES)
                     for kind in ("bbox", "segm"))
