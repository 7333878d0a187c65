// SPDX-License-Identifier: MIT
// EXR through OpenEXR, in memory: OpenEXR's own file streams hide a full disk when they close.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>

#include <cstring>
#include <stdexcept>
#include <vector>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

class MemoryInput : public Imf::IStream {
 public:
  MemoryInput(const std::string& name, std::string_view bytes)
      : IStream(name.c_str()), bytes_(bytes) {}
  bool read(char* to, int count) override {
    const auto n = static_cast<std::size_t>(count);
    if (at_ > bytes_.size() || bytes_.size() - at_ < n)
      throw std::runtime_error("it ends too early");
    std::memcpy(to, bytes_.data() + at_, n);
    at_ += n;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override { at_ = position; }

 private:
  std::string_view bytes_;
  std::uint64_t at_ = 0;
};

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : OStream("memory") {}
  void write(const char* from, int count) override {
    const auto n = static_cast<std::size_t>(count);
    if (bytes_.size() < at_ + n) bytes_.resize(at_ + n);
    std::memcpy(bytes_.data() + at_, from, n);
    at_ += n;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::uint64_t at_ = 0;
};

// The channels that make up the image: R G B, X Y Z, or the only one.
std::vector<std::string> choose_channels(const fs::path& path, const Imf::ChannelList& channels) {
  for (const char* triple : {"RGB", "XYZ"}) {
    std::vector<std::string> names;
    for (int c = 0; c < 3; ++c)
      if (channels.findChannel(std::string(1, triple[c]))) names.emplace_back(1, triple[c]);
    if (names.size() == 3) return names;
  }
  std::vector<std::string> found;
  for (auto it = channels.begin(); it != channels.end(); ++it) found.emplace_back(it.name());
  GLINT_CHECK(
      found.size() == 1,
      kBadReference,
      "{}: channels {}; expected R G B, X Y Z or a single one",
      path.string(),
      found.empty() ? "none" : fmt::format("{}", fmt::join(found, " "))
  );
  return found;
}

// The size of the picture. A cropped picture (data window inside a larger display window) would be
// shifted against its camera.
detail::ClaimedSize window_size(const fs::path& path, const Imf::Header& header) {
  const auto& data = header.dataWindow();
  GLINT_CHECK(
      data == header.displayWindow(),
      kBadReference,
      "{}: the data window differs from the display window; save the image uncropped",
      path.string()
  );
  return {std::int64_t{data.max.x} - data.min.x + 1, std::int64_t{data.max.y} - data.min.y + 1, 1};
}

// Slices of one interleaved float image. OpenEXR adds the window's origin itself: `origin` undoes
// it.
Imf::FrameBuffer interleaved_slices(
    float* pixels, ImageSize size, const std::vector<std::string>& names, Imath::V2i origin
) {
  const std::size_t x_stride = sizeof(float) * names.size();
  const std::size_t y_stride = x_stride * static_cast<std::size_t>(size.width);
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < names.size(); ++c) {
    char* base = reinterpret_cast<char*>(pixels + c) -
                 std::int64_t{origin.x} * static_cast<std::int64_t>(x_stride) -
                 std::int64_t{origin.y} * static_cast<std::int64_t>(y_stride);
    buffer.insert(names[c], Imf::Slice(Imf::FLOAT, base, x_stride, y_stride));
  }
  return buffer;
}

Image read_exr_bytes(const fs::path& path, const std::string& bytes) {
  detail::check_exr_header(path, bytes);
  MemoryInput stream(path.string(), bytes);
  Imf::InputFile file(stream, 0);
  const Imf::Header& header = file.header();
  if (!file.isComplete()) detail::fail_incomplete(path, "EXR", "scan lines are missing");
  detail::ClaimedSize size = window_size(path, header);
  const std::vector<std::string> names = choose_channels(path, header.channels());
  size.channels = static_cast<std::int64_t>(names.size());
  detail::check_claimed_size(path, size, bytes.size());
  for (const std::string& name : names)
    GLINT_CHECK(
        header.channels()[name].xSampling == 1 && header.channels()[name].ySampling == 1,
        kBadReference,
        "{}: channel {} is subsampled; save it at full resolution",
        path.string(),
        name
    );
  Image image(
      static_cast<int>(size.width), static_cast<int>(size.height), static_cast<int>(size.channels)
  );
  const auto& window = header.dataWindow();
  file.setFrameBuffer(interleaved_slices(image.data(), image.size(), names, window.min));
  file.readPixels(window.min.y, window.max.y);
  return image;
}

std::vector<std::string> channel_names(const fs::path& path, ImageView image, bool xyz) {
  if (image.channels == 1) return {"Z"};
  GLINT_CHECK(
      image.channels == 3 && !image.empty(),
      kUsage,
      "{}: cannot write an EXR of {} x {} pixels with {} channels; expected 1 or 3 channels",
      path.string(),
      image.width,
      image.height,
      image.channels
  );
  if (xyz) return {"X", "Y", "Z"};
  return {"R", "G", "B"};
}

}  // namespace

Image detail::read_exr(const fs::path& path) {
  const std::string bytes = read_file(path);
  try {
    return read_exr_bytes(path, bytes);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {  // Iex exceptions and the stream's
    fail_incomplete(path, "EXR", error.what());
  }
}

void write_exr(const fs::path& path, ImageView image, bool xyz) {
  const std::vector<std::string> names = channel_names(path, image, xyz);
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const std::string& name : names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  MemoryOutput stream;
  {  // the file is complete only once OutputFile is destroyed
    Imf::OutputFile file(stream, header, 0);
    float* pixels = const_cast<float*>(image.data);  // read only
    file.setFrameBuffer(interleaved_slices(pixels, image.size(), names, {0, 0}));
    file.writePixels(image.height);
  }
  write_file(path, stream.bytes());
}

}  // namespace glint
