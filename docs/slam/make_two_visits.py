#!/usr/bin/python3
"""Makes the drive of docs/slam/loops.md, "Objects beside points": a block of 194 m is driven round once in the
traffic of `synth --preset street`, and from frame 186 on, 8 m before the first place comes again, in that of
`--preset lorry`. The street is the same: traffic is added after everything that stands. Needs Debian's python3-opencv.

  make_two_visits.py build/penumbra SEED FOLDER      the drive is then in FOLDER/joint
"""
import json, math, os, shutil, subprocess, sys

import cv2

SWITCH, FRAMES, MOVERS = 186, 269, 20000  # MOVERS: added to the numbers of the second visit's traffic
RADIUS, SIDES = 8.0, (44.0, 28.0)


def pose(way):
    """A line of a KITTI pose file, `way` metres along a rounded rectangle."""
    pieces = [(SIDES[0], 0), (math.pi / 2 * RADIUS, 1), (SIDES[1], 0), (math.pi / 2 * RADIUS, 1)] * 2
    way = (way + 20.0) % sum(length for length, _ in pieces)
    x = z = heading = 0.0
    for length, bend in pieces:
        step = min(way, length)
        if bend:
            turned = heading + step / RADIUS
            x += RADIUS * (math.cos(heading) - math.cos(turned))
            z += RADIUS * (math.sin(turned) - math.sin(heading))
            heading = turned
        else:
            x, z = x + step * math.sin(heading), z + step * math.cos(heading)
        way -= step
        if way <= 0.0:
            break
    c, s = math.cos(heading), math.sin(heading)
    return " ".join(f"{v:.9f}" for v in (c, 0, s, x, 0, 1, 0, 0, -s, 0, c, z))


def main(program, seed, folder):
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, "path.txt")
    with open(path, "w") as file:
        file.writelines(pose(float(i)) + "\n" for i in range(FRAMES))
    visits, joint = [], os.path.join(folder, "joint", "sequences", "00")
    for preset in ("street", "lorry"):
        out = os.path.join(folder, preset)
        if not os.path.isdir(out):
            subprocess.run([program, "synth", "--preset", preset, "--path", path, "--seed", seed, "--out", out], check=True)
        visits.append(os.path.abspath(os.path.join(out, "sequences", "00")))
    shutil.rmtree(os.path.join(folder, "joint"), ignore_errors=True)
    for name in ("image_0", "image_1", "instances", "../../poses"):
        os.makedirs(os.path.join(joint, name))
    for name in ("calib.txt", "times.txt", "../../poses/00.txt"):
        shutil.copy(os.path.join(visits[0], name), os.path.join(joint, name))
    first, second = (json.load(open(os.path.join(visit, "instances.json"))) for visit in visits)
    standing = max(int(k) for k, v in first.items() if not v["moving"])
    first.update({str(int(k) + MOVERS): v for k, v in second.items() if int(k) > standing})
    json.dump(first, open(os.path.join(joint, "instances.json"), "w"))
    for i in range(FRAMES):
        for name in ("image_0", "image_1", "instances"):
            source = os.path.join(visits[i >= SWITCH], name, f"{i:06d}.png")
            target = os.path.join(joint, name, f"{i:06d}.png")
            if name == "instances" and i >= SWITCH:
                numbers = cv2.imread(source, cv2.IMREAD_UNCHANGED)
                numbers[numbers > standing] += MOVERS
                cv2.imwrite(target, numbers)
            else:
                os.symlink(source, target)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
