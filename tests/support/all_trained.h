// SPDX-License-Identifier: MIT
// Every method, and options of theirs that change what a step does.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "glint/method.h"

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

}  // namespace glint::test
