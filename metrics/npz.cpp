// SPDX-License-Identifier: MIT
#include "metrics/npz.h"

#include <minizip/unzip.h>

#include <array>
#include <cstring>
#include <memory>

#include "glint/core/error.h"
#include "glint/core/npy.h"

namespace glint {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 30;  // what entries may unpack to, together

struct CloseZip {
  void operator()(void* zip) const { unzClose(zip); }
};
using Zip = std::unique_ptr<void, CloseZip>;

void check_zip(bool good, const fs::path& path) {
  GLINT_CHECK(
      good, kBadReference, "{}: not a complete .npz file; copy or write it again", path.string()
  );
}

std::string entry_name(const Zip& zip, const fs::path& path) {
  std::array<char, 256> name{};
  unz_file_info64 info{};
  const int result = unzGetCurrentFileInfo64(
      zip.get(), &info, name.data(), name.size() - 1, nullptr, 0, nullptr, 0
  );
  check_zip(result == UNZ_OK && info.size_filename < name.size(), path);
  return name.data();
}

// Sizes in the archive are not looked at: an entry ends where its data does, and no entry is larger
// than `limit`.
std::string read_entry(const Zip& zip, const fs::path& path, std::size_t limit) {
  check_zip(unzOpenCurrentFile(zip.get()) == UNZ_OK, path);
  std::string content;
  std::array<char, 1 << 16> chunk{};
  while (true) {
    const int count = unzReadCurrentFile(zip.get(), chunk.data(), chunk.size());
    check_zip(count >= 0, path);
    if (count == 0) break;
    content.append(chunk.data(), static_cast<std::size_t>(count));
    GLINT_CHECK(
        content.size() <= limit,
        kBadReference,
        "{}: more than {} MiB of arrays; this is no file of LPIPS weights",
        path.string(),
        kMaxBytes >> 20
    );
  }
  check_zip(unzCloseCurrentFile(zip.get()) == UNZ_OK, path);  // also compares the checksum
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

NpzArrays read_arrays(const fs::path& path) {
  std::error_code code;
  GLINT_CHECK(fs::is_regular_file(path, code), kBadReference, "{}: no such file", path.string());
  const Zip zip(unzOpen64(path.c_str()));
  check_zip(zip != nullptr, path);
  NpzArrays arrays;
  std::size_t limit = kMaxBytes;
  int position = unzGoToFirstFile(zip.get());
  for (; position == UNZ_OK; position = unzGoToNextFile(zip.get())) {
    const std::string file = entry_name(zip, path);
    const std::string content = read_entry(zip, path, limit);
    limit -= content.size();
    const std::string where = fmt::format("{}: {}", path.string(), file);
    const std::string name = file.ends_with(".npy") ? file.substr(0, file.size() - 4) : file;
    const bool fresh = arrays.emplace(name, parse_array(content, where)).second;
    GLINT_CHECK(fresh, kBadReference, "{}: comes twice", where);
  }
  check_zip(position == UNZ_END_OF_LIST_OF_FILE, path);
  return arrays;
}

}  // namespace

GLINT_PROVIDE(read_npz, read_arrays)

}  // namespace glint
