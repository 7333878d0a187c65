// SPDX-License-Identifier: MIT
#include <turbojpeg.h>

#include <memory>

#include "glint/scene/image_files.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

bool read(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.jpg");
  accepts([&] { read_image_size(file); });
  return accepts([&] { read_image(file, 3); });
}

FuzzInput jpeg(const char* name, int sampling, int flags) {
  constexpr int kWidth = 17, kHeight = 9;
  unsigned char pixels[kWidth * kHeight * 3];
  for (std::size_t i = 0; i < sizeof pixels; ++i) pixels[i] = static_cast<unsigned char>(5 * i);
  const std::unique_ptr<void, decltype(&tjDestroy)> encoder(tjInitCompress(), tjDestroy);
  unsigned char* file = nullptr;
  unsigned long size = 0;
  const int result = tjCompress2(
      encoder.get(), pixels, kWidth, 0, kHeight, TJPF_RGB, &file, &size, sampling, 75, flags
  );
  GLINT_CHECK(result == 0, kEnvironment, "{}: {}", name, tjGetErrorStr2(encoder.get()));
  FuzzInput seed{name, std::string(reinterpret_cast<char*>(file), size)};
  tjFree(file);
  return seed;
}

std::vector<FuzzInput> seeds() {
  return {
      jpeg("420", TJSAMP_420, 0),
      jpeg("444", TJSAMP_444, 0),
      jpeg("grey", TJSAMP_GRAY, 0),
      jpeg("progressive", TJSAMP_420, TJFLAG_PROGRESSIVE)};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"jpeg", read, seeds})

}  // namespace glint::fuzz
