// SPDX-License-Identifier: MIT
#include "reports/verbs/dataset_parts.h"

#include <utility>

#include "glint/core/error.h"

namespace glint {

void add_front3d_options(CLI::App& make, Front3dOptions& options) {
  make.add_option("--house", options.house, "front3d: JSON file of a house of 3D-FRONT");
  make.add_option("--room", options.room, "front3d: instanceid of a room; none: the largest");
  make.add_option("--models", options.models, "front3d: folder of 3D-FUTURE's models; none: boxes");
  make.add_option(
      "--textures", options.textures, "front3d: folder of pictures for surfaces; none: patterns"
  );
}

void check_no_front3d_options(const Front3dOptions& options) {
  for (const auto& [name, value] :
       {std::pair{"--house", &options.house},
        {"--room", &options.room},
        {"--models", &options.models},
        {"--textures", &options.textures}})
    GLINT_CHECK(
        value->empty(), kUsage, "dataset make glassroom: {} {} is of front3d alone", name, *value
    );
}

Front3dOptions front3d_shots(Front3dOptions options, const GlassRoomOptions& room) {
  options.width = room.width;
  options.height = room.height;
  options.views = room.views;
  options.spp = room.spp;
  options.seed = room.seed;
  options.priors = room.priors;
  return options;
}

MadeScene make_front3d_scene(
    const CommonOptions& common,
    Front3dOptions options,
    const GlassRoomOptions& room,
    bool out_given
) {
  options = front3d_shots(std::move(options), room);
  MadeScene made{.name = front3d_name(options), .folder = common.out};
  if (!out_given)
    made.folder = fs::path(common.data) / "front3d" /
                  fmt::format("{}-{}", made.name, front3d_hash(options).substr(0, 8));
  made.is_new = make_front3d(options, made.folder, false);
  return made;
}

}  // namespace glint
