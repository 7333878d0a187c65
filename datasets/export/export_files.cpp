// SPDX-License-Identifier: MIT
#include "datasets/export/export_files.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cmath>
#include <map>

#include "datasets/map_files.h"
#include "datasets/side_maps.h"
#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"

namespace glint {
namespace {

// Values that 8 bits change by more than rounding of floats does.
struct PictureLosses {
  std::atomic<std::size_t> num_rounded{0}, num_clipped{0};

  void count(ImageView picture) {
    std::size_t rounded = 0, clipped = 0;
    for (std::size_t i = 0; i < 3 * picture.num_pixels(); ++i) {
      const float step = 255 * picture.data[i];
      if (step < 0 || step > 255)
        ++clipped;
      else if (std::abs(step - std::nearbyint(step)) > 1e-3f)
        ++rounded;
    }
    num_rounded += rounded;
    num_clipped += clipped;
  }
};

void write_side_prior(const fs::path& path, const MapRow& row, const Image& map) {
  if (row.kind == MapKind::kDepth) return write_png16(path, map);
  write_prior(path, row.kind, map);
}

// How many views have a file of each folder.
using FolderCounts = std::map<std::string, std::size_t>;

FolderCounts count_side_maps(const ExportInput& input) {
  FolderCounts counts;
  const auto count = [&](const fs::path& file) {
    if (!file.empty()) ++counts[file.parent_path().generic_string() + "/"];
  };
  for (const ExportView& view : input.views) {
    view.view->priors.for_each([&](const MapRow& row, const Image&) {
      count(side_prior_file(row, view.name));
    });
    view.view->truth.for_each([&](const MapRow& row, const Image&) {
      count(side_truth_file(row, view.name));
    });
  }
  return counts;
}

std::string describe_side_folder(const std::string& folder) {
  if (folder == "masks/") return "8 bit, glass is white; ground truth";
  if (folder == "depths/") return "16 bit, mm, nearest; ground truth of the first surface";
  if (folder == "normals/") return "8 bit, (n + 1) / 2, camera axes x right, y down; prior";
  if (folder == "priors/depth/") return "16 bit, relative, larger is farther; prior";
  return "8 bit; prior";
}

bool has_other_truth(const ExportView& view) {
  bool found = false;
  view.view->truth.for_each([&](const MapRow& row, const Image&) {
    found = found || side_truth_file(row, view.name).empty();
  });
  return found;
}

void add_side_notes(const ExportInput& input, const FolderCounts& counts, ExportReport& report) {
  if (counts.contains("depths/") || counts.contains("masks/"))
    report.note(
        "depths/ and masks/ are ground truth: a method that trains on them is no fair rival of one "
        "that does not"
    );
  if (std::any_of(input.views.begin(), input.views.end(), has_other_truth))
    report.note(
        "other ground truth (second layer, parts, normals) has no place in this format: score "
        "against the original dataset"
    );
}

}  // namespace

void for_each_view(
    const ExportInput& input,
    const std::string& title,
    const std::function<void(const ExportView&)>& f
) {
  Progress progress(title, input.views.size());
  parallel_for(input.views.size(), 1, [&](std::size_t i) {
    f(input.views[i]);
    progress.advance();
  });
}

void write_pictures(
    const ExportInput& input,
    const fs::path& folder,
    const std::function<fs::path(const ExportView&)>& path_of,
    ExportReport& report
) {
  PictureLosses losses;
  for_each_view(input, "pictures", [&](const ExportView& view) {
    losses.count(view.view->rgb);
    write_png(folder / path_of(view), view.view->rgb);
  });
  if (losses.num_clipped > 0)
    report.note(fmt::format(
        "pictures: {} values outside of [0, 1] were clipped by 8 bits", losses.num_clipped
    ));
  if (losses.num_rounded > 0)
    report.note("pictures were finer than 8 bits: values are rounded to the nearest n / 255");
}

void write_side_maps(const ExportInput& input, const fs::path& folder, ExportReport& report) {
  const FolderCounts counts = count_side_maps(input);
  if (counts.empty()) return;
  std::atomic<std::size_t> num_beyond{0};
  for_each_view(input, "maps", [&](const ExportView& view) {
    view.view->priors.for_each([&](const MapRow& row, const Image& map) {
      const fs::path file = side_prior_file(row, view.name);
      if (!file.empty()) write_side_prior(folder / file, row, map);
    });
    view.view->truth.for_each([&](const MapRow& row, const Image& map) {
      const fs::path file = side_truth_file(row, view.name);
      if (file.empty()) return;
      if (row.kind == MapKind::kDepth)
        num_beyond += write_depth_millimetres(folder / file, map);
      else
        write_true_map(folder / file, row.kind, map);
    });
  });
  for (const auto& [name, count] : counts)
    report.add(name, fmt::format("{} PNG, {}", count, describe_side_folder(name)));
  add_side_notes(input, counts, report);
  if (num_beyond > 0)
    report.note(
        fmt::format("depths/: {} pixels beyond 65.535 m are 0, which is nothing", num_beyond)
    );
}

bool write_points(
    const ExportInput& input,
    const fs::path& folder,
    const std::string& name,
    PointNormals normals,
    ExportReport& report
) {
  PointCloud points = input.scene.points;
  if (points.positions.empty()) return false;
  if (points.normals.empty() && normals == PointNormals::kAlways)
    points.normals.resize(points.positions.size());
  write_point_ply(folder / name, points);
  report.add(name, fmt::format("{} points", points.positions.size()));
  return true;
}

std::string export_name(const std::string& view) {
  std::string name = flat_view_name(view);
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-') c = '_';
  return name;
}

void number_names(std::vector<ExportView>& views) {
  const int digits = views.size() > 10000 ? 6 : 4;
  for (std::size_t i = 0; i < views.size(); ++i)
    views[i].name = fmt::format("{:0{}}_{}", i, digits, export_name(views[i].view->name));
}

std::string count_views(const ExportInput& input) {
  const auto num_test = std::count_if(
      input.views.begin(), input.views.end(), [](const ExportView& view) { return view.is_test; }
  );
  const auto count = static_cast<std::ptrdiff_t>(input.views.size());
  return fmt::format("{} views ({} train, {} test)", count, count - num_test, num_test);
}

std::array<std::array<double, 4>, 4> opengl_world_from_cam(const Camera& camera) {
  const auto& [right, down, forward] = camera.rotation_cam_from_world.rows;
  const Vec3d center = camera.center();
  std::array<std::array<double, 4>, 4> matrix{};
  for (int i = 0; i < 3; ++i)
    matrix[static_cast<std::size_t>(i)] = {right[i], -down[i], -forward[i], center[i]};
  matrix[3] = {0, 0, 0, 1};
  return matrix;
}

}  // namespace glint
