// SPDX-License-Identifier: MIT
#include "glint/scene/image_files.h"
#include "tests/fuzz/fuzz_seeds.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

bool read(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.npy");
  return accepts([&] { read_image(file); });
}

std::vector<FuzzInput> seeds() {
  std::vector<FuzzInput> seeds;
  for (const char* type : {"<f2", "<f4", "<f8", "|u1", "<u2", "|b1"}) {
    const auto bytes = static_cast<std::size_t>(type[2] - '0');
    seeds.push_back({std::string(type + 1), npy_bytes(type, "2, 3", std::string(6 * bytes, '\x3e'))}
    );
  }
  std::string by_columns = npy_bytes("<f4", "2, 3", std::string(24, '\x3e'));
  by_columns.replace(by_columns.find("False"), 5, "True ");
  seeds.push_back({"by columns", by_columns});
  seeds.push_back({"rgba", npy_bytes("|u1", "1, 2, 4", "abcdefgh")});
  seeds.push_back(written("own", [](const fs::path& p) { write_npy(p, ramp(3, 2, 3)); }));
  return seeds;
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"npy", read, seeds})

}  // namespace glint::fuzz
