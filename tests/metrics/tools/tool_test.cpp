// SPDX-License-Identifier: MIT
// The four programs, called as main() calls them.
#include "metrics/tools/tool.h"

#include <unistd.h>
#include <catch2/catch.hpp>

#include <fstream>
#include <sstream>

#include "glint/core/error.h"
#include "glint/scene/camera.h"
#include "glint/scene/image_files.h"
#include "metrics/depth.h"
#include "metrics/psnr.h"
#include "metrics/ssim.h"
#include "tests/metrics/golden_images.h"
#include "tests/support/captured.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

constexpr int kWidth = 24, kHeight = 16;

struct Result {
  int code = 0;
  std::string out, err;
  Json json() const { return Json::parse(out); }
};

Result run(std::unique_ptr<MetricTool> tool, const std::vector<std::string>& args) {
  std::ostringstream out, err;
  std::vector<std::string> quiet = args;
  if (!quiet.empty()) quiet.push_back("--quiet");
  const int code = run_tool(*tool, quiet, out, err);
  return {code, out.str(), err.str()};
}
Result psnr_tool(const std::vector<std::string>& args) { return run(make_psnr_tool(), args); }
Result ssim_tool(const std::vector<std::string>& args) { return run(make_ssim_tool(), args); }
Result depth_tool(const std::vector<std::string>& args) { return run(make_depth_tool(), args); }
Result normal_tool(const std::vector<std::string>& args) { return run(make_normal_tool(), args); }

Image rendered() { return golden::rendered_image(kWidth, kHeight, 3); }
Image reference() { return golden::reference_image(kWidth, kHeight, 3); }

MaskImage left_half() {
  MaskImage mask(kWidth, kHeight, 1);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth / 2; ++x) mask.at(x, y) = 255;
  return mask;
}
void write_mask(const fs::path& path, const MaskImage& mask) {
  write_png(path, golden::make_image(kWidth, kHeight, 1, [&](int x, int y, int) {
              return mask.at(x, y) ? 1.0f : 0.0f;
            }));
}
void write_text(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

// NumPy's file of kWidth x kHeight values, or three of each.
void write_integers_npy(
    const fs::path& path, const std::string& type, int channels, const std::string& values
) {
  std::string header = fmt::format(
      "{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}, {}), }}\n",
      type,
      kHeight,
      kWidth,
      channels
  );
  const std::string length = {static_cast<char>(header.size()), '\0'};
  write_file(path, std::string("\x93NUMPY\x01\0", 8) + length + header + values);
}

// A run folder and a dataset folder with views named 2 and 10.
void write_run(const test::TempFolder& folder) {
  for (const char* view : {"2", "10"}) {
    write_exr(folder / "run/renders" / view / "rgb.exr", rendered());
    write_png(folder / "run/renders" / view / "rgb.png", rendered());
    write_png(folder / "data/images" / view / "000000.png", reference());
  }
}

// Reads references as write_png() stored them.
Image stored_reference(const test::TempFolder& folder) {
  write_png(folder / "stored.png", reference());
  return read_image(folder / "stored.png", 3);
}

}  // namespace

TEST_CASE("glint-psnr gives psnr for a float file and psnr-8bit for a PNG") {
  const test::TempFolder folder;
  write_run(folder);
  const std::string ref = folder / "data/images/2/000000.png";
  const Image truth = stored_reference(folder);
  const Json exr = psnr_tool({folder / "run/renders/2/rgb.exr", ref, "--json"}).json();
  const Json png = psnr_tool({folder / "run/renders/2/rgb.png", ref, "--json"}).json();
  CHECK(exr["mean"]["psnr"] == psnr(rendered(), truth));
  CHECK(png["mean"]["psnr-8bit"] == psnr_8bit(rendered(), truth));
  CHECK(exr["protocol"]["psnr"]["clamp"] == true);
  CHECK(png["protocol"]["psnr-8bit"]["eight_bit"] == true);
}

