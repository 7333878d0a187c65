// SPDX-License-Identifier: MIT
// A packed scene (packed_scene.h) in place of a folder. Its split is the one it was packed with.
#include "datasets/dataset.h"
#include "datasets/packed_scene.h"
#include "datasets/view_maps.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

LoaderMatch match(const fs::path& path) {
  if (!is_file(path)) return {};
  return {Sureness::kContents, "a file"};  // folders are all that others look for
}

Scene load(const fs::path& path, const LoadOptions& options) {
  GLINT_CHECK(
      options.priors == PriorOptions{},
      kUsage,
      "{}: a packed scene keeps the priors that it was packed with; give options of priors to "
      "`dataset pack`",
      path.string()
  );
  GLINT_CHECK(
      options.background.empty(),
      kUsage,
      "{}: a packed scene keeps the pictures that it was packed with; give --background to "
      "`dataset pack`",
      path.string()
  );
  Scene scene = read_packed_scene(path);
  for (std::vector<View>* views : {&scene.train, &scene.test})
    for (View& view : *views) {
      if (!options.with_priors) view.priors = {};
      if (!options.with_truth) view.truth = {};
      fit_view(view, options);
    }
  return scene;
}

}  // namespace

GLINT_REGISTER(LoaderSpec, {"packed", match, load, "a file that `glint-bench dataset pack` wrote"})

}  // namespace glint
