// SPDX-License-Identifier: MIT
// What a page asks for besides frames: itself, photos, videos, the scene, values of pixels.
#include <algorithm>
#include <cmath>

#include "glint/core/device.h"
#include "glint/core/machine.h"
#include "glint/core/parallel.h"
#include "glint/scene/camera_path.h"
#include "glint/scene/camera_path_file.h"
#include "glint/scene/image_files.h"
#include "metrics/components.h"
#include "reports/run/bench/video.h"
#include "reports/run/records/embedded.h"
#include "reports/run/records/script_text.h"
#include "reports/show/viewer/viewer.h"

namespace glint {

namespace {

constexpr int kProtocolVersion = 1, kPhotoQuality = 90;

void replace_mark(std::string& text, std::string_view mark, const std::string& by) {
  const std::size_t at = text.find(mark);
  GLINT_CHECK(at != std::string::npos, kEnvironment, "show/viewer/dist/index.html: no {}", mark);
  text.replace(at, mark.size(), by);
}

std::string page_text(const std::string& title) {
  const auto file = [](const char* name) {
    return embedded_files().at(std::string("show/viewer/dist/") + name);
  };
  std::string html(file("index.html"));
  replace_mark(html, "<!--TITLE-->", html_text("GLINT Bench: " + title));
  replace_mark(
      html, "<!--STYLES-->", fmt::format("<style>{}</style>", inline_text(file("viewer.css")))
  );
  replace_mark(
      html, "<!--SCRIPTS-->", fmt::format("<script>{}</script>", inline_text(file("viewer.js")))
  );
  return html;
}

Json vector_json(Vec3d v) { return {v.x, v.y, v.z}; }

// A pixel by its share of the frame's width and height.
struct PixelAt {
  int x = 0, y = 0;
};
PixelAt pixel_of(const Json& question, ImageSize size) {
  const auto place = [&](const char* field, int n) {
    const Json& share = question.contains(field) ? question[field] : Json();
    GLINT_CHECK(share.is_number(), kUsage, "{}: expected a share of the frame", field);
    return std::clamp(static_cast<int>(std::floor(share.get<double>() * n)), 0, n - 1);
  };
  return {place("x", size.width), place("y", size.height)};
}

// A number, a list of three, or null where the map has nothing.
Json value_at(const Image& map, PixelAt pixel) {
  const float* values = map.data() + map.view().offset(pixel.x, pixel.y);
  Json json = Json::array();
  bool finite = true;
  for (int c = 0; c < map.channels(); ++c) {
    json.push_back(static_cast<double>(values[c]));
    finite = finite && std::isfinite(values[c]);
  }
  if (!finite) return {};
  return map.channels() == 1 ? json[0] : json;
}

Json values_at(const LayerMaps& maps, PixelAt pixel) {
  Json values = Json::object();
  for (const auto& [id, map] : maps)
    if (!map.empty()) values[id] = value_at(map, pixel);
  return values;
}

// The middle of the test cameras looks inwards, or they stand in the room they look at.
bool is_object(const Orbit& orbit, const Scene& scene) {
  const Vec3d low = cast<double>(scene.bounds_min), high = cast<double>(scene.bounds_max);
  const auto inside = [&](Vec3d p) {
    for (int i = 0; i < 3; ++i)
      if (p[i] < low[i] || p[i] > high[i]) return false;
    return true;
  };
  const auto within = std::count_if(scene.train.begin(), scene.train.end(), [&](const View& v) {
    return inside(v.camera.center());
  });
  return orbit.radius > 0 && 2 * static_cast<std::size_t>(within) < scene.train.size();
}

Json views_json(const std::vector<View>& views, const char* split) {
  Json json = Json::array();
  for (std::size_t i = 0; i < views.size(); ++i)
    json.push_back(
        {{"split", split},
         {"index", i},
         {"name", views[i].name},
         {"camera", camera_to_json(views[i].camera)},
         {"photo", !views[i].rgb.empty()}}
    );
  return json;
}

}  // namespace

HttpAnswer Viewer::get(const std::string& path, const Query& query) const {
  if (path == "/") return {200, "text/html; charset=utf-8", page_text(scene_.name)};
  if (path == "/photo") return photo(query);
  if (path == "/video") return video(query);
  return {404, "text/plain; charset=utf-8", "404: " + path + "\n"};
}

HttpAnswer Viewer::photo(const Query& query) const {
  const auto value = [&](const char* name) {
    const auto found = query.find(name);
    return found == query.end() ? std::string() : found->second;
  };
  const std::vector<View>& views = value("split") == "train" ? scene_.train : scene_.test;
  const std::string digits = value("index");
  const bool number = !digits.empty() && digits.size() < 9 &&
                      std::all_of(digits.begin(), digits.end(), [](unsigned char c) {
                        return std::isdigit(c) != 0;
                      });
  const std::size_t index = number ? std::stoul(digits) : views.size();
  if (index >= views.size()) return {404, "text/plain; charset=utf-8", "404: no such view\n"};
  return {200, "image/jpeg", jpeg_bytes(to_bytes(views[index].rgb), kPhotoQuality)};
}

HttpAnswer Viewer::video(const Query& query) const {
  const auto name = query.find("name");
  const fs::path file = name == query.end() ? fs::path() : recorder_.video(name->second);
  if (file.empty()) return {404, "text/plain; charset=utf-8", "404: no such video\n"};
  return {200, "video/mp4", read_file(file)};
}

Json Viewer::scene_json() const {
  std::vector<Camera> cameras;
  for (const View& view : scene_.train) cameras.push_back(view.camera);
  const Vec3d low = cast<double>(scene_.bounds_min), high = cast<double>(scene_.bounds_max);
  Orbit orbit;
  try {
    orbit = fit_orbit(cameras, low, high);
  } catch (const Error&) {  // all in one place
    orbit.target = 0.5 * (low + high);
    orbit.axis = -cameras.front().rotation_cam_from_world.rows[1];
  }
  return {
      {"name", scene_.name},
      {"dataset", scene_.dataset},
      {"up", vector_json(orbit.axis)},
      {"center", vector_json(orbit.target)},
      {"radius", orbit.radius > 0 ? orbit.radius : static_cast<double>(scene_.spatial_scale)},
      {"low", vector_json(low)},
      {"high", vector_json(high)},
      {"kind", is_object(orbit, scene_) ? "object" : "room"}};
}

Json Viewer::hello() const {
  const View& first = scene_.test.empty() ? scene_.train.front() : scene_.test.front();
  Json runs = Json::array();
  for (const ViewedRun& run : runs_) runs.push_back(run.json());
  Json views = views_json(scene_.train, "train");
  for (Json& view : views_json(scene_.test, "test")) views.push_back(std::move(view));
  return {
      {"type", "hello"},
      {"version", kProtocolVersion},
      {"title", scene_.name},
      {"device", on_gpu() ? device_name() : this_machine().cpu},
      {"threads", num_threads()},
      {"scene", scene_json()},
      {"size", {first.camera.width, first.camera.height}},
      {"video", video_program_is_here()},
      {"fps", kMovingFps},
      {"runs", runs},
      {"views", views},
      {"training", options_.iterations > 0 ? Json{{"iterations", options_.iterations}} : Json()}};
}

Json Viewer::probe(const Client& page, const Json& question) const {
  const ImageSize size = page.whole->camera.size();
  const PixelAt pixel = pixel_of(question, size);
  Json panes = Json::array();
  for (std::size_t i = 0; i < page.layers.size(); ++i)
    panes.push_back(
        {{"run", page.whole->panes[i].run}, {"values", values_at(page.layers[i], pixel)}}
    );
  const View* view = snapped_view(*page.whole);
  return {
      {"type", "probe"},
      {"serial", question.value("serial", Json())},
      {"x", pixel.x},
      {"y", pixel.y},
      {"size", {size.width, size.height}},
      {"panes", panes},
      {"truth", view != nullptr ? values_at(true_layers(*view), pixel) : Json()}};
}

Json Viewer::pick(const Client& page, const Json& question) const {
  Json told = {{"type", "pick"}, {"point", Json()}};
  const Camera& camera = page.whole->camera;
  const PixelAt pixel = pixel_of(question, camera.size());
  const auto depth = page.layers[0].find("depth");
  if (depth == page.layers[0].end()) return told;
  const double z = static_cast<double>(depth->second.at(pixel.x, pixel.y));
  if (z > 0)
    told["point"] =
        vector_json(camera.center() + z * camera.ray_in_world(pixel.x + 0.5, pixel.y + 0.5));
  return told;
}

}  // namespace glint
