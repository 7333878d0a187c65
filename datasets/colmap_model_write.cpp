// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstring>
#include <iterator>

#include "datasets/colmap_model.h"
#include "glint/core/error.h"

namespace glint {
namespace {

template <class... T>
void append_bytes(std::string& bytes, const T&... values) {
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
}

// A file in both forms while it is written.
struct ModelFile {
  std::string name, binary, text;

  ModelFile(std::string file, std::string_view what, std::string_view comment, std::uint64_t count)
      : name(std::move(file)),
        text(fmt::format("# {}\n# Number of {}: {}\n", comment, what, count)) {
    append_bytes(binary, count);
  }
  void store(const fs::path& model) const {
    write_file(model / (name + ".bin"), binary);
    write_file(model / (name + ".txt"), text);
  }
};

ModelFile cameras_file(const ColmapModel& data) {
  ModelFile file(
      "cameras",
      "cameras",
      "id, model, width, height, parameters; pixel centres at +0.5",
      data.cameras.size()
  );
  for (const auto& [id, camera] : data.cameras) {
    append_bytes(file.binary, id, std::int32_t{camera.lens}, camera.width, camera.height);
    const std::string_view lens = kColmapLenses[camera.lens].name;
    file.text += fmt::format("{} {} {} {}", id, lens, camera.width, camera.height);
    for (const double value : camera.params) {
      append_bytes(file.binary, value);
      file.text += fmt::format(" {:.17g}", value);
    }
    file.text += "\n";
  }
  return file;
}

ModelFile images_file(const ColmapModel& data) {
  ModelFile file(
      "images",
      "images",
      "id, qw, qx, qy, qz, tx, ty, tz (world to camera), camera, name; then an empty line: no "
      "observations",
      data.images.size()
  );
  for (const ColmapImage& image : data.images) {
    const auto [w, x, y, z] = image.rotation_cam_from_world;
    const Vec3d& t = image.translation_cam_from_world;
    append_bytes(file.binary, image.id, w, x, y, z, t.x, t.y, t.z, image.camera_id);
    file.binary.append(image.name.c_str(), image.name.size() + 1);
    append_bytes(file.binary, std::uint64_t{0});
    file.text += fmt::format("{}", image.id);
    for (const double value : {w, x, y, z, t.x, t.y, t.z})
      file.text += fmt::format(" {:.17g}", value);
    file.text += fmt::format(" {} {}\n\n", image.camera_id, image.name);
  }
  return file;
}

ModelFile points_file(const PointCloud& points) {
  constexpr double kUnknownError = -1;
  ModelFile file(
      "points3D", "points", "id, x, y, z, r, g, b, error, no track", points.positions.size()
  );
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const std::uint64_t id = i + 1;
    const Vec3d p = cast<double>(points.positions[i]);
    std::uint8_t color[3];
    for (int c = 0; c < 3; ++c)
      color[c] = static_cast<std::uint8_t>(
          std::nearbyint(255 * std::clamp(points.colors[i][c], 0.0f, 1.0f))
      );
    append_bytes(file.binary, id, p.x, p.y, p.z, color, kUnknownError, std::uint64_t{0});
    file.text += fmt::format(
        "{} {:.17g} {:.17g} {:.17g} {} {} {} {}\n",
        id,
        p.x,
        p.y,
        p.z,
        color[0],
        color[1],
        color[2],
        kUnknownError
    );
  }
  return file;
}

}  // namespace

void write_colmap_model(const fs::path& model, const ColmapModel& data, const PointCloud& points) {
  cameras_file(data).store(model);
  images_file(data).store(model);
  points_file(points).store(model);
}

}  // namespace glint
