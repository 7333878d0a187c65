// SPDX-License-Identifier: MIT
// check_indexed(): files and values view by view, then the split, the points, and what needs
// several views (check_geometry.h).
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "datasets/check_views.h"
#include "datasets/picture_notes.h"
#include "datasets/recorded_files.h"
#include "datasets/scene_index.h"
#include "glint/core/error.h"
#include "glint/core/middle.h"
#include "glint/core/parallel.h"
#include "glint/core/presence.h"
#include "glint/core/rng.h"

namespace glint {
namespace {

void check_names(const SceneIndex& index, std::vector<Finding>& findings) {
  std::map<std::string, std::string> names;
  bool has_train = false, has_test = false;
  for (const ViewSource& view : index.views) {
    has_train = has_train || view.is_train;
    has_test = has_test || view.is_test;
    if (const std::string problem = view_name_problem(view.name, names); !problem.empty())
      findings.push_back({"view-name", view.where, problem});
    if (view.is_train && view.is_test)
      findings.push_back(
          {"test-in-train", view.where, "listed as train and as test view; remove it from one list"}
      );
  }
  if (const std::string why = scene_name_problem(index); !why.empty())
    findings.push_back({"scene-name", index.folder.string(), why});
  if (!has_train) findings.push_back({"no-views", index.name, no_train_views(index)});
  if (has_train && !has_test)
    findings.push_back(
        {"no-test-views",
         index.name,
         fmt::format(
             "no test views by the split ({}), so that nothing of it is scored; name some as "
             "\"test_views\": [...] in {}",
             index.split_rule,
             (index.folder / "scene.json").string()
         )}
    );
}

bool same_pose(const Camera& a, const Camera& b) {
  constexpr double kSame = 1e-9;
  for (int i = 0; i < 3; ++i) {
    const Vec3d rows = a.rotation_cam_from_world.rows[i] - b.rotation_cam_from_world.rows[i];
    if (!(length(rows) < kSame)) return false;
  }
  return length(a.translation_cam_from_world - b.translation_cam_from_world) < kSame;
}

// The same for the same bytes; empty: not there, or not to be read, which other checks tell.
std::string content_mark(const fs::path& image) try {
  const std::string bytes = read_file(image);
  return fmt::format("{:x}:{}", hash_name(bytes), bytes.size());
} catch (const Error&) {
  return {};
}

// Test views that are train views under another name: same bytes, or same pose.
void check_leaks(const SceneIndex& index, std::vector<Finding>& findings) {
  std::vector<std::string> contents(index.views.size());
  parallel_for(index.views.size(), 1, [&](std::size_t i) {
    contents[i] = content_mark(index.views[i].image);
  });
  for (std::size_t i = 0; i < index.views.size(); ++i)
    for (std::size_t j = 0; j < index.views.size(); ++j) {
      const ViewSource &test = index.views[i], &train = index.views[j];
      if (i == j || !test.is_test || !train.is_train || train.is_test) continue;
      if (!contents[i].empty() && contents[i] == contents[j])
        findings.push_back(
            {"test-in-train",
             test.image.string(),
             fmt::format("the same picture as train view {}; remove one", train.name)}
        );
      else if (same_pose(test.camera, train.camera))
        findings.push_back(
            {"test-in-train",
             test.where,
             fmt::format("the same pose as train view {}; remove one", train.name)}
        );
    }
}

// Depth needs two places. Matrices whose last row was not read put all cameras at the origin.
void check_positions(const SceneIndex& index, std::vector<Finding>& findings) {
  constexpr double kSamePlace = 1e-9;  // of the distance to the origin, or of a metre
  if (index.views.size() < 2) return;
  const Vec3d first = index.views.front().camera.center();
  const double scale = std::max(1.0, length(first));
  if (std::all_of(index.views.begin(), index.views.end(), [&](const ViewSource& view) {
        return length(view.camera.center() - first) <= kSamePlace * scale;
      }))
    findings.push_back(
        {"pose",
         index.folder.string(),
         fmt::format(
             "all {} cameras stand in one point; nothing can be reconstructed from there: the "
             "poses "
             "are damaged, or of another form",
             index.views.size()
         )}
    );
}

bool is_seen(Vec3d point, const std::vector<ViewSource>& views) {
  return std::any_of(views.begin(), views.end(), [&](const ViewSource& view) {
    const Vec3d cam = view.camera.to_cam(point);
    if (!(cam.z > 0)) return false;
    // Some datasets state no size: the principal point is about half of it.
    const Vec2d pixel = view.camera.project(cam);
    const double width = view.camera.width > 0 ? view.camera.width : 2 * view.camera.cx;
    const double height = view.camera.height > 0 ? view.camera.height : 2 * view.camera.cy;
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < width && pixel.y < height;
  });
}

// Points that are spread a hundred times as wide as the cameras, or as little, are mostly in
// another unit: what a view sees of them may be the same.
void check_point_unit(
    const SceneIndex& index, const std::vector<Vec3f>& points, std::vector<Finding>& findings
) {
  constexpr double kMostRatio = 100;
  if (points.size() < kFewestPoints || index.views.empty()) return;
  std::vector<Vec3d> places, centers;
  for (const Vec3f point : points) places.push_back(cast<double>(point));
  for (const ViewSource& view : index.views) centers.push_back(view.camera.center());
  const double of_points = spread_of(places), of_cameras = spread_of(centers);
  if (!(of_points > 0 && of_cameras > 0)) return;
  const double ratio = of_points / of_cameras;
  if (ratio < kMostRatio && ratio > 1 / kMostRatio) return;
  findings.push_back(
      {"points",
       index.points.string(),
       fmt::format(
           "points lie {:.3g} from their middle (median), cameras {:.3g} from theirs, a ratio of "
           "{:.3g}; are both in one unit (1000: millimetres and metres)?",
           of_points,
           of_cameras,
           ratio
       )}
  );
}

void check_points(const SceneIndex& index, std::vector<Finding>& findings) {
  if (index.points.empty()) return;
  const std::string where = index.points.string();
  PointCloud points;
  try {
    points = read_points(index.points);
  } catch (const Error& error) {
    findings.push_back(make_finding("unreadable-file", where, error.what()));
    return;
  }
  constexpr std::size_t kMostSamples = 2000;
  const std::size_t step = points.positions.size() / kMostSamples + 1;
  std::size_t seen = 0, all = 0;
  for (std::size_t i = 0; i < points.positions.size(); i += step, ++all)
    if (is_seen(cast<double>(points.positions[i]), index.views)) ++seen;
  check_point_unit(index, points.positions, findings);
  if (points.positions.size() < kFewestPoints)
    findings.push_back(
        {"points",
         where,
         fmt::format(
             "{} points, expected at least {}; without the file training starts from random ones",
             points.positions.size(),
             kFewestPoints
         )}
    );
  if (2 * seen < all)
    findings.push_back(
        {"points",
         where,
         fmt::format(
             "only {} of {} sampled points lie in any image; points and poses differ in axes or "
             "units",
             seen,
             all
         )}
    );
}

}  // namespace

std::vector<Finding> check_indexed(const SceneIndex& index) {
  std::vector<Finding> findings = index.problems;
  findings.insert(findings.end(), index.remarks.begin(), index.remarks.end());
  check_names(index, findings);
  std::vector<std::vector<Finding>> of_views(index.views.size());
  std::vector<ImageSize> stored(index.views.size(), ImageSize{});
  parallel_for(index.views.size(), 1, [&](std::size_t i) {
    of_views[i] = check_view_files(index.views[i], stored[i]);
  });
  check_picture_sizes(index, stored, findings);
  for (std::vector<Finding>& of_view : of_views)
    std::move(of_view.begin(), of_view.end(), std::back_inserter(findings));
  check_recorded(index.folder, findings);
  check_leaks(index, findings);
  check_positions(index, findings);
  check_points(index, findings);
  check_agreement(index, findings);
  return findings;
}

}  // namespace glint
