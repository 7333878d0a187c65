// SPDX-License-Identifier: MIT
// Zips of NumPy arrays, good ones and bad ones.
#pragma once

#include <minizip/zip.h>

#include <catch2/catch.hpp>
#include <string>

#include "metrics/npz.h"

namespace glint::test {

inline std::string npy_file(
    const NpzArray& array, const std::string& type = "<f4", const std::string& order = "False"
) {
  std::string dictionary = fmt::format(
      "{{'descr': '{}', 'fortran_order': {}, 'shape': ({},), }}\n",
      type,
      order,
      fmt::join(array.shape, ", ")
  );
  std::string file("\x93NUMPY\x01\x00", 8);
  file += static_cast<char>(dictionary.size() & 0xff);
  file += static_cast<char>(dictionary.size() >> 8);
  file += dictionary;
  file.append(
      reinterpret_cast<const char*>(array.values.data()), array.values.size() * sizeof(float)
  );
  return file;
}

// `level`: 0 stores, 9 packs most. Names may repeat.
inline void write_zip(
    const fs::path& path,
    const std::vector<std::pair<std::string, std::string>>& entries,
    int level = 0
) {
  const zipFile zip = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
  REQUIRE(zip != nullptr);
  for (const auto& [name, content] : entries) {
    const int method = level == 0 ? 0 : Z_DEFLATED;
    REQUIRE(
        zipOpenNewFileInZip64(
            zip, name.c_str(), nullptr, nullptr, 0, nullptr, 0, nullptr, method, level, 1
        ) == ZIP_OK
    );
    REQUIRE(
        zipWriteInFileInZip(zip, content.data(), static_cast<unsigned>(content.size())) == ZIP_OK
    );
    REQUIRE(zipCloseFileInZip(zip) == ZIP_OK);
  }
  REQUIRE(zipClose(zip, nullptr) == ZIP_OK);
}

inline void write_npz(const fs::path& path, const NpzArrays& arrays, int level = 0) {
  std::vector<std::pair<std::string, std::string>> entries;
  for (const auto& [name, array] : arrays) entries.emplace_back(name + ".npy", npy_file(array));
  write_zip(path, entries, level);
}

}  // namespace glint::test
