// SPDX-License-Identifier: MIT
// Walks every field of a profile, of its parts and of every method's config: changing it changes
// the documents (and so the keys) of the stages that go by it, and of no other. A field that is new
// has to be given its place here.
#include <catch2/catch.hpp>

#include <fstream>
#include <functional>
#include <set>

#include "reports/run/bench/cell_stages.h"
#include "reports/run/bench/stage_documents.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

using Stages = std::set<std::string>;
const Stages kNone{}, kTrain{"train"}, kMesh{"mesh"}, kScore{"score"};
const Stages kMeshAndScore{"mesh", "score"};  // a default of the comparison follows the option

Profile base_profile() {
  register_fake_methods();
  Profile profile;
  profile.name = "base";
  profile.methods = {"fake"};
  profile.scenes = {"room_1"};
  return profile;
}

CellStages wanted(const Profile& profile) {
  const PlanCell cell = make_plan(profile, {}, {})[0];
  return cell_stages(cell, profile, fake_identity(cell.source), nullptr, {});
}

// The stages that differ in more than the stages before them, and how they say so.
struct Change {
  Stages stages;
  std::vector<std::string> lines;
};

Change change_between(const CellStages& before, const CellStages& after) {
  Change change;
  for (const Stage stage : {Stage::kTrain, Stage::kRender, Stage::kMesh, Stage::kScore}) {
    const auto lines = stage_differences(before[stage].document, after[stage].document);
    if (!lines.empty()) change.stages.emplace(stage_name(stage));
    change.lines.insert(change.lines.end(), lines.begin(), lines.end());
    // Whatever changed in front of a stage changes its key, and nothing else does.
    CHECK(
        (before[stage].document == after[stage].document) ==
        (before[stage].key() == after[stage].key())
    );
  }
  return change;
}

Change change_of(const std::function<void(Profile&)>& edit) {
  Profile profile = base_profile();
  edit(profile);
  return change_between(wanted(base_profile()), wanted(profile));
}

bool names(const Change& change, const std::string& field) {
  return std::any_of(change.lines.begin(), change.lines.end(), [&](const std::string& line) {
    return line.starts_with(field + " ");
  });
}

// Another value of the same type, within what it may be: shares below 1, counts above 0.
Json other_value(const Json& value) {
  static const std::map<std::string, std::string> texts = {
      {"raster", "trace"},
      {"all", "geometry"},
      {"geometry", "all"},
      {"nothing", "all"},
      {"paper", "release"},
      {"release", "paper"},
      {"trace", "raster"},
      {"cameras", "none"},
      {"expected", "median"},
      {"median", "expected"},
      {"real", "off"},
      {"delighted", "basecolor"},
      {"basecolor", "delighted"},
      {"point-to-triangle", "point-to-point"},
      {"", "x"}};
  if (value.is_boolean()) return !value.get<bool>();
  if (value.is_number_integer()) return value.get<std::int64_t>() + 1;
  if (value.is_number()) return value == 0.0 ? 0.25 : 0.75 * value.get<double>();
  if (value.is_string()) {
    INFO("give '" << value.get<std::string>() << "' another value in this test");
    REQUIRE(texts.contains(value));
    return texts.at(value);
  }
  REQUIRE((value.is_array() && !value.empty()));
  Json array = value;
  array[0] = other_value(array[0]);
  return array;
}

// Every field of a part of the profile, against the stages it should change.
template <class Part>
void check_part(
    const Part& part,
    const std::string& prefix,
    Json Profile::*member,
    const std::map<std::string, Stages>& expected
) {
  const Json fields = config_to_json(part);
  for (const auto& [name, value] : fields.items()) {
    INFO(prefix << "." << name);
    REQUIRE(expected.contains(name));
    const Change change = change_of([&, &field = name, &old = value](Profile& profile) {
      // Not above bounds_max, which is 0.
      (profile.*member)[field] = field == "bounds_min" ? Json{-1.0, 0.0, 0.0} : other_value(old);
    });
    CHECK(change.stages == expected.at(name));
    if (!expected.at(name).empty()) CHECK(names(change, prefix + "." + name));
  }
}

}  // namespace

