// SPDX-License-Identifier: MIT
// A folder of data around one file that is fuzzed.
#pragma once

#include "datasets/dataset.h"
#include "glint/scene/image_files.h"
#include "tests/fuzz/fuzz_seeds.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {

// Loads and checks the folder. What the loader refuses, the check has to find.
inline bool read_dataset(const std::string& loader, const fs::path& folder) {
  const LoaderSpec& spec = find_loader(folder, loader);
  const bool loaded = accepts([&] { spec.load(folder, {}); });
  bool nothing_found = false;
  accepts([&] { nothing_found = spec.check(folder, {}).empty(); });
  if (nothing_found && !loaded) throw Finding("it is refused, and the check finds nothing");
  return loaded;
}

// The pictures of tiny_scene(), those of view i by their path.
template <class PathOf>
void write_pictures(const PathOf& path_of) {
  for (const View& view : tiny_scene().train) write_png(path_of(view.name), view.rgb);
}

}  // namespace glint::fuzz
