// SPDX-License-Identifier: MIT
// A scene as our path tracer takes it, as files that other renderers read
// (scripts/blender/render_scene.py; docs/reference/datasets.md):
//   exchange.json   materials, textures, environment, cameras, exposure
//   meshes.obj      metres, z up; a group `mesh_<i>` for each mesh, its material `material_<i>`
//   textures/<i>.exr   linear RGB, float32
#pragma once

#include <vector>

#include "datasets/front3d/front3d.h"
#include "datasets/glassroom/glassroom.h"
#include "datasets/glassroom/trace_scene.h"
#include "glint/core/config.h"
#include "glint/core/files.h"
#include "glint/core/service.h"
#include "glint/scene/camera.h"

namespace glint {

struct ExchangeView {
  std::string name;
  Camera camera;
  bool is_test = false;
};

struct ExchangeScene {
  std::string name;
  TraceScene scene;
  std::vector<ExchangeView> views;
  float exposure = 1;  // radiance times this is what gt/ and pictures have
  Json origin;         // what made it: told, never read
};

// Writes a new folder. Errors (kUsage): it is there already and not empty; (kBadReference): a scene
// that our path tracer would refuse; (kEnvironment): cannot be written.
inline constinit Service<void(const ExchangeScene& scene, const fs::path& folder)>
    write_exchange_scene{"writing scenes for other renderers", kGlassRoomElsewhere};

// The scene that make_glassroom renders with these options. Errors: build_glassroom_scene()'s.
inline constinit Service<ExchangeScene(const GlassRoomOptions& options)> glassroom_for_exchange{
    "writing scenes for other renderers", kGlassRoomElsewhere};
// The same of make_front3d().
inline constinit Service<ExchangeScene(const Front3dOptions& options)> front3d_for_exchange{
    "writing scenes for other renderers", kFront3dElsewhere};

}  // namespace glint
