// SPDX-License-Identifier: MIT
// In place of the generator, which needs Embree, Bullet and image libraries.
#include "datasets/glassroom/glassroom.h"

#include "glint/core/error.h"

namespace glint {

namespace {

[[noreturn]] void fail(const GlassRoomOptions& options) {
  throw Error(
      ExitCode::kEnvironment,
      fmt::format(
          "glassroom {}: this lean build makes no scenes; make and pack it with the full build "
          "(glint-bench dataset make, dataset pack)",
          options.scene
      )
  );
}

}  // namespace

std::string glassroom_hash(const GlassRoomOptions& options) { fail(options); }
bool make_glassroom(const GlassRoomOptions& options, const fs::path&, bool) { fail(options); }

}  // namespace glint