TEST_CASE("maps in memory are scored as files of floats are") {
  const test::TempFolder folder;
  const Image truth = stored_reference(folder);
  const std::unique_ptr<MetricTool> tool = make_psnr_tool();
  MapPair pair;
  pair.prediction = rendered(), pair.reference = truth, pair.family = 0;
  const ImageScores scores = score_maps(*tool, pair);
  REQUIRE(scores.scores.size() == 1);
  CHECK(scores.scores[0] == std::pair<std::string, double>("psnr", psnr(rendered(), truth)));
  pair.mask = MaskImage(kWidth - 1, kHeight, 1);
  CHECK_THROWS_WITH(score_maps(*tool, pair), Catch::Contains("mask"));
}

TEST_CASE("integers are told by what the file holds, whatever its name") {
  const test::TempFolder folder;
  const ByteImage bytes = to_bytes(rendered());
  write_integers_npy(
      folder / "bytes.npy", "|u1", 3, std::string(bytes.values().begin(), bytes.values().end())
  );
  write_npy(folder / "floats.npy", rendered());
  write_png16(folder / "words.png", Image(kWidth, kHeight, 1, 0.3f));
  const Image truth = stored_reference(folder);
  const auto means = [&](const char* prediction) -> Json {
    return psnr_tool({folder / prediction, folder / "stored.png", "--json"}).json()["mean"];
  };
  CHECK(means("bytes.npy") == Json{{"psnr-8bit", psnr_8bit(rendered(), truth)}});
  CHECK(means("floats.npy") == Json{{"psnr", psnr(rendered(), truth)}});
  CHECK(means("words.png").contains("psnr-8bit"));
}

TEST_CASE("a run folder is matched with a dataset folder by view name, in natural order") {
  const test::TempFolder folder;
  write_run(folder);
  const Result result = psnr_tool({folder / "run", folder / "data", "--json"});
  REQUIRE(result.code == 0);
  const Json json = result.json();
  CHECK(json["num_images"] == 2);
  CHECK(json["images"][0]["name"] == "2");
  CHECK(json["images"][1]["name"] == "10");
  CHECK(json["images"][0]["metrics"].contains("psnr"));
  const Json png =
      psnr_tool({folder / "run", folder / "data", "--json", "--pattern", "*.png"}).json();
  CHECK(png["images"][0]["metrics"].contains("psnr-8bit"));
}

TEST_CASE("files side by side are matched by stem, whatever the extension") {
  const test::TempFolder folder;
  for (const char* name : {"a", "b"}) {
    write_exr(folder / "pred" / (std::string(name) + ".exr"), rendered());
    write_png(folder / "ref" / (std::string(name) + ".png"), reference());
  }
  CHECK(psnr_tool({folder / "pred", folder / "ref", "--json"}).json()["num_images"] == 2);
}

TEST_CASE("names on one side only are an error unless allowed") {
  const test::TempFolder folder;
  write_run(folder);
  fs::remove_all(folder / "run/renders/10");
  const Result strict = psnr_tool({folder / "run", folder / "data"});
  CHECK(strict.code == 2);
  CHECK_THAT(strict.err, Catch::Contains("10 (no prediction)"));
  CHECK(strict.out.empty());
  const Json json =
      psnr_tool({folder / "run", folder / "data", "--allow-missing", "--json"}).json();
  CHECK(json["num_images"] == 1);
  CHECK(json["missing"] == Json{"10 (no prediction)"});
}

TEST_CASE("folders without a common name are an error even when names may be missing") {
  const test::TempFolder folder;
  write_png(folder / "pred/a.png", reference());
  write_png(folder / "ref/b.png", reference());
  CHECK(psnr_tool({folder / "pred", folder / "ref", "--allow-missing"}).code == 2);
}

TEST_CASE("globs pair files by what their wildcards stand for, in natural order") {
  const test::TempFolder folder;
  for (const int frame : {2, 10}) {
    write_png(folder / fmt::format("frame{}_rgb.png", frame), rendered());
    write_png(folder / fmt::format("frame{}_gt.png", frame), reference());
  }
  const Result result = psnr_tool({folder / "frame*_rgb.png", folder / "frame*_gt.png", "--json"});
  REQUIRE(result.code == 0);
  const Json images = result.json()["images"];
  REQUIRE(images.size() == 2);
  CHECK(images[0]["name"] == "2");
  CHECK(images[1]["name"] == "10");
  CHECK(psnr_tool({folder / "frame*_rgb.png", folder / "nothing*.png"}).code == 3);
  CHECK(psnr_tool({folder / "nothing*.png", folder / "frame*_gt.png"}).code == 2);
  fs::remove(folder / "frame10_gt.png");
  CHECK(psnr_tool({folder / "frame*_rgb.png", folder / "frame*_gt.png"}).code == 2);
}

