"""The Python module beside the program: same path, errors that say what was expected, arrays that are not copied."""

import os
import pathlib
import subprocess
import tempfile
import threading
import unittest

import numpy as np
import penumbra

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TINY = str(SOURCE / "weights_tools/models/penumbra-tiny.safetensors")


def texture(width, height, seed):
    random = np.random.default_rng(seed)
    image = np.full((height, width), 128, np.uint8)
    for x, y, w, h, grey in zip(
        random.integers(0, width, 30000),
        random.integers(0, height, 30000),
        random.integers(3, 15, 30000),
        random.integers(3, 15, 30000),
        random.integers(0, 256, 30000),
    ):
        image[y : y + h, x : x + w] = grey
    return image


class Walls:
    """A stereo camera that moves to the right before a wall: 6 pixels a frame, disparity 30."""

    def __init__(self):
        self.wall = texture(2000, 240, 1)

    def left(self, frame):
        return self.wall[:, 100 + 6 * frame : 740 + 6 * frame]

    def right(self, frame):
        return self.wall[:, 130 + 6 * frame : 770 + 6 * frame]


class RoundRoom:
    """A stereo camera that turns to the right on the spot in a round room (tests/library/round_room.h)."""

    def __init__(self):
        self.wall = texture(2513, 200, 3).astype(np.float64)

    def view(self, yaw, eye):
        radius, x0, z0 = 8.0, eye * 0.5 * np.cos(yaw), -eye * 0.5 * np.sin(yaw)
        across = (np.arange(480) - 240) / 400
        x, z = across * np.cos(yaw) + np.sin(yaw), np.cos(yaw) - across * np.sin(yaw)
        a, b = x * x + z * z, x0 * x + z0 * z
        depth = (np.sqrt(b * b + a * (radius**2 - x0**2 - z0**2)) - b) / a
        column = 2513 * (np.arctan2(x0 + depth * x, z0 + depth * z) / (2 * np.pi) + 0.5)
        row = 100 + 2513 / (2 * np.pi * radius) * depth * (np.arange(160)[:, None] - 80) / 400
        c, r = np.floor(column).astype(int), np.floor(row).astype(int)
        right, below = column - c, row - r
        pixel = lambda dc, dr: self.wall[r + dr, (c + dc) % 2513]
        upper = (1 - right) * pixel(0, 0) + right * pixel(1, 0)
        lower = (1 - right) * pixel(0, 1) + right * pixel(1, 1)
        return ((1 - below) * upper + below * lower + 0.5).astype(np.uint8)


def rig():
    return penumbra.Rig.stereo(fx=500, fy=500, cx=320, cy=120, width=640, height=240, baseline=0.5)


