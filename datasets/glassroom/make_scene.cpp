// SPDX-License-Identifier: MIT
#include "datasets/glassroom/make_scene.h"

#include <algorithm>
#include <set>
#include <utility>

#include "datasets/glassroom/contact_sheet.h"
#include "datasets/glassroom/noise_floor.h"
#include "datasets/glassroom/priors.h"
#include "datasets/glassroom/replace_scene.h"
#include "datasets/glassroom/sfm_points.h"
#include "datasets/glassroom/write_scene.h"
#include "datasets/recorded_files.h"
#include "datasets/scene_index.h"
#include "glint/core/error.h"
#include "glint/core/interrupt.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr const char* kBehindMeshFile = "mesh_behind.ply";
constexpr int kTestEvery = 8;
// Noise in training views averages out over the views; in a test view it bounds the score.
constexpr int kTestSampleFactor = 4;
constexpr int kSheetColumns = 8, kSheetTileWidth = 240;
constexpr float kFarInRoom = 6, kFarInMirror = 10;  // metres, of the sheet's depth colours

// Of a folder whose scene.json is damaged: what is left of it says so, or the key of the data.
bool was_a_scene(
    const SceneRecipe& recipe, const fs::path& folder, const std::string& description
) {
  return description.find(fmt::format("\"dataset\": \"{}\"", recipe.dataset)) !=
             std::string::npos ||
         is_there(folder / "keys" / "data.json");
}

// The first file of a finished scene that is not there or not as it was written; empty: none.
// Earlier versions made no mesh of what lies behind the glass.
std::string damaged_file(const fs::path& folder) {
  const RecordedFiles files = compare_recorded(folder);
  for (const std::string& name : files.missing)
    if (fs::path(name).filename() != kBehindMeshFile) return name;
  return files.changed.empty() ? "" : files.changed.front();
}

// The description of the scene that a folder holds; null when there is nothing, or a damaged one. A
// folder with anything else in it is not touched.
Json stored_description(const SceneRecipe& recipe, const fs::path& folder) {
  std::error_code code;
  if (!is_there(folder) || fs::is_empty(folder, code)) return {};
  const fs::path description = folder / "scene.json";
  const std::string text = is_there(description) ? read_file(description) : "";
  const Json json = parse_json(text);
  if (!json.is_object() && was_a_scene(recipe, folder, text)) return {};
  GLINT_CHECK(
      json.is_object() && json.value("dataset", Json()) == recipe.dataset &&
          json.contains("hash") && json["hash"].is_string(),
      kUsage,
      "{}: is there already and is not a {} scene; choose another folder",
      folder.string(),
      recipe.title
  );
  return json;
}

// "width 96, now 240; spp 4, now 128": of the options of two scenes.
std::string changed_options(const Json& before, const Json& now) {
  std::set<std::string> names;
  for (const Json* options : {&before, &now})
    if (options->is_object())
      for (const auto& [name, value] : options->items()) names.insert(name);
  std::string text;
  for (const std::string& name : names) {
    const auto value_in = [&](const Json& options) {
      return options.is_object() && options.contains(name) ? options[name].dump() : "the default";
    };
    const std::string earlier = value_in(before), later = value_in(now);
    if (earlier != later)
      text += fmt::format("{}{} {}, now {}", text.empty() ? "" : "; ", name, earlier, later);
  }
  return text.empty() ? "another version made it" : text;
}

Image albedo_behind(const PathTracer& tracer, const Camera& camera) {
  Image albedo(camera.width, camera.height, 3);
  const Vec3f eye = cast<float>(camera.center());
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const auto hit =
          tracer.first_hit(eye, cast<float>(camera.ray_in_world(x + 0.5, y + 0.5)), true);
      for (int c = 0; c < 3; ++c) albedo.at(x, y, c) = hit.hit ? hit.albedo[c] : 0.0f;
    }
  return albedo;
}

Json container_json(const ContainerShape& shape, const Pose& pose, int settling_steps) {
  Json panes = Json::array();
  for (const Pane& pane : container_panes(shape)) {
    Vec3f normal{};
    normal[pane.axis] = 1;
    panes.push_back(
        {{"center", vector_json(pose.apply(pane.center))},
         {"normal", vector_json(pose.rotation * normal)},
         {"half_size_in_container", vector_json(pane.half_size)}}
    );
  }
  return {
      {"size", vector_json(shape.size)},
      {"beam", shape.beam},
      {"pane_thickness", shape.pane_thickness},
      {"ior", shape.glass_ior},
      {"pose", pose_json(pose)},
      {"panes", panes},
      {"settling_steps", settling_steps}};
}

