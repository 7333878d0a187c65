// SPDX-License-Identifier: MIT
#include "reports/run/parcels/make_parcel.h"

#include <sstream>

#include "glint/core/device_lost.h"
#include "glint/core/interrupt.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "reports/run/parcels/parcel_file.h"
#include "reports/run/parcels/parcel_pictures.h"
#include "reports/run/records/stage_files.h"

namespace glint {
namespace {

constexpr std::size_t kLogLines = 100, kLogBytes = std::size_t{32} << 10;
constexpr const char* kRunFiles[] = {"config.json", "env.json", "metrics.json"};

std::string record_text(const Record& record) { return record_to_json(record).dump() + "\n"; }

// What is there of them.
void add_files(const fs::path& run, Parcel& parcel) {
  const auto add = [&](const std::string& name) {
    if (is_file(run / name)) parcel.files[name] = read_file(run / name);
  };
  for (const char* name : kRunFiles) add(name);
  for (const Stage stage : kStages) add(fmt::format("keys/{}.json", stage_name(stage)));
  add("log.jsonl");
  if (const auto log = parcel.files.find("log.jsonl");
      log != parcel.files.end() && log->second.size() > kLogBytes)
    log->second = thinned_log(log->second, kLogLines);
}

// Of the renders' files those that come along: hashes are what packs least.
void shorten_render_key(Parcel& parcel) {
  const auto found = parcel.files.find("keys/render.json");
  Json json = found == parcel.files.end() ? Json() : parse_json(found->second);
  if (!json.is_object()) return;
  for (const char* list : {"files", "sha256"}) {
    const Json all = json.value(list, Json::object());
    json[list] = Json::object();
    for (const auto& [name, value] : all.items())
      if (parcel.files.contains(name)) json[list][name] = value;
  }
  found->second = json.dump(1) + "\n";
}

void add_results(const EndedCell& cell, Parcel& parcel) {
  RunSpec spec = read_run_spec(cell.run);
  const Scene& scene = cell.scene().scene;
  parcel.model = compact_model(spec, scene);
  parcel.files.merge(parcel_pictures(spec, scene));
  shorten_render_key(parcel);
}

Parcel parcel_of(const EndedCell& cell) {
  Parcel parcel;
  parcel.record = cell.record;
  add_files(cell.run, parcel);
  if (cell.record.ok()) add_results(cell, parcel);
  parcel.files[kRecordFile] = record_text(cell.record);
  return parcel;
}

void make_parcel(const EndedCell& cell, const fs::path& folder) {
  const fs::path path = folder / parcel_name(cell.record.cell);
  try {
    const Parcel parcel = parcel_of(cell);
    write_parcel(path, parcel);
    log::info(fmt::format(
        "  {}: {} KiB{}",
        path.string(),
        (fs::file_size(path) + 1023) / 1024,
        parcel.model.files.empty()
            ? ""
            : fmt::format(", depth within {:.3f} mm", 1e3 * parcel.model.difference.mean)
    ));
  } catch (const Interrupted&) {
    throw;
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    log::warn(fmt::format("{}: no parcel: {}", cell.record.cell.text(), error.what()));
  }
}

bool has_parcel_of(const Record& record, const fs::path& folder) {
  const fs::path path = folder / parcel_name(record.cell);
  if (!is_there(path)) return false;
  try {
    return record_text(read_parcel_record(path)) == record_text(record);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

std::function<void(const EndedCell&)> parcel_writer(const fs::path& folder) {
  return [folder](const EndedCell& cell) { make_parcel(cell, folder); };
}

void write_missing_parcels(const RunnerOptions& options, const fs::path& folder, bool only_failed) {
  const auto records = read_records(options.out / "records.jsonl");
  LoadedScene loaded;
  std::string loaded_name;
  for (const PlanCell& cell : make_plan(options.profile, options.filter, options.assignments)) {
    const Record* record = find_record(records, cell.cell);
    if (record == nullptr || (only_failed && record->ok())) continue;
    if (has_parcel_of(*record, folder)) continue;
    const auto scene = [&]() -> const LoadedScene& {
      if (loaded_name != cell.cell.scene) loaded = options.load(cell.source);
      loaded_name = cell.cell.scene;
      return loaded;
    };
    make_parcel({*record, run_folder(options.out, cell.cell), scene}, folder);
  }
}

std::string thinned_log(const std::string& log, std::size_t lines) {
  std::vector<std::string> all;
  std::istringstream in(log);
  for (std::string line; std::getline(in, line);) all.push_back(line);
  const std::size_t step =
      std::max<std::size_t>((all.size() + lines - 1) / std::max<std::size_t>(lines, 1), 1);
  std::string text;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (i % step == 0 || i + 1 == all.size() || all[i].find("\"events\"") != std::string::npos)
      text += all[i] + "\n";
  return text;
}

}  // namespace glint