TEST_CASE("a file whose name looks like a glob is a file") {
  const test::TempFolder folder;
  write_png(folder / "frame[1].png", rendered());
  write_png(folder / "gt.png", reference());
  CHECK(psnr_tool({folder / "frame[1].png", folder / "gt.png"}).code == 0);
}

TEST_CASE("two files of one name ask for a pattern") {
  const test::TempFolder folder;
  write_png(folder / "pred/a.png", reference());
  write_exr(folder / "pred/a.exr", reference());
  write_png(folder / "ref/a.png", reference());
  const Result result = psnr_tool({folder / "pred", folder / "ref"});
  CHECK(result.code == 2);
  CHECK_THAT(result.err, Catch::Contains("--pattern"));
  CHECK(psnr_tool({folder / "pred", folder / "ref", "--pattern", "*.exr"}).code == 0);
}

TEST_CASE("a mask file and a mask folder restrict the score") {
  const test::TempFolder folder;
  write_run(folder);
  write_mask(folder / "mask.png", left_half());
  for (const char* view : {"2", "10"})
    write_mask(folder / "masks" / (std::string(view) + ".png"), left_half());
  const double expected = psnr(rendered(), stored_reference(folder), left_half());
  for (const char* mask : {"mask.png", "masks"}) {
    const Result result =
        psnr_tool({folder / "run", folder / "data", "--mask", folder / mask, "--json"});
    REQUIRE(result.code == 0);
    CHECK(result.json()["images"][1]["metrics"]["psnr"] == expected);
  }
}

TEST_CASE("glass masks add the scores of their regions") {
  const test::TempFolder folder;
  write_run(folder);
  write_mask(folder / "glass.png", left_half());
  const Result result =
      ssim_tool({folder / "run", folder / "data", "--glass", folder / "glass.png", "--json"});
  const Json mean = result.json()["mean"];
  const Image truth = stored_reference(folder);
  CHECK(mean["ssim-3dgs@glass"] == ssim_3dgs(rendered(), truth, left_half()));
  CHECK(mean.contains("ssim-3dgs@glass-border"));
  CHECK(mean.contains("ssim-3dgs@opaque"));
}

TEST_CASE("bad masks are the reference's fault") {
  const test::TempFolder folder;
  write_run(folder);
  write_png(folder / "small.png", Image(3, 3, 1, 1.0f));
  write_mask(folder / "empty.png", MaskImage(kWidth, kHeight, 1));
  write_mask(folder / "masks/2.png", left_half());
  for (const char* mask : {"small.png", "empty.png", "masks", "absent.png"}) {
    CAPTURE(mask);
    CHECK(psnr_tool({folder / "run", folder / "data", "--mask", folder / mask}).code == 3);
  }
}

TEST_CASE("identical images are counted") {
  const test::TempFolder folder;
  write_png(folder / "a.png", reference());
  const Result result = psnr_tool({folder / "a.png", folder / "a.png"});
  CHECK(result.out == "psnr-8bit 100.0000 dB\nnum_identical 1\n");
}

TEST_CASE("CSV has a row per image, unrounded, and the mean") {
  const test::TempFolder folder;
  write_run(folder);
  const Result result = psnr_tool({folder / "run", folder / "data", "--csv"});
  std::istringstream lines(result.out);
  std::string header, first, second, mean;
  std::getline(lines, header), std::getline(lines, first);
  std::getline(lines, second), std::getline(lines, mean);
  CHECK(header == "name,psnr");
  CHECK(first.substr(0, 2) == "2,");
  CHECK(second.substr(0, 3) == "10,");
  CHECK(std::stod(mean.substr(5)) == psnr(rendered(), stored_reference(folder)));
}

