// SPDX-License-Identifier: MIT
#include "reports/run/bench/cell_needs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/glassroom/glassroom.h"
#include "glint/core/error.h"
#include "glint/method.h"
#include "glint/scene/layer_maps.h"
#include "glint/train/initial_points.h"
#include "reports/run/records/earlier_run.h"
#include "reports/run/records/run_folder.h"
#include "reports/run/records/stage_files.h"

namespace glint {
namespace {

// The program, its libraries and what they keep.
constexpr double kProgramBytes = 60e6;
// A value, its gradient and its two moments, of 58 values a surfel with SH degree 3, and the lists
// and trees over them.
constexpr double kBytesPerSurfel = 4 * 58 * sizeof(float) + 250;
constexpr double kSets = 3;  // interface, transmission, reflection
// Maps that a step keeps for its way back, losses and pictures of features.
constexpr double kBytesPerPixel = 1500;
// Blocks of voxels around the surfaces of a room, and a mesh taken out of them: 0.68 GB at 2 cm.
constexpr double kFusionBytesTimesVoxel2 = 270e3;  // bytes m^2

double bytes_of(const Image& image) {
  return double(image.num_pixels()) * image.channels() * sizeof(float);
}

double bytes_of(const MapSet& maps) {
  double bytes = 0;
  maps.for_each([&](const MapRow&, const Image& map) { bytes += bytes_of(map); });
  return bytes;
}

// Surfels, and maps of a step.
double training_bytes(const MemoryUser& user, const SceneSize& scene) {
  const double pixels = scene.view_pixels;
  const double seen = std::max(scene.points, pixels / kPixelsPerSurfel);
  const double surfels = std::min(double(user.max_surfels), seen);
  return kBytesPerPixel * pixels + kSets * kBytesPerSurfel * surfels;
}

// What a setting asks for by its number.
struct Asked {
  const char* setting;
  double bytes;
};

// A value, its gradient and its two moments.
constexpr double kBytesPerTrained = 4 * sizeof(float);
// Of a value of a network's layer at a pixel: itself and its gradient, in two layers and their
// sums.
constexpr double kBytesPerHidden = 8 * sizeof(float);

// The setting that asks for most. Settings that a method does not have ask for nothing.
Asked asked_by_settings(const Json& config, const SceneSize& scene) {
  const auto value = [&](const char* name) { return number_or(config, name, 0); };
  const double pixels = scene.view_pixels, rows = value("map_height");
  const double cells = std::pow(value("reflection_cells"), 3);
  const double grid = std::min(cells, ReflectionGrid::kPointsPerPixel * pixels);
  const Asked all[] = {
      {"random_points", scene.points > 0 ? 0 : kBytesPerSurfel * value("random_points")},
      {"reflection_cells", kBytesPerSurfel * grid},
      {"map_height", kBytesPerTrained * 2 * rows * rows * value("map_channels")},
      {"hidden",
       value("hidden") * (kBytesPerHidden * pixels + kBytesPerTrained * value("hidden"))}};
  return *std::ranges::max_element(all, {}, &Asked::bytes);
}

std::string gib(double bytes) { return fmt::format("{:.2f} GiB", bytes / (1 << 30)); }

// As rooms of profiles `smoke` and `ci` came out, of the methods with most maps and surfels.
constexpr double kBytesPerRenderedPixel = 125;  // all maps of a test view, and pictures of them
constexpr double kBytesPerModelPixel = 600;     // surfels, per pixel of one picture
constexpr double kCheckpoints = 4;          // of a model's size: moments, the last one and the next
constexpr double kBytesPerTrainPixel = 11;  // renders_train/, while meshes are made
constexpr double kMeshBytesTimesVoxel2 = 7000;  // bytes m^2: of each of two meshes
constexpr double kRoomBytes = 18e6;             // true meshes of a room
constexpr double kBytesPerRoomPixel = 47;       // photo, truth and priors of a view
constexpr double kTestShare = 1.0 / 8;          // of the views

std::string counted(int count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

double pixels_of(const SceneSource& source) { return double(source.width) * source.height; }

double run_bytes(const SceneSource& source, double voxel) {
  const double pixels = pixels_of(source), views = source.views;
  return kBytesPerRenderedPixel * pixels * views * kTestShare + kBytesPerModelPixel * pixels +
         2 * kMeshBytesTimesVoxel2 / (voxel * voxel);
}

// While a cell runs, beside what stays.
double temporary_bytes(const SceneSource& source) {
  const double pixels = pixels_of(source);
  return kCheckpoints * kBytesPerModelPixel * pixels +
         kBytesPerTrainPixel * pixels * source.views * (1 - kTestShare);
}

double bytes_of_run(const fs::path& run) {
  double bytes = 0;
  std::error_code code;
  for (const fs::path& file : files_of_run(run))
    if (const auto size = fs::file_size(file, code); !code) bytes += static_cast<double>(size);
  return bytes;
}

}  // namespace

MemoryUser memory_user(const std::string& method, const Json& config, const Profile& profile) {
  const Json resolved = create_method(method, config)->config();
  const auto max_surfels = resolved.value("max_surfels", std::numeric_limits<std::size_t>::max());
  return {
      method,
      max_surfels,
      profile.mesh_protocol().num_samples,
      profile.tsdf_options().voxel,
      resolved};
}

SceneSize size_of(const Scene& scene) {
  SceneSize size;
  for (const auto* views : {&scene.train, &scene.test})
    for (const View& view : *views) {
      size.view_pixels = std::max(size.view_pixels, double(view.camera.width) * view.camera.height);
      size.image_bytes += bytes_of(view.rgb) + bytes_of(view.counted) + bytes_of(view.priors) +
                          bytes_of(view.truth);
    }
  size.points = double(scene.points.positions.size());
  if (!scene.test.empty()) {
    const Camera& camera = scene.test.front().camera;
    size.resolution = fmt::format("{}x{}", camera.width, camera.height);
  }
  return size;
}

SceneSize size_of(const SceneSource& room) {
  const bool with_layers = always_has_layers(room.room.empty() ? room.scene : room.room);
  int channels = 3;  // of the photo
  for (const MapRow& row : maps()) {
    if ((is_layer_map(row) || is_path_map(row)) && !with_layers) continue;
    channels += row.channels() * (int(!row.prior.empty()) + int(!row.truth.empty()));
  }
  const double pixels = pixels_of(room);
  return {
      pixels,
      pixels * room.views * channels * sizeof(float),
      0,
      fmt::format("{}x{}", room.width, room.height)};
}

double bytes_taken(const Record& record) {
  const auto training = record.metrics.find("peak-memory");
  const double trained = training == record.metrics.end() ? 0 : training->second;
  return std::max(trained, record.process_memory_mb) * 1e6;
}

namespace {

Estimate estimate_by_stages(
    const MemoryUser& user, const SceneSize& scene, const std::vector<Record>& records
) {
  double most = 0;
  for (const Record& record : records)
    if (record.ok() && record.cell.method == user.method && record.resolution == scene.resolution)
      most = std::max(most, bytes_taken(record));
  if (most > 0) return {most, "what such cells took before"};
  const Estimate stages[] = {
      {training_bytes(user, scene), "its images and surfels"},
      {user.voxel > 0 ? kFusionBytesTimesVoxel2 / (user.voxel * user.voxel) : 0,
       "its images and the fusion of meshes"},
      {kBytesPerMeshSample * double(user.mesh_samples), "its images and the samples of meshes"}};
  Estimate largest = *std::ranges::max_element(stages, {}, &Estimate::bytes);
  largest.bytes += kProgramBytes + scene.image_bytes;
  return largest;
}

}  // namespace

Estimate estimate_memory(
    const MemoryUser& user, const SceneSize& scene, const std::vector<Record>& records
) {
  const Estimate stages = estimate_by_stages(user, scene, records);
  const Asked asked = asked_by_settings(user.config, scene);
  if (asked.bytes <= stages.bytes) return stages;
  const std::string by = fmt::format("{} = {}", asked.setting, user.config[asked.setting].dump());
  return {asked.bytes + kProgramBytes + scene.image_bytes, by};
}

double estimate_device_bytes(const MemoryUser& user, const SceneSize& scene) {
  return training_bytes(user, scene) + scene.image_bytes;
}

double device_bytes_of_process(double bytes_in_use) {
  constexpr double kKept = 1.25;          // blocks are of a few sizes, and wait to be used again
  constexpr double kDriverBytes = 500e6;  // kernels, stacks and tables of a context
  return kKept * bytes_in_use + kDriverBytes;
}

void check_fits(const Estimate& estimate, std::uint64_t available) {
  if (estimate.bytes <= static_cast<double>(available)) return;
  throw OutOfMemory(fmt::format(
      "needs about {} (by {}), {} are free; lower that setting where it is one; else fewer --jobs, "
      "a "
      "smaller max_pixels of the scene or max_surfels of the method",
      gib(estimate.bytes),
      estimate.from,
      gib(static_cast<double>(available))
  ));
}

std::optional<Estimate> disk_of_runs(
    const std::vector<PlanCell>& plan, const Profile& profile, const fs::path& folder
) {
  double finished_bytes = 0, formula_bytes = 0, temporary = 0;
  int finished = 0, left = 0, unknown = 0;
  const double voxel = profile.tsdf_options().voxel;
  for (const PlanCell& cell : plan) {
    const fs::path run = run_folder(folder, cell.cell);
    if (read_stage(run, Stage::kScore)) {
      finished_bytes += bytes_of_run(run);
      ++finished;
      continue;
    }
    ++left;
    if (!cell.source.made()) ++unknown;
    formula_bytes += cell.source.made() ? run_bytes(cell.source, voxel) : 0;
    temporary = std::max(temporary, cell.source.made() ? temporary_bytes(cell.source) : 0);
  }
  if (finished > 0)
    return Estimate{
        finished_bytes / finished * left + (left > 0 ? temporary : 0),
        counted(finished, "finished run")};
  if (unknown > 0) return std::nullopt;
  return Estimate{formula_bytes + temporary, "sizes of pictures"};
}

double disk_of_room(const SceneSource& source) {
  return kRoomBytes + kBytesPerRoomPixel * pixels_of(source) * source.views;
}

std::optional<Estimate> memory_of_cells(
    const std::vector<PlanCell>& plan, const Profile& profile, const std::vector<Record>& records
) {
  std::optional<Estimate> most;
  const auto take = [&](double bytes, const std::string& from) {
    if (bytes > 0 && (!most || bytes > most->bytes)) most = Estimate{bytes, from};
  };
  for (const Record& record : records) take(bytes_taken(record), "records");
  for (const PlanCell& cell : plan) {
    if (!cell.source.made()) continue;
    const MemoryUser user = memory_user(cell.cell.method, cell.config, profile);
    const Estimate estimate = estimate_memory(user, size_of(cell.source), records);
    take(
        estimate.bytes,
        fmt::format("{} of {}: {}", cell.cell.method, cell.cell.scene, estimate.from)
    );
  }
  return most;
}

}  // namespace glint
