// SPDX-License-Identifier: MIT
#include "reports/run/records/earlier_run.h"

#include <algorithm>
#include <array>
#include <functional>
#include <set>

#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/core/replace_folder.h"
#include "glint/scene/maps.h"
#include "glint/train/checkpoint.h"
#include "reports/run/records/parcel_run.h"
#include "reports/run/records/stage_files.h"

namespace glint {
namespace {

constexpr const char* kSaving = ".saving";
constexpr std::array kTopFiles = {
    "config.json",
    "env.json",
    "log.jsonl",
    "metrics.json",
    "mesh.json",
    "mesh.ply",
    "mesh_transmission.ply",
    kParcelFile,
    "record.json",
    "strip.png"};
constexpr std::array kRenderFolders = {"renders", "renders_train"};

bool is_map_file(const std::string& name) {
  const auto& rows = maps();
  return std::any_of(rows.begin(), rows.end(), [&](const MapRow& row) {
    return (!row.file.empty() && name == row.file) || (!row.picture.empty() && name == row.picture);
  });
}

// All but folders, links themselves too.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files = list_entries(folder);
  std::erase_if(files, is_real_folder);
  return files;
}

std::vector<fs::path> folders_in(const fs::path& folder) {
  std::vector<fs::path> folders = list_entries(folder);
  std::erase_if(folders, std::not_fn(is_real_folder));
  return folders;
}

void add_render_files(const fs::path& renders, std::vector<fs::path>& ours) {
  for (const fs::path& view : folders_in(renders))
    for (const fs::path& file : files_in(view))
      if (is_map_file(file.filename().string())) ours.push_back(file);
}

// pictures/VIEW/MAP.png.
void add_parcel_pictures(const fs::path& pictures, std::vector<fs::path>& ours) {
  for (const fs::path& view : folders_in(pictures))
    for (const fs::path& file : files_in(view))
      if (file.extension() == ".png" && find_map(file.stem().string()) != nullptr)
        ours.push_back(file);
}

// paths/NAME/path.json, layers.mp4 and LAYER/NNNN.png or .exr.
void add_path_files(const fs::path& paths, std::vector<fs::path>& ours) {
  for (const fs::path& path : folders_in(paths)) {
    for (const char* name : {"path.json", "layers.mp4"}) ours.push_back(path / name);
    for (const fs::path& layer : folders_in(path))
      for (const fs::path& file : files_in(layer)) {
        const std::string stem = file.stem().string(), extension = file.extension().string();
        if ((extension == ".png" || extension == ".exr") && stem.size() >= 4 &&
            stem.find_first_not_of("0123456789") == std::string::npos)
          ours.push_back(file);
      }
  }
}

// A name in keys/ may have been edited: nothing outside of the folder.
bool stays_inside(const fs::path& name) {
  return name.is_relative() && std::find(name.begin(), name.end(), "..") == name.end();
}

// What tells whether it is a run, a finished one, and which files are its own goes last: wherever
// the work on a folder is cut off, the next one goes on.
int rank_of(const fs::path& file, const fs::path& run) {
  const std::string name = file.lexically_relative(run).generic_string();
  if (name == "config.json") return 3;
  if (name == "env.json" || name == "metrics.json") return 2;
  return name.starts_with("keys/") ? 1 : 0;
}

}  // namespace

std::vector<fs::path> files_of_run(const fs::path& run) {
  std::vector<fs::path> ours;
  for (const char* name : kTopFiles) ours.push_back(run / name);
  if (const auto trained = read_stage(run, Stage::kTrain))
    for (const auto& [name, bytes] : trained->files)
      if (stays_inside(name)) ours.push_back(run / name);
  for (const Stage stage : kStages)
    ours.push_back(run / "keys" / fmt::format("{}.json", stage_name(stage)));
  for (const char* renders : kRenderFolders) add_render_files(run / renders, ours);
  add_parcel_pictures(run / kParcelPictures, ours);
  add_path_files(run / "paths", ours);
  std::erase_if(ours, std::not_fn(is_taken));
  std::sort(ours.begin(), ours.end());
  ours.erase(std::unique(ours.begin(), ours.end()), ours.end());
  std::stable_sort(ours.begin(), ours.end(), [&](const fs::path& a, const fs::path& b) {
    return rank_of(a, run) < rank_of(b, run);
  });
  return ours;
}

