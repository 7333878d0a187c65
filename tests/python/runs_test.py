# SPDX-License-Identifier: MIT
"""Scenes, runs, trainings and records: arrays equal the files that glint-bench writes; calls leave the interpreter's lock."""

import json
import signal
import subprocess
import sys
import threading
import time
import unittest

from support import BIN, RoomCase, np, run_program, tool

import glint_bench

STEPS = 40


def bench(*arguments):
    return run_program(BIN / "glint-bench", *arguments, "--quiet")


class Scenes(RoomCase):
    def test_arrays(self):
        scene = glint_bench.load_scene(self.room)
        self.assertEqual((scene.name, scene.dataset), ("room_1", "glassroom"))
        view = scene.test[0]
        self.assertEqual((view.image.shape, view.image.dtype), ((36, 64, 3), np.float32))
        self.assertFalse(view.image.flags.writeable)
        self.assertEqual(view.truth["depth"].shape, (36, 64, 1))
        self.assertEqual(scene.train[0].priors["normal"].shape, (36, 64, 3))
        self.assertIsNone(view.counted)
        self.assertEqual(scene.points["positions"].shape[1], 3)
        self.assertIn("test", scene.describe())

    def test_arrays_outlive_their_scene(self):
        scene = glint_bench.load_scene(self.room)
        image, points = scene.train[0].image, scene.points["positions"]
        expected = image.copy(), points.copy()
        self.assertTrue(np.shares_memory(image, scene.train[0].image))  # the scene's own memory
        del scene
        np.testing.assert_array_equal(image, expected[0])
        np.testing.assert_array_equal(points, expected[1])

    def test_options_and_errors(self):
        small = glint_bench.load_scene(self.room, max_pixels=600)
        self.assertLess(small.test[0].camera.width * small.test[0].camera.height, 600)
        with self.assertRaises(glint_bench.GlintError) as raised:
            glint_bench.load_scene(self.folder / "nowhere")
        self.assertEqual((raised.exception.code, raised.exception.exit_code), ("bad_reference", 3))
        self.assertIn("nowhere", raised.exception.file)

    def test_a_camera_projects_as_the_true_depth_says(self):
        view = glint_bench.load_scene(self.room).test[0]
        camera = view.camera
        x, y, depth = 20.5, 10.5, float(view.truth["depth"][10, 20, 0])
        in_cam = depth * np.array([(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1])
        world = camera.rotation_cam_from_world.T @ (in_cam - camera.translation_cam_from_world)
        np.testing.assert_allclose(camera.project(world[None])[0], [x, y, depth], rtol=1e-9)


class Lists(unittest.TestCase):
    def test_control_c_ends_them_before_the_next_image(self):
        image = np.zeros((540, 960, 3), np.float32)

        def stop(*_):
            raise KeyboardInterrupt

        before = signal.signal(signal.SIGALRM, stop)
        self.addCleanup(signal.signal, signal.SIGALRM, before)
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with self.assertRaises(KeyboardInterrupt):
            glint_bench.ssim([image] * 100_000, [image] * 100_000)  # for hours


class Cameras(unittest.TestCase):
    def test_look_at(self):
        camera = glint_bench.Camera.look_at((1, 2, 3), (1, 5, 3), width=60, height=40, fov_x_deg=90)
        np.testing.assert_allclose(camera.center, [1, 2, 3], atol=1e-12)
        np.testing.assert_allclose(camera.project([[1, 5, 3], [1, 5, 4]]), [[30, 20, 3], [30, 10, 3]], atol=1e-9)
        self.assertEqual(camera.with_size(60, 80).height, 80)

    def test_what_is_no_camera_is_refused(self):
        for text, arguments in {
            "expected 1 to 16384": {"width": 0},
            "expected pixels above 0": {"fx": 0},
            "no rotation": {"rotation_cam_from_world": 2 * np.eye(3)},
            r"expected shape \[3\]\[3\]": {"rotation_cam_from_world": np.eye(4)},
        }.items():
            with self.assertRaisesRegex(ValueError, text):
                glint_bench.Camera(**{"width": 6, "height": 4, "fx": 5, "fy": 5} | arguments)
        with self.assertRaisesRegex(ValueError, "along `up`"):
            glint_bench.Camera.look_at((0, 0, 0), (0, 0, 1), width=6, height=4)


class Trainings(RoomCase):
    def run_folder(self):
        return self.folder / "runs" / "run"

    def train(self, **options):
        arguments = {"method": "2dgs", "iterations": STEPS, "run": self.run_folder()} | options
        return glint_bench.train(self.room, **arguments)

    def test_a_run_equals_that_of_the_program(self):
        steps = []
        run = self.train(callback=lambda step, _: steps.append(step))
        self.assertEqual([step["iteration"] for step in steps], list(range(STEPS)))
        self.assertEqual(set(steps[0]), {"iteration", "loss", "psnr", "num_surfels", "terms", "sets", "events"})
        other = self.folder / "other" / "run"
        bench("train", "--dataset", self.room, "--method", "2dgs", "--iterations", STEPS, "--run", other)
        ours, theirs = (sorted(folder.glob("*.ply")) for folder in (self.run_folder(), other))
        self.assertEqual([file.name for file in ours], [file.name for file in theirs])
        self.assertEqual([file.read_bytes() for file in ours], [file.read_bytes() for file in theirs])
        self.assertEqual(run.num_surfels, steps[-1]["num_surfels"])

    def test_renders_and_scores_equal_those_of_the_program(self):
        self.train()
        bench("render", "--run", self.run_folder())
        bench("eval", "--run", self.run_folder(), "--out", self.folder / "out")
        run = glint_bench.load_run(self.run_folder())
        scored = json.loads((self.run_folder() / "metrics.json").read_text())
        for view, expected in zip(run.scene.test, scored["views"]):
            maps = run.render(view)
            scores = glint_bench.score_view(maps, view)
            found = {name: scores["metrics"][name] for name in scores["metrics"] if "fps" not in name}
            for name, value in found.items():
                self.assertEqual(expected["metrics"][name], value, name)
            self.assertGreater(len(found), 20)
            np.save(self.folder / "truth.npy", view.image)
            file = self.run_folder() / "renders" / view.name / "rgb.exr"
            program = tool("psnr", file, self.folder / "truth.npy")
            self.assertEqual(glint_bench.psnr(maps["rgb"], view.image)["mean"], program["mean"])
            self.assertIn("psnr@glass", glint_bench.glass(maps, view)["metrics"])
            self.assertNotIn("psnr", glint_bench.glass(maps, view)["metrics"])
        rows = glint_bench.read_records(self.folder / "out" / "single" / "records.jsonl")
        self.assertEqual((rows[0]["method"], rows[0]["status"]), ("2dgs", "ok"))
        self.assertEqual(rows[0]["psnr"], scored["metrics"]["psnr"])
        self.assertFalse(any(isinstance(value, dict) for value in rows[0].values()))

    def test_a_model_renders_as_its_run(self):
        run = self.train()
        model = glint_bench.load_model(sorted(self.run_folder().glob("*.ply"))[0], self.room)
        self.assertIsNone(model.folder)
        camera = run.scene.test[0].camera
        np.testing.assert_array_equal(model.render(camera)["rgb"], run.render(camera)["rgb"])

    def test_in_memory_it_is_the_same(self):
        scene = glint_bench.load_scene(self.room)
        before = set(self.folder.iterdir())
        run = glint_bench.train(scene, "2dgs", iterations=STEPS)
        self.assertEqual(set(self.folder.iterdir()), before)
        self.assertIsNone(run.folder)
        camera = scene.test[0].camera
        np.testing.assert_array_equal(run.render(camera)["rgb"], self.train().render(camera)["rgb"])

    def test_callbacks_render(self):
        scores = []

        def score(step, run):
            view = run.scene.test[0]
            scores.append(glint_bench.psnr(run.render(view)["rgb"], view.image)["mean"]["psnr"])

        self.train(callback=score, callback_every=15)
        self.assertEqual(len(scores), 3)  # 15, 30 and the last

    def test_what_a_callback_raises_ends_the_training_and_it_goes_on(self):
        class Enough(Exception):
            pass

        kept = []

        def stop(step, run):
            kept.append(run)
            if step["iteration"] == 20:
                raise Enough

        with self.assertRaises(Enough):
            self.train(callback=stop)
        with self.assertRaisesRegex(glint_bench.GlintError, "ended by an exception"):
            kept[0].render(kept[0].scene.test[0])
        steps = []
        run = self.train(callback=lambda step, _: steps.append(step["iteration"]))
        self.assertEqual(steps[0], 21)
        whole = self.train(run=self.folder / "whole" / "run")
        camera = run.scene.test[0].camera
        np.testing.assert_array_equal(run.render(camera)["rgb"], whole.render(camera)["rgb"])

    def test_settings_and_errors(self):
        run = self.train(settings={"lambda_ssim": 0.25, "depth": "median"})
        self.assertEqual((run.config["lambda_ssim"], run.config["depth"]), (0.25, "median"))
        with self.assertRaisesRegex(glint_bench.GlintError, "no field 'nonsense'"):
            self.train(settings={"nonsense": 1}, run=None)
        with self.assertRaises(glint_bench.GlintError) as raised:
            self.train(iterations=STEPS + 1)
        self.assertEqual(raised.exception.exit_code, 1)
        with self.assertRaisesRegex(TypeError, "expected its folder"):
            glint_bench.train(glint_bench.load_scene(self.room), "2dgs", run=self.folder / "x")

    def test_other_threads_run_meanwhile(self):
        count, done = 0, threading.Event()

        def work():
            nonlocal count
            while not done.is_set():
                count += 1
                time.sleep(0.001)

        thread = threading.Thread(target=work)
        thread.start()
        before = count
        start = time.perf_counter()
        glint_bench.train(self.room, "2dgs", iterations=150)
        seconds, during = time.perf_counter() - start, count - before
        done.set()
        thread.join()
        self.assertGreater(during, 20 * seconds)  # it never gets to run where the lock is kept

    def test_control_c(self):
        script = f"""
import glint_bench
def told(step, run):
    if step["iteration"] == 20: print("on its way", flush=True)
try:
    glint_bench.train({str(self.room)!r}, "2dgs", iterations=100000, run={str(self.run_folder())!r}, callback=told)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
        with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "on its way\n")
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.stdout.readline(), "interrupted\n")
        self.assertEqual(process.returncode, 0)

        class Enough(Exception):
            pass

        def first(step, run):
            self.assertGreater(step["iteration"], 20)
            raise Enough

        with self.assertRaises(Enough):
            self.train(iterations=100000, callback=first)


if __name__ == "__main__":
    unittest.main()