TEST_CASE("every field of a profile changes the keys that go by it and no other") {
  struct Place {
    std::function<void(Profile&)> edit;
    Stages stages;
    std::string field;  // in the reason
  };
  const std::map<std::string, Place> places = {
      {"description", {[](Profile& p) { p.description = "other"; }, kNone, ""}},
      {"iterations", {[](Profile& p) { p.iterations += 1; }, kTrain, "iterations"}},
      {"methods", {[](Profile& p) { p.methods.push_back("fake/other"); }, kNone, ""}},
      {"leave_out", {[](Profile& p) { p.leave_out = {"*/9"}; }, kNone, ""}},
      {"seeds", {[](Profile& p) { p.seeds = {1}; }, kTrain, "seed"}},
      {"test_psnr_every", {[](Profile& p) { p.test_psnr_every += 1; }, kNone, ""}},
      {"timing_frames", {[](Profile& p) { p.timing_frames += 1; }, kScore, "timing_frames"}},
      {"timing_warmup", {[](Profile& p) { p.timing_warmup += 1; }, kScore, "timing_warmup"}},
      {"gpus", {[](Profile& p) { p.gpus += 1; }, kNone, ""}},
      {"defaults", {[](Profile& p) { p.defaults["max_pixels"] = 9; }, kTrain, "scene.max_pixels"}},
      {"scenes", {[](Profile& p) { p.scenes.push_back("room_2"); }, kNone, ""}},
      {"manifests", {[](Profile& p) { p.manifests = {"3d-front-t"}; }, kNone, ""}},
      {"overrides",
       {[](Profile& p) {
          p.overrides["fake"] = {{"grey", 0.25}};
        },
        kTrain,
        "config.grey"}},
      {"mesh", {[](Profile& p) { p.mesh["min_cluster"] = 7; }, kMesh, "mesh.min_cluster"}},
      {"mesh_metrics",
       {[](Profile& p) { p.mesh_metrics["num_samples"] = 10; },
        kScore,
        "mesh_metrics.num_samples"}}};
  base_profile().visit([&](const std::string& name, const auto&, const char*) {
    INFO(name);
    REQUIRE(places.contains(name));
    const Place& place = places.at(name);
    const Change change = change_of(place.edit);
    CHECK(change.stages == place.stages);
    if (!place.field.empty()) CHECK(names(change, place.field));
  });
  CHECK(change_of([](Profile& profile) { profile.name = "other"; }).stages.empty());
}

TEST_CASE("every option of the fusion changes the mesh's key") {
  check_part(
      TsdfOptions{},
      "mesh",
      &Profile::mesh,
      {{"voxel", kMeshAndScore},
       {"truncation_voxels", kMesh},
       {"max_depth", kMesh},
       {"bounds_min", kMesh},
       {"bounds_max", kMesh},
       {"min_cluster", kMesh},
       {"max_memory_mb", kNone}}  // a mesh that fits is the same
  );
}

TEST_CASE("every constant of the comparison of meshes changes the score's key") {
  check_part(
      MeshProtocol{},
      "mesh_metrics",
      &Profile::mesh_metrics,
      {{"num_samples", kScore},
       {"seed", kScore},
       {"distance", kNone},  // both are scored
       {"thresholds_m", kScore},
       {"max_distance_m", kScore},
       {"cull", kScore},
       {"cull_tolerance_m", kScore},
       {"cull_max_edge_m", kScore}}
  );
}

TEST_CASE("every field of every method's config changes the training's key") {
  const Json data = {{"content", "c"}};
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    const Json before = train_document(id, Json::object(), {}, data);
    REQUIRE_FALSE(before.at("config").empty());
    for (const auto& [name, value] : before.at("config").items()) {
      INFO(id << " " << name);
      Json same = Json::object();
      // More than one layer needs the transmission set as it is.
      if (name == "transmission" && before.at("config").contains("layers")) same["layers"] = 1;
      Json changed = same;
      changed[name] = other_value(value);
      const Json base = train_document(id, same, {}, data);
      const Json after = train_document(id, changed, {}, data);
      CHECK(stage_key(after) != stage_key(base));
      const auto lines = stage_differences(base, after);
      REQUIRE_FALSE(lines.empty());
      CHECK(lines.front().starts_with("config." + name + " "));
    }
  }
}