class SlamTest(unittest.TestCase):
    def test_follows_a_camera(self):
        walls, slam = Walls(), penumbra.Slam(rig())
        for frame in range(12):
            found = slam.track(0.1 * frame, walls.left(frame), walls.right(frame))
            self.assertEqual(found.state, penumbra.State.tracking, found.why_lost)
            self.assertAlmostEqual(found.T_world_camera[0, 3], 0.1 * frame, delta=0.02)
            self.assertEqual(found.T_world_camera.shape, (4, 4))
        self.assertEqual(found.covariance.shape, (6, 6))
        slam.finish()
        times, poses = slam.trajectory()
        self.assertEqual(times.shape, (12,))
        self.assertEqual(poses.shape, (12, 4, 4))
        shown = slam.snapshot()
        self.assertGreater(len(shown["points"]), 100)
        self.assertEqual(len(shown["points"]), len(shown["colours"]))
        truth = poses.copy()
        truth[:, 0, 3] += 5.0
        self.assertLess(penumbra.evaluate((times, truth), (times, poses))["rmse"], 1e-9)

    def test_tells_how_a_closed_loop_moved_the_map(self):
        room, told, step = RoundRoom(), [], np.radians(4)
        seen_as = 1 / 0.98  # turns are measured too large by a focal length that is too short
        camera = penumbra.Rig.stereo(fx=392, fy=392, cx=240, cy=80, width=480, height=160, baseline=0.5)
        slam = penumbra.Slam(camera, deterministic=True)
        slam.on_map_changed(told.append)
        before = np.eye(4)
        for frame in range(105):
            earlier = len(told)
            found = slam.track(0.1 * frame, room.view(frame * step, 0), room.view(frame * step, 1))
            for T_new_old in told[earlier:]:
                before = T_new_old @ before
            turned = np.linalg.inv(before) @ found.T_world_camera
            bent = 0.03 if len(told) > earlier else 0.01  # radians, a closed loop between the two frames
            self.assertAlmostEqual(np.arctan2(turned[0, 2], turned[2, 2]), seen_as * step if frame else 0, delta=bent)
            before = found.T_world_camera
        self.assertGreater(max(abs(np.arctan2(T[0, 2], T[2, 2])) for T in told), 0.05)

    def test_other_threads_run_meanwhile(self):
        walls, slam, seen = Walls(), penumbra.Slam(rig()), []
        ended = threading.Event()

        def look():
            while not ended.is_set():
                seen.append(len(slam.snapshot()["points"]))

        looker = threading.Thread(target=look)
        looker.start()
        for frame in range(8):
            slam.track(0.1 * frame, walls.left(frame), walls.right(frame))
        ended.set()
        looker.join()
        self.assertTrue(seen)

    def test_says_what_is_wrong(self):
        walls, slam = Walls(), penumbra.Slam(rig())
        with self.assertRaisesRegex(TypeError, "left: expected uint8"):
            slam.track(0.0, walls.left(0).astype(np.int32), walls.right(0))
        with self.assertRaisesRegex(ValueError, "side by side"):
            slam.track(0.0, walls.wall[:, ::2], walls.right(0))
        with self.assertRaisesRegex(RuntimeError, "expected 640 x 240 pixels"):
            slam.track(0.0, walls.left(0)[:100], walls.right(0))
        with self.assertRaisesRegex(RuntimeError, "right image"):
            slam.track(0.0, walls.left(0))
        with self.assertRaisesRegex(ValueError, "4 x 4"):
            slam.track(0.0, walls.left(0), walls.right(0), motion=np.eye(3))
        with self.assertRaisesRegex(RuntimeError, "nowhere"):
            penumbra.Rig.read("/nowhere/calibration.yaml")
        self.assertEqual(slam.track(0.0, walls.left(0), walls.right(0)).state, penumbra.State.tracking)

    def test_same_path_as_the_program(self):
        """Of an image folder, to the digits that the program writes."""
        with tempfile.TemporaryDirectory() as folder:
            folder, walls = pathlib.Path(folder), Walls()
            for side, image in (("left", walls.left), ("right", walls.right)):
                (folder / side).mkdir()
                for frame in range(10):
                    pixels = np.ascontiguousarray(image(frame))
                    header = b"P5\n%d %d\n255\n" % (pixels.shape[1], pixels.shape[0])
                    (folder / side / f"{frame:06}.pgm").write_bytes(header + pixels.tobytes())
            calibration = folder / "calibration.yaml"
            calibration.write_text(
                "sensor: stereo\nfx: 500\nfy: 500\ncx: 320\ncy: 120\nbaseline: 0.5\n"
                "width: 640\nheight: 240\nrate: 10\n"
            )
            out = folder / "out"
            command = [os.environ["PENUMBRA_BINARY"], "slam", str(folder), "--deterministic", "--out", str(out)]
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            _, written = penumbra.read_trajectory(str(out / "trajectory_tum.txt"))
            slam = penumbra.Slam(penumbra.Rig.read(str(calibration)), deterministic=True)
            for frame in range(10):
                slam.track(0.1 * frame, walls.left(frame), walls.right(frame))
            slam.finish()
            _, poses = slam.trajectory()
            np.testing.assert_allclose(poses, written, atol=2e-6)


class SegmenterTest(unittest.TestCase):
    def test_finds_things_in_either_order_of_colours(self):
        segmenter = penumbra.Segmenter(TINY, least_score=0.0)
        image = np.dstack([texture(320, 120, seed) for seed in (1, 2, 3)])
        swapped = np.ascontiguousarray(image[:, :, ::-1])
        found, again = segmenter.find(image), segmenter.find(swapped, rgb=True)
        self.assertEqual(len(found), len(again))
        for a, b in zip(found, again):
            self.assertEqual((a.class_name, a.score, a.box), (b.class_name, b.score, b.box))
            self.assertEqual(a.mask.dtype, np.uint8)
            np.testing.assert_array_equal(a.mask, b.mask)


if __name__ == "__main__":
    unittest.main()
