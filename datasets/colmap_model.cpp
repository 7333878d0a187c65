// SPDX-License-Identifier: MIT
#include "datasets/colmap_model.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <sstream>

#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

static_assert(std::endian::native == std::endian::little);

// A binary file, read from its beginning to its end.
class ByteReader {
 public:
  explicit ByteReader(const fs::path& path) : path_(path.string()), bytes_(read_file(path)) {}

  template <class T>
  T get(const char* field) {
    require(sizeof(T), field);
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  // A number of entries of at least `smallest` bytes each.
  std::uint64_t count(std::size_t smallest, const char* field) {
    const auto value = get<std::uint64_t>(field);
    GLINT_CHECK(
        value <= (bytes_.size() - at_) / smallest,
        kBadReference,
        "{}: {} is {}, but {} bytes are left; the file is cut off or damaged",
        path_,
        field,
        value,
        bytes_.size() - at_
    );
    return value;
  }
  std::string text(const char* field) {
    const std::size_t end = bytes_.find('\0', at_);
    if (end == std::string::npos) require(bytes_.size() - at_ + 1, field);
    std::string value = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return value;
  }
  void skip(std::uint64_t count, std::size_t size) { at_ += count * size; }
  const std::string& path() const { return path_; }

 private:
  void require(std::size_t size, const char* field) const {
    GLINT_CHECK(
        size <= bytes_.size() - at_,
        kBadReference,
        "{}: ends within {}; it is cut off or damaged",
        path_,
        field
    );
  }

  std::string path_, bytes_;
  std::size_t at_ = 0;
};

int known_lens(const std::string& path, std::int64_t id) {
  GLINT_CHECK(
      id >= 0 && id < static_cast<std::int64_t>(std::size(kColmapLenses)),
      kBadReference,
      "{}: camera model {} is not known; undistort the images (colmap image_undistorter)",
      path,
      id
  );
  return static_cast<int>(id);
}

int known_lens(const std::string& path, const std::string& name) {
  for (std::size_t i = 0; i < std::size(kColmapLenses); ++i)
    if (kColmapLenses[i].name == name) return static_cast<int>(i);
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: camera model {} is not known; undistort the images (colmap image_undistorter)",
          path,
          name
      )
  );
}

std::map<std::uint32_t, ColmapCamera> read_binary_cameras(const fs::path& path) {
  ByteReader file(path);
  std::map<std::uint32_t, ColmapCamera> cameras;
  const std::uint64_t count = file.count(24, "the number of cameras");
  for (std::uint64_t i = 0; i < count; ++i) {
    ColmapCamera& camera = cameras[file.get<std::uint32_t>("a camera")];
    camera.lens = known_lens(file.path(), file.get<std::int32_t>("a camera"));
    camera.width = file.get<std::uint64_t>("a camera");
    camera.height = file.get<std::uint64_t>("a camera");
    camera.params.resize(kColmapLenses[camera.lens].num_params);
    for (double& value : camera.params) value = file.get<double>("a camera's parameters");
  }
  return cameras;
}

std::vector<ColmapImage> read_binary_images(const fs::path& path) {
  ByteReader file(path);
  std::vector<ColmapImage> images(file.count(73, "the number of images"));
  for (ColmapImage& image : images) {
    image.id = file.get<std::uint32_t>("an image");
    Vec4<double>& q = image.rotation_cam_from_world;
    for (double* value : {&q.w, &q.x, &q.y, &q.z}) *value = file.get<double>("an image");
    for (int i = 0; i < 3; ++i) image.translation_cam_from_world[i] = file.get<double>("an image");
    image.camera_id = file.get<std::uint32_t>("an image");
    image.name = file.text("an image's name");
    file.skip(file.count(24, "the number of an image's points"), 24);
  }
  return images;
}

