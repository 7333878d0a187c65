// SPDX-License-Identifier: MIT
#include "metrics/lpips_weights.h"

#include <cmath>
#include <cstdlib>

#include "glint/core/sha256.h"
#include "tests/metrics/tiny_lpips.h"
#include "tests/support/temp_folder.h"
#include "tests/support/write_npz.h"

using namespace glint;
using namespace glint::test;

namespace {

const LpipsNetwork& squeeze_network() { return lpips_networks()[1]; }

std::string error_with(const std::function<void(NpzArrays&)>& change) {
  NpzArrays arrays = random_arrays(tiny_network());
  change(arrays);
  return bad_reference([&] { make_lpips_weights(tiny_network(), arrays, "w.npz"); });
}

bool says(const std::string& message, const std::string& text) {
  INFO(message);
  return message.find(text) != std::string::npos;
}

// An environment variable for as long as it lives.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    ::setenv(name, value.c_str(), 1);
  }
  ~Environment() { ::setenv(name_, old_.c_str(), 1); }

 private:
  const char* name_;
  std::string old_;  // empty counts as unset
};

}  // namespace

TEST_CASE("The networks have the taps of the published ones") {
  const std::vector<std::vector<int>> expected = {
      {64, 192, 384, 256, 256}, {64, 128, 256, 384, 384, 512, 512}, {64, 128, 256, 512, 512}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    std::vector<int> channels;
    for (const LpipsLayer& layer : lpips_networks()[i].layers)
      if (layer.tap) channels.push_back(layer.channels);
    CHECK(channels == expected[i]);
  }
}

TEST_CASE("Weights become a chain of steps, two of them for a fire module") {
  const NpzArrays arrays = random_arrays(tiny_network());
  const LpipsWeights weights = make_lpips_weights(tiny_network(), arrays, "w.npz");
  REQUIRE(weights.steps.size() == 7);
  CHECK(weights.lin.size() == 3);
  const FeatureStep& expansions = weights.steps[3];
  CHECK(expansions.out_channels == 10);
  CHECK(expansions.tap);
  // A 1x1 kernel in the middle of a 3x3 one.
  const auto& one = arrays.at("features.3.expand1x1.weight").values;
  CHECK(expansions.weight[9 * 5 + 4] == one[5]);
  CHECK(expansions.weight[9 * 5 + 3] == 0);
  const auto& three = arrays.at("features.3.expand3x3.weight").values;
  CHECK(expansions.weight.back() == three.back());
}

TEST_CASE("Arrays that are missing, of another shape or too many are errors that name them") {
  CHECK(says(error_with([](auto& a) { a.erase("features.5.bias"); }), "no array 'features.5.bias'")
  );
  CHECK(says(
      error_with([](auto& a) {
        a["features.0.weight"].shape = {6, 3, 25, 1};
      }),
      "w.npz: features.0.weight has shape (6, 3, 25, 1), expected (6, 3, 5, 5)"
  ));
  CHECK(says(error_with([](auto& a) { a["classifier"] = {{1}, {0}}; }), "'classifier' belongs to"));
}

TEST_CASE("Values that are not finite and negative lin weights are errors") {
  CHECK(says(
      error_with([](auto& a) { a["features.7.bias"].values[2] = NAN; }),
      "features.7.bias has values that are not finite"
  ));
  CHECK(says(
      error_with([](auto& a) { a["lin1.weight"].values[3] = -0.5f; }), "lin1.weight has negative"
  ));
}

TEST_CASE("A file says which network it is; weights that nobody published have no version") {
  const TempFolder folder;
  write_npz(folder / "any_name.npz", random_arrays(squeeze_network()));
  const LpipsWeights weights = load_lpips_weights(folder / "any_name.npz");
  CHECK(weights.network == "squeeze");
  CHECK(weights.version.empty());
  CHECK(weights.sha256 == sha256(read_file(folder / "any_name.npz")));
  CHECK(weights.arrays_sha256.size() == 64);
  CHECK(weights.arrays_sha256 != weights.sha256);
}

TEST_CASE("The checksum of arrays knows values and names") {
  NpzArrays arrays = random_arrays(tiny_network());
  const auto checksum = [&] {
    return make_lpips_weights(tiny_network(), arrays, "w").arrays_sha256;
  };
  const std::string before = checksum();
  CHECK(checksum() == before);
  arrays["lin0.weight"].values[0] += 0.5f;
  CHECK(checksum() != before);
}

TEST_CASE("A zip without a network's arrays is an error that says how to make the file") {
  const TempFolder folder;
  write_npz(folder / "a.npz", {{"something", {{1}, {1}}}});
  const std::string message = bad_reference([&] { load_lpips_weights(folder / "a.npz"); });
  CHECK(says(message, "convert_lpips_weights.py"));
}

TEST_CASE("Weights are found in a file, or by their name in a folder, and only of that network") {
  const TempFolder folder;
  const fs::path file = folder / "lpips_squeeze_v0.1.npz";
  write_npz(file, random_arrays(squeeze_network()));
  CHECK(lpips_weights_at(file, "squeeze") != nullptr);
  CHECK(lpips_weights_at(file, "")->network == "squeeze");
  CHECK(lpips_weights_at(file, "vgg") == nullptr);
  CHECK(lpips_weights_at(folder.path(), "squeeze") != nullptr);
  CHECK(lpips_weights_at(folder.path(), "vgg") == nullptr);
  CHECK(lpips_weights_at(folder.path(), "") == nullptr);  // alex
  CHECK(lpips_weights_at(folder / "absent", "squeeze") == nullptr);
  CHECK(lpips_weights_at({}, "squeeze") == nullptr);
  write_file(file, "damaged");
  error_of(ExitCode::kEnvironment, [&] { lpips_weights_at(folder.path(), "squeeze"); });
}

TEST_CASE("The place is the environment's, then the cache folder's") {
  const Environment cache("XDG_CACHE_HOME", "/cache"), home("HOME", "/home/me");
  {
    const Environment weights("GLINT_LPIPS_WEIGHTS", "/weights");
    CHECK(lpips_weights_place() == "/weights");
  }
  const Environment none("GLINT_LPIPS_WEIGHTS", "");
  CHECK(lpips_weights_place() == "/cache/glint-bench/lpips");
  const Environment no_cache("XDG_CACHE_HOME", "");
  CHECK(lpips_weights_place() == "/home/me/.cache/glint-bench/lpips");
}
