// SPDX-License-Identifier: MIT
#include "reports/run/records/stage_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/sha256.h"

namespace glint {
namespace {

constexpr std::size_t kKeyDigits = 20;

fs::path file_of(const fs::path& folder, Stage stage) {
  return folder / "keys" / fmt::format("{}.json", stage_name(stage));
}

std::string relative_name(const fs::path& file, const fs::path& folder) {
  return file.lexically_normal().lexically_relative(folder.lexically_normal()).generic_string();
}

// Hidden ones, and keys/.
bool is_no_output(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with(".") || (name == "keys" && is_folder(path));
}

std::vector<fs::path> files_below(const fs::path& place) {
  if (is_file(place)) return {place};
  return list_files_below(place, is_no_output);
}

struct StageReading {
  std::optional<StageFile> file;
  std::string why_not;
};

StageReading examine(const fs::path& folder, Stage stage) {
  const fs::path path = file_of(folder, stage);
  const auto code = stage == Stage::kData ? ExitCode::kBadReference : ExitCode::kBadPrediction;
  const auto text = with_exit_code(code, [&] {
    return is_there(path) ? std::optional(read_file(path)) : std::nullopt;
  });
  if (!text) return {};
  const Json json = parse_json(*text);
  try {
    StageFile file{
        json.at("made_from"),
        json.at("files"),
        json.at("note"),
        json.value("sha256", std::map<std::string, std::string>{})};
    if (!file.document.is_object()) return {std::nullopt, "damaged"};
    const std::string stored = json.at("key"), key = stage_key(file.document);
    if (stored != key)
      return {
          std::move(file), fmt::format("its key {} is not that of its document, {}", stored, key)};
    return {std::move(file), ""};
  } catch (const nlohmann::json::exception&) {
    return {std::nullopt, "damaged"};
  }
}

// Empty: the file is there and of that size.
std::string size_change(const fs::path& folder, const std::string& name, std::uintmax_t bytes) {
  if (!is_file(folder / name)) return name + " is missing";
  const std::uintmax_t size = fs::file_size(folder / name);
  return size == bytes ? "" : fmt::format("{} has {} bytes, had {}", name, size, bytes);
}

bool has_same_bytes(const fs::path& folder, const StageFile& stage, const std::string& name) {
  const auto hash = stage.hashes.find(name);
  return hash == stage.hashes.end() || sha256(read_file(folder / name)) == hash->second;
}

// Other bytes have another state: sizes and times of writing come out of an archive as they were,
// the file's number and the time of its last change of any kind do not. Errors (kBadReference): it
// is gone.
Json state_of(const fs::path& file) {
  struct stat found {};
  GLINT_CHECK(
      ::stat(file.c_str(), &found) == 0,
      kBadReference,
      "{}: cannot be looked up ({})",
      file.string(),
      std::strerror(errno)
  );
  const auto nanoseconds = [](const timespec& time) {
    return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
  };
  return {found.st_size, nanoseconds(found.st_mtim), nanoseconds(found.st_ctim), found.st_ino};
}

// Hashes of files, by name and state. What cannot be read of them is computed again.
class HashCache {
 public:
  HashCache(const fs::path& data, const fs::path& cache)
      : path_(cache / (sha256(fs::absolute(data).lexically_normal().string()) + ".json")) {
    known_ = or_warn([&] { return is_there(path_) ? parse_json(read_file(path_)) : Json(); });
    if (!known_.is_object()) known_ = Json::object();
  }

  std::string hash_of(const fs::path& file, const std::string& name) {
    const Json state = state_of(file);
    const auto found = known_.find(name);
    const bool same = found != known_.end() && found->is_object() &&
                      found->value("state", Json()) == state &&
                      found->value("hash", Json()).is_string();
    const std::string hash = same ? (*found)["hash"].get<std::string>() : sha256(read_file(file));
    changed_ = changed_ || !same;
    used_[name] = {{"state", state}, {"hash", hash}};
    return hash;
  }

  // A cache that cannot be written is done without.
  void save() const try {
    if (changed_) write_file(path_, used_.dump());
  } catch (const Error&) {
  }

 private:
  fs::path path_;
  Json known_, used_ = Json::object();
  bool changed_ = false;
};

}  // namespace

std::string_view stage_name(Stage stage) {
  constexpr std::array<std::string_view, kStages.size()> kNames{
      "data", "train", "render", "mesh", "score"};
  return kNames[static_cast<std::size_t>(stage)];
}

std::string stage_key(const Json& document) {
  return sha256(document.dump()).substr(0, kKeyDigits);
}

std::optional<StageFile> read_stage(const fs::path& folder, Stage stage) {
  const StageReading reading = examine(folder, stage);
  return reading.why_not.empty() ? reading.file : std::nullopt;
}

std::string key_of_stage(const fs::path& folder, Stage stage) {
  const auto ended = read_stage(folder, stage);
  return ended ? stage_key(ended->document) : "";
}

std::string why_unreadable(const fs::path& folder, Stage stage) try {
  return examine(folder, stage).why_not;
} catch (const Error& error) {
  return error.what();
}

void write_stage(
    const fs::path& folder,
    Stage stage,
    const Json& document,
    const std::vector<std::string>& outputs,
    const std::string& note
) {
  Json json = {
      {"key", stage_key(document)},
      {"note", note},
      {"files", Json::object()},
      {"sha256", Json::object()}};
  for (const std::string& output : outputs)
    for (const fs::path& file : files_below(folder / output)) {
      const std::string name = relative_name(file, folder), content = read_file(file);
      json["files"][name] = content.size();
      json["sha256"][name] = sha256(content);
    }
  json["made_from"] = document;
  write_file(file_of(folder, stage), json.dump(1) + "\n");
}

void forget_stage(const fs::path& folder, Stage stage) {
  std::error_code code;
  fs::remove(file_of(folder, stage), code);
}

std::string what_is_damaged(const fs::path& folder, const StageFile& stage) {
  for (const auto& [name, bytes] : stage.files)
    if (std::string change = size_change(folder, name, bytes); !change.empty()) return change;
  return {};
}

std::vector<std::string> changed_files(const fs::path& folder, const StageFile& stage) {
  std::vector<std::string> changes;
  for (const auto& [name, bytes] : stage.files) {
    std::string change = size_change(folder, name, bytes);
    if (change.empty() && !has_same_bytes(folder, stage, name)) change = name + " has other bytes";
    if (!change.empty()) changes.push_back(std::move(change));
  }
  return changes;
}

Json with_machine_of(Json now, const Json& then) {
  if (!now.contains("machine") || !then.contains("machine")) return now;
  for (auto& [name, entry] : now["machine"].items()) {
    const auto found = then["machine"].find(name);
    if (entry.is_string() && found != then["machine"].end() && found->is_object()) entry = *found;
  }
  return now;
}

std::string content_hash(const fs::path& data, const fs::path& cache) {
  HashCache hashes(data, cache);
  std::string text;
  const auto files = is_file(data) ? std::vector{data}
                                   : list_files_below(data, is_no_output, FolderLinks::kFollowed);
  for (const fs::path& file : files) {
    const std::string name = relative_name(file, data);
    text += fmt::format("{} {}\n", hashes.hash_of(file, name), name);
  }
  hashes.save();
  return sha256(text).substr(0, kKeyDigits);
}

}  // namespace glint
