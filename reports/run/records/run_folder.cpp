// SPDX-License-Identifier: MIT
#include "reports/run/records/run_folder.h"

#include <algorithm>
#include <sstream>

#include "glint/core/json_error.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"
#include "reports/run/records/earlier_run.h"
#include "reports/run/records/environment.h"

namespace glint {

namespace {

// The fields of config.json, written and read in one place.
template <class S, class V>
void visit_spec(S& spec, V&& v) {
  v("method", spec.method);
  v("overrides", spec.config);
  v("iterations", spec.options.iterations);
  v("seed", spec.options.seed);
  v("dataset", spec.dataset);
  v("scene", spec.scene);
  v("max_pixels", spec.max_pixels);
  v("dataset_hash", spec.dataset_hash);
}

void check_map(const fs::path& folder, const MapRow& row, const Image& map, ImageSize size) {
  GLINT_CHECK(
      map.size() == size && map.channels() == row.channels(),
      kBadPrediction,
      "{}: the method rendered {} as {}x{}x{}, expected {}x{}x{}",
      folder.string(),
      row.id,
      map.width(),
      map.height(),
      map.channels(),
      size.width,
      size.height,
      row.channels()
  );
  GLINT_CHECK(
      !row.kept || !row.stored_file().empty(),
      kBadPrediction,
      "{}: the method rendered {}, for which the table of maps (glint/scene/maps.h) has no file",
      folder.string(),
      row.id
  );
}

}  // namespace

fs::path run_folder(const fs::path& out, const CellKey& cell) { return out / "runs" / cell.text(); }

void write_run_spec(const RunSpec& spec, const Json& resolved_config) {
  Json json = {{kWrittenByField, kWrittenBy}};
  visit_spec(spec, [&](const char* name, const auto& field) { json[name] = field; });
  json["dataset_folder"] = spec.dataset_folder.string();
  if (spec.image_ratio != 1) json["image_ratio"] = spec.image_ratio;
  json["config"] = resolved_config;
  if (!spec.row.empty()) json["row"] = spec.row;
  write_file(spec.folder / "config.json", json.dump(2) + "\n");
}

RunSpec read_run_spec(const fs::path& folder) {
  const fs::path path = folder / "config.json";
  GLINT_CHECK(
      with_exit_code(ExitCode::kBadPrediction, [&] { return is_there(path); }),
      kBadPrediction,
      "{}: not a run folder (no config.json); make one with `glint-bench train`",
      folder.string()
  );
  const Json json = read_json_object(path, ExitCode::kBadPrediction);
  RunSpec spec;
  spec.folder = folder;
  try {
    visit_spec(spec, [&](const char* name, auto& field) { read_field(json.at(name), field); });
    spec.dataset_folder = json.at("dataset_folder").get<std::string>();
    spec.row = json.value("row", "");
    spec.image_ratio = json.value("image_ratio", 1.0);
  } catch (const nlohmann::json::exception& error) {
    throw Error(
        ExitCode::kBadPrediction,
        fmt::format("{}: {}; train again", path.string(), json_error(error))
    );
  }
  return spec;
}

void write_trained(const RunSpec& spec, const TrainCost& cost) {
  Json json = environment_json();
  json["train_seconds"] = cost.seconds;
  json["peak_memory_mb"] = cost.peak_memory_mb;
  json["device_memory_mb"] = cost.device_memory_mb;
  json["void_steps"] = cost.void_steps;
  json["warnings"] = cost.warnings;
  json["notes"] = cost.notes;
  json["data_notes"] = cost.data_notes;
  write_file(spec.folder / "env.json", json.dump(2) + "\n");
}

std::optional<TrainCost> trained_cost(const RunSpec& spec) {
  const fs::path path = spec.folder / "env.json";
  if (!with_exit_code(ExitCode::kBadPrediction, [&] { return is_there(path); }))
    return std::nullopt;
  const Json json = read_json_object(path, ExitCode::kBadPrediction);
  try {
    return TrainCost{
        json.value("train_seconds", 0.0),
        json.value("peak_memory_mb", 0.0),
        json.value("device_memory_mb", 0.0),
        json.value("warnings", std::vector<std::string>{}),
        json.value("notes", std::vector<std::string>{}),
        json.value("data_notes", std::vector<std::string>{}),
        json.value("void_steps", Json())};
  } catch (const nlohmann::json::exception& error) {
    throw Error(
        ExitCode::kBadPrediction,
        fmt::format("{}: {}; train again", path.string(), json_error(error))
    );
  }
}

fs::path view_folder(const fs::path& run, const std::string& view_name) {
  return run / "renders" / flat_view_name(view_name);
}

void write_render(const fs::path& folder, const MapSet& rendered, bool eight_bit) {
  const ImageSize size = rendered["rgb"].size();
  rendered.for_each([&](const MapRow& row, const Image& map) {
    check_map(folder, row, map, size);
    const bool picture_only = eight_bit && !row.picture.empty();
    if (!row.file.empty() && !picture_only)
      write_exr(folder / row.file, map, row.kind == MapKind::kNormal);
    if (!row.picture.empty()) write_png(folder / row.picture, map);
  });
}

bool is_eight_bit_render(const fs::path& view_folder) {
  const fs::path run = view_folder.parent_path().parent_path();
  if (is_there(view_folder / "rgb.exr") || !is_there(run / "config.json")) return false;
  const Json json = read_json_object(run / "config.json", ExitCode::kBadPrediction);
  const auto config = json.find("config");
  return config != json.end() && config->is_object() &&
         config->value(kEightBitField, Json()) == true;
}

fs::path render_file(const fs::path& folder, const MapRow& row) {
  const fs::path stored = folder / row.stored_file(), picture = folder / row.picture;
  return !row.picture.empty() && !is_there(stored) && is_there(picture) ? picture : stored;
}

std::vector<std::string> log_tail(const fs::path& run, std::size_t lines) {
  std::vector<std::string> tail;
  const fs::path path = run / "log.jsonl";
  if (run.empty() || !is_there(path)) return tail;
  std::istringstream log(read_file(path));
  for (std::string line; std::getline(log, line);) tail.push_back(line);
  if (tail.size() > lines) tail.erase(tail.begin(), tail.end() - static_cast<long>(lines));
  return tail;
}

}  // namespace glint