TEST_CASE("without arguments the usage is printed and the exit code is 1") {
  for (auto make : {make_psnr_tool, make_ssim_tool, make_depth_tool, make_normal_tool}) {
    const Result result = run(make(), {});
    CHECK(result.code == 1);
    CHECK(result.out.empty());
    CHECK_THAT(result.err, Catch::Contains("PREDICTION"));
  }
}

TEST_CASE("--help succeeds and shows an example") {
  for (auto make : {make_psnr_tool, make_ssim_tool, make_depth_tool, make_normal_tool}) {
    const Result result = run(make(), {"--help"});
    CHECK(result.code == 0);
    CHECK_THAT(result.out, Catch::Contains("Example:"));
  }
}

TEST_CASE("unknown options and values are usage errors") {
  CHECK(psnr_tool({"a.png", "b.png", "--no-such-option"}).code == 1);
  CHECK(ssim_tool({"a.png", "b.png", "--variant", "median"}).code == 1);
  CHECK(depth_tool({"a.exr", "b.exr", "--align", "best"}).code == 1);
  CHECK(depth_tool({"a.exr", "b.exr", "--ray", "0", "1", "2", "3"}).code == 1);
  CHECK(normal_tool({"a.exr", "b.exr", "--axes", "vulkan"}).code == 1);
  CHECK(psnr_tool({"a.png"}).code == 1);
}

TEST_CASE("a file against a folder is a usage error") {
  const test::TempFolder folder;
  write_run(folder);
  CHECK(psnr_tool({folder / "run/renders/2/rgb.png", folder / "data"}).code == 1);
}

TEST_CASE("missing paths name the side at fault") {
  const test::TempFolder folder;
  write_png(folder / "a.png", reference());
  const Result prediction = psnr_tool({folder / "absent.png", folder / "a.png"});
  const Result truth = psnr_tool({folder / "a.png", folder / "absent.png"});
  CHECK(prediction.code == 2);
  CHECK(truth.code == 3);
  CHECK_THAT(truth.err, Catch::Contains("absent.png"));
}

TEST_CASE("empty folders name the side at fault") {
  const test::TempFolder folder;
  fs::create_directories(folder / "empty");
  write_png(folder / "full/a.png", reference());
  CHECK(psnr_tool({folder / "empty", folder / "full"}).code == 2);
  CHECK(psnr_tool({folder / "full", folder / "empty"}).code == 3);
}

TEST_CASE("damaged files name the side at fault") {
  const test::TempFolder folder;
  write_png(folder / "a.png", reference());
  const std::string bytes = read_file(folder / "a.png");
  write_text(folder / "cut.png", bytes.substr(0, bytes.size() / 2));
  CHECK(psnr_tool({folder / "cut.png", folder / "a.png"}).code == 2);
  CHECK(psnr_tool({folder / "a.png", folder / "cut.png"}).code == 3);
}

TEST_CASE("images of another size are the prediction's fault") {
  const test::TempFolder folder;
  write_png(folder / "a.png", reference());
  write_png(folder / "b.png", Image(5, 4, 3, 0.5f));
  const Result result = psnr_tool({folder / "b.png", folder / "a.png"});
  CHECK(result.code == 2);
  CHECK_THAT(result.err, Catch::Contains("5 x 4") && Catch::Contains("24 x 16"));
}

TEST_CASE("a prediction that is not finite is refused with its file and pixel") {
  const test::TempFolder folder;
  Image broken = rendered();
  broken.at(7, 3, 1) = std::numeric_limits<float>::quiet_NaN();
  write_exr(folder / "broken.exr", broken);
  write_png(folder / "a.png", reference());
  const Result result = psnr_tool({folder / "broken.exr", folder / "a.png"});
  CHECK(result.code == 2);
  CHECK_THAT(result.err, Catch::Contains("broken.exr") && Catch::Contains("(7, 3)"));
}

