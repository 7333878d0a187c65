// SPDX-License-Identifier: MIT
// In place of the loaders of folders (library folder_loaders), which need image libraries.
#include "datasets/dataset.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

LoaderMatch match(const fs::path& path) {
  return {is_folder(path) ? Sureness::kName : Sureness::kNone, "a folder"};
}

[[noreturn]] Scene load(const fs::path& path, const LoadOptions&) {
  throw Error(
      ExitCode::kEnvironment,
      fmt::format(
          "{}: a folder; this lean build reads packed scenes only: make one with the full build "
          "(glint-bench dataset pack {} room.safetensors)",
          path.string(),
          path.string()
      )
  );
}

}  // namespace

GLINT_REGISTER(LoaderSpec, {"folder", match, load, "nothing: folders need the full build"})

}  // namespace glint
