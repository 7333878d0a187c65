// SPDX-License-Identifier: MIT
// The 3D scene of a GlassRoom before rendering: room, settled container and its contents, cameras.
#pragma once

#include <memory>
#include <vector>

#include "datasets/glassroom/camera_path.h"
#include "datasets/glassroom/glassroom.h"
#include "datasets/glassroom/room.h"
#include "datasets/glassroom/settle.h"

namespace glint {

struct GlassRoomScene {
  RoomModel room;  // with container and objects in its TraceScene
  ContainerShape container;
  SettleResult settled;
  Bounds container_bounds;             // of the settled container, world
  std::unique_ptr<PathTracer> tracer;  // of room.scene
  std::vector<Camera> cameras;         // `views` of them, along the path
  std::uint64_t layout_seed = 0;
  double glass_share = 0;  // mean share of pixels whose first surface is glass
};

// Layouts are tried one after the other, each from its own seed, until one settles upright and
// gives a camera path with a glass share within [0.15, 0.40]. The scene is built in place because
// the tracer refers to it. Errors (kUsage): unknown scene name or prior level, sizes out of range;
// (kEnvironment): no layout in 16 worked.
std::unique_ptr<GlassRoomScene> build_glassroom_scene(const GlassRoomOptions& options);

// Radiance factor that brings the median luminance to `kMiddle`, lowered until at most
// `kMaxClipped` of the pixels clip.
float fit_exposure(const GlassRoomScene& scene, std::uint64_t seed);

}  // namespace glint
