#!/usr/bin/python3
"""How hard the synthetic office is: ATE of plain tracking (no masks, no movers, no filter) over presets and seeds.

usage: judge_office.py [--penumbra FILE] [--frames N] [--seeds 1,2,3] [--presets a,b] [-- more options of slam]
Prints a table: median and all values of the ATE in metres (RMSE after rigid alignment), by preset.
"""
import argparse
import json
import pathlib
import shutil
import statistics
import subprocess
import tempfile

PRESETS = [f"{people}-{path}" for people in ("walking", "sitting") for path in ("xyz", "static", "rpy", "halfsphere")]
PUBLISHED = {"walking-xyz": 0.752, "walking-static": 0.390, "walking-rpy": 0.871, "walking-halfsphere": 0.486, "sitting-static": 0.009}


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def ate_of(arguments, preset, seed, folder):
    data, out = folder / "data", folder / "slam"
    run(arguments.penumbra, "synth", "--scene", "office", "--preset", preset, "--seed", str(seed), "--frames",
        str(arguments.frames), "--out", str(data))
    run(arguments.penumbra, "slam", str(data), "--movers", "off", "--filter", "off", "--out", str(out), *arguments.more)
    result = json.loads(run(arguments.penumbra, "eval", "--groundtruth", str(data / "groundtruth.txt"), "--estimate",
                            str(out / "trajectory_tum.txt"), "--json"))
    return result["ape_m"]["rmse"], result["ape_m"]["count"]


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--penumbra", default=str(pathlib.Path(__file__).resolve().parents[1] / "build" / "penumbra"))
    parser.add_argument("--frames", type=int, default=600)
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--presets", default=",".join(PRESETS))
    parser.add_argument("more", nargs="*")
    arguments = parser.parse_args()
    print("| preset | median ATE, m | each seed | frames located | ORB-SLAM2 on TUM |")
    print("|---|---|---|---|---|")
    for preset in arguments.presets.split(","):
        errors, located = [], []
        for seed in arguments.seeds.split(","):
            folder = pathlib.Path(tempfile.mkdtemp(prefix="office-"))
            try:
                error, count = ate_of(arguments, preset, int(seed), folder)
                errors.append(error)
                located.append(count / arguments.frames)
            finally:
                shutil.rmtree(folder)
        each = ", ".join(f"{error:.3f}" for error in errors)
        published = f"{PUBLISHED[preset]:.3f}" if preset in PUBLISHED else ""
        print(f"| {preset} | {statistics.median(errors):.3f} | {each} | {100 * min(located):.0f} % | {published} |", flush=True)


if __name__ == "__main__":
    main()
