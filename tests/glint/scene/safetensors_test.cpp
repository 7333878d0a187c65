// SPDX-License-Identifier: MIT
#include "glint/scene/safetensors.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

template <class T>
TensorToWrite tensor(const std::string& name, std::vector<std::size_t> shape, std::vector<T> v) {
  return {name, {kTensorTypeOf<T>, std::move(shape)}, [v](std::byte* to) {
            if (!v.empty()) std::memcpy(to, v.data(), v.size() * sizeof(T));
          }};
}

// A file of that header and that many bytes behind it.
std::string file_of(const std::string& header, std::size_t bytes) {
  const std::uint64_t length = header.size();
  std::string file(reinterpret_cast<const char*>(&length), sizeof length);
  return file + header + std::string(bytes, '\1');
}

std::string entry(const std::string& name, const std::string& rest) {
  return "\"" + name + "\":{" + rest + "}";
}
std::string entry(
    const std::string& name, const char* type, const std::string& shape, const std::string& range
) {
  return entry(
      name,
      "\"dtype\":\"" + std::string(type) + "\",\"shape\":[" + shape + "],\"data_offsets\":[" +
          range + "]"
  );
}

struct HeaderFile : TempFolder {
  std::string error(const std::string& header, std::size_t bytes) const {
    return raw_error(file_of("{" + header + "}", bytes));
  }
  std::string raw_error(const std::string& content) const {
    write_file(path() / "x.safetensors", content);
    const std::string message =
        bad_reference([&] { SafetensorsFile file(path() / "x.safetensors"); });
    CHECK_THAT(message, Contains("x.safetensors"));
    return message;
  }
};

}  // namespace

TEST_CASE("tensors of every type come back bit for bit, with their shapes and the metadata") {
  const TempFolder folder;
  const fs::path path = folder / "x.safetensors";
  const std::vector<TensorToWrite> tensors = {
      tensor<std::uint8_t>("bytes", {3}, {0, 7, 255}),
      tensor<std::uint16_t>("halfway", {1, 2}, {1, 65535}),
      tensor<std::int32_t>("integers", {2}, {-5, 1 << 30}),
      tensor<float>("floats", {1, 1, 2}, {-0.0f, 1e-40f}),
      tensor<double>("doubles", {1}, {0.1}),
      tensor<float>("none", {0, 4}, {})};
  write_safetensors(path, {{"name", "a \"room\""}}, tensors);
  SafetensorsFile file(path);
  CHECK(file.metadata().at("name") == "a \"room\"");
  CHECK(file.names().size() == tensors.size());
  CHECK(file.read<std::uint8_t>("bytes", {3}) == std::vector<std::uint8_t>{0, 7, 255});
  CHECK(file.read<std::uint16_t>("halfway", {1, 2}) == std::vector<std::uint16_t>{1, 65535});
  CHECK(file.read<std::int32_t>("integers", {2}) == std::vector<std::int32_t>{-5, 1 << 30});
  const std::vector<float> floats = file.read<float>("floats", {1, 1, 2});
  CHECK(std::signbit(floats[0]));
  CHECK(floats[1] == 1e-40f);
  CHECK(file.read<double>("doubles", {1}) == std::vector<double>{0.1});
  CHECK(file.read<float>("none", {0, 4}).empty());
}

TEST_CASE("arrays are aligned to their type, as programs that map the file expect") {
  const TempFolder folder;
  const fs::path path = folder / "x.safetensors";
  write_safetensors(
      path, {}, {tensor<std::uint8_t>("a", {1}, {1}), tensor<double>("b", {1}, {2.0})}
  );
  const std::string file = read_file(path);
  std::uint64_t length = 0;
  std::memcpy(&length, file.data(), sizeof length);
  CHECK(length % 8 == 0);
  const auto header = nlohmann::json::parse(file.substr(8, length));
  CHECK(header["b"]["data_offsets"][0] == 0);
  CHECK(header["a"]["data_offsets"][0] == 8);
}