namespace {

// The folders between the files and the run, if they have become empty.
void remove_empty_folders(const std::vector<fs::path>& files, const fs::path& run) {
  std::set<fs::path> parents;
  for (const fs::path& file : files)
    for (fs::path parent = file.parent_path(); parent != run && parent.has_relative_path();
         parent = parent.parent_path())
      parents.insert(parent);
  std::error_code code;
  for (auto deepest = parents.rbegin(); deepest != parents.rend(); ++deepest)
    fs::remove(*deepest, code);  // fails where something is left
}

void check_done(const std::error_code& code, const fs::path& path) {
  GLINT_CHECK(
      !code,
      kEnvironment,
      "{}: cannot be moved or removed ({}); give write permission to its folder, or choose another "
      "--run",
      path.string(),
      code.message()
  );
}

constexpr const char* kCheckpoint = "checkpoint";

// What others put beside it stays.
void remove_checkpoint(const fs::path& run) {
  const std::vector<fs::path> files = {run / kProgressFile, run / kCheckpointFile};
  std::error_code code;
  for (const fs::path& file : files) {
    if (is_taken(file)) fs::remove(file, code);
    check_done(code, file);
  }
  remove_empty_folders(files, run);
  const fs::path folder = run / kCheckpoint;
  if (!is_real_folder(folder)) return;
  for (const std::string& name : leaves_below(folder))
    log::warn(fmt::format("{}: of no run, left as it is", (folder / name).string()));
}

}  // namespace

void remove_run(const fs::path& run) {
  const std::vector<fs::path> files = files_of_run(run);
  std::error_code code;
  const auto remove_file = [&](const fs::path& file) {
    fs::remove(file, code);
    check_done(code, file);
  };
  for (const fs::path& file : files)
    if (rank_of(file, run) < 3) remove_file(file);
  fs::remove_all(run / kSaving, code);
  check_done(code, run / kSaving);
  remove_checkpoint(run);
  remove_empty_folders(files, run);
  remove_file(run / "config.json");  // until now the folder is a run's
  fs::remove(run, code);             // fails where something is left
}

namespace {

void move_run(const fs::path& from, const fs::path& to) {
  const std::vector<fs::path> files = files_of_run(from);
  write_file(to / "config.json", read_file(from / "config.json"));
  std::error_code code;
  for (const fs::path& file : files) {
    const fs::path target = to / file.lexically_relative(from);
    fs::create_directories(target.parent_path(), code);
    fs::rename(file, target, code);
    check_done(code, file);
  }
  remove_checkpoint(from);  // of a finished run: its last state is in its files
  remove_empty_folders(files, from);
}

bool is_finished(const fs::path& run) {
  return is_there(run / "env.json") || is_there(run / "metrics.json");
}

void remove_previous(const fs::path& run) {
  const fs::path previous = run / kPreviousRun;
  if (!is_our_run(previous)) return;
  remove_run(previous);
  std::error_code code;
  fs::remove(previous, code);
}

}  // namespace

bool is_our_run(const fs::path& folder) {
  const fs::path path = folder / "config.json";
  if (!is_file(path)) return false;
  const Json json = parse_json(read_file(path));
  return json.is_object() && json.value(kWrittenByField, Json()) == kWrittenBy;
}

namespace {

void add_runs_below(const fs::path& folder, std::vector<fs::path>& runs) {
  for (const fs::path& path : or_warn([&] { return list_entries(folder); })) {
    const bool is_run = or_warn([&] { return is_folder(path) && is_our_run(path); });
    if (is_run)
      runs.push_back(path);
    else if (is_real_folder(path))
      add_runs_below(path, runs);
  }
}

}  // namespace

