// SPDX-License-Identifier: MIT
#include "metrics/fusion/tsdf_volume.h"

#include <dlfcn.h>

#include "glint/core/error.h"
#include "glint/core/files.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

using Maker = TsdfVolume* (*)(const TsdfVolumeOptions&);

// lib/ lies beside the folder of the program.
fs::path module_path() {
  std::error_code code;
  const fs::path program = fs::read_symlink("/proc/self/exe", code);
  return program.parent_path().parent_path() / "lib" / "libglint_tsdf.so";
}

// Loaded once and kept. Null: there is none; `why` then says what the loader said.
Maker load_maker(std::string& why) {
  static std::string reason;
  static const Maker maker = []() -> Maker {
    void* module = dlopen(module_path().c_str(), RTLD_NOW | RTLD_LOCAL);
    void* symbol = module != nullptr ? dlsym(module, "glint_make_tsdf_volume") : nullptr;
    if (symbol == nullptr) reason = dlerror();
    return reinterpret_cast<Maker>(symbol);
  }();
  why = reason;
  return maker;
}

}  // namespace

std::unique_ptr<TsdfVolume> make_tsdf_volume(const TsdfVolumeOptions& options) {
  std::string why;
  const Maker maker = load_maker(why);
  GLINT_CHECK(
      maker != nullptr,
      kEnvironment,
      "no meshes: {}; install libopen3d-dev (scripts/setup.sh does) and build again",
      why
  );
  return std::unique_ptr<TsdfVolume>(maker(options));
}

bool has_tsdf_volume() { return is_there(module_path()); }

}  // namespace glint