PointCloud read_binary_points(const fs::path& path) {
  ByteReader file(path);
  PointCloud points;
  const std::uint64_t count = file.count(51, "the number of points");
  for (std::uint64_t i = 0; i < count; ++i) {
    file.get<std::uint64_t>("a point");
    Vec3d position;
    for (int c = 0; c < 3; ++c) position[c] = file.get<double>("a point");
    Vec3f color;
    for (int c = 0; c < 3; ++c) color[c] = static_cast<float>(file.get<std::uint8_t>("a point"));
    file.get<double>("a point");
    file.skip(file.count(8, "the length of a point's track"), 8);
    points.positions.push_back(cast<float>(position));
    points.colors.push_back((1 / 255.0f) * color);
  }
  return points;
}

// "# Number of images: 10, mean observations per image: 3": the number.
std::optional<std::uint64_t> stated_count(std::string_view comment) {
  const std::size_t number = comment.find(": ");
  if (!comment.starts_with("# Number of ") || number == std::string_view::npos) return {};
  std::uint64_t count = 0;
  const char* begin = comment.data() + number + 2;
  return std::from_chars(begin, comment.data() + comment.size(), count).ec == std::errc{}
             ? std::optional(count)
             : std::nullopt;
}

// Calls f(stream, line number) for every line that is no comment; the count that a comment states.
// Where `skip_empty` is not set, empty lines count, too: the second line of an image may be empty.
template <class F>
std::optional<std::uint64_t> for_each_line(const fs::path& path, bool skip_empty, F&& f) {
  std::optional<std::uint64_t> stated;
  std::istringstream file(read_text(path));
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.starts_with('#') && !stated) stated = stated_count(line);
    if (line.starts_with('#') || (skip_empty && line.empty())) continue;
    std::istringstream fields(line);
    f(fields, number);
    GLINT_CHECK(
        !fields.fail(),
        kBadReference,
        "{}: line {}: a value is missing or no number; it is cut off or damaged",
        path.string(),
        number
    );
  }
  return stated;
}

// The rest of a line has to be groups of `width` values; 0: nothing.
void require_groups(std::istringstream& fields, std::size_t width) {
  if (fields.fail()) return;
  std::size_t count = 0;
  for (std::string word; fields >> word;) ++count;
  fields.clear();
  if (width == 0 ? count > 0 : count % width != 0) fields.setstate(std::ios::failbit);
}

void check_count(
    const fs::path& path, std::optional<std::uint64_t> stated, std::size_t found, const char* what
) {
  GLINT_CHECK(
      !stated || *stated == found,
      kBadReference,
      "{}: says that it has {} {}, holds {}; it is cut off or damaged",
      path.string(),
      stated.value_or(0),
      what,
      found
  );
}

std::map<std::uint32_t, ColmapCamera> read_text_cameras(const fs::path& path) {
  std::map<std::uint32_t, ColmapCamera> cameras;
  const auto stated = for_each_line(path, true, [&](std::istringstream& fields, std::size_t) {
    std::uint32_t id = 0;
    std::string lens;
    ColmapCamera camera;
    if (!(fields >> id >> lens)) return;
    camera.lens = known_lens(path.string(), lens);
    camera.params.resize(kColmapLenses[camera.lens].num_params);
    fields >> camera.width >> camera.height;
    for (double& value : camera.params) fields >> value;
    require_groups(fields, 0);
    cameras[id] = std::move(camera);
  });
  check_count(path, stated, cameras.size(), "cameras");
  return cameras;
}

std::vector<ColmapImage> read_text_images(const fs::path& path) {
  std::vector<ColmapImage> images;
  bool is_second = false;  // line of an image: its observations
  const auto stated = for_each_line(path, false, [&](std::istringstream& fields, std::size_t) {
    if (!is_second && (fields >> std::ws).eof()) return fields.clear();
    if (is_second) require_groups(fields, 3);  // x, y and the number of a point
    if (!is_second) {
      ColmapImage& image = images.emplace_back();
      Vec4<double>& q = image.rotation_cam_from_world;
      Vec3d& t = image.translation_cam_from_world;
      fields >> image.id >> q.w >> q.x >> q.y >> q.z >> t.x >> t.y >> t.z >> image.camera_id;
      std::getline(fields >> std::ws, image.name);  // may hold blanks
    }
    is_second = !is_second;
  });
  check_count(path, stated, images.size(), "images");
  return images;
}

