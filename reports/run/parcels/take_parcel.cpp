// SPDX-License-Identifier: MIT
#include "reports/run/parcels/take_parcel.h"

#include <set>

#include "glint/core/left_behind.h"
#include "metrics/metric.h"
#include "reports/run/bench/run_stage.h"
#include "reports/run/records/parcel_run.h"

namespace glint {
namespace {

// Of the machine that trained, what people ask for.
Json origin_of(const Record& record) {
  Json origin = Json::object();
  for (const char* field : {"machine", "cpu", "device", "git_revision", "date"})
    if (record.environment.contains(field)) origin[field] = record.environment[field];
  return origin;
}

// What the stage was made from, as the parcel's keys say; null: it did not end there.
Json document_in(const Parcel& parcel, Stage stage) {
  const auto found = parcel.files.find(fmt::format("keys/{}.json", stage_name(stage)));
  if (found == parcel.files.end()) return {};
  const Json json = parse_json(found->second);
  return json.is_object() ? json.value("made_from", Json()) : Json();
}

std::string dataset_folder_in(const Parcel& parcel) {
  const auto found = parcel.files.find("config.json");
  const Json json = found == parcel.files.end() ? Json() : parse_json(found->second);
  const Json folder = json.is_object() ? json.value("dataset_folder", Json()) : Json();
  return folder.is_string() ? folder.get<std::string>() : "";
}

Json parcel_json(const Parcel& parcel, const std::string& from) {
  Json files = Json::object();
  for (const CompactFile& file : parcel.model.files)
    files[file.name] =
        file.surfels
            ? (file.empty ? "left out: depth does not depend on it" : "surfels without colours")
            : (file.zeroed ? "zeros: depth does not depend on it" : "whole");
  return {
      {"parcel", from},
      {"sha256", parcel.sha256},
      {"trained_on", origin_of(parcel.record)},
      {"dataset_folder", dataset_folder_in(parcel)},
      {"colours", false},
      {"model", files},
      {"depth_error_m", parcel.model.difference.mean},
      {"one_sided", parcel.model.difference.one_sided},
      {"score_key", parcel.record.score_key},
      {"mesh_made_from", document_in(parcel, Stage::kMesh)},
      {"score_made_from", document_in(parcel, Stage::kScore)},
      {"meshes", nullptr}};
}

// The stages that ended there, with what came along of their files.
void rewrite_keys(const Parcel& parcel, const fs::path& run) {
  std::set<std::string> brought;
  for (const auto& [name, bytes] : parcel.files) brought.insert(name);
  for (const CompactFile& file : parcel.model.files) brought.insert(file.name);
  for (const Stage stage : kStages) {
    const auto done = read_stage(run, stage);
    if (!done) continue;
    std::vector<std::string> here;
    for (const auto& [name, bytes] : done->files)
      if (brought.contains(name)) here.push_back(name);
    write_stage(run, stage, done->document, here, done->note);
  }
}

void write_run(const Parcel& parcel, const std::string& from, const fs::path& run) {
  for (const auto& [name, bytes] : parcel.files) write_file(run / name, bytes);
  for (const CompactFile& file : parcel.model.files) write_compact_file(file, run);
  rewrite_keys(parcel, run);
  write_file(run / kParcelFile, parcel_json(parcel, from).dump(2) + "\n");
}

// Whole, or not at all.
void put_run(const Parcel& parcel, const std::string& from, const fs::path& run) {
  const UnfinishedFolder fresh(run);
  write_run(parcel, from, fresh.path());
  std::error_code code;
  fs::remove_all(run, code);  // of a cell that failed there
  fs::rename(fresh.path(), run, code);
  GLINT_CHECK(!code, kEnvironment, "{}: cannot be written ({})", run.string(), code.message());
}

bool has_meshes(const Record& record) {
  return record.metrics.contains(mesh_metric_list().front().id);
}

bool came_in(const fs::path& run, const Parcel& parcel) {
  const auto earlier = parcel_of_run(run);
  return earlier && earlier->value("sha256", Json()) == parcel.sha256;
}

}  // namespace

MergedCell take_parcel(
    const fs::path& into, const Parcel& parcel, const std::string& from, bool write
) {
  const fs::path records_file = into / "records.jsonl";
  const fs::path run = run_folder(into, parcel.record.cell);
  const auto records = read_records(records_file);
  const Record* ours = find_record(records, parcel.record.cell);
  if (ours != nullptr && came_in(run, parcel))
    return {parcel.record.cell, MergeVerdict::kReplicate, from, ""};
  MergedCell merged = judge_merge(parcel.record, ours, from);
  if (merged.verdict != MergeVerdict::kTaken || !write) return merged;
  put_run(parcel, from, run);
  append_record(records_file, parcel.record);
  return merged;
}

bool wants_meshes(const fs::path& run, const Record& record) {
  if (!record.ok() || has_meshes(record)) return false;
  const auto parcel = parcel_of_run(run);
  return parcel && parcel->value("mesh_made_from", Json()).is_object() &&
         !parcel->value("meshes", Json()).is_object();
}

bool wants_meshes(const Parcel& parcel) {
  return parcel.record.ok() && !has_meshes(parcel.record) &&
         document_in(parcel, Stage::kMesh).is_object();
}

}  // namespace glint