TEST_CASE("colours far outside of their range are told in every output") {
  const test::TempFolder folder;
  Image bytes = rendered();
  for (float& value : bytes.values()) value *= 255;
  write_exr(folder / "bytes.exr", bytes);
  write_png(folder / "a.png", reference());
  const std::vector<std::string> pair = {folder / "bytes.exr", folder / "a.png"};
  const Result text = psnr_tool(pair);
  CHECK(text.code == 0);
  CHECK_THAT(
      text.out,
      Catch::Contains("warning: ") && Catch::Contains("bytes.exr: values from") &&
          Catch::Contains("divide bytes by 255")
  );
  const Result json = psnr_tool({pair[0], pair[1], "--json"});
  REQUIRE(json.json()["images"][0]["warnings"].size() == 1);
  write_exr(folder / "good.exr", rendered());
  CHECK(
      psnr_tool({folder / "good.exr", folder / "a.png"}).out.find("warning") == std::string::npos
  );
  // A reference counts, too.
  CHECK_THAT(
      psnr_tool({folder / "good.exr", folder / "bytes.exr"}).out, Catch::Contains("values from")
  );
}

TEST_CASE("glint-ssim prints one variant or all") {
  const test::TempFolder folder;
  write_run(folder);
  const std::string pred = folder / "run/renders/2/rgb.exr",
                    ref = folder / "data/images/2/000000.png";
  const Image truth = stored_reference(folder);
  CHECK(ssim_tool({pred, ref, "--json"}).json()["mean"].size() == 1);
  const Json all = ssim_tool({pred, ref, "--json", "--variant", "all"}).json();
  CHECK(all["mean"]["ssim-3dgs"] == ssim_3dgs(rendered(), truth));
  CHECK(all["mean"]["ssim-wang"] == ssim_wang(rendered(), truth));
  CHECK(all["protocol"]["ssim-wang"]["border"] == "valid region");
}

TEST_CASE("a picture smaller than the window has no ssim-wang, which is told") {
  const test::TempFolder folder;
  write_png(folder / "a.png", Image(5, 3, 3, 0.5f));
  const std::string file = folder / "a.png";
  const Result wang = ssim_tool({file, file, "--variant", "wang"});
  CHECK(wang.code == 3);
  CHECK_THAT(wang.err, Catch::Contains("5 x 3 pixels is smaller than the window of 11 x 11"));
  const Result all = ssim_tool({file, file, "--variant", "all"});
  CHECK(all.code == 0);
  CHECK_THAT(
      all.out,
      Catch::StartsWith("ssim-3dgs 1.0") && Catch::Contains("a.png: ssim-wang is left out: the")
  );
}

TEST_CASE("glint-depth aligns on request and names the alignment in the id") {
  const test::TempFolder folder;
  const Image truth = golden::true_depth_map(kWidth, kHeight);
  write_exr(folder / "truth.exr", truth);
  write_exr(folder / "twice.exr", golden::make_image(kWidth, kHeight, 1, [&](int x, int y, int) {
              return 2 * truth.at(x, y);
            }));
  const std::vector<std::string> files = {folder / "twice.exr", folder / "truth.exr", "--json"};
  const auto with = [&](std::vector<std::string> extra) {
    extra.insert(extra.begin(), files.begin(), files.end());
    return depth_tool(extra).json();
  };
  CHECK(with({})["mean"]["depth-absrel"] == 1);
  CHECK(with({"--align", "median"})["mean"]["depth-absrel-median"] == Approx(0).margin(1e-7));
  CHECK(with({"--align", "affine"})["protocol"]["depth-absrel-affine"]["alignment"] == "affine");
  CHECK(with({"--release"})["mean"]["depth-delta1-release"] == 100);
}

TEST_CASE("glint-depth turns distances along rays into planar depth") {
  const test::TempFolder folder;
  const Camera camera{kWidth, kHeight, 20, 21, 12.5, 7.5};
  write_exr(folder / "truth.exr", Image(kWidth, kHeight, 1, 3.0f));
  write_exr(folder / "rays.exr", golden::make_image(kWidth, kHeight, 1, [&](int x, int y, int) {
              return static_cast<float>(3 * length(camera.ray_in_cam(x + 0.5, y + 0.5)));
            }));
  const std::string rays = folder / "rays.exr", truth = folder / "truth.exr";
  const Json made = depth_tool({rays, truth, "--json", "--ray", "20", "21", "12.5", "7.5"}).json();
  CHECK(made["mean"]["depth-absrel"] == Approx(0).margin(1e-7));
  CHECK(depth_tool({rays, truth, "--json"}).json()["mean"]["depth-absrel"] > 0.02);
}

