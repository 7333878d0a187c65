// SPDX-License-Identifier: MIT
#include "reports/provenance/profile_needs.h"

#include <algorithm>

#include "reports/bench/memory_estimate.h"
#include "reports/records/earlier_run.h"
#include "reports/records/run_folder.h"
#include "reports/records/stage_files.h"

namespace glint {
namespace {

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

double pixels_of(const SceneSource& source) {
  return static_cast<double>(source.width) * static_cast<double>(source.height);
}

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
    const MemoryEstimate estimate = estimate_memory(user, size_of(cell.source), records);
    take(
        estimate.bytes,
        fmt::format("{} of {}: {}", cell.cell.method, cell.cell.scene, estimate.from)
    );
  }
  return most;
}

}  // namespace glint
