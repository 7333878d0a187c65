# SPDX-License-Identifier: MIT
"""Scores of arrays are those of the programs, to the last digit, with their protocols and warnings."""

import unittest
import warnings

from support import ROOT, FolderCase, np, tool, write_lpips_weights

import glint_bench

RNG = np.random.default_rng(7)
SIZE = (37, 53)


def picture():
    return RNG.random((*SIZE, 3), dtype=np.float32)


def rows_of(document):
    """What a document says but for names of files."""
    images = [
        {key: image[key] for key in ("metrics", "warnings") if key in image} for image in document["images"]
    ]
    return {**{key: document[key] for key in ("tool", "num_images", "mean", "summary", "protocol")}, "images": images}


class Metrics(FolderCase):
    def pair(self, prediction, truth):
        return self.save("prediction.npy", prediction), self.save("truth.npy", truth)

    def check_same(self, name, prediction, truth, *options, **arguments):
        program = tool(name, *self.pair(prediction, truth), *options)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            arrays = getattr(glint_bench, name)(prediction, truth, **arguments)
        self.assertEqual(rows_of(arrays) | {"images": []}, rows_of(program) | {"images": []})
        self.assertEqual(
            [image["metrics"] for image in arrays["images"]], [image["metrics"] for image in program["images"]]
        )
        return arrays, [str(warning.message) for warning in caught]

    def test_psnr(self):
        truth = picture()
        arrays, _ = self.check_same("psnr", truth + 0.1 * picture(), truth)
        self.assertIn("clamp", arrays["protocol"]["psnr"])

    def test_psnr_of_eight_bits_is_that_of_a_picture_of_integers(self):
        render, truth = picture(), picture()
        stored = np.rint(render * 255).astype(np.uint8)
        program = tool("psnr", *self.pair(stored, truth))
        self.assertEqual(glint_bench.psnr(render, truth, eight_bit=True)["mean"], program["mean"])

    def test_masks_and_regions_of_glass(self):
        render, truth = picture(), picture()
        mask, glass = RNG.random(SIZE) > 0.3, np.zeros(SIZE, bool)
        glass[5:20, 8:30] = True
        files = {"--mask": self.save("mask.npy", mask.astype(np.uint8) * 255)}
        files["--glass"] = self.save("glass.npy", glass.astype(np.uint8) * 255)
        options = [word for pair in files.items() for word in pair]
        arrays, _ = self.check_same("psnr", render, truth, *options, mask=mask, glass=glass)
        self.assertIn("psnr@glass-border", arrays["mean"])
        for other in (glass.astype(np.uint8), glass.astype(np.float32)[..., None]):
            self.assertEqual(glint_bench.psnr(render, truth, mask, other)["mean"], arrays["mean"])

    def test_ssim(self):
        self.check_same("ssim", picture(), picture(), "--variant", "all", variant="all")

    def test_depth(self):
        truth = 1 + 3 * RNG.random((*SIZE, 1), dtype=np.float32)
        prediction = truth + 0.2 * RNG.random((*SIZE, 1), dtype=np.float32)
        prediction[:3] = 0
        self.check_same("depth", prediction, truth)
        self.check_same("depth", prediction[..., 0], truth[..., 0], "--align", "affine", align="affine")
        self.check_same("depth", prediction, truth, "--release", release=True)
        self.check_same("depth", prediction, truth, "--max-depth", 2.5, max_depth=2.5)
        self.check_same("depth", prediction, truth, "--ray", 50, 50, 26.5, 18.5, ray=(50, 50, 26.5, 18.5))

    def test_a_depth_in_other_units_is_told(self):
        truth = 1 + 3 * RNG.random((*SIZE, 1), dtype=np.float32)
        with self.assertWarnsRegex(glint_bench.GlintWarning, "millimetres"):
            scores = glint_bench.depth(1000 * truth, truth)
        self.assertIn("millimetres", scores["images"][0]["warnings"][0])

    def test_normal(self):
        normals = RNG.standard_normal((*SIZE, 3)).astype(np.float32)
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        turned = normals * np.float32([1, -1, -1])
        self.check_same("normal", turned, normals, "--axes", "opengl", axes="opengl")
        with self.assertWarnsRegex(glint_bench.GlintWarning, "opengl"):
            glint_bench.normal(turned, normals)

    def test_lists_are_folders(self):
        renders, truths = [picture() for _ in range(3)], [picture() for _ in range(3)]
        for name, images in (("renders", renders), ("truths", truths)):
            (self.folder / name).mkdir()
            for i, image in enumerate(images):
                np.save(self.folder / name / f"{i}.npy", image)
        program = tool("psnr", self.folder / "renders", self.folder / "truths")
        self.assertEqual(rows_of(glint_bench.psnr(renders, truths)), rows_of(program))

    def test_lpips(self):
        render = RNG.random((96, 80, 3), dtype=np.float32)
        truth = RNG.random((96, 80, 3), dtype=np.float32)
        file = self.folder / "lpips_alex_v0.1.safetensors"
        write_lpips_weights(file)
        self.check_same("lpips", render, truth, "--weights", file, weights=file)

    def test_without_weights_the_error_says_where_they_come_from(self):
        with self.assertRaisesRegex(glint_bench.GlintError, "fetch_lpips_weights.sh") as raised:
            glint_bench.lpips(picture(), picture(), weights=self.folder / "nowhere")
        self.assertEqual((raised.exception.code, raised.exception.exit_code), ("environment", 6))


