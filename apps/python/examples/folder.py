"""Follows a stereo camera through a folder with calibration.yaml, left/ and right/, and plots the path.

    python3 folder.py FOLDER [groundtruth_tum.txt]

Needs Pillow and matplotlib; with the true path it says how far off the estimate is, and asks evo as well if that is there.
"""

# %% Read the folder
import pathlib
import sys

import matplotlib.pyplot as plt
import numpy as np
import penumbra
from PIL import Image

folder = pathlib.Path(sys.argv[1])
names = sorted(path.name for path in (folder / "left").iterdir())
times_file = folder / "times.txt"
times = np.loadtxt(times_file) if times_file.exists() else 0.1 * np.arange(len(names))

# %% Follow the camera
slam = penumbra.Slam(penumbra.Rig.read(str(folder / "calibration.yaml")))
for time, name in zip(times, names):
    left, right = (np.asarray(Image.open(folder / side / name).convert("L")) for side in ("left", "right"))
    found = slam.track(time, left, right)
    if found.state != penumbra.State.tracking:
        print(f"{name}: {found.state.name}, {found.why_lost}")
slam.finish()
stamps, poses = slam.trajectory()

# %% Look at the path from above
points = slam.snapshot()["points"]
plt.scatter(points[:, 0], points[:, 2], s=0.2, c="lightgrey")
plt.plot(poses[:, 0, 3], poses[:, 2, 3], label="estimate")
plt.axis("equal")
plt.xlabel("x [m]")
plt.ylabel("z [m]")

# %% Compare it with the truth
if len(sys.argv) > 2:
    truth = penumbra.read_trajectory(sys.argv[2])
    plt.plot(truth[1][:, 0, 3], truth[1][:, 2, 3], "--", label="truth")
    print("APE", penumbra.evaluate(truth, (stamps, poses)))
    try:
        from evo.core import metrics, sync, trajectory

        pair = sync.associate_trajectories(
            trajectory.PoseTrajectory3D(poses_se3=list(truth[1]), timestamps=truth[0]),
            trajectory.PoseTrajectory3D(poses_se3=list(poses), timestamps=stamps),
        )
        pair[1].align(pair[0])
        ape = metrics.APE(metrics.PoseRelation.translation_part)
        ape.process_data(pair)
        print("evo", ape.get_statistic(metrics.StatisticsType.rmse))
    except ImportError:
        pass
plt.legend()
plt.savefig(folder / "path.png", dpi=150)