// Every pane and mirror: what is of layers.
Json smooth_json(const TraceScene& scene) {
  Json surfaces = Json::array();
  for (const TraceMesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    const bool mirror = material.kind == MaterialKind::kMirror;
    if (!mirror && material.kind != MaterialKind::kThinDielectric) continue;
    Json corners = Json::array();
    for (const Vec3f vertex : mesh.vertices) corners.push_back(vector_json(vertex));
    Json surface{{"name", material.name}, {"kind", name_of(material.kind)}, {"corners", corners}};
    surface[mirror ? "albedo" : "tint"] = vector_json(mirror ? material.albedo : material.tint);
    surfaces.push_back(surface);
  }
  return surfaces;
}

Json materials_json(const TraceScene& scene) {
  Json materials = Json::array();
  for (const Material& m : scene.materials)
    materials.push_back(
        {{"name", m.name},
         {"kind", name_of(m.kind)},
         {"albedo", vector_json(m.albedo)},
         {"textured", m.texture >= 0},
         {"roughness", m.roughness},
         {"ior", m.ior},
         {"emission", vector_json(m.emission)}}
    );
  return materials;
}

Json items_json(const RoomModel& room) {
  Json items = Json::array();
  for (const PlacedItem& item : room.items)
    items.push_back(
        {{"kind", item.kind},
         {"low", vector_json(item.bounds.low)},
         {"high", vector_json(item.bounds.high)}}
    );
  return items;
}

void write_meshes(const TraceScene& scene, const fs::path& folder) {
  write_mesh_ply(folder / "gt" / "mesh.ply", truth_mesh(scene, TruthLayer::kFirst));
  write_mesh_ply(folder / "gt" / kBehindMeshFile, truth_mesh(scene, TruthLayer::kBehind));
}

// Renders and writes one scene into a folder.
class SceneMaker {
 public:
  SceneMaker(const SceneRecipe& recipe, const fs::path& folder)
      : recipe_(recipe),
        options_(recipe.shots),
        folder_(folder),
        seed_(recipe.render_seed),
        scene_(recipe.build()),
        exposure_(fit_exposure(*scene_, seed_)),
        sheet_(
            options_.views,
            kSheetColumns,
            {kSheetTileWidth, std::max(1, kSheetTileWidth * options_.height / options_.width)},
            options_.layers ? kFarInMirror : kFarInRoom
        ),
        prior_model_(prior_level(options_.priors)) {
    std::vector<Camera> train;
    for (int view = 0; view < options_.views; ++view) {
      if (is_test_view(view)) continue;
      train.push_back(scene_->cameras[static_cast<std::size_t>(view)]);
      train_views_.push_back(view);
    }
    choose_missing_priors();
    points_ = sfm_points(*scene_->tracer, train, sfm_model_, seed_);
    if (points_.size() < kFewestPoints) points_.clear();
    cloud_.positions.resize(points_.size());
    cloud_.colors.resize(points_.size());
  }

  void make() {
    Progress progress(
        recipe_.dataset + " " + recipe_.name, static_cast<std::size_t>(options_.views)
    );
    for (int view = 0; view < options_.views; ++view) {
      make_view(view);
      progress.advance();
    }
    write_cameras(folder_, scene_->cameras);
    if (!points_.empty()) write_point_ply(folder_ / "sparse" / "0" / "points3D.ply", cloud_);
    write_meshes(scene_->room.scene, folder_);
    const Json data = description();  // without the sheet: letters differ between machines
    write_png(folder_ / "contact_sheet.png", sheet_.image());
    write_file(folder_ / "scene.json", data.dump(1) + "\n");
  }

 private:
  // Their share is that of training views, and that of test views.
  void choose_missing_priors() {
    std::vector<int> test_views;
    for (int view = 0; view < options_.views; ++view)
      if (is_test_view(view)) test_views.push_back(view);
    std::uint64_t stream = 0;
    for (const std::vector<int>* views : {&train_views_, &test_views}) {
      const int count = static_cast<int>(views->size());
      for (const int i : views_without_priors(prior_model_, count, seed_, stream))
        without_priors_.insert((*views)[static_cast<std::size_t>(i)]);
      ++stream;
    }
  }

  MapSet priors_of(int view, const PathTracerOutput& truth) const {
    if (without_priors_.contains(view)) return {};
    const Image behind =
        albedo_behind(*scene_->tracer, scene_->cameras[static_cast<std::size_t>(view)]);
    return simulate_priors(truth, behind, prior_model_, seed_, static_cast<std::uint64_t>(view));
  }

  void make_view(int view) {
    const Camera& camera = scene_->cameras[static_cast<std::size_t>(view)];
    const auto stream = static_cast<std::uint64_t>(view);
    const int spp = options_.spp * (is_test_view(view) ? kTestSampleFactor : 1);
    const PathTracerOutput truth = scene_->tracer->render(
        camera, {.spp = spp, .seed = seed_, .view = stream, .layers = options_.layers}
    );
    if (is_test_view(view)) noise_.add(truth, exposure_);
    const MapSet priors = priors_of(view, truth);
    write_view(folder_, view, truth, priors, exposure_);
    sheet_.add(view, truth, priors, exposure_);
    color_points(view, display_image(truth.radiance, exposure_));
  }