class Meshes(FolderCase):
    MESHES = ROOT / "metrics/conformance/mesh"

    def read(self, name):
        """Vertices and faces of a binary PLY of ours."""
        data = (self.MESHES / name).read_bytes()
        header, _, body = data.partition(b"end_header\n")
        lines = header.decode().split("\n")
        num_vertices, num_faces = (int(line.split()[2]) for line in lines if line.startswith("element"))
        vertices = np.frombuffer(body, "<f4", 3 * num_vertices).reshape(-1, 3)
        faces = np.frombuffer(body[vertices.nbytes:], np.dtype([("count", "u1"), ("ids", "<i4", 3)]), num_faces)
        return vertices, faces["ids"]

    def check_same(self, prediction, reference, surfaces, *options, **arguments):
        program = tool("mesh", self.MESHES / prediction, self.MESHES / reference, "--samples", 5000, *options)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            arrays = glint_bench.mesh(*surfaces, samples=5000, **arguments)
        for name in ("prediction", "reference"):
            program.pop(name)
        self.assertEqual(arrays | {"warnings": []}, program | {"warnings": []})

    def test_meshes(self):
        names = ("sphere_095.ply", "sphere_100.ply")
        surfaces = [self.read(name) for name in names]
        self.check_same(*names, surfaces)
        self.check_same(
            *names, surfaces, "--thresholds", 0.02, 0.08, "--distance", "point-to-point", "--seed", 3,
            thresholds=(0.02, 0.08), distance="point-to-point", seed=3,
        )

    def test_points(self):
        points = RNG.random((400, 3), dtype=np.float32)
        scores = glint_bench.mesh(points, points, samples=400)
        self.assertEqual(scores["surfaces"]["prediction"], {"kind": "points", "num_samples": 400, "num_points": 400})
        self.assertEqual(scores["metrics"]["mesh-cd"], 0)

    def test_faces_are_checked(self):
        points = RNG.random((4, 3), dtype=np.float32)
        with self.assertRaisesRegex(ValueError, r"prediction\[1\]: face 0 has vertex 4 of 4"):
            glint_bench.mesh((points, np.array([[0, 1, 4]])), points)
        with self.assertRaisesRegex(TypeError, "integers"):
            glint_bench.mesh((points, np.array([[0.0, 1, 2]])), points)

    def test_what_no_camera_sees_is_left_out(self):
        sphere = self.read("sphere_100.ply")
        camera = glint_bench.Camera.look_at((0, 0, 4), (0, 0, 0), (0, 1, 0), width=64, height=64)
        scores = glint_bench.mesh(sphere, sphere, [camera], samples=2000)
        culling = scores["surfaces"]["prediction"]["culling"]
        self.assertLess(culling["faces_after"], culling["faces_split"])
        self.assertEqual(scores["protocol"]["cull"], "cameras")


class Refusals(unittest.TestCase):
    """What is wrong with an array, and what to do."""

    def check(self, error, text, render, truth=None, score=glint_bench.psnr):
        with self.assertRaises(error) as raised:
            score(render, picture() if truth is None else truth)
        self.assertEqual(str(raised.exception), text)

    def test_types(self):
        self.check(
            TypeError, "render: dtype float64; expected float32: give render.astype(numpy.float32)",
            picture().astype(np.float64),
        )
        self.check(
            TypeError,
            "render: dtype uint8; expected float32 in [0, 1]: give render.astype(numpy.float32) / 255",
            np.zeros((*SIZE, 3), np.uint8),
        )
        self.check(TypeError, "render: builtins.str; expected a NumPy array: give numpy.asarray(render)", "a.png")

    def test_shapes(self):
        cases = {
            "shape (3, 37, 53); expected [H][W][3]; channels come last: give numpy.moveaxis(render, 0, -1)":
                np.moveaxis(picture(), -1, 0),
            "shape (2, 37, 53, 3); expected [H][W][3]; several images are a list: give list(render)":
                np.stack([picture()] * 2),
            "shape (37, 53, 4); expected [H][W][3]; without alpha: give render[..., :3]":
                np.zeros((*SIZE, 4), np.float32),
            "shape (37, 53); expected [H][W][3]; grey to three channels: give numpy.stack([render] * 3, axis=-1)":
                np.zeros(SIZE, np.float32),
        }
        for text, array in cases.items():
            self.check(ValueError, "render: " + text, array)

    def test_what_a_refusal_says_is_enough(self):
        render = np.moveaxis((picture() * 255).astype(np.uint8), -1, 0)
        mended = np.moveaxis(render.astype(np.float32) / 255, 0, -1)
        self.assertIn("psnr", glint_bench.psnr(mended, picture())["mean"])

    def test_sizes(self):
        with self.assertRaisesRegex(glint_bench.GlintError, "render: 50 x 37 pixels, but truth has 53 x 37") as raised:
            glint_bench.psnr(picture()[:, :50], picture())
        self.assertEqual(raised.exception.code, "bad_prediction")
        self.assertEqual(raised.exception.cure, "render at the reference's size")
        with self.assertRaisesRegex(glint_bench.GlintError, "mask: mask of 3 x 3 pixels"):
            glint_bench.psnr(picture(), picture(), np.ones((3, 3), bool))
        with self.assertRaisesRegex(ValueError, "render: 2, truth: 1 images"):
            glint_bench.psnr([picture()] * 2, [picture()])

    def test_options_are_those_of_the_programs(self):
        with self.assertRaisesRegex(glint_bench.GlintError, "--variant: msssim not in") as raised:
            glint_bench.ssim(picture(), picture(), variant="msssim")
        self.assertEqual(raised.exception.exit_code, 1)


if __name__ == "__main__":
    unittest.main()