TEST_CASE("every field of a room counts, where it lies and what it is called do not") {
  const test::TempFolder data;
  write_file(data.path() / "priors/normal/0000.png", "{}");
  const std::map<std::string, std::pair<Json, bool>> places = {
      {"dataset", {"other", false}},
      {"scene", {"room_2", true}},
      {"loader", {"nerfstudio", false}},  // of folders, where the code of the loader counts
      {"max_pixels", {100.0, true}},
      {"image_ratio", {0.5, true}},
      {"prior_folder", {(data.path() / "priors").string(), true}},
      {"prior_axes", {"opengl", true}},
      {"prior_depth", {"inverted", true}},
      {"prior_overlap", {3, true}},
      {"albedo_from_basecolor", {true, true}},
      {"width", {161, true}},
      {"height", {91, true}},
      {"views", {65, true}},
      {"spp", {129, true}},
      {"seed", {1, true}},
      {"room", {"room_2", true}},
      {"priors", {"poor", true}}};
  SceneSource base;
  base.dataset = "glassroom";
  base.scene = "room_1";
  const Json before = identify_source(base, data.path()).document;
  base.visit([&](const std::string& name, const auto&, const char*) {
    if (name == "folder") return;  // no room then: see below
    if (name == "assets") return;  // of older profiles, empty
    INFO(name);
    REQUIRE(places.contains(name));
    const auto& [value, counts] = places.at(name);
    SceneSource changed = base;
    config_from_json(changed, {{name, value}}, "test");
    const auto lines = stage_differences(before, identify_source(changed, data.path()).document);
    CHECK(lines.size() == (counts ? 1 : 0));
    // The room is what it is made from, whatever the scene is called.
    const std::string field = name == "room" ? "scene" : name;
    if (counts && !lines.empty()) CHECK(lines[0].starts_with("scene." + field + " "));
  });
}

TEST_CASE("a room under another name, with the priors there have always been, is that room") {
  const test::TempFolder data;
  SceneSource base;
  base.dataset = "glassroom";
  base.scene = "room_1";
  const Json before = identify_source(base, data.path()).document;
  CHECK_FALSE(before.at("scene").contains("priors"));
  SceneSource variant = base;
  variant.scene = "default";
  variant.room = "room_1";
  CHECK(identify_source(variant, data.path()).document == before);
}

TEST_CASE("of a folder its files count, not its name") {
  const test::TempFolder data;
  for (const char* folder : {"a", "b"})
    for (const char* file : {"intri.yml", "images/0/0.png"})
      write_file(data.path() / folder / file, file);
  const fs::path hashes = data.path() / ".hashes";
  const auto hash = [&](const char* folder) { return content_hash(data.path() / folder, hashes); };
  CHECK(hash("a") == hash("b"));
  write_file(data.path() / "b/images/0/0.png", "other");
  CHECK(hash("a") != hash("b"));
  write_file(data.path() / "b/images/0/0.png", "images/0/0.png");
  CHECK(hash("a") == hash("b"));
  write_file(data.path() / "b/.notes", "hidden");
  CHECK(hash("a") == hash("b"));
  fs::rename(data.path() / "b/intri.yml", data.path() / "b/extri.yml");
  CHECK(hash("a") != hash("b"));
}

TEST_CASE("another version of a folder is told where sizes and times of writing are the same") {
  const test::TempFolder data;
  const fs::path file = data.path() / "room/points.bin", hashes = data.path() / ".hashes";
  write_file(file, "first");
  const fs::file_time_type time = fs::last_write_time(file);
  const std::string first = content_hash(data.path() / "room", hashes);
  std::ofstream(file) << "other";  // the same file, as an archive unpacked over it
  fs::last_write_time(file, time);
  CHECK(content_hash(data.path() / "room", hashes) != first);
  write_file(file, "first");  // a file in its place
  fs::last_write_time(file, time);
  CHECK(content_hash(data.path() / "room", hashes) == first);
}

