// SPDX-License-Identifier: MIT
#include "reports/provenance/audit.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "glint/core/device_lost.h"
#include "glint/core/interrupt.h"
#include "glint/core/parallel.h"
#include "metrics/fusion/tsdf_volume.h"
#include "reports/bench/evaluate.h"
#include "reports/bench/mesh_stage.h"
#include "reports/bench/stage_documents.h"
#include "reports/bench/stages.h"

namespace glint {
namespace {

class ThreadsFor {
 public:
  explicit ThreadsFor(int threads) : before_(num_threads()) { set_num_threads(threads); }
  ~ThreadsFor() { set_num_threads(before_); }
  ThreadsFor(const ThreadsFor&) = delete;
  ThreadsFor& operator=(const ThreadsFor&) = delete;

 private:
  int before_;
};

// One training and all that is made from it.
struct Trial {
  std::string name;
  int threads = 0;
  fs::path folder;
  std::map<std::string, std::string> hashes;  // file -> SHA-256
  std::map<std::string, double> metrics;
};

std::vector<Trial> trials_of(const AuditOptions& options) {
  const int threads = num_threads();
  std::vector<Trial> trials{{"first", threads, {}, {}, {}}};
  for (int i = 1; i < options.repeats; ++i)
    trials.push_back(
        {options.repeats > 2 ? fmt::format("again, {}", i) : "again", threads, {}, {}, {}}
    );
  if (!options.other_threads) return trials;
  if (threads != 1) trials.push_back({"1 thread", 1, {}, {}, {}});
  if (threads != 2) trials.push_back({"2 threads", 2, {}, {}, {}});
  return trials;
}

// Differences of maps over all views.
class MapSums {
 public:
  void add(const MapSet& a, const MapSet& b) {
    a.for_each([&](const MapRow& row, const Image& map) {
      if (b.has(row)) add(sums_[std::string(row.id)], map, b[row]);
    });
  }
  // Of those that differ.
  std::map<std::string, MapDifference> differences() const {
    std::map<std::string, MapDifference> differences;
    for (const auto& [id, sum] : sums_)
      if (sum.max > 0) differences[id] = {sum.max, std::sqrt(sum.squares / sum.count)};
    return differences;
  }

 private:
  struct Sum {
    double max = 0, squares = 0, count = 0;
  };
  static void add(Sum& sum, const Image& a, const Image& b) {
    const std::size_t size = a.num_pixels() * static_cast<std::size_t>(a.channels());
    for (std::size_t i = 0; i < size; ++i) {
      const double difference = std::abs(double{a.data()[i]} - double{b.data()[i]});
      sum.max = std::max(sum.max, difference);
      sum.squares += difference * difference;
    }
    sum.count += static_cast<double>(size);
  }

  std::map<std::string, Sum> sums_;
};

class MethodAudit {
 public:
  MethodAudit(
      const std::string& method, const Json& config, const Scene& scene, const AuditOptions& options
  )
      : scene_(scene), options_(options) {
    spec_.method = method;
    spec_.config = config;
    spec_.options = options.run;
    spec_.dataset = scene.dataset;
    spec_.scene = scene.name;
    spec_.dataset_hash = scene.spec_hash;
    spec_.anew = true;
    spec_.train_document = train_document(method, config, options.run, Json::object());
  }

  AuditedMethod run() {
    AuditedMethod audited{spec_.method, "", {}, {}};
    std::vector<Trial> trials = trials_of(options_);
    for (Trial& trial : trials) run_trial(trial);
    for (std::size_t i = 1; i < trials.size(); ++i)
      audited.runs.push_back(compared(trials.front(), trials[i]));
    audited.spread = spread_of(trials);
    return audited;
  }

 private:
  void run_trial(Trial& trial) {
    throw_if_interrupted();
    const ThreadsFor threads(trial.threads);
    std::string name = trial.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    trial.folder = options_.folder / flat_view_name(spec_.method) / name;
    spec_.folder = trial.folder;
    const auto method = train_stage(spec_, scene_);
    render_stage(spec_, scene_, *method);
    if (has_tsdf_volume() && fuse_stage.here()) make_mesh(*method);
    trial.metrics = eval_stage(spec_, scene_, {.mesh = options_.mesh});
    for (const Stage stage : kStages)
      if (auto done = read_stage(spec_.folder, stage)) trial.hashes.merge(done->hashes);
    trial.hashes.erase("env.json");  // what it took, which no two trainings share
  }

  // A method that was trained this shortly may have no surface yet.
  void make_mesh(Method& method) const try {
    mesh_stage(spec_, scene_, method, options_.tsdf);
  } catch (const Error& error) {
    if (error.code() != ExitCode::kBadPrediction) throw;
  }

  AuditedRun compared(const Trial& first, const Trial& other) const {
    AuditedRun run{other.name, other.threads, 0, {}, {}};
    std::set<std::string> names;
    for (const Trial* trial : {&first, &other})
      for (const auto& entry : trial->hashes) names.insert(entry.first);
    run.files = names.size();
    for (const std::string& name : names) {
      const auto a = first.hashes.find(name), b = other.hashes.find(name);
      const bool both = a != first.hashes.end() && b != other.hashes.end();
      if (!both || a->second != b->second) run.differing.push_back(name);
    }
    if (!run.differing.empty()) run.maps = map_differences(first, other);
    return run;
  }

  std::map<std::string, MapDifference> map_differences(const Trial& first, const Trial& other)
      const {
    MapSums sums;
    for (const View& view : scene_.test) {
      const auto maps_of = [&](const Trial& trial) {
        return read_scored_maps(view_folder(trial.folder, view.name), view.rgb.size());
      };
      sums.add(maps_of(first), maps_of(other));
    }
    return sums.differences();
  }

  static std::map<std::string, double> spread_of(const std::vector<Trial>& trials) {
    std::map<std::string, double> spread;
    for (const auto& [id, value] : trials.front().metrics) {
      double low = value, high = value;
      for (const Trial& trial : trials)
        if (const auto found = trial.metrics.find(id); found != trial.metrics.end()) {
          low = std::min(low, found->second);
          high = std::max(high, found->second);
        }
      if (high > low) spread[id] = high - low;
    }
    return spread;
  }

  const Scene& scene_;
  const AuditOptions& options_;
  RunSpec spec_;
};

}  // namespace

bool AuditedMethod::same_bytes() const {
  return failure.empty() && std::all_of(runs.begin(), runs.end(), [](const AuditedRun& run) {
           return run.differing.empty();
         });
}

AuditedMethod audit_method(
    const std::string& method, const Json& config, const Scene& scene, const AuditOptions& options
) {
  try {
    return MethodAudit(method, config, scene, options).run();
  } catch (const Interrupted&) {
    throw;
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    return {method, error.what(), {}, {}};
  }
}

}  // namespace glint
