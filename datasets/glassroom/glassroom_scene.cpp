// SPDX-License-Identifier: MIT
#include "datasets/glassroom/glassroom_scene.h"

#include <algorithm>

#include "datasets/glassroom/check_panes.h"
#include "datasets/glassroom/scene_programs.h"
#include "glint/core/error.h"
#include "glint/core/progress.h"

namespace glint {

namespace {

constexpr int kLayoutTries = 16;
constexpr int kObjects = 6;
constexpr int kNestedObjects = 4, kInnerObjects = 3;  // where there is a case in the container
constexpr float kMiddle = 0.2f;                       // linear luminance that the median pixel gets
constexpr double kMaxClipped = 0.04;                  // share of pixels
constexpr ImageSize kProbeSize{64, 36};

Bounds container_bounds(const ContainerShape& shape, const Pose& pose) {
  Bounds bounds;
  for (const Bounds& beam : container_beams(shape))
    for (int corner = 0; corner < 8; ++corner)
      bounds.include(pose.apply(
          {(corner & 1) ? beam.low.x : beam.high.x,
           (corner & 2) ? beam.low.y : beam.high.y,
           (corner & 4) ? beam.low.z : beam.high.z}
      ));
  return bounds;
}

// Share of a coarse grid of pixels that meet glass first, mean over the cameras.
double mean_glass_share(const PathTracer& tracer, const std::vector<Camera>& cameras) {
  std::size_t glass = 0, total = 0;
  for (const Camera& full : cameras) {
    const Camera camera = resized(full, kProbeSize);
    const Vec3f eye = cast<float>(camera.center());
    for (int y = 0; y < camera.height; y += 2)
      for (int x = 0; x < camera.width; x += 2, ++total)
        glass +=
            tracer.first_hit(eye, cast<float>(camera.ray_in_world(x + 0.5, y + 0.5)), false).glass;
  }
  return static_cast<double>(glass) / static_cast<double>(total);
}

// Objects for what of the container an inner case leaves free.
std::vector<ContainerObject> objects_beside(const ContainerShape& shape, Rng& rng) {
  ContainerShape half = shape;
  half.size = 0.55f * half.size;
  return random_objects(half, kNestedObjects, rng);
}

// Container, what is in it and how all that came to rest, into the room.
void fill_room(const LayoutRecipe& recipe, GlassRoomScene& scene, Rng& rng) {
  RoomModel& room = scene.room;
  scene.container = recipe.container(room, rng);
  std::vector<ContainerObject> objects = recipe.nested
                                             ? objects_beside(scene.container, rng)
                                             : random_objects(scene.container, kObjects, rng);
  InnerCase inner;
  if (recipe.nested) inner = random_inner_case(scene.container, kInnerObjects, rng);
  for (const ContainerObject& object : objects) scene.objects.push_back(object.name);
  const SettleOptions drop{
      .support_height = room.support_height,
      .place = room.container_place,
      .yaw = room.container_yaw + rng.uniform(-room.yaw_range, room.yaw_range)};
  scene.settled = settle(scene.container, objects, drop, rng, recipe.nested ? &inner : nullptr);
  GLINT_CHECK(scene.settled.at_rest, kEnvironment, "settle: not at rest in time");
  add_container(room.scene, scene.container, scene.settled.container);
  add_objects(room.scene, std::move(objects), scene.settled.objects, rng);
  if (!recipe.nested) return;
  scene.inner = inner.shape;
  add_container(room.scene, inner.shape, scene.settled.inner_case);
  add_objects(room.scene, std::move(inner.objects), scene.settled.inner_objects, rng);
}

std::unique_ptr<GlassRoomScene> try_layout(
    const LayoutRecipe& recipe, const ShotOptions& shots, std::uint64_t seed
) {
  auto scene = std::make_unique<GlassRoomScene>();
  scene->layout_seed = seed;
  RoomModel& room = scene->room = recipe.room(seed);
  Rng rng(seed, hash_name(recipe.name + "/container"));
  fill_room(recipe, *scene, rng);
  scene->container_bounds = container_bounds(scene->container, scene->settled.container);
  if (shots.layers) check_panes(room.scene);
  scene->tracer = std::make_unique<PathTracer>(room.scene);
  CameraPathOptions path = recipe.path ? recipe.path(room, scene->container) : CameraPathOptions();
  path.size = {shots.width, shots.height};
  path.views = shots.views;
  scene->cameras = camera_path(*scene->tracer, room.bounds(), scene->container_bounds, path, rng);
  scene->glass_share = mean_glass_share(*scene->tracer, scene->cameras);
  GLINT_CHECK(
      scene->glass_share >= recipe.min_glass && scene->glass_share <= recipe.max_glass,
      kEnvironment,
      "glass covers {:.0f} % of the images",
      100 * scene->glass_share
  );
  return scene;
}

}  // namespace

void check_shots(const ShotOptions& shots, const std::string& generator) {
  const auto in_range = [&](const char* field, int value, int low, int high) {
    GLINT_CHECK(
        value >= low && value <= high,
        kUsage,
        "{}: {} is {}, expected {} to {}",
        generator,
        field,
        value,
        low,
        high
    );
  };
  in_range("width", shots.width, 8, 8192);
  in_range("height", shots.height, 8, 8192);
  in_range("views", shots.views, 2, 9999);
  in_range("spp", shots.spp, 1, 1 << 20);
  check_prior_level(shots.priors, generator);
}

std::unique_ptr<GlassRoomScene> build_layout(const LayoutRecipe& recipe, const ShotOptions& shots) {
  std::string reason;
  for (int attempt = 0; attempt < kLayoutTries; ++attempt) try {
      return try_layout(recipe, shots, recipe.seed * 1000 + static_cast<std::uint64_t>(attempt));
    } catch (const Error& error) {
      if (error.code() != ExitCode::kEnvironment) throw;
      reason = error.what();
      log::info(fmt::format("{}: layout {} rejected: {}", recipe.name, attempt, reason));
    }
  throw Error(
      ExitCode::kEnvironment,
      fmt::format(
          "{}: none of {} layouts of {} worked (the last: {}); try another seed",
          recipe.generator,
          kLayoutTries,
          recipe.name,
          reason
      )
  );
}

std::unique_ptr<GlassRoomScene> build_glassroom_scene(const GlassRoomOptions& options) {
  check_shots(shots_of(options), "glassroom");
  const SceneProgram& program = scene_program(options.scene);
  const LayoutRecipe recipe{
      .generator = "glassroom",
      .name = options.scene,
      .room = [&](std::uint64_t seed) { return build_room(program.room, seed); },
      .container =
          [&](const RoomModel&, Rng& rng) {
            ContainerShape shape = random_container(rng);
            shape.tints = program.tints.value_or(shape.tints);
            return shape;
          },
      .path =
          [&](const RoomModel&, const ContainerShape&) {
            return CameraPathOptions{.max_radius = program.max_radius};
          },
      .nested = program.nested,
      .min_glass = program.min_glass,
      .max_glass = program.max_glass,
      .seed = options.seed};
  return build_layout(recipe, shots_of(options));
}

float fit_exposure(const GlassRoomScene& scene, std::uint64_t seed) {
  constexpr std::size_t kProbes = 12;
  std::vector<float> luminance, largest;
  for (std::size_t i = 0; i < kProbes; ++i) {
    const Camera camera = resized(scene.cameras[i * scene.cameras.size() / kProbes], kProbeSize);
    const PathTracerOutput probe =
        scene.tracer->render(camera, {.spp = 16, .seed = seed ^ 0xE5705u, .view = i});
    for (std::size_t k = 0; k < probe.radiance.num_pixels(); ++k) {
      const float* rgb = probe.radiance.data() + 3 * k;
      luminance.push_back(0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2]);
      largest.push_back(std::max({rgb[0], rgb[1], rgb[2]}));
    }
  }
  const auto quantile = [](std::vector<float>& values, double share) {
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return std::max(*at, 1e-6f);
  };
  return std::min(kMiddle / quantile(luminance, 0.5), 1 / quantile(largest, 1 - kMaxClipped));
}

}  // namespace glint
