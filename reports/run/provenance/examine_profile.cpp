// SPDX-License-Identifier: MIT
#include "reports/run/provenance/examine_profile.h"

#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <set>

#include "glint/core/machine.h"
#include "glint/method.h"
#include "glint/train/perceptual.h"
#include "reports/run/bench/cell_needs.h"
#include "reports/run/records/manifest.h"
#include "reports/run/records/stage_files.h"

namespace glint {
namespace {

constexpr double kGigabyte = 1e9;
constexpr double kComfortable = 0.8;  // of what is free: more than that is a note

std::string size_in_gb(double bytes) { return fmt::format("{:.2f} GB", bytes / kGigabyte); }

bool on_one_disk(const fs::path& a, const fs::path& b) {
  const auto device_of = [](const fs::path& path) {
    struct stat status {};
    return ::stat(nearest_existing(path).c_str(), &status) == 0 ? status.st_dev : dev_t{};
  };
  return device_of(a) == device_of(b);
}

Checked compare_need(
    const std::string& name,
    double need,
    double there,
    const std::string& from,
    const std::string& advice
) {
  const CheckState state = need > there                  ? CheckState::kBad
                           : need > kComfortable * there ? CheckState::kNote
                                                         : CheckState::kOk;
  return {
      name,
      state,
      fmt::format(
          "about {} needed (estimate from {}), {} there", size_in_gb(need), from, size_in_gb(there)
      ),
      state == CheckState::kOk ? "" : advice};
}

class ProfileExamination {
 public:
  explicit ProfileExamination(const ProfileToExamine& examined) : examined_(examined) {}

  std::vector<Checked> rows() {
    for (const SceneSource& source : sources())
      if (source.manifest.empty()) add_scene(source);
    for (const std::string& id : examined_.profile.manifests) add_manifest(*find_manifest(id));
    add_weights();
    add_disk();
    add_memory();
    return std::move(rows_);
  }

 private:
  // Of the cells that are planned, each once.
  std::vector<SceneSource> sources() const {
    std::vector<SceneSource> sources;
    for (const PlanCell& cell : examined_.plan)
      if (sources.empty() || sources.back().scene != cell.source.scene)
        sources.push_back(cell.source);
    return sources;
  }

  void add_scene(const SceneSource& source) {
    const std::string name = "scene " + source.scene;
    try {
      const SceneIdentity identity = examined_.identify(source);
      if (identity.why_not.empty())
        rows_.push_back({name, CheckState::kOk, "there"});
      else if (source.made())
        add_room_to_make(source, name, identity.why_not);
      else
        rows_.push_back({name, CheckState::kBad, identity.why_not, "bring the data there"});
    } catch (const Error& error) {
      rows_.push_back({name, CheckState::kBad, error.what(), "mend the data"});
    }
  }

  // Missing scenes are a note: the cells of the others run. Of those that are there what is not as
  // published is bad.
  void add_manifest(const Manifest& manifest) {
    std::size_t there = 0;
    std::string wrong;
    for (const ManifestSceneState& state : examine_manifest(manifest, examined_.data, false)) {
      if (state.there) ++there;
      for (const Finding& finding : state.findings)
        wrong += fmt::format("{}{}: {}", wrong.empty() ? "" : "; ", state.name, finding.message);
    }
    const std::string name = "dataset " + manifest.id;
    const std::string missing = missing_scenes_text(manifest, examined_.data);
    if (!wrong.empty())
      rows_.push_back(
          {name, CheckState::kBad, wrong, "`dataset check " + manifest.id + "` has more"}
      );
    else if (!missing.empty())
      rows_.push_back({name, CheckState::kNote, missing, "its cells are left out, others run"});
    else
      rows_.push_back({name, CheckState::kOk, fmt::format("{} scenes, as published", there)});
  }

  void add_room_to_make(
      const SceneSource& source, const std::string& name, const std::string& why
  ) {
    rows_.push_back({name, CheckState::kNote, "will be made: " + why});
    data_bytes_ += disk_of_room(source);
  }

  // Methods whose training looks at LPIPS, where there are no weights of it. Weights that cannot be
  // used are told of elsewhere.
  void add_weights() try {
    if (!perceptual_network().empty()) return;
    std::set<std::string> methods;
    for (const PlanCell& cell : examined_.plan) {
      const auto inputs = create_method(cell.cell.method, cell.config)->inputs();
      if (std::find(inputs.begin(), inputs.end(), "LPIPS weights") != inputs.end())
        methods.insert(cell.cell.method);
    }
    if (!methods.empty())
      rows_.push_back(
          {"weights",
           CheckState::kNote,
           fmt::format("{} train without LPIPS: no weights", fmt::join(methods, ", ")),
           "scripts/fetch_lpips_weights.sh fetches them"}
      );
  } catch (const Error&) {
  }

  void add_disk() {
    const auto runs = disk_of_runs(examined_.plan, examined_.profile, examined_.folder);
    if (!runs) {
      rows_.push_back(
          {"disk of runs", CheckState::kNote, "not known before one of these cells has run"}
      );
      return;
    }
    const bool together = on_one_disk(examined_.folder, examined_.data);
    const auto free = [](const fs::path& folder) {
      return static_cast<double>(free_disk_bytes(folder));
    };
    rows_.push_back(compare_need(
        "disk of runs",
        runs->bytes + (together ? data_bytes_ : 0),
        free(examined_.folder),
        runs->from,
        "free some, or choose another --out"
    ));
    if (!together && data_bytes_ > 0)
      rows_.push_back(compare_need(
          "disk of data",
          data_bytes_,
          free(examined_.data),
          "sizes of pictures",
          "free some, or choose another --data"
      ));
  }

  // A machine of the size of the largest cell would do.
  void add_memory() {
    const auto need = memory_of_cells(
        examined_.plan, examined_.profile, read_records(examined_.folder / "records.jsonl")
    );
    if (!need) {
      rows_.push_back(
          {"memory of cells", CheckState::kNote, "not known before one of these cells has run"}
      );
      return;
    }
    rows_.push_back(compare_need(
        "memory of cells",
        need->bytes,
        static_cast<double>(this_machine().memory_bytes),
        need->from,
        "use smaller images, or another machine"
    ));
  }

  const ProfileToExamine& examined_;
  double data_bytes_ = 0;  // of rooms that will be made
  std::vector<Checked> rows_;
};

}  // namespace

std::vector<Checked> examine_profile(const ProfileToExamine& examined) {
  return ProfileExamination(examined).rows();
}

}  // namespace glint
