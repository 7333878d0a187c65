// SPDX-License-Identifier: MIT
#include "datasets/check_views.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "datasets/check_geometry.h"
#include "datasets/check_layers.h"
#include "datasets/counted_pixels.h"
#include "datasets/prior_maps.h"
#include "datasets/undistort.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"
#include "glint/scene/layer_maps.h"

namespace glint {
namespace {

// ---------------------------------------------------------------- one view's files

// What cannot be looked up is not missing: reading it says why.
bool is_missing(const fs::path& path) try { return !is_there(path); } catch (const Error&) {
  return false;
}

// The image, or an empty one with a finding.
Image read_or_report(const fs::path& path, int channels, std::vector<Finding>& findings) {
  const std::string where = path.string();
  if (is_missing(path)) {
    findings.push_back({"missing-file", where, "no such file; expected one per view"});
    return {};
  }
  try {
    return channels == 0 ? read_image(path) : read_image(path, channels);
  } catch (const Error& error) {
    findings.push_back(make_finding("unreadable-file", where, error.what()));
    return {};
  }
}

std::size_t count_not_finite(const Image& map) {
  const auto values = map.values();
  return static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [](float v) {
    return !std::isfinite(v);
  }));
}

// Pixels whose normal is there but not of unit length.
std::size_t count_not_unit(const Image& normal) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < normal.num_pixels(); ++i) {
    const float* n = normal.data() + 3 * i;
    const float norm = length(Vec3f{n[0], n[1], n[2]});
    if (norm > 0 && !(std::abs(norm - 1) < 0.05f)) ++count;
  }
  return count;
}

void check_values(
    MapKind kind, const std::string& where, const Image& map, std::vector<Finding>& findings
) {
  const auto values = map.values();
  if (kind == MapKind::kDepth && *std::min_element(values.begin(), values.end()) < 0)
    findings.push_back(
        {"depth-values",
         where,
         "holds negative depth; expected metres in front of the camera, or 0"}
    );
  if (kind != MapKind::kNormal) return;
  // Anti-aliased edges leave a few.
  const std::size_t count = count_not_unit(map);
  if (count > map.num_pixels() / 20)
    findings.push_back(
        {"normal-length",
         where,
         fmt::format("{} of {} pixels hold no unit vector", count, map.num_pixels())}
    );
}

// Of an image or a map. False: nothing more can be said of it.
bool check_finite_values(const fs::path& path, const Image& map, std::vector<Finding>& findings) {
  if (map.empty()) return false;
  const std::size_t count = count_not_finite(map);
  if (count > 0)
    findings.push_back(
        {"non-finite",
         path.string(),
         fmt::format("{} values are not finite; store 0 where nothing is known", count)}
    );
  return count == 0;
}

// A map that has to be as large as its view's image.
struct SizedMap {
  std::string name;  // "prior.normal"
  fs::path path;
  ImageSize size;
};

// Reads a view's maps and looks at their values, and at its layers; sizes are compared once all are
// known.
std::vector<SizedMap> check_maps(const ViewSource& view, std::vector<Finding>& findings) {
  std::vector<SizedMap> maps;
  MapSet layers;
  const auto add = [&](std::string name, const fs::path& path, const Image& map) {
    if (!map.empty()) maps.push_back({std::move(name), path, map.size()});
  };
  view.priors.for_each([&](const MapRow& row, const fs::path& path) {
    // Depth comes in one channel or spread over three.
    const int channels = row.kind == MapKind::kDepth ? 0 : row.channels();
    const Image map = read_or_report(path, channels, findings);
    if (!view.prior_programs.has(row)) add(fmt::format("prior.{}", row.id), path, map);
    check_finite_values(path, map, findings);
  });
  view.truth.for_each([&](const MapRow& row, const fs::path& path) {
    const Image map = read_or_report(path, row.channels(), findings);
    add(fmt::format("truth.{}", row.id), path, map);
    if (!check_finite_values(path, map, findings)) return;
    check_values(row.kind, path.string(), map, findings);
    if (is_of_layers(row)) layers[row] = map;
  });
  check_layers(view, layers, findings);
  return maps;
}

