// SPDX-License-Identifier: MIT
#include "reports/run/parcels/parcel_file.h"

#include <algorithm>
#include <cmath>

#include "glint/core/json_error.h"
#include "glint/core/sha256.h"
#include "glint/scene/safetensors.h"
#include "glint/scene/scene.h"
#include "reports/run/parcels/byte_pack.h"
#include "reports/run/parcels/picture_code.h"

namespace glint {
namespace {

constexpr const char* kFormat = "glint-parcel";
constexpr int kVersion = 1;
constexpr std::size_t kMostFiles = 4096, kMostBytes = std::size_t{1} << 28, kMostName = 400;
constexpr std::size_t kHashDigits = 20;
constexpr const char* kPackedNot = "not";
constexpr const char* kPackedZlib = "zlib";
constexpr const char* kPackedPixels = "pixels";  // of a PNG file

// ---------------------------------------------------------------- writing

class ParcelWriter {
 public:
  explicit ParcelWriter(const Parcel& parcel) : parcel_(parcel) {
    for (const auto& [name, bytes] : parcel.files) add_file(name, bytes);
    for (const CompactFile& file : parcel.model.files)
      if (file.surfels)
        add_surfels(file);
      else
        add_model_file(file);
  }

  void write(const fs::path& path) {
    about_["depth"] = {
        {"mean_m", parcel_.model.difference.mean},
        {"one_sided", parcel_.model.difference.one_sided},
        {"tolerance_m", parcel_.model.tolerance}};
    const std::string about = about_.dump();
    write_safetensors(
        path,
        {{"format", kFormat},
         {"version", std::to_string(kVersion)},
         {"about", about},
         {"sha256", parcel_hash(about)}},
        tensors_
    );
  }

 private:
  void add_file(const std::string& name, const std::string& bytes) {
    if (name.ends_with(".png"))
      if (const auto picture = code_picture(bytes)) return add_picture(name, *picture);
    const std::string packed = pack_bytes(bytes);
    const bool smaller = packed.size() < bytes.size();
    add("file " + name, smaller ? packed : bytes);
    about_["files"][name] = {
        {"bytes", bytes.size()},
        {"packed", smaller ? kPackedZlib : kPackedNot},
        {"sha256", parcel_hash(bytes)}};
  }
  void add_picture(const std::string& name, const PictureCode& picture) {
    add("file " + name, picture.coded);
    about_["files"][name] = {
        {"packed", kPackedPixels},
        {"size", {picture.width, picture.height, picture.channels}},
        {"sha256", parcel_hash(picture.pixels)}};
  }
  void add_model_file(const CompactFile& file) {
    add_file(file.name, file.bytes);
    about_["files"][file.name]["model"] = file.zeroed ? "zeros" : "whole";
  }
  void add_surfels(const CompactFile& file) {
    Json fields = Json::object();
    for (const auto& [field, bytes] : file.code.fields) {
      add(fmt::format("surfels {} {}", file.name, field), bytes);
      fields[field] = parcel_hash(bytes);
    }
    about_["surfels"][file.name] = {
        {"of", file.count}, {"empty", file.empty}, {"code", file.code.about}, {"sha256", fields}};
  }
  void add(const std::string& tensor, std::string bytes) {
    const TensorInfo info{TensorType::kU8, {bytes.size()}};
    tensors_.push_back({tensor, info, [bytes = std::move(bytes)](std::byte* to) {
                          std::transform(bytes.begin(), bytes.end(), to, [](char byte) {
                            return static_cast<std::byte>(byte);
                          });
                        }});
  }

  const Parcel& parcel_;
  Json about_ = {{"files", Json::object()}, {"surfels", Json::object()}};
  std::vector<TensorToWrite> tensors_;
};

// ---------------------------------------------------------------- reading

class ParcelReader {
 public:
  explicit ParcelReader(const fs::path& path)
      : path_(path),
        file_(with_exit_code(ExitCode::kBadPrediction, [&] { return SafetensorsFile(path); })) {
    read_about();
  }

