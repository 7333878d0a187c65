// SPDX-License-Identifier: MIT
// Every format: what is exported is read back by its loader.
#include "datasets/export/exporter.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "datasets/counted_pixels.h"
#include "datasets/dataset.h"
#include "datasets/side_maps.h"
#include "glint/core/config.h"
#include "glint/core/progress.h"
#include "glint/core/rng.h"
#include "tests/support/box_room.h"
#include "tests/support/image_difference.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

constexpr ImageSize kSize{48, 36};

// Pictures of 8 bits, a glass mask, all priors.
void fill_maps(View& view) {
  for (float& value : view.rgb.values()) value = std::nearbyint(255 * value) / 255;
  Image glass(kSize.width, kSize.height, 1), relative = view.truth["depth"];
  for (int x = 10; x < 30; ++x) glass.at(x, 20) = 1;
  for (float& value : relative.values()) value *= 0.2f;
  view.truth["glass"] = glass;
  view.priors["depth"] = relative;
  view.priors["albedo"] = view.priors["basecolor"] = view.rgb;
}

// 17 views, of which every 8th is a test view.
Scene room() {
  set_quiet(true);
  Scene scene;
  scene.name = "box";
  scene.dataset = "rooms";
  scene.spec_hash = "abc";
  scene.simulated_priors = true;
  std::vector<View> views = box_room_views(17, kSize, 0.1);
  for (std::size_t i = 0; i < views.size(); ++i) {
    fill_maps(views[i]);
    (i % 8 == 0 ? scene.test : scene.train).push_back(views[i]);
  }
  scene.points.positions = {{0.1f, 2, 1}, {1, 2, 1e-7f}, {3, 1, 2}, {2, 2, 2}};
  scene.points.colors = {{0, 1, 0.2f}, {0.4f, 0, 1}, {1, 1, 1}, {0.6f, 0.8f, 0}};
  set_extent(scene);
  return scene;
}

struct Exported : TempFolder {
  fs::path folder = path() / "out";
  ExportReport report;

  explicit Exported(
      const std::string& format, const Scene& scene = room(), ExportSplit split = ExportSplit::kAll
  )
      : report(export_scene(scene, folder, {format, split})) {}

  bool notes(const std::string& text) const {
    return std::any_of(report.notes.begin(), report.notes.end(), [&](const std::string& note) {
      return note.find(text) != std::string::npos;
    });
  }
};

std::vector<std::string> formats() {
  std::vector<std::string> ids;
  for (const auto& [id, exporter] : Registry<ExporterSpec>::all()) ids.push_back(id);
  return ids;
}

void check_camera(const Camera& a, const Camera& b) {
  CHECK(a.size() == b.size());
  for (const auto field : {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy})
    CHECK(std::abs(a.*field - b.*field) < 1e-6);
  CHECK(length(a.translation_cam_from_world - b.translation_cam_from_world) < 1e-6);
  for (int i = 0; i < 3; ++i)
    CHECK(length(a.rotation_cam_from_world.rows[i] - b.rotation_cam_from_world.rows[i]) < 1e-6);
}

// How far a map may be off: of a format with a place for all maps, and of side maps.
float tolerance(const MapRow& row, bool is_prior, bool has_scene_maps) {
  if (row.kind == MapKind::kNormal) return is_prior ? 0.012f : 0;  // 8 bits, then made unit
  if (is_prior && row.kind == MapKind::kDepth) return has_scene_maps ? 1e-4f : 1e-5f;
  if (is_prior) return 1e-6f;
  return row.id == "depth" && !has_scene_maps ? 0.5e-3f + 1e-6f : 0;  // millimetres
}

void check_maps(const View& original, const View& loaded, const ExporterSpec& exporter) {
  const auto check_set = [&](const MapSet& a, const MapSet& b, bool is_prior) {
    for (const MapRow& row : maps()) {
      const fs::path side =
          is_prior ? side_prior_file(row, original.name) : side_truth_file(row, original.name);
      INFO(original.name << " " << row.id << (is_prior ? " prior" : " truth"));
      const bool has_place = exporter.has_scene_maps || !side.empty();
      REQUIRE(b.has(row) == (a.has(row) && has_place));
      if (b.has(row))
        CHECK(
            largest_difference(a[row], b[row]) <= tolerance(row, is_prior, exporter.has_scene_maps)
        );
    }
  };
  check_set(original.priors, loaded.priors, true);
  check_set(original.truth, loaded.truth, false);
}

