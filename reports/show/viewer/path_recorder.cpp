// SPDX-License-Identifier: MIT
#include "reports/show/viewer/path_recorder.h"

#include "reports/run/records/script_text.h"

namespace glint {

namespace {

constexpr std::size_t kMaxCameras = 20000;
constexpr double kFps = 24;

std::string name_of(const Json& message) {
  const Json name = message.value("name", Json());
  const std::string text = name.is_string() ? name.get<std::string>() : "";
  const std::string problem = why_no_folder_name(text);
  GLINT_CHECK(problem.empty(), kUsage, "name: '{}' {}; expected the name of a file", text, problem);
  return text;
}

CameraPath path_of(const Json& message, const Camera& lens) {
  const Json cameras = message.value("cameras", Json());
  GLINT_CHECK(
      cameras.is_array() && !cameras.empty() && cameras.size() <= kMaxCameras,
      kUsage,
      "cameras: expected a list of 1 to {}",
      kMaxCameras
  );
  CameraPath path;
  for (std::size_t i = 0; i < cameras.size(); ++i)
    path.cameras.push_back(camera_from_json(cameras[i], lens, fmt::format("cameras[{}]", i)));
  const Json fps = message.value("fps", Json(kFps));
  path.fps = fps.is_number() && fps.get<double>() > 0 ? fps.get<double>() : kFps;
  return path;
}

}  // namespace

Json PathRecorder::begin(const Json& message, ViewedRun& run, const Scene& scene) {
  const std::string name = name_of(message);
  const CameraPath path = path_of(message, scene.train.front().camera);
  const bool video = message.value("video", Json(false)) == true;
  GLINT_CHECK(!video || !busy(), kUsage, "{} is being made; wait for it", name_);
  const fs::path folder = run.names().folder / "paths", file = folder / (name + ".json");
  write_camera_path(file, path);
  if (video) {
    rendering_ = std::make_unique<PathRendering>(
        run.method(), scene, PathFrames{folder / name, path, {}, false}
    );
    name_ = name;
  }
  const std::string command = fmt::format(
      "glint-bench render --run {} --path {}",
      shell_word(run.names().folder.string()),
      shell_word(file.string())
  );
  return {{"type", "path"}, {"file", file.string()}, {"command", command}};
}

Json PathRecorder::step() {
  try {
    if (rendering_->done() == rendering_->count()) return finish();
    rendering_->next();
  } catch (...) {
    rendering_.reset();
    throw;
  }
  return {
      {"type", "video"},
      {"name", name_},
      {"done", rendering_->done()},
      {"of", rendering_->count()},
      {"file", Json()},
      {"error", Json()}};
}

Json PathRecorder::finish() {
  const PathResult result = rendering_->finish();
  rendering_.reset();
  const bool made = !result.video.empty();
  const std::lock_guard lock(mutex_);
  if (made) videos_[name_] = result.video;
  return {
      {"type", "video"},
      {"name", name_},
      {"done", result.frames},
      {"of", result.frames},
      {"file", made ? Json(result.video.string()) : Json()},
      {"error", made ? Json() : Json(result.no_video)}};
}

fs::path PathRecorder::video(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = videos_.find(name);
  return found == videos_.end() ? fs::path() : found->second;
}

}  // namespace glint
