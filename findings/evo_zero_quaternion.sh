#!/bin/bash
# evo 1.38.1: a trajectory whose quaternions are all zeros (a driver that never filled them in) is read without an
# error, and each counts as the identity: the full APE, rotation included, against a camera that does not turn is 0,
# and the errors of one that turns are computed as if the estimate had claimed not to. Only the method check(), which has
# to be asked, calls the quaternions invalid. A quaternion of length 2 is normalised in silence.
set -eu
T=$(mktemp -d); trap 'rm -rf "$T"' EXIT; cd "$T"
python3 -m venv v; v/bin/pip install -q evo==1.38.1 numpy==2.2.6
cat > a.py <<'P'
import math
from evo.core import metrics, sync
from evo.tools import file_interface
def trajectory(name, quaternion):
    with open(name, "w") as f:
        for i in range(20): f.write(" ".join(str(v) for v in (0.1 * i, 0.5 * i, math.sin(i), 0) + quaternion(i)) + "\n")
    return file_interface.read_tum_trajectory_file(name)
def ape(reference, estimate, relation):
    m = metrics.APE(relation); m.process_data(sync.associate_trajectories(reference, estimate)); return round(float(m.get_statistic(metrics.StatisticsType.rmse)), 3)
R = metrics.PoseRelation
still = trajectory("still.txt", lambda i: (0, 0, 0, 1))
turned = trajectory("turned.txt", lambda i: (0, 0, math.sin(0.5), math.cos(0.5)))
zeros = trajectory("zeros.txt", lambda i: (0, 0, 0, 0))
twice = trajectory("twice.txt", lambda i: (0, 0, 0, 2))
seen = [ape(still, zeros, R.full_transformation), ape(turned, zeros, R.rotation_angle_rad), ape(still, twice, R.full_transformation)]
print("evo 1.38.1: zeros against no turn, full APE", seen[0], "; against a turn of 1 rad", seen[1], "; length 2, full APE", seen[2])
print("check() of zeros:", zeros.check()[1]["quaternions"])
assert seen == [0.0, 1.0, 0.0] and not zeros.check()[0]
P
v/bin/python a.py
