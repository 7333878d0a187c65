// SPDX-License-Identifier: MIT
// JPEG, which the product reads and does not write.
#pragma once

#include <turbojpeg.h>

#include "glint/core/error.h"
#include "glint/core/files.h"
#include "glint/scene/image_files.h"

namespace glint::test {

inline void write_jpeg(const fs::path& path, const Image& colors, int quality = 95) {
  const ByteImage bytes = to_bytes(colors);
  const tjhandle coder = tjInitCompress();
  unsigned char* data = nullptr;
  unsigned long size = 0;
  const int result = tjCompress2(
      coder,
      bytes.data(),
      bytes.width(),
      0,
      bytes.height(),
      TJPF_RGB,
      &data,
      &size,
      TJSAMP_444,
      quality,
      0
  );
  if (result == 0) write_file(path, {reinterpret_cast<const char*>(data), size});
  tjFree(data);
  tjDestroy(coder);
  GLINT_CHECK(result == 0, kEnvironment, "{}: no JPEG was made", path.string());
}

}  // namespace glint::test
