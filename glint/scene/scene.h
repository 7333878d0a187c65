// SPDX-License-Identifier: MIT
// What a method trains on and is scored against: posed images, priors, points and, where it exists,
// ground truth. Loaders (datasets/) fill it; nothing here knows a file format.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/image.h"
#include "glint/core/vec.h"
#include "glint/scene/camera.h"
#include "glint/scene/maps.h"
#include "glint/scene/surfels.h"

namespace glint {

// The kind of View::counted, which is neither rendered nor true nor a prior: no row of maps().
inline constexpr MapRow kCountedRow{"counted", "Pixels that count", MapKind::kMask};

struct View {
  std::string name;
  Camera camera;
  Image rgb;  // [H][W][3] as displayed (sRGB-encoded), [0, 1]
  // [H][W][1] 1: the pixel counts; 0: no loss and no score looks at it, and `rgb` is grey there.
  // Empty: all count.
  Image counted;
  MapSet priors;  // predictions of other networks, or simulated ones
  MapSet truth;   // both layers of glass; the true image is `rgb`
};

struct Scene {
  std::string name;
  std::string dataset;  // "glassroom", "nerfstudio", ...
  bool simulated_priors = false;
  std::vector<View> train, test;
  PointCloud points;                 // sparse points; empty when the dataset has none
  Vec3f bounds_min{}, bounds_max{};  // metres; see set_extent
  float spatial_scale = 1;           // 1.1 x largest distance of train cameras to their mean
  std::string spec_hash;             // identifies the data; part of every record
  // For people: how priors that others made were read and why, how many pixels have one, how
  // pictures were shrunk.
  std::vector<std::string> data_notes;
};

// The name of a view as file names have it: '_' for '/'.
std::string flat_view_name(std::string view_name);

// Why a name from a file cannot be that of a folder: "is empty", "holds a path separator". Empty:
// it can.
std::string why_no_folder_name(std::string_view name);

// What is wrong with the name of a view, given those before it (flat name -> name); it is added to
// them. Empty: nothing.
std::string view_name_problem(const std::string& name, std::map<std::string, std::string>& before);

// 1.1 x the largest distance of a camera centre to the mean of the centres.
float camera_extent(const std::vector<View>& views);

// Sets spatial_scale from the train cameras (1 when they stand in one place), and the bounds from
// the points: their 0.5 and 99.5 percentiles. Without points, the bounds are the box of the train
// cameras and of the points 2 x spatial_scale in front of them.
void set_extent(Scene& scene);

}  // namespace glint