  Record record() {
    const std::string where = path_.string() + ": " + kRecordFile;
    const Json json = parse_json(file(kRecordFile));
    if (json.is_discarded()) fail(std::string(kRecordFile) + " is no JSON");
    return record_from_json(json, where);
  }

  Parcel parcel() {
    Parcel parcel;
    parcel.record = record();
    for (const auto& [name, entry] : entries("files").items()) {
      if (!entry.contains("model")) {
        parcel.files[name] = file(name);
        continue;
      }
      CompactFile other{.name = name, .bytes = file(name)};
      other.zeroed = entry["model"] == "zeros";
      parcel.model.files.push_back(std::move(other));
    }
    for (const auto& [name, entry] : entries("surfels").items())
      parcel.model.files.push_back(surfels(name, entry));
    read_depth(parcel.model);
    check_all_read();
    parcel.sha256 = sha256(read_file(path_));
    return parcel;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(
        ExitCode::kBadPrediction,
        fmt::format("{}: {}; the parcel is damaged, bring it again", path_.string(), what)
    );
  }

  std::string metadata(const std::string& name) const {
    const auto found = file_.metadata().find(name);
    return found == file_.metadata().end() ? "" : found->second;
  }

  void read_about() {
    GLINT_CHECK(
        metadata("format") == kFormat,
        kBadPrediction,
        "{}: no parcel: its format is '{}', expected '{}' (glint-bench all --parcels)",
        path_.string(),
        metadata("format"),
        kFormat
    );
    GLINT_CHECK(
        metadata("version") == std::to_string(kVersion),
        kBadPrediction,
        "{}: a parcel of version '{}', this program reads {}; take the program that wrote it, or a "
        "newer one",
        path_.string(),
        metadata("version"),
        kVersion
    );
    const std::string text = metadata("about");
    if (parcel_hash(text) != metadata("sha256")) fail("what it says of itself has another hash");
    about_ = parse_json(text);
    if (!about_.is_object()) fail("what it says of itself is no JSON object");
    for (const char* part : {"files", "surfels"})
      for (const auto& [name, entry] : entries(part).items()) check_name(name, entry);
    for (const auto& [name, entry] : entries("surfels").items())
      if (entries("files").contains(name)) fail(fmt::format("the file '{}' is there twice", name));
  }

  const Json& entries(const char* part) const {
    static const Json none = Json::object();
    const auto found = about_.find(part);
    if (found == about_.end()) return none;
    if (!found->is_object() || found->size() > kMostFiles)
      fail(fmt::format("'{}' is no list of files", part));
    return *found;
  }

  // A file below the run's folder, and nothing else.
  void check_name(const std::string& name, const Json& entry) const {
    std::string why = name.size() > kMostName ? "is too long" : "";
    std::istringstream parts(name + "/");
    for (std::string part; std::getline(parts, part, '/') && why.empty();) {
      why = why_no_folder_name(part);
      if (why.empty() && part.starts_with(".")) why = "is hidden";
    }
    if (!why.empty()) fail(fmt::format("the file '{}': its name {}", name, why));
    if (!entry.is_object()) fail(fmt::format("the file '{}' is not described", name));
  }

  // The bytes of a tensor of U8.
  std::string bytes(const std::string& tensor) {
    const TensorInfo* info = file_.find(tensor);
    if (info == nullptr) fail(fmt::format("'{}' is not in it", tensor));
    const auto values = with_exit_code(ExitCode::kBadPrediction, [&] {
      return file_.read<std::uint8_t>(tensor, {info->num_bytes()});
    });
    read_.push_back(tensor);
    return {values.begin(), values.end()};
  }

