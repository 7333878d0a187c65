# SPDX-License-Identifier: MIT
"""scripts/seen_through.py: which training views see a surface bare and which through glass, of a wall and a pane."""

import subprocess
import sys
import types
import unittest

from support import ROOT, RoomCase, np

sys.path.insert(0, str(ROOT / "scripts"))
import seen_through  # noqa: E402

import glint_bench  # noqa: E402

WALL = 2.0  # metres before all cameras


def view_of_wall(glass_columns, shift=0.0, wall=WALL):
    """8x4 pixels, one to the metre at the wall's depth; a pane 1 m off covers the columns. shift: metres to the right."""
    truth = {name: np.zeros((4, 8, 1), np.float32) for name in ("depth", "glass", "behind_depth")}
    truth["depth"][:] = wall
    truth["depth"][:, glass_columns] = 1
    truth["glass"][:, glass_columns] = 1
    truth["behind_depth"][:, glass_columns] = wall
    camera = glint_bench.Camera(8, 4, WALL, WALL, translation_cam_from_world=[-shift, 0, 0])
    return types.SimpleNamespace(camera=camera, truth=truth, image=np.full((4, 8, 3), 0.5, np.float32))


class SeenThrough(unittest.TestCase):
    def masks(self, *train):
        """Columns of each part; rows are alike."""
        parts = seen_through.parts_of(view_of_wall([7]), train)
        for mask in parts.values():
            self.assertTrue((mask == mask[0]).all())
        return {title: np.flatnonzero(mask[0]).tolist() for title, mask in parts.items()}

    def test_the_share_of_views_decides(self):
        parts = self.masks(view_of_wall([0, 1, 2, 3]), view_of_wall([2, 3]), view_of_wall([3]), view_of_wall([]))
        expected = {"glass": [7], "never": [4, 5, 6], "to 1/3": [0, 1], "to 2/3": [2], "above": [3]}
        self.assertEqual(parts, expected)

    def test_who_does_not_see_it_does_not_count(self):
        elsewhere = view_of_wall([], wall=1.5)  # something stands before the wall
        beside = view_of_wall([], shift=5)  # sees columns 5 and 6 of those that count
        parts = self.masks(view_of_wall([0, 5]), elsewhere, beside)
        expected = {"glass": [7], "never": [1, 2, 3, 4, 6], "to 1/3": [], "to 2/3": [5], "above": [0]}
        self.assertEqual(parts, expected)

    def test_what_none_sees_has_no_part(self):
        self.assertEqual(self.masks(view_of_wall([], shift=6))["never"], [6])

    def test_errors_of_a_part_are_pooled(self):
        view = view_of_wall([7])
        render = np.full((4, 8, 3), 0.6, np.float32)
        render[:, 0] = 7  # is clipped to 1
        errors = seen_through.squared_errors(types.SimpleNamespace(render=lambda _: {"rgb": render}), [view])
        columns = np.arange(8)[None].repeat(4, 0)
        self.assertEqual(seen_through.psnr(errors, [columns == 1]), "20.00")
        self.assertEqual(seen_through.psnr(errors, [columns < 2]), f"{-10 * np.log10((0.25 + 0.01) / 2):.2f}")
        self.assertEqual(seen_through.psnr(errors, [columns > 8]), "-")

    def test_picture_has_photo_and_runs_beside_each_other(self):
        view = view_of_wall([7])
        runs = [types.SimpleNamespace(render=lambda _, v=v: {"rgb": np.full((4, 8, 3), v, np.float32)}) for v in (0, 7)]
        sheet = seen_through.picture([view, view], runs)
        self.assertEqual((sheet.shape, sheet.dtype), ((8, 24, 3), np.uint8))
        self.assertEqual(sheet[5, [0, 8, 16], 1].tolist(), [128, 0, 255])


class Program(RoomCase):
    def seen_through(self, *arguments):
        command = [sys.executable, ROOT / "scripts/seen_through.py", self.room, *arguments]
        return subprocess.run(command, capture_output=True, text=True)

    def test_a_run_of_a_room(self):
        run = self.folder / "run"
        glint_bench.train(self.room, "2dgs", iterations=20, run=run)
        done = self.seen_through(run)
        self.assertEqual(done.returncode, 0, done.stderr)
        head, _, shares, row = done.stdout.splitlines()
        self.assertEqual(head, "| run | glass | never | to 1/3 | to 2/3 | above |")
        percent = [float(cell) for cell in shares.split("|")[2:-1]]
        self.assertGreater(percent[0], 5)
        self.assertLessEqual(sum(percent), 100.3)
        self.assertGreater(float(row.split("|")[2]), 5)

    def test_a_picture_needs_views_that_exist(self):
        picture = self.folder / "sheet.png"
        without = self.seen_through(self.folder, "--picture", picture)
        self.assertEqual(without.returncode, 2)
        self.assertIn("--picture and --views belong together", without.stderr)
        unknown = self.seen_through(self.folder, "--picture", picture, "--views", "nobody")
        self.assertEqual(unknown.returncode, 1)
        self.assertIn("no view nobody; expected names such as", unknown.stderr)
        self.assertFalse(picture.exists())


if __name__ == "__main__":
    unittest.main()
