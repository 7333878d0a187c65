// SPDX-License-Identifier: MIT
// test_fuzz TARGET CORPUS: the target's seeds, each whole and damaged, then the files of
// CORPUS/TARGET in the same way. Exits with 4 on a finding, whose bytes it leaves beside itself.
// test_fuzz --list; test_fuzz --seeds TARGET FOLDER: writes the seeds for libFuzzer.
#include <chrono>
#include <cstdio>

#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "tests/fuzz/fuzz_target.h"

using namespace glint;
using namespace glint::fuzz;

namespace {

constexpr double kLongest = 10;  // seconds an input

const FuzzTarget& find_target(const std::string& id) {
  const auto it = Registry<FuzzTarget>::all().find(id);
  GLINT_CHECK(it != Registry<FuzzTarget>::all().end(), kUsage, "{}: no such target; --list", id);
  return it->second;
}

std::vector<FuzzInput> corpus_of(const fs::path& folder) {
  std::vector<FuzzInput> inputs;
  if (fs::is_directory(folder))
    for (const fs::path& file : list_files(folder))
      inputs.push_back({file.filename().string(), read_file(file)});
  return inputs;
}

class Replay {
 public:
  explicit Replay(const FuzzTarget& target) : target_(target) {}

  void run(const FuzzInput& input) {
    run(input.name, input.bytes, false);
    for (const std::string& bytes : damaged(input.bytes))
      run(input.name + ", damaged", bytes, false);
  }
  // One that is refused would say nothing about the code behind the first check.
  void run_seed(const FuzzInput& seed) {
    run(seed.name, seed.bytes, true);
    run(seed);
  }
  int report() const {
    std::printf("%s: %d inputs, %d findings\n", target_.id.c_str(), runs_, findings_);
    return findings_ > 0 ? static_cast<int>(ExitCode::kCheckFailed) : 0;
  }

 private:
  void run(const std::string& name, std::string_view bytes, bool must_be_taken) {
    ++runs_;
    const auto start = std::chrono::steady_clock::now();
    auto [accepted, finding] = outcome_of(target_, bytes);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (finding.empty() && took.count() > kLongest) finding = fmt::format("{} s", took.count());
    if (finding.empty() && must_be_taken && !accepted) finding = "a seed that is refused";
    if (finding.empty()) return;
    const std::string file = fmt::format("finding-{}-{}", target_.id, ++findings_);
    std::fprintf(
        stderr,
        "%s: %s: %s (bytes: %s)\n",
        target_.id.c_str(),
        name.c_str(),
        finding.c_str(),
        file.c_str()
    );
    write_file(file, bytes);
  }

  const FuzzTarget& target_;
  int runs_ = 0, findings_ = 0;
};

int run(const std::vector<std::string>& arguments) {
  if (arguments == std::vector<std::string>{"--list"}) {
    for (const auto& [id, target] : Registry<FuzzTarget>::all()) std::puts(id.c_str());
    return 0;
  }
  if (arguments.size() == 3 && arguments[0] == "--seeds") {
    for (const FuzzInput& seed : find_target(arguments[1]).seeds())
      write_file(fs::path(arguments[2]) / seed.name, seed.bytes);
    return 0;
  }
  GLINT_CHECK(arguments.size() == 2, kUsage, "expected TARGET CORPUS");
  const FuzzTarget& target = find_target(arguments[0]);
  Replay replay(target);
  for (const FuzzInput& seed : target.seeds()) replay.run_seed(seed);
  for (const FuzzInput& input : corpus_of(fs::path(arguments[1]) / target.id)) replay.run(input);
  return replay.report();
}

}  // namespace

int main(int argc, char** argv) {
  set_quiet(true);
  set_num_threads(1);
  try {
    return run({argv + 1, argv + argc});
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code());
  }
}
