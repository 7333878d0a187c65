// SPDX-License-Identifier: MIT
#include "metrics/npz.h"

#include "tests/support/temp_folder.h"
#include "tests/support/write_npz.h"

using namespace glint;
using namespace glint::test;

namespace {

const NpzArray kSix{{2, 3}, {1, 2, 3, 4, 5, 6}};

std::string error_of_entry(const std::string& content) {
  const TempFolder folder;
  write_zip(folder / "a.npz", {{"x.npy", content}});
  return bad_reference([&] { read_npz(folder / "a.npz"); });
}

bool says(const std::string& message, const std::string& text) {
  INFO(message);
  return message.find(text) != std::string::npos;
}

}  // namespace

TEST_CASE("arrays of a zip come back by name, stored or packed") {
  const TempFolder folder;
  for (const int level : {0, 9}) {
    write_npz(folder / "a.npz", {{"one", {{1}, {0.25f}}}, {"six", kSix}}, level);
    const NpzArrays arrays = read_npz(folder / "a.npz");
    CHECK(arrays.size() == 2);
    CHECK(arrays.at("six").shape == kSix.shape);
    CHECK(arrays.at("six").values == kSix.values);
    CHECK(arrays.at("one").values == std::vector<float>{0.25f});
  }
}

TEST_CASE("arrays of another type or order are errors that name the entry") {
  CHECK(says(error_of_entry(npy_file(kSix, "<f8")), "x.npy: type '<f8'"));
  CHECK(says(error_of_entry(npy_file(kSix, "<f4", "True")), "Fortran order"));
  CHECK(says(error_of_entry("no array at all"), "x.npy: not a complete NPY file"));
}

TEST_CASE("a shape that its values do not fill is an error, however large") {
  NpzArray array = kSix;
  for (const std::vector<std::int64_t>& shape : std::vector<std::vector<std::int64_t>>{
           {2, 2}, {7}, {0, 6}, {1L << 40, 1L << 40}, {1L << 62, 4}, {2, 3, 1L << 32}}) {
    array.shape = shape;
    CHECK(says(error_of_entry(npy_file(array)), "do not fill the shape"));
  }
}

TEST_CASE("a name that comes twice is an error") {
  const TempFolder folder;
  write_zip(folder / "a.npz", {{"x.npy", npy_file(kSix)}, {"x.npy", npy_file(kSix)}});
  CHECK(says(bad_reference([&] { read_npz(folder / "a.npz"); }), "x.npy: comes twice"));
}

TEST_CASE("files that are no zip, or are missing, are errors that name the file") {
  const TempFolder folder;
  write_file(folder / "a.npz", "text");
  CHECK(says(bad_reference([&] { read_npz(folder / "a.npz"); }), "a.npz: not a complete .npz"));
  CHECK(says(bad_reference([&] { read_npz(folder / "b.npz"); }), "b.npz: no such file"));
  CHECK(says(bad_reference([&] { read_npz(folder.path()); }), "no such file"));
}

TEST_CASE("a zip that is cut off or damaged anywhere is an error, or its arrays are as they were") {
  const TempFolder folder;
  write_npz(folder / "a.npz", {{"six", kSix}}, 9);
  const std::string good = read_file(folder / "a.npz");
  const auto fails = [&](const std::string& content) {
    write_file(folder / "b.npz", content);
    try {
      for (const auto& [name, array] : read_npz(folder / "b.npz"))
        CHECK(array.values == kSix.values);
      return false;
    } catch (const Error&) {
      return true;
    }
  };
  constexpr std::size_t kEndRecord = 22;  // bytes; without it the entries cannot be found
  for (std::size_t length = 0; length < good.size(); ++length)
    if (!fails(good.substr(0, length))) CHECK(length > good.size() - kEndRecord);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string damaged = good;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x5a);
    fails(damaged);
  }
}
