// SPDX-License-Identifier: MIT
#include "reports/run/bench/path_frames.h"

#include <algorithm>

#include "glint/core/interrupt.h"
#include "glint/core/nearest.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "reports/run/bench/video.h"
#include "reports/show/pictures/layers.h"
#include "reports/show/pictures/strip.h"

namespace glint {

namespace {

constexpr const char* kPathFile = "path.json";
constexpr std::size_t kDepthFrames = 8;  // that give the range of depths where there is no truth

// The maps to show of what was rendered.
std::vector<MapRow> chosen_maps(const MapSet& output, const std::vector<std::string>& wanted) {
  std::vector<std::string> ids;
  std::vector<MapRow> rows;
  output.for_each([&](const MapRow& row, const Image&) {
    if (row.shown_file().empty()) return;
    ids.emplace_back(row.id);
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), row.id) != wanted.end())
      rows.push_back(row);
  });
  for (const std::string& id : wanted)
    GLINT_CHECK(
        std::find(ids.begin(), ids.end(), id) != ids.end(),
        kUsage,
        "--maps {}: the method renders no such map; {}its maps: {}",
        id,
        did_you_mean(id, ids),
        comma_list(ids)
    );
  return rows;
}

// What a path leaves in its folder, beside the cameras.
std::vector<fs::path> outputs_in(const fs::path& folder) {
  std::vector<fs::path> outputs = {folder / "layers", folder / "layers.mp4"};
  for (const MapRow& row : maps()) outputs.push_back(folder / row.id);
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

DepthScale scale_of(Method& method, const Scene& scene, const std::vector<Camera>& cameras) {
  const DepthScale scale = depth_scale({}, scene.test);
  if (scale.from_truth) return scale;
  std::vector<View> frames(std::min(kDepthFrames, cameras.size()));
  for (std::size_t i = 0; i < frames.size(); ++i)
    frames[i].truth = method.render(cameras[i * cameras.size() / frames.size()]);
  return depth_scale({}, frames);
}

class FrameWriter {
 public:
  FrameWriter(const PathFrames& options, std::vector<MapRow> maps, DepthScale scale)
      : options_(options), maps_(std::move(maps)), scale_(scale) {}

  void write(std::size_t frame, const MapSet& output) const {
    std::vector<TitledPicture> pictures;
    for (const MapRow& row : maps_) {
      const Image& map = output[row];
      if (map.empty()) continue;
      const fs::path file = options_.folder / row.id / fmt::format("{:04}", frame);
      pictures.push_back({std::string(row.title), layer_picture(layer_of(row), map, scale_)});
      write_png(file.string() + ".png", pictures.back().picture);
      if (options_.values && !row.file.empty())
        write_exr(file.string() + ".exr", map, row.kind == MapKind::kNormal);
    }
    if (frame_sheet.here() && !pictures.empty())
      write_png(
          options_.folder / "layers" / fmt::format("{:04}.png", frame), frame_sheet(pictures)
      );
  }

 private:
  const PathFrames& options_;
  std::vector<MapRow> maps_;
  DepthScale scale_;
};

}  // namespace

PathResult render_path(Method& method, const Scene& scene, const PathFrames& options) {
  const std::vector<Camera>& cameras = options.path.cameras;
  GLINT_CHECK(!cameras.empty(), kUsage, "a path without frames");
  const std::vector<MapRow> rows = chosen_maps(method.render(cameras.front()), options.maps);
  clear_path_folder(options.folder);
  write_camera_path(options.folder / kPathFile, options.path);
  const FrameWriter writer(options, rows, scale_of(method, scene, cameras));
  PathResult result;
  for (const MapRow& row : rows) result.maps.emplace_back(row.id);
  Progress progress("render path", cameras.size());
  for (const Camera& camera : cameras) {
    throw_if_interrupted();
    writer.write(result.frames++, method.render(camera));
    progress.advance();
  }
  const fs::path video = options.folder / "layers.mp4";
  result.no_video = frame_sheet.here()
                        ? write_video(options.folder / "layers/%04d.png", options.path.fps, video)
                        : "this lean build draws no layers side by side";
  if (result.no_video.empty()) result.video = video;
  return result;
}

}  // namespace glint
