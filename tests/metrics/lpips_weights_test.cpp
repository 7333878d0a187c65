// SPDX-License-Identifier: MIT
#include "metrics/lpips_weights.h"

#include <cmath>
#include <cstdlib>

#include "glint/core/sha256.h"
#include "tests/metrics/tiny_lpips.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

const LpipsNetwork& alex_network() { return lpips_networks()[0]; }

std::string error_with(const std::function<void(LpipsArrays&)>& change) {
  LpipsArrays arrays = random_arrays(tiny_network());
  change(arrays);
  return bad_reference([&] { make_lpips_weights(tiny_network(), arrays, "w.safetensors"); });
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
      {64, 192, 384, 256, 256}, {64, 128, 256, 512, 512}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    std::vector<int> channels;
    for (const LpipsLayer& layer : lpips_networks()[i].layers)
      if (layer.tap) channels.push_back(layer.channels);
    CHECK(channels == expected[i]);
  }
}

TEST_CASE("Weights become a chain of steps") {
  const LpipsArrays arrays = random_arrays(tiny_network());
  const LpipsWeights weights = make_lpips_weights(tiny_network(), arrays, "w");
  REQUIRE(weights.steps.size() == 6);
  CHECK(weights.lin.size() == 3);
  const FeatureStep& step = weights.steps[2];
  CHECK(step.out_channels == 10);
  CHECK(step.tap);
  CHECK(step.weight == arrays.at("features.3.weight").values);
  CHECK(weights.steps[3].pools);
}

TEST_CASE("Arrays that are missing, of another shape or too many are errors that name them") {
  CHECK(says(error_with([](auto& a) { a.erase("features.5.bias"); }), "no array 'features.5.bias'")
  );
  CHECK(says(
      error_with([](auto& a) {
        a["features.0.weight"].shape = {6, 3, 25, 1};
      }),
      "w.safetensors: features.0.weight has shape (6, 3, 25, 1), expected (6, 3, 5, 5)"
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
  write_weights(folder / "any_name.safetensors", random_arrays(alex_network()));
  const LpipsWeights weights = load_lpips_weights(folder / "any_name.safetensors");
  CHECK(weights.network == "alex");
  CHECK(weights.version.empty());
  CHECK(weights.sha256 == sha256(read_file(folder / "any_name.safetensors")));
  CHECK(weights.arrays_sha256.size() == 64);
  CHECK(weights.arrays_sha256 != weights.sha256);
}

TEST_CASE("The checksum of arrays knows values and names") {
  LpipsArrays arrays = random_arrays(tiny_network());
  const auto checksum = [&] {
    return make_lpips_weights(tiny_network(), arrays, "w").arrays_sha256;
  };
  const std::string before = checksum();
  CHECK(checksum() == before);
  arrays["lin0.weight"].values[0] += 0.5f;
  CHECK(checksum() != before);
}

TEST_CASE("A file without a network's arrays is an error that says how to make the file") {
  const TempFolder folder;
  write_weights(folder / "a.safetensors", {{"something", {{1}, {1}}}});
  const std::string message = bad_reference([&] { load_lpips_weights(folder / "a.safetensors"); });
  CHECK(says(message, "convert_lpips_weights.py"));
}

TEST_CASE("Weights are found in a file, or by their name in a folder, and only of that network") {
  const TempFolder folder;
  const fs::path file = folder / "lpips_alex_v0.1.safetensors";
  write_weights(file, random_arrays(alex_network()));
  CHECK(lpips_weights_at(file, "alex") != nullptr);
  CHECK(lpips_weights_at(file, "")->network == "alex");
  CHECK(lpips_weights_at(file, "vgg") == nullptr);
  CHECK(lpips_weights_at(folder.path(), "alex") != nullptr);
  CHECK(lpips_weights_at(folder.path(), "vgg") == nullptr);
  CHECK(lpips_weights_at(folder.path(), "")->network == "alex");
  CHECK(lpips_weights_at(folder / "absent", "alex") == nullptr);
  CHECK(lpips_weights_at({}, "alex") == nullptr);
  write_file(file, "damaged");
  error_of(ExitCode::kEnvironment, [&] { lpips_weights_at(folder.path(), "alex"); });
}

TEST_CASE("An .npz of earlier versions is an error that says how to make weights of it") {
  const TempFolder folder;
  const fs::path file = folder / "lpips_vgg_v0.1.npz";
  write_file(file, "PK");
  for (const fs::path& place : {file, folder.path()}) {
    const std::string message =
        error_of(ExitCode::kEnvironment, [&] { lpips_weights_at(place, "vgg"); });
    CHECK(says(message, "scripts/convert_lpips_weights.py --npz " + file.string()));
    CHECK(says(message, "scripts/fetch_lpips_weights.sh"));
  }
  CHECK(lpips_weights_at(folder.path(), "alex") == nullptr);
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