  std::string file(const std::string& name) {
    const Json& files = entries("files");
    if (!files.contains(name)) fail(fmt::format("no {}", name));
    try {
      const Json& entry = files[name];
      const std::string packed = entry.at("packed").get<std::string>(),
                        hash = entry.at("sha256").get<std::string>();
      if (packed == kPackedPixels) return picture(name, entry.at("size"), hash);
      if (packed != kPackedZlib && packed != kPackedNot)
        fail(fmt::format("{} is packed as '{}'", name, packed));
      std::size_t size = 0;
      read_field(entry.at("bytes"), size);
      return content(name, size, packed == kPackedZlib, hash);
    } catch (const nlohmann::json::exception& error) {
      fail(fmt::format("{}: {}", name, json_error(error)));
    }
  }

  std::string content(
      const std::string& name, std::size_t size, bool packed, const std::string& hash
  ) {
    if (size > kMostBytes - bytes_) fail(fmt::format("{} is said to have {} bytes", name, size));
    bytes_ += size;
    std::string content = bytes("file " + name);
    if (packed) content = unpack_bytes(content, size, path_.string() + ": " + name);
    check_hash(name, content, hash);
    if (content.size() != size) fail(fmt::format("{} has {} bytes", name, content.size()));
    return content;
  }

  std::string picture(const std::string& name, const Json& size, const std::string& hash) {
    PictureCode picture{.coded = bytes("file " + name)};
    read_field(size.at(0), picture.width);
    read_field(size.at(1), picture.height);
    read_field(size.at(2), picture.channels);
    std::string png = picture_of_code(picture, path_.string() + ": " + name);
    check_hash(name, picture.pixels, hash);
    return png;
  }

  void check_hash(const std::string& name, const std::string& bytes, const std::string& hash)
      const {
    if (parcel_hash(bytes) != hash)
      fail(fmt::format("{} has other bytes than it was sent with", name));
  }

  CompactFile surfels(const std::string& name, const Json& entry) {
    CompactFile file{.name = name, .surfels = true};
    const std::string where = path_.string() + ": " + name;
    try {
      read_field(entry.at("of"), file.count);
      read_field(entry.at("empty"), file.empty);
      file.code.about = entry.at("code");
      for (const auto& [field, hash] : entry.at("sha256").items()) {
        std::string& content = file.code.fields[field];
        content = bytes(fmt::format("surfels {} {}", name, field));
        if (hash != parcel_hash(content)) fail(fmt::format("{}: {} has other bytes", name, field));
      }
    } catch (const nlohmann::json::exception& error) {
      fail(fmt::format("{}: {}", name, json_error(error)));
    }
    unpack_surfels(file.code.about, file.code.fields, where);  // or it is refused
    return file;
  }

  void read_depth(CompactModel& model) const {
    const Json depth = about_.value("depth", Json::object());
    const auto number = [&](const char* name) { return number_or(depth, name, 0); };
    model.difference = {number("mean_m"), number("one_sided")};
    model.tolerance = number("tolerance_m");
    for (const double value : {model.difference.mean, model.difference.one_sided, model.tolerance})
      if (!(value >= 0) || !std::isfinite(value)) fail("the error of its depth is no number");
  }

  void check_all_read() {
    std::sort(read_.begin(), read_.end());
    for (const std::string& name : file_.names())
      if (!std::binary_search(read_.begin(), read_.end(), name))
        fail(fmt::format("it holds '{}', of which it says nothing", name));
  }

  fs::path path_;
  SafetensorsFile file_;
  Json about_;
  std::vector<std::string> read_;  // tensors
  std::size_t bytes_ = 0;          // of the files that were read
};

}  // namespace

std::string parcel_hash(std::string_view bytes) { return sha256(bytes).substr(0, kHashDigits); }

std::string parcel_name(const CellKey& cell) {
  std::string name = cell.text();
  std::replace(name.begin(), name.end(), '/', '+');
  return name + kParcelExtension;
}

void write_parcel(const fs::path& path, const Parcel& parcel) { ParcelWriter(parcel).write(path); }

Parcel read_parcel(const fs::path& path) {
  return read_within_memory(path, [&] { return ParcelReader(path).parcel(); });
}

Record read_parcel_record(const fs::path& path) { return ParcelReader(path).record(); }

}  // namespace glint
