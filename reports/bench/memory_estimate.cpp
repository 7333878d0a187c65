// SPDX-License-Identifier: MIT
#include "reports/bench/memory_estimate.h"

#include <algorithm>
#include <limits>

#include "glint/core/error.h"
#include "glint/method.h"
#include "reports/bench/plan.h"

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
// Points, normals, distances and the trees over them, of two meshes.
constexpr double kBytesPerSample = 600;
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

std::string gib(double bytes) { return fmt::format("{:.2f} GiB", bytes / (1 << 30)); }

}  // namespace

MemoryUser memory_user(const std::string& method, const Json& config, const Profile& profile) {
  const Json resolved = create_method(method, config)->config();
  const auto max_surfels = resolved.value("max_surfels", std::numeric_limits<std::size_t>::max());
  return {method, max_surfels, profile.mesh_protocol().num_samples, profile.tsdf_options().voxel};
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
  int channels = 3;  // of the photo
  for (const MapRow& row : maps())
    channels += row.channels() * (int(!row.prior.empty()) + int(!row.truth.empty()));
  const double pixels = double(room.width) * room.height;
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

MemoryEstimate estimate_memory(
    const MemoryUser& user, const SceneSize& scene, const std::vector<Record>& records
) {
  double most = 0;
  for (const Record& record : records)
    if (record.ok() && record.cell.method == user.method && record.resolution == scene.resolution)
      most = std::max(most, bytes_taken(record));
  if (most > 0) return {most, "what such cells took before"};
  const MemoryEstimate stages[] = {
      {training_bytes(user, scene), "its images and surfels"},
      {user.voxel > 0 ? kFusionBytesTimesVoxel2 / (user.voxel * user.voxel) : 0,
       "its images and the fusion of meshes"},
      {kBytesPerSample * double(user.mesh_samples), "its images and the samples of meshes"}};
  MemoryEstimate largest = *std::ranges::max_element(stages, {}, &MemoryEstimate::bytes);
  largest.bytes += kProgramBytes + scene.image_bytes;
  return largest;
}

double estimate_device_bytes(const MemoryUser& user, const SceneSize& scene) {
  return training_bytes(user, scene) + scene.image_bytes;
}

double device_bytes_of_process(double bytes_in_use) {
  constexpr double kKept = 1.25;          // blocks are of a few sizes, and wait to be used again
  constexpr double kDriverBytes = 500e6;  // kernels, stacks and tables of a context
  return kKept * bytes_in_use + kDriverBytes;
}

void check_fits(const MemoryEstimate& estimate, std::uint64_t available) {
  if (estimate.bytes <= static_cast<double>(available)) return;
  throw OutOfMemory(fmt::format(
      "needs about {} (by {}), {} are free; fewer --jobs, a smaller max_pixels of the scene or "
      "max_surfels of the method",
      gib(estimate.bytes),
      estimate.from,
      gib(static_cast<double>(available))
  ));
}

}  // namespace glint