// The one size of maps and camera where it is the image that differs from them; else empty. A
// single map against the image says nothing; against it and the camera, it is the map that differs.
ImageSize size_against_image(
    const ViewSource& view, ImageSize image, const std::vector<SizedMap>& maps
) {
  if (image.width == 0 || maps.empty()) return {};
  const ImageSize size = maps.front().size;
  const bool agree =
      std::all_of(maps.begin(), maps.end(), [&](const SizedMap& map) { return map.size == size; });
  const ImageSize stated = view.camera.size();
  const bool outvoted = stated == size || (maps.size() > 1 && stated != image);
  return agree && size != image && outvoted ? size : ImageSize{};
}

void report_image_size(
    const ViewSource& view,
    ImageSize image,
    ImageSize expected,
    std::size_t num_maps,
    std::vector<Finding>& findings
) {
  const bool as_stated = view.camera.size() == expected;
  findings.push_back(
      {"wrong-size",
       view.image.string(),
       fmt::format(
           "the image has {} x {} pixels, {}its {} maps {} x {}; store {}{}",
           image.width,
           image.height,
           as_stated ? "its camera and " : "",
           num_maps,
           expected.width,
           expected.height,
           as_stated ? "the image at that size" : "all of them at one size",
           orientation_hint(view.image)
       )}
  );
}

void check_map_sizes(
    const std::vector<SizedMap>& maps, ImageSize image, std::vector<Finding>& findings
) {
  for (const SizedMap& map : maps)
    if (image.width > 0 && map.size != image)
      findings.push_back(
          {"wrong-size",
           map.path.string(),
           fmt::format(
               "{} has {} x {} pixels, its view's image {} x {}",
               map.name,
               map.size.width,
               map.size.height,
               image.width,
               image.height
           )}
      );
}

void check_counted(const fs::path& path, ImageSize image, std::vector<Finding>& findings) {
  if (is_missing(path)) {
    findings.push_back({"missing-file", path.string(), "no such file; a mask names it"});
    return;
  }
  try {
    read_counted(path, image);
  } catch (const Error& error) {
    findings.push_back(make_finding("mask-path", path.string(), error.what()));
  }
}

// Intrinsics that belong to another size show in the principal point when no size is stated.
// False: the camera cannot be brought to the image.
bool check_camera(const ViewSource& view, ImageSize image, std::vector<Finding>& findings) {
  if (const auto problem = camera_problem(view.camera, view.where)) {
    findings.push_back(*problem);
    return false;
  }
  if (image.width == 0) return false;
  Camera camera;
  try {
    camera = camera_at(view, image);
  } catch (const Error& error) {
    findings.push_back(make_finding("intrinsics-size", view.where, error.what()));
    return false;
  }
  if (is_off_center(camera))
    findings.push_back(
        {"intrinsics-size",
         view.where,
         fmt::format(
             "principal point ({:.1f}, {:.1f}) in an image of {} x {} pixels; the intrinsics "
             "belong to "
             "another size",
             camera.cx,
             camera.cy,
             camera.width,
             camera.height
         )}
    );
  try {
    if (!view.distortion.empty()) Undistortion(camera, view.distortion);
  } catch (const Error& error) {
    findings.push_back(make_finding("distortion", view.where, error.what()));
  }
  return true;
}

// ---------------------------------------------------------------- maps against cameras

constexpr std::size_t kMostViews = 8;        // looked at, evenly spaced
constexpr std::size_t kEnoughSamples = 200;  // to say anything

// A view's camera and a map at its stored size; `usable` is false when either cannot be read.
struct PosedMap {
  Camera camera;
  Image map;
  bool usable = false;
};

template <class Reader>
PosedMap read_posed(const ViewSource& view, const fs::path& path, Reader&& read) {
  PosedMap result;
  if (path.empty()) return result;
  try {
    result.map = read(path);
    result.camera = camera_at(view, result.map.size());
    result.usable = count_not_finite(result.map) == 0;
  } catch (const Error&) {
    // Named by check_view_files().
  }
  return result;
}

PosedMap read_depth(const ViewSource& view, MapId depth) {
  return read_posed(view, view.truth[depth], [&](const fs::path& p) {
    return read_true_values(p, MapKind::kDepth, view.depth_scale);
  });
}

using Views = std::vector<const ViewSource*>;

