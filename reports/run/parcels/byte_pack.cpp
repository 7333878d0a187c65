// SPDX-License-Identifier: MIT
#include "reports/run/parcels/byte_pack.h"

#include <libdeflate.h>

#include <memory>

#include "glint/core/error.h"

namespace glint {
namespace {

constexpr std::size_t kMostRatio = 1032;  // of deflate

}  // namespace

std::string pack_bytes(std::string_view bytes, int level) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(level), libdeflate_free_compressor
  );
  if (!compressor) throw std::bad_alloc();
  std::string packed(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  packed.resize(libdeflate_zlib_compress(
      compressor.get(), bytes.data(), bytes.size(), packed.data(), packed.size()
  ));
  return packed;
}

std::string unpack_bytes(std::string_view packed, std::size_t bytes, std::string_view where) {
  GLINT_CHECK(
      bytes / kMostRatio <= packed.size(),
      kBadPrediction,
      "{}: {} bytes are said to be packed in {}, which cannot hold so many; the file is damaged",
      where,
      bytes,
      packed.size()
  );
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflater(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor
  );
  if (!inflater) throw std::bad_alloc();
  std::string content(bytes, '\0');
  const auto result = libdeflate_zlib_decompress(
      inflater.get(), packed.data(), packed.size(), content.data(), content.size(), nullptr
  );
  GLINT_CHECK(
      result == LIBDEFLATE_SUCCESS,
      kBadPrediction,
      "{}: the packed bytes are damaged, or not {} of them",
      where,
      bytes
  );
  return content;
}

}  // namespace glint