void check_views(
    const std::vector<View>& a, const std::vector<View>& b, const ExporterSpec& exporter
) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i].name == b[i].name);
    check_camera(a[i].camera, b[i].camera);
    CHECK(largest_difference(a[i].rgb, b[i].rgb) < 1e-6f);
    check_maps(a[i], b[i], exporter);
  }
}

void check_scene(const Scene& a, const Scene& b, const ExporterSpec& exporter) {
  CHECK(a.name == b.name);
  CHECK(a.dataset == b.dataset);
  CHECK(b.simulated_priors);
  CHECK(a.spec_hash != b.spec_hash);  // rounded: not the same data
  check_views(a.train, b.train, exporter);
  check_views(a.test, b.test, exporter);
  REQUIRE(a.points.positions.size() == b.points.positions.size());
  for (std::size_t i = 0; i < a.points.positions.size(); ++i) {
    CHECK(a.points.positions[i].x == b.points.positions[i].x);
    CHECK(a.points.positions[i].z == b.points.positions[i].z);
    CHECK(length(a.points.colors[i] - b.points.colors[i]) < 1e-6f);
  }
  CHECK(b.points.normals.empty());
}

// Test views' names as they were: without the number in front.
std::vector<std::string> plain_names(const std::vector<View>& views) {
  std::vector<std::string> names;
  for (const View& view : views) {
    const std::size_t from = view.name.find('f');
    names.push_back(view.name.substr(from == std::string::npos ? 0 : from));
  }
  return names;
}

}  // namespace

TEST_CASE("every format gives back cameras, pictures, points, split and maps") {
  const Scene scene = room();
  REQUIRE(formats() == std::vector<std::string>{"blender", "colmap", "easyvolcap", "nerfstudio"});
  for (const auto& [id, exporter] : Registry<ExporterSpec>::all()) {
    INFO(id);
    const Exported exported(id, scene);
    CHECK(find_loader(exported.folder).name == id);
    check_scene(scene, load_scene(exported.folder, {}), exporter);
    std::string findings;
    for (const Finding& finding : check_dataset(exported.folder))
      findings += finding.check + ": " + finding.where + ": " + finding.message + "\n";
    CHECK(findings == "");
    CHECK(exported.notes("split: "));
    CHECK(exported.notes("simulated"));
    CHECK(!exported.report.parts.empty());
    // Nothing under a temporary name.
    CHECK(std::distance(fs::directory_iterator(exported.path()), {}) == 1);
  }
}

TEST_CASE("every format but blender's takes any pinhole camera and one of its own a view") {
  Scene scene = room();
  for (View& view : scene.train) view.camera.cx += 1.2345678901, view.camera.fy *= 1.1;
  scene.train[3].camera.fx *= 1.01;
  for (const auto& [id, exporter] : Registry<ExporterSpec>::all()) {
    INFO(id);
    const TempFolder folder;
    if (id == "blender") {
      CHECK_THAT(
          error_of(ExitCode::kUsage, [&] { export_scene(scene, folder / "out", {id}); }),
          Contains("view 0001") && Contains("principal point (25.2346, 18)") &&
              Contains("--format colmap or nerfstudio")
      );
      CHECK(fs::is_empty(folder.path()));  // nothing half done is left
      continue;
    }
    export_scene(scene, folder / "out", {id});
    check_scene(scene, load_scene(folder / "out", {}), exporter);
  }
}

TEST_CASE("every format keeps a split that is not every 8th view") {
  Scene scene = room();
  scene.train.push_back(scene.test.back());  // 0016
  scene.test.pop_back();
  std::swap(scene.test[1], scene.train[4]);  // 0008 and 0005
  std::sort(scene.train.begin(), scene.train.end(), [](const View& a, const View& b) {
    return a.name < b.name;
  });
  for (const std::string& id : formats()) {
    INFO(id);
    const Exported exported(id, scene);
    const Scene loaded = load_scene(exported.folder, {});
    REQUIRE(loaded.test.size() == 2);
    CHECK(loaded.test[0].name == "0000");
    CHECK(loaded.test[1].name == "0005");
    CHECK(loaded.train.size() == 15);
    CHECK(
        find_loader(exported.folder).split_rule(exported.folder).find("every") == std::string::npos
    );
    if (id == "colmap") CHECK(exported.notes("NOT the split of this scene"));
  }
}

