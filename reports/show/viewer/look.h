// SPDX-License-Identifier: MIT
// What somebody at the viewer wants to see: the page's message "look".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "glint/core/config.h"
#include "glint/scene/camera.h"
#include "reports/show/pictures/relit.h"

namespace glint {

// A view of the dataset.
struct ViewId {
  bool test = true;
  std::size_t index = 0;
};

// What has normal . x > offset is not drawn.
struct CutPlane {
  Vec3d normal;       // unit, world
  double offset = 0;  // metres
};

enum class SurfelStyle { kImage, kDiscs, kPoints };

struct LookPane {
  std::size_t run = 0;
  std::string layer = "rgb";
};

struct Look {
  std::uint64_t serial = 0;
  Camera camera;                // of a whole frame
  std::optional<ViewId> view;   // snapped to: the camera is that view's
  std::vector<LookPane> panes;  // one or two, of the same camera
  LightScales scales;
  SurfelStyle style = SurfelStyle::kImage;
  std::vector<std::string> hidden;  // sets that are not drawn as discs or points
  std::optional<CutPlane> cut;
};

// What a look may name.
struct LookLimits {
  std::size_t runs = 0, train = 0, test = 0;
};

// The camera of a snapped view is left to the caller. Errors (kUsage) name the field, what was
// found and what was expected.
Look look_from_json(const Json& json, const LookLimits& limits);

// {"split": "test", "index": 3}; errors as above.
ViewId view_id_from_json(const Json& json, const LookLimits& limits);

}  // namespace glint