template <class Predicate>
Views views_where(const SceneIndex& index, Predicate&& predicate) {
  Views views;
  for (const ViewSource& view : index.views)
    if (predicate(view)) views.push_back(&view);
  return views;
}

// Indices of up to kMostViews of them, evenly spaced.
std::vector<std::size_t> sample(const Views& views) {
  const std::size_t count = std::min(views.size(), kMostViews);
  std::vector<std::size_t> ids;
  for (std::size_t i = 0; i < count; ++i) ids.push_back(i * views.size() / count);
  return ids;
}

void report_depth(
    const DepthAgreement& agreement, const std::string& where, std::vector<Finding>& findings
) {
  // Share. GlassRooms stay below 0.011 (32 x 18 pixels), 0.002 (64 x 36); poses of another view,
  // swapped directions and millimetres lie above 0.05, mostly above 0.2 (scripts/sweep_check.py).
  constexpr double kMostInFront = 0.03;
  constexpr double kMostError = 0.02;  // relative; sensors stay below
  const DepthKind kind = agreement.best();
  const double planar = agreement.median_error(DepthKind::kPlanar);
  const double ray_length = agreement.median_error(DepthKind::kRayLength);
  if (agreement.share_in_front(kind) > kMostInFront || agreement.median_error(kind) > kMostError)
    findings.push_back(
        {"depth-poses",
         where,
         fmt::format(
             "carried into neighbouring views, {:.0f} % of the depth lies in front of what they "
             "see, and "
             "the rest differs by {:.2g} (relative); depth and poses differ in axes, units or "
             "convention",
             100 * agreement.share_in_front(kind),
             agreement.median_error(kind)
         )}
    );
  else if (kind == DepthKind::kRayLength)
    findings.push_back(
        {"ray-length-depth",
         where,
         fmt::format(
             "read as distance along the ray, neighbouring views differ by {:.2g}, read as planar "
             "depth "
             "by {:.2g} (relative); expected planar depth: multiply by the cosine to the optical "
             "axis",
             ray_length,
             planar
         )}
    );
}

// One kind of depth of the whole dataset: views against others a little further along the path.
DepthKind check_depth(const SceneIndex& index, MapId depth, std::vector<Finding>& findings) {
  DepthAgreement agreement;
  const Views views =
      views_where(index, [&](const ViewSource& view) { return view.truth.has(depth); });
  const std::size_t gap = std::max<std::size_t>(1, views.size() / 12);
  for (const std::size_t i : sample(views)) {
    if (i + gap >= views.size()) continue;
    const PosedMap from = read_depth(*views[i], depth), to = read_depth(*views[i + gap], depth);
    if (!from.usable || !to.usable) continue;
    agreement.add_pair(from.camera, from.map, to.camera, to.map);
    agreement.add_pair(to.camera, to.map, from.camera, from.map);
  }
  if (agreement.num_tested(DepthKind::kPlanar) < kEnoughSamples) return DepthKind::kPlanar;
  report_depth(agreement, views.front()->truth[depth].parent_path().string(), findings);
  return agreement.best();
}

void report_normals(
    const NormalAgreement& agreement, const std::string& where, std::vector<Finding>& findings
) {
  constexpr double kFits = 0.5;  // mean cosine; noisy priors stay above 0.8
  if (agreement.num_samples() < kEnoughSamples) return;
  const int best = agreement.best_pattern();
  const double cosine = agreement.mean_cosine(best);
  const double world = agreement.mean_cosine_world();
  std::string message;
  if (world > cosine + 0.1 && world > kFits)
    message =
        fmt::format("stored in world axes (mean cosine {:.3f} to the depth's normals)", world);
  else if (cosine < kFits)
    message = fmt::format("fit the depth under no sign pattern (best mean cosine {:.3f})", cosine);
  else if (best != 0)
    message = fmt::format(
        "axes {} are flipped (mean cosine to the depth's normals {:.3f} with the flip, {:.3f} as "
        "stored)",
        flipped_axes(best),
        cosine,
        agreement.mean_cosine(0)
    );
  if (message.empty()) return;
  message += "; expected camera axes x right, y down, z forward";
  findings.push_back({"normal-axes", where, message});
}