TEST_CASE("pictures are numbered where names are in another order for programs than for people") {
  Scene scene = room();
  int i = 0;
  std::vector<View*> views;
  for (std::vector<View>* list : {&scene.train, &scene.test})
    for (View& view : *list) views.push_back(&view);
  std::sort(views.begin(), views.end(), [](const View* a, const View* b) {
    return a->name < b->name;
  });
  for (View* view : views) view->name = fmt::format("f.a/{}", i++);  // f.a/10 before f.a/9
  for (const std::string& id : formats()) {
    INFO(id);
    const Exported exported(id, scene);
    const Scene loaded = load_scene(exported.folder, {});
    REQUIRE(loaded.test.size() == 3);
    CHECK(loaded.test[1].name == "0008_f_a_8");
    CHECK(loaded.train[9].name == "0011_f_a_11");
    CHECK(exported.notes("go back by the order"));
  }
}

TEST_CASE("a COLMAP export makes the test views every 8th where their number allows") {
  Scene scene = room();
  for (std::vector<View>* list : {&scene.train, &scene.test})
    for (View& view : *list) view.name = "f" + view.name;
  std::swap(scene.test[1], scene.train[4]);  // f0005 for f0008: still three of seventeen
  std::sort(scene.train.begin(), scene.train.end(), [](const View& a, const View& b) {
    return a.name < b.name;
  });
  const Exported exported("colmap", scene);
  CHECK(exported.notes("pictures are numbered so that every 8th"));
  const Scene by_list = load_scene(exported.folder, {});
  CHECK(plain_names(by_list.test) == std::vector<std::string>{"f0000", "f0005", "f0016"});
  CHECK(by_list.test[1].name == "0008_f0005");
  CHECK(by_list.test[1].truth.has("glass"));  // its maps went with it
  check_camera(by_list.test[1].camera, scene.test[1].camera);
  // As 3DGS and gsplat split it, which do not read the list.
  fs::remove(exported.folder / "sparse/0/test.txt");
  CHECK(plain_names(load_scene(exported.folder, {}).test) == plain_names(by_list.test));
}

TEST_CASE("--split writes the views of one kind") {
  const Scene scene = room();
  for (const std::string& id : formats()) {
    INFO(id);
    const Exported exported(id, scene, ExportSplit::kTrain);
    const Scene loaded = load_scene(exported.folder, {});
    CHECK(loaded.train.size() == 14);
    CHECK(loaded.test.empty());
    const Exported test("blender", scene, ExportSplit::kTest);
    CHECK_THAT(bad_reference([&] { load_scene(test.folder, {}); }), Contains("no train views"));
  }
  Scene no_test = scene;
  no_test.test.clear();
  const TempFolder folder;
  CHECK_THAT(
      error_of(
          ExitCode::kUsage,
          [&] {
            export_scene(no_test, folder / "out", {"colmap", ExportSplit::kTest});
          }
      ),
      Contains("no views")
  );
}

TEST_CASE("what 8 bits and 65 metres do not hold is said") {
  Scene scene = room();
  scene.train[0].rgb.at(3, 4, 1) = 1.5f;
  scene.train[1].rgb.at(3, 4, 1) = 0.50001f;
  scene.train[2].truth["depth"].at(5, 6) = 70;
  const Exported exported("nerfstudio", scene);
  CHECK(exported.notes("1 values outside of [0, 1]"));
  CHECK(exported.notes("finer than 8 bits"));
  CHECK(exported.notes("1 pixels beyond 65.535 m"));
  const Scene loaded = load_scene(exported.folder, {});
  CHECK(loaded.train[0].rgb.at(3, 4, 1) == 1);
  CHECK(loaded.train[2].truth["depth"].at(5, 6) == 0);
  const Exported exact("nerfstudio");
  CHECK_FALSE(exact.notes("8 bits"));
}

