// SPDX-License-Identifier: MIT
// WebP by libwebp, the first frame of an animation excepted: those are refused.
#include <webp/decode.h>

#include "glint/core/error.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

const std::uint8_t* bytes_of(std::string_view file) {
  return reinterpret_cast<const std::uint8_t*>(file.data());
}

WebPBitstreamFeatures features_of(const fs::path& path, std::string_view file) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes_of(file), file.size(), &features) != VP8_STATUS_OK)
    detail::fail_incomplete(path, "WebP", "the header cannot be read");
  GLINT_CHECK(
      features.has_animation == 0,
      kBadReference,
      "{}: a WebP of several pictures; save the one that is meant",
      path.string()
  );
  return features;
}

}  // namespace

detail::ClaimedSize detail::webp_size(const fs::path& path, std::string_view file) {
  const WebPBitstreamFeatures features = features_of(path, file);
  return {features.width, features.height, 4};
}

Image detail::decode_webp(
    const fs::path& path, std::string_view file, std::optional<float> background
) {
  const WebPBitstreamFeatures features = features_of(path, file);
  ByteImage pixels(features.width, features.height, 4);
  const std::uint8_t* decoded = WebPDecodeRGBAInto(
      bytes_of(file), file.size(), pixels.data(), pixels.values().size(), 4 * features.width
  );
  if (decoded == nullptr) fail_incomplete(path, "WebP", "its pixels are damaged or missing");
  Image picture(features.width, features.height, 3);
  for (std::size_t i = 0; i < picture.num_pixels(); ++i) {
    const float alpha = background ? unit_value(pixels.data()[4 * i + 3], 255) : 1;
    for (std::size_t c = 0; c < 3; ++c)
      picture.data()[3 * i + c] =
          alpha * unit_value(pixels.data()[4 * i + c], 255) + (1 - alpha) * background.value_or(0);
  }
  return picture;
}

}  // namespace glint