TEST_CASE("another type, another shape and a missing tensor are errors that say what is there") {
  const TempFolder folder;
  write_safetensors(folder / "x", {}, {tensor<float>("a", {2, 3}, {1, 2, 3, 4, 5, 6})});
  SafetensorsFile file(folder / "x");
  CHECK_THAT(
      bad_reference([&] {
        file.read<double>("a", {2, 3});
      }),
      Contains("tensor a is F32 (2, 3), expected F64 (2, 3)")
  );
  CHECK_THAT(bad_reference([&] { file.read<float>("a", {6}); }), Contains("expected F32 (6)"));
  CHECK_THAT(bad_reference([&] { file.read<float>("b", {6}); }), Contains("no tensor b"));
}

TEST_CASE("headers that do not go with the file are errors") {
  const HeaderFile f;
  const std::string a = entry("a", "F32", "2", "0,8");
  CHECK_THAT(f.error(a, 7), Contains("tensor a: bytes 0 to 8 of 7"));
  CHECK_THAT(f.error(a, 9), Contains("the last 1 bytes are no tensor's"));
  CHECK_THAT(f.error(entry("a", "F32", "2", "4,12"), 12), Contains("4 bytes in front of tensor a"));
  CHECK_THAT(
      f.error(a + "," + entry("b", "F32", "2", "4,12"), 12), Contains("b: its bytes overlap")
  );
  CHECK_THAT(f.error(entry("a", "F32", "3", "0,8"), 8), Contains("(3) of F32 does not fill 8"));
  CHECK_THAT(f.error(entry("a", "F32", "2", "8,0"), 8), Contains("bytes 8 to 0"));
  CHECK_THAT(f.error(entry("a", "BF16", "4", "0,8"), 8), Contains("dtype BF16, expected U8"));
  CHECK_THAT(f.error(entry("a", "F32", "-2", "0,8"), 8), Contains("shape is no list"));
  CHECK_THAT(f.error(entry("a", "F32", "2.0", "0,8"), 8), Contains("shape is no list"));
  CHECK_THAT(f.error(entry("a", "F32", "2", "0"), 8), Contains("no pair"));
  CHECK_THAT(f.error(entry("a", "\"dtype\":\"F32\""), 0), Contains("no shape"));
  CHECK_THAT(f.error("\"a\":3", 0), Contains("a is no object"));
  // Products that wrap around 2^64.
  CHECK_THAT(
      f.error(entry("a", "F64", "4611686018427387905,2", "0,16"), 16), Contains("does not fill 16")
  );
  CHECK_THAT(f.error(entry("a", "F32", "99999999999999999999999", "0,8"), 8), Contains("no list"));
}

TEST_CASE("files that are no safetensors file are errors, and allocate nothing") {
  const HeaderFile f;
  CHECK_THAT(f.raw_error(""), Contains("0 bytes, too few"));
  CHECK_THAT(f.raw_error("\x89PNG\r\n\x1a\n and more"), Contains("in a file of"));
  CHECK_THAT(f.raw_error(std::string(8, '\xff')), Contains("header of 18446744073709551615 bytes"));
  CHECK_THAT(f.raw_error(file_of("[1, 2]", 0)), Contains("no JSON object"));
  CHECK_THAT(f.raw_error(file_of("{\"a\": ", 0)), Contains("no JSON object"));
  CHECK_THAT(bad_reference([&] { SafetensorsFile file(f / "absent"); }), Contains("no such file"));
  CHECK_THAT(bad_reference([&] { SafetensorsFile file(f.path()); }), Contains("is a folder"));
}

TEST_CASE("every cut-off file is an error") {
  const HeaderFile f;
  write_safetensors(f / "good", {{"k", "v"}}, {tensor<float>("a", {2, 3}, {1, 2, 3, 4, 5, 6})});
  const std::string good = read_file(f / "good");
  for (std::size_t length = 0; length < good.size(); ++length) f.raw_error(good.substr(0, length));
}
