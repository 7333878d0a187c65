// SPDX-License-Identifier: MIT
#include "reports/run/bench/path_frames.h"

#include <algorithm>
#include <optional>

#include "glint/core/interrupt.h"
#include "glint/core/nearest.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "reports/run/bench/video.h"
#include "reports/show/pictures/layers.h"
#include "reports/show/pictures/relit.h"
#include "reports/show/pictures/strip.h"

namespace glint {

// A picture of each frame: of a map, or of none in the table (layer_without_glass()).
struct ShownLayer {
  PageLayer layer;
  std::optional<MapRow> row;

  Image map_in(const MapSet& output) const { return row ? output[*row] : without_glass(output); }
};

namespace {

constexpr const char* kPathFile = "path.json";
constexpr std::size_t kDepthFrames = 8;  // that give the range of depths where there is no truth

std::vector<ShownLayer> shown_layers(const MapSet& output) {
  std::vector<ShownLayer> shown;
  output.for_each([&](const MapRow& row, const Image&) {
    if (!row.shown_file().empty()) shown.push_back({layer_of(row), row});
  });
  if (!without_glass(output).empty()) shown.push_back({layer_without_glass(), {}});
  return shown;
}

std::vector<std::string> ids_of(const std::vector<ShownLayer>& layers) {
  std::vector<std::string> ids;
  for (const ShownLayer& one : layers) ids.push_back(one.layer.id);
  return ids;
}

// Those of what was rendered that are wanted, in the order in which they are.
std::vector<ShownLayer> chosen_layers(
    const MapSet& output, const std::vector<std::string>& wanted
) {
  std::vector<ShownLayer> all = shown_layers(output);
  if (wanted.empty()) return all;
  const std::vector<std::string> ids = ids_of(all);
  std::vector<ShownLayer> chosen;
  for (const std::string& id : wanted) {
    const auto known = std::find(ids.begin(), ids.end(), id);
    GLINT_CHECK(
        known != ids.end(),
        kUsage,
        "--maps {}: the method renders no such map; {}its maps: {}",
        id,
        did_you_mean(id, ids),
        comma_list(ids)
    );
    chosen.push_back(all[static_cast<std::size_t>(known - ids.begin())]);
  }
  return chosen;
}

// What a path leaves in its folder, beside the cameras.
std::vector<fs::path> outputs_in(const fs::path& folder) {
  std::vector<fs::path> outputs = {folder / "layers", folder / "layers.mp4"};
  for (const MapRow& row : maps()) outputs.push_back(folder / row.id);
  outputs.push_back(folder / layer_without_glass().id);
  return outputs;
}

// Removes those of an earlier path, and nothing else.
void clear_path_folder(const fs::path& folder) {
  std::error_code code;
  for (const fs::path& output : outputs_in(folder)) {
    if (!is_taken(output)) continue;
    GLINT_CHECK(
        is_there(folder / kPathFile),
        kUsage,
        "{}: is there, but of no earlier path; choose another folder",
        output.string()
    );
    fs::remove_all(output, code);
  }
}

}  // namespace

DepthScale path_depth_scale(
    Method& method, const Scene& scene, const std::vector<Camera>& cameras
) {
  const DepthScale scale = depth_scale({}, scene.test);
  if (scale.from_truth) return scale;
  std::vector<View> frames(std::min(kDepthFrames, cameras.size()));
  for (std::size_t i = 0; i < frames.size(); ++i)
    frames[i].truth = method.render(cameras[i * cameras.size() / frames.size()]);
  return depth_scale({}, frames);
}

struct PathRendering::Frames {
  Method& method;
  PathFrames options;
  std::vector<ShownLayer> layers;
  DepthScale scale;
  PathResult result;

  void write(std::size_t frame, const MapSet& output) const {
    std::vector<TitledPicture> pictures;
    for (const ShownLayer& shown : layers) {
      const Image map = shown.map_in(output);
      if (map.empty()) continue;
      const fs::path file = options.folder / shown.layer.id / fmt::format("{:04}", frame);
      pictures.push_back({shown.layer.title, layer_picture(shown.layer, map, scale)});
      write_png(file.string() + ".png", pictures.back().picture);
      if (options.values && shown.row && !shown.row->file.empty())
        write_exr(file.string() + ".exr", map, shown.row->kind == MapKind::kNormal);
    }
    if (frame_sheet.here() && !pictures.empty())
      write_png(options.folder / "layers" / fmt::format("{:04}.png", frame), frame_sheet(pictures));
  }
};

PathRendering::PathRendering(Method& method, const Scene& scene, PathFrames options) {
  const std::vector<Camera>& cameras = options.path.cameras;
  GLINT_CHECK(!cameras.empty(), kUsage, "a path without frames");
  const auto layers = chosen_layers(method.render(cameras.front()), options.maps);
  clear_path_folder(options.folder);
  write_camera_path(options.folder / kPathFile, options.path);
  const DepthScale scale = path_depth_scale(method, scene, cameras);
  frames_ = std::make_unique<Frames>(Frames{
      method, std::move(options), layers, scale, {0, ids_of(layers), {}, {}}});
}

PathRendering::~PathRendering() = default;

std::size_t PathRendering::done() const { return frames_->result.frames; }
std::size_t PathRendering::count() const { return frames_->options.path.cameras.size(); }

void PathRendering::next() {
  const std::size_t frame = frames_->result.frames;
  frames_->write(frame, frames_->method.render(frames_->options.path.cameras[frame]));
  ++frames_->result.frames;
}

PathResult PathRendering::finish() {
  PathResult& result = frames_->result;
  const fs::path& folder = frames_->options.folder;
  const fs::path video = folder / "layers.mp4";
  result.no_video = frame_sheet.here()
                        ? write_video(folder / "layers/%04d.png", frames_->options.path.fps, video)
                        : "this lean build draws no layers side by side";
  if (result.no_video.empty()) result.video = video;
  return result;
}

PathResult render_path(Method& method, const Scene& scene, const PathFrames& options) {
  PathRendering rendering(method, scene, options);
  Progress progress("render path", rendering.count());
  while (rendering.done() < rendering.count()) {
    throw_if_interrupted();
    rendering.next();
    progress.advance();
  }
  return rendering.finish();
}

}  // namespace glint
