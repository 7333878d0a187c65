// SPDX-License-Identifier: MIT
// glint-lpips and the ids of views, with weights that nobody published.
#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "glint/scene/image_files.h"
#include "metrics/lpips.h"
#include "metrics/tools/tool.h"
#include "tests/metrics/golden_images.h"
#include "tests/metrics/tiny_lpips.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kWidth = 48, kHeight = 40;

struct Result {
  int code = 0;
  std::string out, err;
};

Result lpips_tool(std::vector<std::string> args) {
  std::ostringstream out, err;
  args.push_back("--quiet");
  const int code = run_tool(*make_lpips_tool(), args, out, err);
  return {code, out.str(), err.str()};
}

bool contains(const std::string& text, const std::string& part) {
  INFO(text);
  return text.find(part) != std::string::npos;
}

// Two folders with one picture each, and the weights of AlexNet, random.
struct Files {
  TempFolder folder;
  Files() {
    write_npy(folder / "a/x.npy", golden::prediction_image(kWidth, kHeight, 3));
    write_npy(folder / "b/x.npy", golden::reference_image(kWidth, kHeight, 3));
    write_weights(folder / "lpips_alex_v0.1.safetensors", random_arrays(lpips_networks()[0]));
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::vector<std::string> arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> args = {path("a"), path("b")};
    args.insert(args.end(), more.begin(), more.end());
    return args;
  }
};

}  // namespace

TEST_CASE("glint-lpips without weights says where to put them, and exits with 6") {
  const Files files;
  const Result result = lpips_tool(files.arguments({"--weights", files.path("none")}));
  CHECK(result.code == 6);
  CHECK(result.out.empty());
  for (const char* part :
       {"lpips_alex_v0.1.safetensors", "convert_lpips_weights.py", "GLINT_LPIPS_WEIGHTS"})
    CHECK(contains(result.err, part));
  CHECK(contains(result.err, files.path("none")));
}

TEST_CASE("glint-lpips with damaged weights, or another network's, exits with 6") {
  const Files files;
  write_file(files.folder / "bad.safetensors", "text");
  const Result bad = lpips_tool(files.arguments({"--weights", files.path("bad.safetensors")}));
  CHECK(bad.code == 6);
  CHECK(contains(bad.err, "bad.safetensors: 4 bytes, too few for a header"));
  const std::string weights = files.path("lpips_alex_v0.1.safetensors");
  CHECK(lpips_tool(files.arguments({"--weights", weights, "--net", "vgg"})).code == 6);
}

TEST_CASE("glint-lpips prints the library's value with the network in its name, and its protocol") {
  const Files files;
  const std::string file = files.path("lpips_alex_v0.1.safetensors");
  const Result result = lpips_tool(files.arguments({"--weights", file, "--json"}));
  REQUIRE(result.code == 0);
  const Json json = Json::parse(result.out);
  Lpips lpips(lpips_weights_at(file, "alex"));
  const double expected = lpips.distance(
      golden::prediction_image(kWidth, kHeight, 3), golden::reference_image(kWidth, kHeight, 3)
  );
  CHECK(json["mean"]["lpips-alex"] == expected);
  const Json protocol = json["protocol"]["lpips-alex"];
  CHECK(protocol["network"] == "alex");
  CHECK(protocol["range"] == "[-1, 1]");
  CHECK(protocol["weights"] == "unknown");
  CHECK(protocol["sha256"] == lpips.weights().sha256);
}

TEST_CASE("glint-lpips in the range of 3DGS has another name and another value") {
  const Files files;
  const auto value = [&](const char* range, const char* id) {
    const Result result = lpips_tool(files.arguments(
        {"--weights", files.folder.path().string(), "--net", "alex", "--range", range, "--json"}
    ));
    REQUIRE(result.code == 0);
    return Json::parse(result.out)["mean"][id].get<double>();
  };
  CHECK(value("lpips", "lpips-alex") != value("3dgs", "lpips-alex-3dgs"));
}

TEST_CASE("glint-lpips averages the enlarged map over a mask and over glass") {
  const Files files;
  MaskImage left(kWidth, kHeight, 1);
  Image picture(kWidth, kHeight, 1);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth / 2; ++x) left.at(x, y) = 255, picture.at(x, y) = 1;
  write_png(files.folder / "m/x.png", picture);
  const std::string file = files.path("lpips_alex_v0.1.safetensors");
  const auto means = [&](const char* option) {
    const Result result =
        lpips_tool(files.arguments({"--weights", file, option, files.path("m"), "--json"}));
    REQUIRE(result.code == 0);
    return Json::parse(result.out)["mean"];
  };
  Lpips lpips(lpips_weights_at(file, "alex"));
  const double expected = lpips.distance(
      golden::prediction_image(kWidth, kHeight, 3),
      golden::reference_image(kWidth, kHeight, 3),
      left
  );
  CHECK(means("--mask")["lpips-alex"] == expected);
  CHECK(means("--glass")["lpips-alex@glass"] == expected);
}

TEST_CASE("Views have LPIPS where weights are, and say that the others have none") {
  const Files files;
  ::setenv("GLINT_LPIPS_WEIGHTS", files.folder.path().c_str(), 1);  // looked at once in a process
  const auto missing = missing_metrics();
  CHECK(missing.count("lpips-alex") == 0);
  for (const char* id : {"lpips-vgg", "lpips-vgg-3dgs"}) CHECK(missing.at(id) == "no weights");
  const Image prediction = golden::prediction_image(kWidth, kHeight, 3);
  const Image reference = golden::reference_image(kWidth, kHeight, 3);
  ViewPair pair;
  pair.rendered["rgb"] = prediction, pair.truth["rgb"] = reference;
  const auto scores = evaluate_view(pair);
  Lpips lpips(lpips_weights_at(files.folder.path(), "alex"));
  CHECK(scores.at("lpips-alex") == lpips.distance(prediction, reference));
  CHECK(scores.count("lpips-vgg") == 0);
  CHECK(metric_protocols()["lpips-alex"]["sha256"] == lpips.weights().sha256);
  CHECK_FALSE(metric_protocols()["lpips-vgg"].contains("sha256"));
}
