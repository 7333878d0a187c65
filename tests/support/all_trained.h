// SPDX-License-Identifier: MIT
// Every method, options of theirs that change what a step does, and what comes of a training.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "glint/core/files.h"
#include "glint/method.h"
#include "tests/support/temp_folder.h"

namespace glint::test {

// Options that change what a step does: exposure counts from the start, whatever SSIM is.
inline const Json kExposure{
    {"exposure", true}, {"exposure_from", 0}, {"exposure_max_ssim_loss", 3.0}};

struct Trained {
  std::string name, id;
  Json options = Json::object();
  Trained(std::string name, std::string id, Json options)
      : name(std::move(name)), id(std::move(id)), options(std::move(options)) {}
  explicit Trained(const std::string& id) : name(id), id(id) {}
};
inline std::vector<Trained> all_trained() {
  std::vector<Trained> all;
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) all.emplace_back(id);
  for (const char* id : {"pgsr", "tsgs"})
    all.emplace_back(std::string(id) + ", exposure", id, kExposure);
  return all;
}

// What a method saves.
inline std::string saved_bytes(const Method& method) {
  const TempFolder folder;
  method.save(folder.path().string());
  std::string bytes;
  for (const fs::path& file : list_files(folder.path())) bytes += read_file(file);
  return bytes;
}

}  // namespace glint::test
