# SPDX-License-Identifier: MIT
"""help() of everything public: what it is, shapes and units; errors have their fields; types are those of the stubs."""

import inspect
import pydoc
import re
import unittest

from support import ROOT

import glint_bench
from glint_bench import GlintError

SHAPED = ("psnr", "ssim", "lpips", "depth", "normal", "mesh", "glass", "score_view", "load_scene", "load_run",
          "load_model", "train", "read_records")


class Help(unittest.TestCase):
    def test_every_public_name_has_help(self):
        for name in glint_bench.__all__:
            text = inspect.getdoc(getattr(glint_bench, name))
            self.assertTrue(text and len(text) > 20, name)

    def test_functions_on_arrays_say_their_shapes(self):
        for name in SHAPED:
            self.assertRegex(inspect.getdoc(getattr(glint_bench, name)), r"\[[HNM]\]\[", name)

    def test_parameters_are_all_explained(self):
        for name in SHAPED:
            function = getattr(glint_bench, name)
            for parameter in inspect.signature(function).parameters:
                if parameter in ("folder", "path", "method", "model"):
                    continue
                self.assertRegex(inspect.getdoc(function), rf"\b{parameter}\b", f"{name}: {parameter}")

    def test_members_of_classes_say_what_they_are(self):
        for kind in (glint_bench.Camera, glint_bench.View, glint_bench.Scene, glint_bench.Run):
            for name, member in vars(kind).items():
                if not name.startswith("_"):
                    self.assertTrue(member.__doc__, f"{kind.__name__}.{name}")

    def test_help_reads(self):
        text = pydoc.plain(pydoc.render_doc(glint_bench))
        for word in ("psnr(", "class Run", "eight_bit: ", "[H][W][3]"):
            self.assertIn(word, text)

    def test_stubs_name_what_there_is(self):
        stub = (ROOT / "python/glint_bench/_glint_bench.pyi").read_text()
        compiled = {name for name in vars(glint_bench._glint_bench) if not name.startswith("_")}
        named = set(re.findall(r"^(?:class|def) (\w+)", stub, re.MULTILINE))
        self.assertEqual(named, compiled)
        for name in ("Camera", "View", "Scene", "Run"):
            body = re.search(rf"^class {name}:\n((?:    .*\n|\n)+)", stub, re.MULTILINE)[1]
            members = set(re.findall(r"^    (?:def )?([a-z]\w*)[:(]", body, re.MULTILINE))
            found = {member for member in vars(getattr(glint_bench, name)) if not member.startswith("_")}
            self.assertEqual(members, found, name)

    def test_docs_list_every_public_name(self):
        text = (ROOT / "docs/guide/python.md").read_text()
        for name in glint_bench.__all__:
            self.assertIn(f"`{name}", text)
        self.assertLess(len(text.split()), 601)


class Errors(unittest.TestCase):
    def test_fields(self):
        error = GlintError("data/room/intri.yml: no such file; add it", 3)
        self.assertEqual((error.code, error.exit_code), ("bad_reference", 3))
        self.assertEqual((error.file, error.cure), ("data/room/intri.yml", "add it"))
        self.assertEqual(str(error), "data/room/intri.yml: no such file; add it")
        bare = GlintError("something else", 6)
        self.assertEqual((bare.code, bare.file, bare.cure), ("environment", None, None))


if __name__ == "__main__":
    unittest.main()
