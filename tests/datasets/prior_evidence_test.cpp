// SPDX-License-Identifier: MIT
// The axes of normals and the kind of depth are told from true depth and from sparse points alone,
// in a room whose surfaces are known; noise tells nothing.
#include "datasets/prior_evidence.h"

#include <catch2/catch.hpp>

#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "tests/support/box_room.h"
#include "tests/support/stored_priors.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

constexpr ImageSize kSize{96, 72};

struct EvidenceRoom : TempFolder {
  std::vector<View> views = box_room_views(12, kSize, 0.5);

  // With `truth` there is true depth; without, only the points.
  explicit EvidenceRoom(bool truth) {
    write_easyvolcap(path(), views);
    if (!truth) fs::remove_all(path() / "gt");
  }
  void write(const char* prior, const std::function<Image(const View&)>& map) const {
    for (const View& view : views)
      write_png(path() / "diffrens" / prior / view.name / "000000.png", map(view));
  }
  Scene load(const PriorOptions& priors = {}) const {
    LoadOptions options;
    options.priors = priors;
    return load_scene(path(), options);
  }
};

bool has_note(const Scene& scene, const std::string& part) {
  return std::any_of(scene.data_notes.begin(), scene.data_notes.end(), [&](const auto& note) {
    UNSCOPED_INFO(note);
    return note.find(part) != std::string::npos;
  });
}

float mean_cosine(const Image& a, const Image& b) {
  float sum = 0;
  for (std::size_t i = 0; i < a.values().size(); ++i) sum += a.data()[i] * b.data()[i];
  return sum / static_cast<float>(a.num_pixels());
}

// Pearson's sign is enough here: does the prior grow with depth?
bool grows_with(const Image& prior, const Image& depth) {
  float near_sum = 0, far_sum = 0;
  int near_count = 0, far_count = 0;
  for (std::size_t i = 0; i < prior.num_pixels(); ++i) {
    const float z = depth.data()[i];
    (z < 1.5f ? near_sum : far_sum) += prior.data()[i];
    ++(z < 1.5f ? near_count : far_count);
  }
  REQUIRE((near_count > 50 && far_count > 50));
  return near_sum / static_cast<float>(near_count) < far_sum / static_cast<float>(far_count);
}

}  // namespace

TEST_CASE("normals in any of the axes are detected and turned") {
  const bool truth = GENERATE(true, false);
  const auto axes = static_cast<PriorAxes>(GENERATE(0, 1, 2, 3));
  const EvidenceRoom room(truth);
  INFO("truth " << truth << ", axes " << kPriorAxes[static_cast<std::size_t>(axes)]);
  room.write("normal", [&](const View& view) {
    return encoded(stored_normals(view.truth["normal"], axes, view.camera));
  });
  const Scene scene = room.load();
  CHECK(
      has_note(scene, fmt::format("{} axes, detected", kPriorAxes[static_cast<std::size_t>(axes)]))
  );
  for (std::size_t i = 0; i < scene.train.size(); ++i)
    for (const View& view : room.views)
      if (view.name == scene.train[i].name)
        CHECK(mean_cosine(scene.train[i].priors["normal"], view.truth["normal"]) > 0.98f);
}

TEST_CASE("depth of any kind is detected and grows with the distance afterwards") {
  const bool truth = GENERATE(true, false);
  const auto kind = static_cast<PriorDepth>(GENERATE(0, 1, 2));
  const EvidenceRoom room(truth);
  INFO("truth " << truth << ", kind " << kPriorDepths[static_cast<std::size_t>(kind)]);
  room.write("depth", [&](const View& view) { return stored_depth(view.truth["depth"], kind); });
  const Scene scene = room.load();
  CHECK(has_note(
      scene, fmt::format("depth priors: {}, detected", kPriorDepths[static_cast<std::size_t>(kind)])
  ));
  CHECK(grows_with(scene.train[3].priors["depth"], room.views[4].truth["depth"]));
}

TEST_CASE("priors of noise are undecided and stay as documented") {
  const bool truth = GENERATE(true, false);
  const EvidenceRoom room(truth);
  std::uint64_t seed = 0;
  room.write("normal", [&](const View&) { return noise_map(kSize, 3, ++seed); });
  room.write("depth", [&](const View&) { return noise_map(kSize, 1, ++seed); });
  const Scene scene = room.load();
  CHECK(has_note(scene, "normal priors: opencv axes, undecided"));
  CHECK(has_note(scene, "depth priors: linear, undecided"));
}

TEST_CASE("what is forced is taken, and the notes keep the evidence") {
  const EvidenceRoom room(false);
  const Scene scene = room.load({.axes = "opengl", .depth = "inverted"});
  CHECK(has_note(scene, "normal priors: opengl axes, as stated"));
  CHECK(has_note(scene, "opencv fits best"));
  CHECK(has_note(scene, "depth priors: inverted, as stated"));
  CHECK_FALSE(grows_with(scene.train[3].priors["depth"], room.views[4].truth["depth"]));
  CHECK_THAT(
      error_of(ExitCode::kUsage, [&] { room.load({.axes = "up"}); }),
      Contains("'up'; expected auto")
  );
}

TEST_CASE("the check names axes and depth that are not as documented, with points alone") {
  const EvidenceRoom room(false);
  CHECK(check_dataset(room.path()).empty());
  room.write("normal", [&](const View& view) {
    return encoded(stored_normals(view.truth["normal"], PriorAxes::kOpengl, view.camera));
  });
  room.write("depth", [](const View& view) {
    return stored_depth(view.truth["depth"], PriorDepth::kDisparity);
  });
  const auto has = [](const std::vector<Finding>& findings, const char* check, const char* part) {
    return std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) {
      UNSCOPED_INFO(finding.check << ": " << finding.message);
      return finding.check == check && finding.message.find(part) != std::string::npos;
    });
  };
  const std::vector<Finding> findings = check_dataset(room.path());
  CHECK(has(findings, "normal-axes", "opengl fits best"));
  CHECK(has(findings, "depth-polarity", "disparity found"));
  write_file(room.path() / "scene.json", R"({"prior_axes": "opengl", "prior_depth": "disparity"})");
  const std::vector<Finding> stated = check_dataset(room.path());
  for (const Finding& finding : stated) UNSCOPED_INFO(finding.check << ": " << finding.message);
  CHECK(stated.empty());
}
