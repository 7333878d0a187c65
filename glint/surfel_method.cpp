// SPDX-License-Identifier: MIT
#include "glint/surfel_method.h"

#include "glint/scene/ply.h"

namespace glint {

namespace {

fs::path file_of(const std::string& folder, const MethodSet& set) {
  return fs::path(folder) / (std::string(set.name) + ".ply");
}

}  // namespace

void SurfelMethod::save(const std::string& folder) const {
  for (const MethodSet& set : sets_) write_surfel_ply(file_of(folder, set), set.set->cloud());
}

void SurfelMethod::load(const std::string& folder) {
  for (const MethodSet& set : sets_) set.set->load(read_surfel_ply(file_of(folder, set)));
}

void SurfelMethod::check_channels(
    const std::string& folder, const std::vector<std::string>& names, std::size_t set
) const {
  const MethodSet& checked = sets_[set];
  GLINT_CHECK(
      checked.set->cloud().extra_names == names,
      kBadPrediction,
      "{}: expected the extra fields {}; was it trained by another method?",
      file_of(folder, checked).string(),
      comma_list(names)
  );
}

void SurfelMethod::check_finite() const {
  for (const MethodSet& set : sets_) glint::check_finite(set.set->cloud(), set.name);
}

bool SurfelMethod::visit_state(TrainingState& state) {
  for (const MethodSet& set : sets_) state(set.name, *set.set);
  return true;
}

std::size_t SurfelMethod::num_surfels() const {
  std::size_t sum = 0;
  for (const MethodSet& set : sets_) sum += set.set->cloud().size();
  return sum;
}

}  // namespace glint