  void color_points(int view, const Image& image) {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const SfmPoint& point = points_[i];
      if (train_views_[static_cast<std::size_t>(point.view)] != view) continue;
      const float* rgb = image.pixel(point.x, point.y);
      cloud_.positions[i] = point.position;
      cloud_.colors[i] = {rgb[0], rgb[1], rgb[2]};
    }
  }

  Json description() const {
    std::vector<std::string> train, test, without_priors;
    for (int view = 0; view < options_.views; ++view)
      (is_test_view(view) ? test : train).push_back(view_name(view));
    for (const int view : without_priors_) without_priors.push_back(view_name(view));
    Json json{
        {"name", recipe_.name},
        {"dataset", recipe_.dataset},
        {"hash", recipe_.hash},
        {"generator_version", recipe_.version},
        {"options", recipe_.options},
        {"test_sample_factor", kTestSampleFactor},
        {"layout_seed", scene_->layout_seed},
        {"render_seed", seed_},
        {"simulated_priors", true},
        {"priors_label", "simulated priors"},
        {"prior_level", options_.priors},
        {"prior_model", config_to_json(prior_model_)},
        {"without_priors", without_priors},
        {"sfm_model", config_to_json(sfm_model_)},
        {"num_points", points_.size()},
        {"exposure", exposure_},
        {"image_encoding", "sRGB(clamp(gt/rgb)); gt radiance = scene radiance * exposure"},
        {"up", "z"},
        {"unit", "metre"},
        {"split", {{"train", train}, {"test", test}}},
        {"glass_share", scene_->glass_share},
        {"room_size", vector_json(scene_->room.size)},
        {"container",
         container_json(scene_->container, scene_->settled.container, scene_->settled.num_steps)},
        {"items", items_json(scene_->room)},
        {"materials", materials_json(scene_->room.scene)}};
    if (options_.layers) json.update(of_layers());
    if (recipe_.more) json.update(recipe_.more(*scene_));
    json["files"] = file_hashes(folder_);
    return json;
  }

  Json of_layers() const {
    Json json{{"layers", true}, {"panes_and_mirrors", smooth_json(scene_->room.scene)}};
    if (const Json floor = noise_.json(); !floor.is_null()) json["noise_floor"] = floor;
    if (scene_->inner)
      json["inner_container"] =
          container_json(*scene_->inner, scene_->settled.inner_case, scene_->settled.num_steps);
    return json;
  }

  const SceneRecipe& recipe_;
  const ShotOptions& options_;
  fs::path folder_;
  std::uint64_t seed_;
  std::unique_ptr<GlassRoomScene> scene_;
  float exposure_;
  ContactSheet sheet_;
  NoiseFloor noise_;
  PriorModel prior_model_;
  SfmModel sfm_model_;
  std::vector<int> train_views_;
  std::set<int> without_priors_;  // views
  std::vector<SfmPoint> points_;
  PointCloud cloud_;
};

}  // namespace

bool is_test_view(int view) { return view % kTestEvery == 0; }

Json vector_json(Vec3f v) { return Json::array({v.x, v.y, v.z}); }

Json pose_json(const Pose& pose) {
  Json rows = Json::array();
  for (const Vec3f& row : pose.rotation.rows) rows.push_back(vector_json(row));
  return {{"rotation_world_from_local", rows}, {"translation", vector_json(pose.translation)}};
}

bool make_scene(const SceneRecipe& recipe, const fs::path& folder, bool again) {
  recover_scene(folder);
  const Json stored = stored_description(recipe, folder);
  const bool is_other = stored.is_object() && stored["hash"] != recipe.hash;
  const bool is_same = stored.is_object() && !is_other && !again;
  if (is_other)
    log::warn(fmt::format(
        "{}: the scene there is replaced ({})",
        folder.string(),
        changed_options(stored.value("options", Json()), recipe.options)
    ));
  const std::string damaged = is_same ? damaged_file(folder) : "";
  if (!damaged.empty())
    log::warn(fmt::format("{}: damaged; making the scene again", (folder / damaged).string()));
  if (is_same && damaged.empty()) {
    // Made before there was such a file: the scene is the same, so nothing is rendered again.
    if (!is_there(folder / "gt" / kBehindMeshFile))
      write_meshes(recipe.build()->room.scene, folder);
    return false;
  }
  UnfinishedFolder unfinished(folder);
  SceneMaker(recipe, unfinished.path()).make();
  replace_scene(unfinished.path(), folder);
  return true;
}

}  // namespace glint
