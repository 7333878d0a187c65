// SPDX-License-Identifier: MIT
#include "glint/train/training_state.h"

#include <fmt/ranges.h>

#include <sstream>

#include "glint/core/error.h"

namespace glint {

namespace {

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace

void TrainingState::operator()(const std::string& name, SurfelCloud& cloud) {
  part(name, [&] {
    std::string channels = fmt::format("{}", fmt::join(cloud.extra_names, " "));
    (*this)("extra_names", channels);
    if (reading()) cloud.extra_names = words_of(channels);
    cloud.for_each_array([&](const char* array, FloatArray& values, std::size_t) {
      (*this)(array, values);
    });
  });
  const std::size_t count = cloud.size();
  cloud.for_each_array([&](const char* array, const FloatArray& values, std::size_t width) {
    GLINT_CHECK(
        values.size() == count * width,
        kBadReference,
        "{}{}.{} has {} values, expected {} for {} surfels",
        path_,
        name,
        array,
        values.size(),
        count * width,
        count
    );
  });
}

}  // namespace glint