// Normals whose dataset has no true depth can still be asked whether they face the camera.
void report_facing(double share, const std::string& where, std::vector<Finding>& findings) {
  if (share >= 0.5) return;
  findings.push_back(
      {"normal-axes",
       where,
       fmt::format(
           "only {:.0f} % of the normals face the camera; expected camera axes x right, y down, z "
           "forward",
           100 * share
       )}
  );
}

using DepthKinds = std::map<std::string_view, DepthKind>;  // by id of the depth

// At the size of the view's picture, in the axes that are documented for it.
Image read_normal_prior(const ViewSource& view, const MapRow& row) {
  Image normal = read_stored_prior(view, row);
  if (view.prior_programs.has(row))
    normal = resize_prior(std::move(normal), row.kind, read_image(view.image, 3).size());
  convert_prior(row.kind, view.prior_reading, camera_at(view, normal.size()), normal);
  return normal;
}

// Those that have the map and the depth of its surface, else those that have the map.
Views views_of_normals(const SceneIndex& index, MapFiles ViewSource::*files, const MapRow& row) {
  const MapRow* depth = depth_of(row);
  const auto has = [&](const ViewSource& view) { return (view.*files).has(row); };
  Views both = views_where(index, [&](const ViewSource& view) {
    return has(view) && depth != nullptr && view.truth.has(*depth);
  });
  return both.empty() ? views_where(index, has) : both;
}

void check_normals(
    const SceneIndex& index,
    MapFiles ViewSource::*files,
    const MapRow& row,
    const DepthKinds& depth_kinds,
    std::vector<Finding>& findings
) {
  const MapRow* depth_row = depth_of(row);
  NormalAgreement agreement;
  double facing = 0;
  int num_read = 0;
  std::string where;
  const Views views = views_of_normals(index, files, row);
  for (const std::size_t i : sample(views)) {
    const ViewSource& view = *views[i];
    const fs::path& path = (view.*files)[row];
    const PosedMap normal = read_posed(view, path, [&](const fs::path& p) {
      return files == &ViewSource::priors ? read_normal_prior(view, row) : read_image(p, 3);
    });
    if (!normal.usable) continue;
    where = path.parent_path().string();
    facing += facing_share(normal.camera, normal.map);
    ++num_read;
    if (depth_row == nullptr) continue;
    const PosedMap depth = read_depth(view, *depth_row);
    if (depth.usable && depth.map.size() == normal.map.size())
      agreement.add_view(normal.camera, depth.map, depth_kinds.at(depth_row->id), normal.map);
  }
  if (agreement.num_samples() >= kEnoughSamples)
    report_normals(agreement, where, findings);
  else if (num_read > 0)
    report_facing(facing / num_read, where, findings);
}

}  // namespace

std::vector<Finding> check_view_files(const ViewSource& view, ImageSize& stored) {
  std::vector<Finding> findings;
  const Image image = read_or_report(view.image, 3, findings);
  std::vector<Finding> of_maps;
  const std::vector<SizedMap> maps = check_maps(view, of_maps);
  const ImageSize expected = size_against_image(view, image.size(), maps);
  const bool image_differs = expected.width > 0;
  if (image_differs)
    report_image_size(view, image.size(), expected, maps.size(), findings);
  else
    check_map_sizes(maps, image.size(), of_maps);
  if (check_camera(view, image_differs ? ImageSize{} : image.size(), findings))
    stored = image.size();
  if (check_finite_values(view.image, image, findings))
    if (const std::string problem = color_range_problem(image); !problem.empty())
      findings.push_back({"color-values", view.image.string(), problem});
  if (!view.counted.empty() && !image.empty())
    check_counted(view.counted, image_differs ? expected : image.size(), findings);
  findings.insert(findings.end(), of_maps.begin(), of_maps.end());
  return findings;
}

void check_agreement(const SceneIndex& index, std::vector<Finding>& findings) {
  DepthKinds kinds;
  // Which surface is the second along a ray changes between views: only first ones are carried.
  for (const MapRow& row : maps())
    if (row.kind == MapKind::kDepth)
      kinds[row.id] = is_layer_map(row) ? kinds["depth"] : check_depth(index, row, findings);
  for (const auto files : {&ViewSource::truth, &ViewSource::priors})
    for (const MapRow& row : maps())
      if (row.kind == MapKind::kNormal) check_normals(index, files, row, kinds, findings);
}

}  // namespace glint