TEST_CASE("a PNG holds no metric depth by itself") {
  const test::TempFolder folder;
  write_png(folder / "depth.png", golden::make_image(kWidth, kHeight, 1, [](int x, int, int) {
              return 0.2f + 0.02f * static_cast<float>(x);
            }));
  write_exr(folder / "truth.exr", golden::true_depth_map(kWidth, kHeight));
  CHECK(depth_tool({folder / "depth.png", folder / "truth.exr"}).code == 2);
  CHECK(depth_tool({folder / "truth.exr", folder / "depth.png"}).code == 3);
  CHECK(depth_tool({folder / "depth.png", folder / "truth.exr", "--align", "affine"}).code == 0);
}

TEST_CASE("integers of 16 bits hold no metric depth by themselves, whatever the file's name") {
  const test::TempFolder folder;
  write_integers_npy(folder / "depth.npy", "<u2", 1, std::string(2 * kWidth * kHeight, '\x7f'));
  write_exr(folder / "truth.exr", golden::true_depth_map(kWidth, kHeight));
  CHECK(depth_tool({folder / "depth.npy", folder / "truth.exr"}).code == 2);
  CHECK(depth_tool({folder / "truth.exr", folder / "depth.npy"}).code == 3);
}

TEST_CASE("a prediction of holes alone is the prediction's fault") {
  const test::TempFolder folder;
  write_exr(folder / "holes.exr", Image(kWidth, kHeight, 1));
  write_exr(folder / "depth.exr", Image(kWidth, kHeight, 1, 1.0f));
  const Result result = depth_tool({folder / "holes.exr", folder / "depth.exr", "--release"});
  CHECK(result.code == 2);
  CHECK_THAT(result.err, Catch::Contains("holes.exr: no pixel to score"));
}

TEST_CASE("a depth reference without any depth is the reference's fault") {
  const test::TempFolder folder;
  write_exr(folder / "none.exr", Image(kWidth, kHeight, 1));
  write_exr(folder / "depth.exr", Image(kWidth, kHeight, 1, 1.0f));
  CHECK(depth_tool({folder / "depth.exr", folder / "none.exr"}).code == 3);
}

TEST_CASE("glint-normal turns other axes into OpenCV's") {
  const test::TempFolder folder;
  const Image truth = golden::make_image(kWidth, kHeight, 3, [](int x, int y, int c) {
    return static_cast<float>(golden::unit_normal(x, y, c));
  });
  const auto flipped = [&](float sx, float sy, float sz) {
    return golden::make_image(kWidth, kHeight, 3, [&, sx, sy, sz](int x, int y, int c) {
      return (c == 0 ? sx : c == 1 ? sy : sz) * truth.at(x, y, c);
    });
  };
  write_exr(folder / "opencv.exr", truth, true);
  write_exr(folder / "opengl.exr", flipped(1, -1, -1), true);
  write_exr(folder / "stablenormal.exr", flipped(-1, -1, -1), true);
  for (const std::string axes : {"opencv", "opengl", "stablenormal"}) {
    const std::string file = folder / (axes + ".exr"), ref = folder / "opencv.exr";
    const Json json = normal_tool({file, ref, "--axes", axes, "--json"}).json();
    CHECK(json["mean"]["normal-mae"] == Approx(0).margin(1e-6));
    CHECK(json["protocol"]["normal-mae"]["prediction_axes"] == axes);
  }
  const Json wrong =
      normal_tool({folder / "stablenormal.exr", folder / "opencv.exr", "--json"}).json();
  CHECK(wrong["mean"]["normal-mae"] == Approx(180).epsilon(1e-6));
}