TEST_CASE("a scene without points and maps is exported without them") {
  Scene scene = room();
  scene.points = {};
  for (std::vector<View>* views : {&scene.train, &scene.test})
    for (View& view : *views) view.priors = view.truth = {};
  for (const auto& [id, exporter] : Registry<ExporterSpec>::all()) {
    INFO(id);
    const Exported exported(id, scene);
    CHECK(exported.notes("no points"));
    CHECK_FALSE(exported.notes("ground truth"));
    check_scene(scene, load_scene(exported.folder, {}), exporter);
    CHECK(check_dataset(exported.folder).empty());
  }
}

TEST_CASE("a scene of which some views lack priors comes back as it is") {
  Scene scene = room();
  scene.train[2].priors = {};
  scene.train[5].priors["depth"] = {};
  scene.test[1].priors = {};
  for (const auto& [id, exporter] : Registry<ExporterSpec>::all()) {
    INFO(id);
    const Exported exported(id, scene);
    check_scene(scene, load_scene(exported.folder, {}), exporter);
    CHECK(check_dataset(exported.folder).empty());
  }
}

TEST_CASE("nerfstudio's file names depth where all views have it, and lists every split") {
  Scene scene = room();
  const auto transforms = [](const Exported& exported) {
    return Json::parse(read_file(exported.folder / "transforms.json"));
  };
  Json json = transforms(Exported("nerfstudio", scene));
  CHECK(json["frames"][4]["depth_file_path"] == "depths/0004.png");
  CHECK(json["val_filenames"] == json["test_filenames"]);
  CHECK(json["test_filenames"][1] == "images/0008.png");
  CHECK(json["ply_file_path"] == "points3D.ply");
  CHECK_FALSE(json["frames"][4].contains("mask_path"));
  scene.train[2].truth["depth"] = {};
  json = transforms(Exported("nerfstudio", scene));
  CHECK_FALSE(json["frames"][4].contains("depth_file_path"));
}

TEST_CASE("masks of what counts go with every format; those that do not name them say so") {
  Scene scene = room();
  Image& counted = scene.train[2].counted;
  counted = Image(scene.train[2].rgb.width(), scene.train[2].rgb.height(), 1, 1.0f);
  counted.at(5, 6) = 0;
  blank_uncounted(scene.train[2]);
  for (const auto& [id, exporter] : Registry<ExporterSpec>::all()) {
    INFO(id);
    const Exported exported(id, scene);
    CHECK(exported.notes("pixels that do not count") != exporter.names_counted);
    const Scene loaded = load_scene(exported.folder, {});
    REQUIRE(loaded.train.size() == scene.train.size());
    const auto found = loaded.train[2].counted.values();
    CHECK(std::equal(found.begin(), found.end(), counted.values().begin(), counted.values().end()));
    CHECK(loaded.train[1].counted.empty());
  }
}

TEST_CASE("only an earlier export is replaced, and only with --force") {
  const Scene scene = room();
  Exported exported("colmap", scene);
  write_file(exported.folder / "notes.txt", "mine");
  fs::create_directories(exported.folder / "outputs");
  CHECK_THAT(
      error_of(ExitCode::kUsage, [&] { export_scene(scene, exported.folder, {"colmap"}); }),
      Contains("--force replaces it")
  );
  const ExportOptions force{"nerfstudio", ExportSplit::kAll, true};
  const ExportReport report = export_scene(scene, exported.folder.string() + "/", force);
  CHECK(find_loader(exported.folder).name == "nerfstudio");
  CHECK_FALSE(fs::exists(exported.folder / "sparse"));
  CHECK(read_file(exported.folder / "notes.txt") == "mine");
  CHECK(fs::exists(exported.folder / "outputs"));
  CHECK(
      fmt::format("{}", fmt::join(report.notes, "; "))
          .find("2 files that are of no export stayed: notes.txt, ...") != std::string::npos
  );
  write_file(exported.path() / "mine/thesis.txt", "x");
  CHECK_THAT(
      error_of(ExitCode::kUsage, [&] { export_scene(scene, exported.path() / "mine", force); }),
      Contains("holds no earlier export")
  );
  CHECK(fs::exists(exported.path() / "mine/thesis.txt"));
  CHECK_THAT(
      error_of(ExitCode::kUsage, [&] { export_scene(scene, exported.path() / "new", {"obj"}); }),
      Contains("no such format") && Contains("colmap: 3DGS")
  );
}