std::vector<fs::path> runs_below(const fs::path& folder) {
  std::vector<fs::path> runs;
  add_runs_below(folder, runs);
  std::sort(runs.begin(), runs.end());
  return runs;
}

bool holds_work(const fs::path& folder) {
  return is_there(folder / "config.json") &&
         (is_finished(folder) || is_there(folder / kCheckpointFile));
}

namespace {

// What a process left that was killed while it wrote is nobody's work.
bool holds_files(const fs::path& folder) {
  const std::vector<fs::path> entries = list_entries(folder);
  const std::vector<fs::path> left = list_left_behind(folder, false);
  return !std::includes(left.begin(), left.end(), entries.begin(), entries.end());
}

}  // namespace

void check_run_folder(const fs::path& folder) {
  const bool used = holds_files(folder);
  GLINT_CHECK(
      !used || is_our_run(folder) || is_our_run(folder / kPreviousRun),
      kUsage,
      "{}: holds files, but no earlier run (its config.json is not there, or not one that "
      "glint-bench wrote); choose an empty or new folder",
      folder.string()
  );
}

namespace {

// The outermost of a folder and those around it that is not there; empty: all are.
fs::path outermost_missing(fs::path folder) {
  fs::path missing;
  for (; !folder.empty() && !is_there(folder); folder = folder.parent_path()) missing = folder;
  return missing;
}

// A folder and those around it up to `outermost`, as far as they are empty.
void remove_if_empty(fs::path folder, const fs::path& outermost) {
  std::error_code code;
  while (fs::remove(folder, code) && folder != outermost) folder = folder.parent_path();
}

}  // namespace

EarlierRun::EarlierRun(const fs::path& folder, bool goes_on)
    : folder_(folder), outermost_made_(outermost_missing(folder)) {
  check_run_folder(folder);
  remove_left_behind(folder);
  if (goes_on) return;
  std::error_code code;
  const fs::path previous = folder / kPreviousRun;
  if (is_our_run(folder) && is_finished(folder)) {
    if (is_finished(previous)) remove_previous(folder);
    move_run(folder, previous);
  } else if (is_our_run(folder)) {
    remove_run(folder);
  }
  fs::create_directories(folder, code);
  GLINT_CHECK(!code, kEnvironment, "{}: cannot be made ({})", folder.string(), code.message());
}

// The handler is inside: that of a destructor's function-try-block throws on at its end.
EarlierRun::~EarlierRun() {
  if (dropped_) return;
  try {
    put_back();
  } catch (const std::exception& error) {
    log::warn(
        fmt::format("{}: the earlier run could not be put back: {}", folder_.string(), error.what())
    );
  }
}

void EarlierRun::put_back() const {
  const fs::path previous = folder_ / kPreviousRun;
  if (!is_our_run(previous)) {
    if (!outermost_made_.empty()) remove_if_empty(folder_, outermost_made_);
    return;
  }
  for (const char* sign : {"log.jsonl", kCheckpointFile, "env.json", "metrics.json"})
    if (is_taken(folder_ / sign)) {
      log::warn(fmt::format("the run that was there before is kept in {}", previous.string()));
      return;
    }
  remove_run(folder_);
  move_run(previous, folder_);
  std::error_code code;
  fs::remove(previous, code);
}

void EarlierRun::drop() {
  dropped_ = true;
  remove_previous(folder_);
}

void remove_renders(const fs::path& renders) {
  std::vector<fs::path> files;
  add_render_files(renders, files);
  std::error_code code;
  for (const fs::path& file : files) fs::remove(file, code);
  remove_empty_folders(files, renders.parent_path());
}

std::vector<std::string> save_in_place(
    const fs::path& folder, const std::function<void(const fs::path&)>& save
) {
  const fs::path fresh = folder / kSaving;
  fs::remove_all(fresh);
  save(fresh);
  std::vector<std::string> names;
  for (const fs::path& file : list_entries(fresh)) {
    names.push_back(file.filename().string());
    fs::rename(file, folder / names.back());
  }
  fs::remove(fresh);
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace glint
