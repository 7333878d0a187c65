// SPDX-License-Identifier: MIT
// The 3D scene of a GlassRoom before rendering: room, settled container and its contents, cameras.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/glassroom/camera_path.h"
#include "datasets/glassroom/glassroom.h"
#include "datasets/glassroom/room.h"
#include "datasets/glassroom/settle.h"

namespace glint {

struct GlassRoomScene {
  RoomModel room;  // with container and objects in its TraceScene
  ContainerShape container;
  std::vector<std::string> objects;     // names of what is in the container, as in settled.objects
  std::optional<ContainerShape> inner;  // of the case in the container
  SettleResult settled;
  Bounds container_bounds;             // of the settled container, world
  std::unique_ptr<PathTracer> tracer;  // of room.scene
  std::vector<Camera> cameras;         // `views` of them, along the path
  std::uint64_t layout_seed = 0;
  double glass_share = 0;  // mean share of pixels whose first surface is glass
};

// What every generator of rooms is asked for.
struct ShotOptions {
  int width = 160, height = 90;  // pixels
  int views = 64, spp = 64;
  std::string priors;   // level
  bool layers = false;  // maps of every layer and path
};
template <class Options>
ShotOptions shots_of(const Options& o) {
  ShotOptions shots{
      .width = o.width, .height = o.height, .views = o.views, .spp = o.spp, .priors = o.priors};
  if constexpr (requires { o.layers; }) shots.layers = o.layers || always_has_layers(o.scene);
  return shots;
}
// Errors (kUsage): out of range; `generator` opens the message.
void check_shots(const ShotOptions& shots, const std::string& generator);

// How a layout comes to be from a seed.
struct LayoutRecipe {
  std::string generator, name;  // "glassroom", "room_1": in messages; the name seeds the container
  std::function<RoomModel(std::uint64_t seed)> room;
  std::function<ContainerShape(const RoomModel& room, Rng& rng)> container;
  // Of the cameras round a container; `views` and `size` are those of the shots.
  std::function<CameraPathOptions(const RoomModel& room, const ContainerShape& shape)> path;
  bool nested = false;                        // a smaller case in the container
  double min_glass = 0.15, max_glass = 0.40;  // limits of the mean share of glass in the images
  std::uint64_t seed = 0;
};

// Layouts are tried one after the other, each from its own seed, until one settles upright and
// gives a camera path with a glass share within the limits. The scene is built in place because the
// tracer refers to it. Errors (kEnvironment): no layout in 16 worked; (kBadReference): panes touch;
// those of the recipe.
std::unique_ptr<GlassRoomScene> build_layout(const LayoutRecipe& recipe, const ShotOptions& shots);

// Errors (kUsage): unknown scene name or prior level, sizes out of range; (kEnvironment): those of
// build_layout().
std::unique_ptr<GlassRoomScene> build_glassroom_scene(const GlassRoomOptions& options);

// Radiance factor that brings the median luminance to `kMiddle`, lowered until at most
// `kMaxClipped` of the pixels of a few small probes clip; of views it may be a little more.
float fit_exposure(const GlassRoomScene& scene, std::uint64_t seed);

}  // namespace glint
