// SPDX-License-Identifier: MIT
#include "reports/run/parcels/parcel_pictures.h"

#include "glint/core/evenly_chosen.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "reports/run/parcels/depth_check.h"
#include "reports/run/parcels/picture_code.h"
#include "reports/show/pictures/layers.h"

namespace glint {
namespace {

// In the order in which they are taken; those that a method does not render are passed over.
constexpr const char* kSmallMaps[] = {
    "depth",
    "transmission",
    "reflection",
    "transparency",
    "behind_depth",
    "normal",
    "interface",
    "specularity"};

// Each pixel the mean of four.
Image halved(const Image& image) {
  Image half(std::max(image.width() / 2, 1), std::max(image.height() / 2, 1), image.channels());
  for (int y = 0; y < half.height(); ++y)
    for (int x = 0; x < half.width(); ++x)
      for (int c = 0; c < half.channels(); ++c) {
        const int right = std::min(2 * x + 1, image.width() - 1),
                  below = std::min(2 * y + 1, image.height() - 1);
        half.at(x, y, c) = 0.25f * (image.at(2 * x, 2 * y, c) + image.at(right, 2 * y, c) +
                                    image.at(2 * x, below, c) + image.at(right, below, c));
      }
  return half;
}

std::string png_of(const Image& picture) {
  const TemporaryFolder folder("glint-parcel");
  write_png(folder / "picture.png", picture);
  return read_file(folder / "picture.png");
}

class PictureTaker {
 public:
  PictureTaker(const RunSpec& spec, const Scene& scene)
      : spec_(spec), scene_(scene), views_(evenly_chosen(kPictureViews, scene.test.size())) {}

  std::map<std::string, std::string> take() {
    take_pictures();
    scale_ = depth_scale({spec_.folder}, scene_.test);
    // The middle view first: where there is room for one only, it is that.
    std::rotate(
        views_.begin(),
        views_.begin() + static_cast<std::ptrdiff_t>(views_.size() / 2),
        views_.end()
    );
    for (const std::size_t view : views_)
      for (const char* map : kSmallMaps) take_small(scene_.test[view], map);
    return std::move(taken_);
  }

 private:
  void take_pictures() {
    for (const std::size_t view : views_) {
      const fs::path folder = view_folder(spec_.folder, scene_.test[view].name);
      const fs::path picture = folder / MapId("rgb").row().picture;
      if (is_there(picture))
        add("renders" / folder.filename() / picture.filename(), read_file(picture));
    }
  }

  void take_small(const View& view, const std::string& map) {
    const fs::path folder = view_folder(spec_.folder, view.name);
    if (!has_rendered_layer(folder, map, view)) return;
    const Image values = rendered_layer(folder, map, view);
    if (values.empty()) return;
    const PageLayer layer = layer_of(*find_map(map));
    Image picture = halved(layer_picture(layer, values, scale_));
    const fs::path name = fs::path("pictures") / folder.filename() / (map + ".png");
    if (view.name != scene_.test[views_.front()].name) picture = halved(picture);
    if (!add(name, png_of(picture))) add(name, png_of(halved(picture)));
  }

  bool add(const fs::path& name, const std::string& bytes) {
    const auto code = code_picture(bytes);
    const std::size_t size = code ? code->coded.size() : bytes.size();  // as it is sent
    if (bytes_ + size > kPictureBytes) return false;
    bytes_ += size;
    taken_[name.generic_string()] = bytes;
    return true;
  }

  const RunSpec& spec_;
  const Scene& scene_;
  std::vector<std::size_t> views_;
  DepthScale scale_;
  std::map<std::string, std::string> taken_;
  std::size_t bytes_ = 0;
};

}  // namespace

std::map<std::string, std::string> parcel_pictures(const RunSpec& spec, const Scene& scene) try {
  return PictureTaker(spec, scene).take();
} catch (const Error& error) {
  log::warn(fmt::format("{}: a parcel without pictures: {}", spec.folder.string(), error.what()));
  return {};
}

}  // namespace glint