TEST_CASE("a reason names what has changed, with both values") {
  using Lines = std::vector<std::string>;
  const Json then = {
      {"inputs", {{"train", "a"}}},
      {"mesh", {{"voxel", 0.02}}},
      {"data", {{"scene", {{"spp", 64}}}, {"content", "a"}, {"code", {{"d.cpp", "1"}}}}},
      {"code", {{"a.cpp", "1"}, {"b.cpp", "1"}}}};
  const auto lines = [&](const std::function<void(Json&)>& edit) {
    Json now = then;
    edit(now);
    return stage_differences(then, now);
  };
  CHECK(lines([](Json&) {}).empty());
  CHECK(lines([](Json& now) { now["inputs"]["train"] = "b"; }).empty());
  CHECK(lines([](Json& now) { now["mesh"]["voxel"] = 0.5; }) == Lines{"mesh.voxel 0.02 -> 0.5"});
  CHECK(
      lines([](Json& now) { now["mesh"]["voxel"] = 0.02f; })[0].find("0.0199999995") !=
      std::string::npos
  );  // what differs is shown
  CHECK(lines([](Json& now) { now["data"]["scene"]["spp"] = 8; }) == Lines{"scene.spp 64 -> 8"});
  CHECK(lines([](Json& now) { now["data"]["content"] = "b"; }) == Lines{"other files in the data"});
  CHECK(lines([](Json& now) { now["code"]["b.cpp"] = "2"; }) == Lines{"code of b.cpp"});
  CHECK(lines([](Json& now) {
          for (const char* file : {"a.cpp", "c.cpp", "e.cpp"}) now["code"][file] = "2";
          now["data"]["code"]["d.cpp"] = "2";
        }) == Lines{"code of a.cpp, c.cpp, d.cpp and 1 more"});
}

TEST_CASE("what a machine has gained counts, what it has lost since does not") {
  const Json had = {{"machine", {{"lpips", {{"sha256", "a"}}}}}};
  const Json lacks = {{"machine", {{"lpips", "no weights"}}}};
  CHECK(with_machine_of(lacks, had) == had);
  CHECK(with_machine_of(had, lacks) == had);
  CHECK(stage_differences(lacks, had) == std::vector<std::string>{"lpips no weights -> there"});
  const Json other = {{"machine", {{"lpips", {{"sha256", "b"}}}}}};
  CHECK(with_machine_of(other, had) == other);
  CHECK(stage_differences(had, other) == std::vector<std::string>{"lpips has other files"});
}

TEST_CASE("each stage's key goes by the code of the method and of the stage") {
  const auto has = [](const Json& document, const char* file) {
    return document.at("code").contains(file);
  };
  const Json data = {{"content", "c"}};
  const Json two = train_document("2dgs", Json::object(), {}, data);
  const Json glint = train_document("glint/no-trans", Json::object(), {}, data);
  CHECK(has(two, "baselines/2dgs.cpp"));
  CHECK_FALSE(has(two, "glint/glint.cpp"));
  CHECK(has(glint, "glint/glint.cpp"));
  CHECK(has(glint, "glint/glint_model.cpp"));
  CHECK_FALSE(has(glint, "baselines/2dgs.cpp"));
  CHECK_FALSE(has(two, "metrics/mesh/mesh_scores.cpp"));
  CHECK(has(render_document("2dgs", ""), "reports/run/bench/stages.cpp"));
  CHECK(has(mesh_document("2dgs", "", {}), "metrics/fusion/tsdf.cpp"));
  const Json score = score_document("2dgs", {}, {}, std::nullopt);
  for (const char* file :
       {"metrics/mesh/mesh_scores.cpp", "metrics/view/psnr.cpp", "metrics/ssim.cpp"})
    CHECK(has(score, file));
  for (const Json& document : {two, glint, score})
    for (const char* file : {"reports/show/tables/tables.cpp", "reports/run/records/records.cpp"})
      CHECK_FALSE(has(document, file));
}
