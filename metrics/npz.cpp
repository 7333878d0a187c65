// SPDX-License-Identifier: MIT
#include "metrics/npz.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string_view>

#include "glint/core/error.h"
#include "glint/core/npy.h"

namespace glint {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 30;  // what entries may unpack to, together

void check_zip(bool good, const fs::path& path) {
  GLINT_CHECK(
      good, kBadReference, "{}: not a complete .npz file; copy or write it again", path.string()
  );
}

// The numbers of a zip, little-endian; errors: behind its end.
class ZipBytes {
 public:
  ZipBytes(std::string_view bytes, const fs::path& path) : bytes_(bytes), path_(path) {}

  std::string_view text(std::size_t at, std::size_t count) const {
    check_zip(at <= bytes_.size() && count <= bytes_.size() - at, path_);
    return bytes_.substr(at, count);
  }
  std::uint32_t number(std::size_t at, std::size_t num_bytes) const {
    std::uint32_t value = 0;
    for (const char byte : text(at, num_bytes)) {
      value = value >> 8 | static_cast<std::uint32_t>(static_cast<unsigned char>(byte)) << 24;
    }
    return value >> 8 * (4 - num_bytes);
  }
  bool has(std::size_t at, std::string_view signature) const {
    return text(at, signature.size()) == signature;
  }
  std::size_t size() const { return bytes_.size(); }
  void check(bool good) const { check_zip(good, path_); }

 private:
  std::string_view bytes_;
  const fs::path& path_;
};

// Signatures and sizes of APPNOTE.TXT 4.3: of an entry, of its line in the directory behind all
// entries, of the record behind the directory.
constexpr std::string_view kEntry{"PK\x03\x04", 4}, kLine{"PK\x01\x02", 4}, kEnd{"PK\x05\x06", 4};
constexpr std::size_t kEntryBytes = 30, kLineBytes = 46, kEndBytes = 22;
constexpr std::size_t kMostComment = 0xffff;
constexpr std::uint32_t kStored = 0, kDeflated = 8;

struct ZipEntry {
  std::string name;
  std::uint32_t method, crc;
  std::size_t packed_bytes, bytes, at;  // at: where the entry begins
};

std::size_t find_end(const ZipBytes& zip) {
  zip.check(zip.size() >= kEndBytes);
  const std::size_t last = zip.size() - kEndBytes;
  for (std::size_t back = 0; back <= std::min(last, kMostComment); ++back)
    if (zip.has(last - back, kEnd) && zip.number(last - back + 20, 2) == back) return last - back;
  zip.check(false);
  return 0;
}

std::vector<ZipEntry> directory_of(const ZipBytes& zip) {
  const std::size_t end = find_end(zip);
  std::size_t at = zip.number(end + 16, 4);
  std::vector<ZipEntry> entries(zip.number(end + 10, 2));
  for (ZipEntry& entry : entries) {
    zip.check(zip.has(at, kLine));
    const std::size_t name_bytes = zip.number(at + 28, 2);
    entry.name = zip.text(at + kLineBytes, name_bytes);
    entry.method = zip.number(at + 10, 2);
    entry.crc = zip.number(at + 16, 4);
    entry.packed_bytes = zip.number(at + 20, 4), entry.bytes = zip.number(at + 24, 4);
    entry.at = zip.number(at + 42, 4);
    at += kLineBytes + name_bytes + zip.number(at + 30, 2) + zip.number(at + 32, 2);
  }
  zip.check(at == end);
  return entries;
}

struct FreeInflater {
  void operator()(libdeflate_decompressor* inflater) const {
    libdeflate_free_decompressor(inflater);
  }
};

std::string inflated(std::string_view packed, std::size_t bytes, const ZipBytes& zip) {
  const std::unique_ptr<libdeflate_decompressor, FreeInflater> inflater(
      libdeflate_alloc_decompressor()
  );
  std::string content(bytes, '\0');
  const auto result = libdeflate_deflate_decompress(
      inflater.get(), packed.data(), packed.size(), content.data(), content.size(), nullptr
  );
  zip.check(result == LIBDEFLATE_SUCCESS);  // also where it would be shorter
  return content;
}

// No entry is larger than `limit`.
std::string read_entry(
    const ZipBytes& zip, const ZipEntry& entry, const fs::path& path, std::size_t limit
) {
  GLINT_CHECK(
      entry.bytes <= limit,
      kBadReference,
      "{}: more than {} MiB of arrays; this is no file of LPIPS weights",
      path.string(),
      kMaxBytes >> 20
  );
  zip.check(zip.has(entry.at, kEntry));
  const std::size_t begin =
      entry.at + kEntryBytes + zip.number(entry.at + 26, 2) + zip.number(entry.at + 28, 2);
  const std::string_view packed = zip.text(begin, entry.packed_bytes);
  zip.check(entry.method == kDeflated || (entry.method == kStored && packed.size() == entry.bytes));
  std::string content =
      entry.method == kStored ? std::string(packed) : inflated(packed, entry.bytes, zip);
  zip.check(libdeflate_crc32(0, content.data(), content.size()) == entry.crc);
  return content;
}

// False where the product of the extents is not `count` values.
bool fits(const std::vector<std::int64_t>& shape, std::size_t count) {
  std::size_t product = 1;
  for (const std::int64_t extent : shape) {
    if (extent < 1 || static_cast<std::uint64_t>(extent) > count / product) return false;
    product *= static_cast<std::size_t>(extent);
  }
  return product == count;
}

NpzArray parse_array(std::string_view file, const std::string& where) {
  const NpyHeader header = parse_npy_header(file, where);
  GLINT_CHECK(
      header.type == "<f4" && !header.fortran_order,
      kBadReference,
      "{}: type '{}'{}; expected '<f4' (float32, little-endian) in C order",
      where,
      header.type,
      header.fortran_order ? " in Fortran order" : ""
  );
  const std::size_t num_bytes = file.size() - header.values_at;
  NpzArray array{header.shape, std::vector<float>(num_bytes / sizeof(float))};
  GLINT_CHECK(
      num_bytes % sizeof(float) == 0 && fits(header.shape, array.values.size()),
      kBadReference,
      "{}: {} bytes of values do not fill the shape ({})",
      where,
      num_bytes,
      fmt::join(header.shape, ", ")
  );
  std::memcpy(array.values.data(), file.data() + header.values_at, num_bytes);
  return array;
}

}  // namespace

NpzArrays read_npz(const fs::path& path) {
  std::error_code code;
  GLINT_CHECK(fs::is_regular_file(path, code), kBadReference, "{}: no such file", path.string());
  const std::string file = read_file(path);
  const ZipBytes zip(file, path);
  NpzArrays arrays;
  std::size_t limit = kMaxBytes;
  for (const ZipEntry& entry : directory_of(zip)) {
    const std::string content = read_entry(zip, entry, path, limit);
    limit -= content.size();
    const std::string where = fmt::format("{}: {}", path.string(), entry.name);
    const bool npy = entry.name.ends_with(".npy");
    const std::string name = npy ? entry.name.substr(0, entry.name.size() - 4) : entry.name;
    const bool fresh = arrays.emplace(name, parse_array(content, where)).second;
    GLINT_CHECK(fresh, kBadReference, "{}: comes twice", where);
  }
  return arrays;
}

}  // namespace glint
