// SPDX-License-Identifier: MIT
// The stages of a cell and what each leaves behind when it is through: keys/<stage>.json, written
// last, with the document of everything its files were made from. The document's hash is the
// stage's key: equal keys, nothing to do again.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/files.h"

namespace glint {

enum class Stage { kData, kTrain, kRender, kMesh, kScore };
inline constexpr std::array kStages{
    Stage::kData, Stage::kTrain, Stage::kRender, Stage::kMesh, Stage::kScore};
std::string_view stage_name(Stage stage);  // "data", "train", "render", "mesh", "score"

// 20 hexadecimal digits of the document's SHA-256.
std::string stage_key(const Json& document);

struct StageFile {
  Json document;
  std::map<std::string, std::uintmax_t> files;  // what the stage wrote -> bytes
  std::string note;                             // of a stage that ended without: why no mesh
  std::map<std::string, std::string> hashes;    // name -> SHA-256; earlier versions wrote none
};

// Nothing: the stage did not end here (or the file is damaged, which is the same). Errors
// (kBadPrediction; of data kBadReference): it cannot be looked up or read.
std::optional<StageFile> read_stage(const fs::path& folder, Stage stage);
// Its key; empty: it did not end here.
std::string key_of_stage(const fs::path& folder, Stage stage);
// What is wrong with the stage's file: "damaged", "its key is not that of its document", why it
// cannot be read. Empty: nothing, or it is not there.
std::string why_unreadable(const fs::path& folder, Stage stage);
// With the files below `outputs` (files or folders in `folder`; those that are absent are not
// listed).
void write_stage(
    const fs::path& folder,
    Stage stage,
    const Json& document,
    const std::vector<std::string>& outputs,
    const std::string& note = {}
);
void forget_stage(const fs::path& folder, Stage stage);

// The first of the stage's files that is missing or has another size: "mesh.ply is missing". Empty:
// all there.
std::string what_is_damaged(const fs::path& folder, const StageFile& stage);

// Every one of them that is missing or has other bytes, in words. Files without a hash go by their
// size.
std::vector<std::string> changed_files(const fs::path& folder, const StageFile& stage);

// What differs between the documents of a stage then and now, one line each: "mesh.voxel 0.02 ->
// 0.5", "code of baselines/2dgs.cpp". Keys of the stages before ("inputs") are left out.
std::vector<std::string> stage_differences(const Json& then, const Json& now);

// `now`, where "machine" entries that the machine has no longer are those of `then`: what was
// measured with weights stays good when the weights have gone. Entries are objects where there is
// something, and text that says what is missing where not.
Json with_machine_of(Json now, const Json& then);

// A folder's or file's content: hash over names and bytes of all files but hidden ones and keys/.
// Hashes of single files are kept in `cache` by their size, times and number. Errors
// (kBadReference): a file cannot be read.
std::string content_hash(const fs::path& data, const fs::path& cache);

}  // namespace glint