PointCloud read_text_points(const fs::path& path) {
  PointCloud points;
  const auto stated = for_each_line(path, true, [&](std::istringstream& fields, std::size_t) {
    std::uint64_t id = 0;
    Vec3d position;
    Vec3f color;
    double error = 0;
    fields >> id >> position.x >> position.y >> position.z >> color.x >> color.y >> color.z >>
        error;
    require_groups(fields, 2);  // of a track: the number of an image and of its point
    points.positions.push_back(cast<float>(position));
    points.colors.push_back((1 / 255.0f) * color);
  });
  check_count(path, stated, points.positions.size(), "points");
  return points;
}

// The file of that name as .bin or .txt; empty: neither.
fs::path binary_or_text(const fs::path& model, const std::string& name) {
  for (const char* extension : {".bin", ".txt"})
    if (const fs::path path = model / (name + extension); is_there(path)) return path;
  return {};
}

double length_of(const Vec4<double>& q) {
  return std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
}

// Programs write unit quaternions, few digits or many: another length is a number that is damaged.
void check_rotations(const std::vector<ColmapImage>& images, const fs::path& path) {
  constexpr double kRounding = 5e-3;
  for (const ColmapImage& image : images) {
    const double length = length_of(image.rotation_cam_from_world);
    GLINT_CHECK(
        std::abs(length - 1) < kRounding,
        kBadReference,
        "{}: image {}: its quaternion has length {:.4g}, expected 1; a number of it is damaged",
        path.string(),
        image.name,
        length
    );
  }
}

}  // namespace

Mat3d rotation_of(const ColmapImage& image) {
  const Vec4<double>& q = image.rotation_cam_from_world;
  const double norm = length_of(q);
  return rotation_from_quaternion({q.w / norm, q.x / norm, q.y / norm, q.z / norm});
}

fs::path find_colmap_model(const fs::path& folder) {
  for (const char* model : {"sparse/0", "sparse", "colmap/sparse/0"})  // ns-process-data's
    if (!binary_or_text(folder / model, "cameras").empty() &&
        !binary_or_text(folder / model, "images").empty())
      return folder / model;
  return {};
}

fs::path find_colmap_points(const fs::path& model) {
  for (const char* name : {"points3D.bin", "points3D.txt", "points3D.ply"})
    if (const fs::path path = model / name; is_there(path))
      return path.extension() == ".bin" && read_file(path) == std::string(8, '\0') ? fs::path()
                                                                                   : path;
  return {};
}

ColmapModel read_colmap_model(const fs::path& model) {
  const fs::path cameras = binary_or_text(model, "cameras"),
                 images = binary_or_text(model, "images");
  GLINT_CHECK(
      !cameras.empty() && !images.empty(),
      kBadReference,
      "{}: no COLMAP model; expected cameras.bin and images.bin, or .txt",
      model.string()
  );
  ColmapModel read{
      cameras.extension() == ".bin" ? read_binary_cameras(cameras) : read_text_cameras(cameras),
      images.extension() == ".bin" ? read_binary_images(images) : read_text_images(images)};
  check_rotations(read.images, images);
  return read;
}

PointCloud read_colmap_points(const fs::path& path) {
  PointCloud points =
      path.extension() == ".bin" ? read_binary_points(path) : read_text_points(path);
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const Vec3f p = points.positions[i];
    GLINT_CHECK(
        std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z),
        kBadReference,
        "{}: point {} is not finite; remove it",
        path.string(),
        i
    );
  }
  return points;
}

}  // namespace glint