TEST_CASE("glint-normal decodes PNG maps, black being no normal") {
  const test::TempFolder folder;
  const Image truth = golden::make_image(kWidth, kHeight, 3, [](int x, int y, int c) {
    return static_cast<float>(golden::unit_normal(x, y, c));
  });
  write_exr(folder / "truth.exr", truth, true);
  write_png(folder / "coded.png", golden::make_image(kWidth, kHeight, 3, [&](int x, int y, int c) {
              return x < kWidth / 2 ? 0.5f * truth.at(x, y, c) + 0.5f : 0.0f;
            }));
  const Json mean =
      normal_tool({folder / "coded.png", folder / "truth.exr", "--json"}).json()["mean"];
  CHECK(mean["normal-coverage"] == 50);
  CHECK(mean["normal-mae"] == Approx(45).margin(0.2));  // half at 90, half at the rounding's 0.2
}

TEST_CASE("a normal map needs three channels") {
  const test::TempFolder folder;
  write_exr(folder / "grey.exr", Image(kWidth, kHeight, 1, 1.0f));
  write_exr(folder / "normal.exr", golden::true_normal_map(kWidth, kHeight), true);
  CHECK(normal_tool({folder / "grey.exr", folder / "normal.exr"}).code == 2);
  CHECK(normal_tool({folder / "normal.exr", folder / "grey.exr"}).code == 3);
}

TEST_CASE("output that cannot be written is an error of the environment") {
  const test::TempFolder folder;
  write_png(folder / "a.png", reference());
  std::ofstream full("/dev/full");
  std::ostringstream err;
  const auto tool = make_psnr_tool();
  CHECK(run_tool(*tool, {folder / "a.png", folder / "a.png"}, full, err) == 6);
  CHECK_THAT(err.str(), Catch::Contains("standard output cannot be written"));
  std::ofstream help("/dev/full");
  CHECK(run_tool(*tool, {"--help"}, help, err) == 6);
}

TEST_CASE("numbers on the command line are finite") {
  for (const char* number : {"nan", "-inf", "1e999"}) {
    const Result result = depth_tool({"a", "b", "--max-depth", number});
    CHECK(result.code == 1);
    CHECK_THAT(result.err, Catch::Contains("--max-depth"));
  }
}

TEST_CASE("counts on the command line are no more than can be counted") {
  const Result result = depth_tool({"a", "b", "--threads", "2000000000"});
  CHECK(result.code == 1);
  CHECK_THAT(
      result.err, Catch::Contains("--threads is 2000000000") && Catch::Contains("1000000000")
  );
}

TEST_CASE("a mask that leaves nothing out but may be in alpha is told of") {
  const test::TempFolder folder;
  // 4 x 3 pixels, white, grey with alpha.
  constexpr unsigned char kWhite[] = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
      0x52, 0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x03, 0x08, 0x04, 0x00, 0x00, 0x00, 0x1e,
      0xfd, 0x66, 0x4d, 0x00, 0x00, 0x00, 0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0xf8,
      0xdf, 0x00, 0x81, 0x0c, 0x18, 0x0c, 0x00, 0xf5, 0x73, 0x11, 0xf5, 0x29, 0x63, 0x55, 0xa9,
      0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  write_file(folder / "mask.png", std::string(std::begin(kWhite), std::end(kWhite)));
  write_png(folder / "a.png", Image(4, 3, 3, 0.5f));
  const std::string said = test::captured(2, [&] {
    CHECK(psnr_tool({folder / "a.png", folder / "a.png", "--mask", folder / "mask.png"}).code == 0);
  });
  CHECK_THAT(said, Catch::Contains("mask.png: white throughout"));
  CHECK(load_mask(folder / "mask.png", {4, 3}).at(0, 0) == 255);
}

TEST_CASE("names in CSV are no formulas, and messages show what a terminal would obey") {
  const test::TempFolder folder;
  for (const char* name : {"=1+1.png", "x.png"}) {
    write_png(folder / "a" / name, reference());
    write_png(folder / "b" / name, reference());
  }
  CHECK_THAT(psnr_tool({folder / "a", folder / "b", "--csv"}).out, Catch::Contains("\n'=1+1,"));
  const Result missing = psnr_tool({folder / "\x1b[2J.png", folder / "b/x.png"});
  CHECK_THAT(missing.err, Catch::Contains("\\x1b[2J.png"));
}
