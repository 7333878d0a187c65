// SPDX-License-Identifier: MIT
#include "tests/fuzz/fuzz_target.h"

#include <sys/resource.h>

#include <unistd.h>
#include <fstream>
#include <iterator>
#include <typeinfo>

#include "glint/core/rng.h"

namespace glint::fuzz {

namespace {

constexpr std::size_t kLongestMessage = 16384;  // bytes
// KiB; sanitizers keep what was freed, on top.
#if defined(__SANITIZE_ADDRESS__)
constexpr long kMostMemory = 2 << 20;
#else
constexpr long kMostMemory = 1 << 20;
#endif
constexpr int kCuts = 16, kChanged = 400, kMostChanges = 4;

class InputFolder {
 public:
  InputFolder() {
    std::error_code code;
    std::string pattern =
        (fs::is_directory("/dev/shm", code) ? fs::path("/dev/shm") : fs::temp_directory_path()) /
        "glint_fuzz_XXXXXX";
    GLINT_CHECK(::mkdtemp(pattern.data()) != nullptr, kEnvironment, "{}: cannot be made", pattern);
    path_ = pattern;
  }
  ~InputFolder() {
    std::error_code code;
    fs::remove_all(path_, code);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string read_whole(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

long peak_memory_kib() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

void check_message(const Error& error) {
  const std::string message = error.what();
  const bool names_it = message.find(input_folder().filename().string()) != std::string::npos;
  if (!names_it) throw Finding("an error that does not name the file: " + message);
  if (message.size() > kLongestMessage)
    throw Finding(fmt::format("a message of {} bytes", message.size()));
}

}  // namespace

const fs::path& input_folder() {
  static const InputFolder folder;
  return folder.path();
}

fs::path input_file(std::string_view bytes, const fs::path& name) {
  const fs::path path = input_folder() / name;
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out.good()) throw Finding(path.string() + ": no room for the input");
  return path;
}

FuzzInput written(const std::string& name, const std::function<void(const fs::path&)>& write) {
  const fs::path path = input_folder() / ("seed_" + name);
  write(path);
  FuzzInput input{name, read_whole(path)};
  fs::remove(path);
  return input;
}

Image ramp(int width, int height, int channels) {
  Image image(width, height, channels);
  const std::size_t count = image.values().size();
  for (std::size_t i = 0; i < count; ++i)
    image.data()[i] = static_cast<float>(i) / static_cast<float>(count - 1);
  return image;
}

bool accepts(const std::function<void()>& read) {
  try {
    read();
    return true;
  } catch (const OutOfMemory& error) {
    throw Finding(error.what());
  } catch (const Error& error) {
    check_message(error);
    return false;
  }
}

Outcome outcome_of(const FuzzTarget& target, std::string_view bytes) {
  const long before = peak_memory_kib();
  Outcome outcome;
  try {
    outcome.accepted = target.read(bytes);
  } catch (const std::exception& error) {
    outcome.finding = fmt::format("{}: {}", typeid(error).name(), error.what());
  }
  const long peak = peak_memory_kib();
  if (outcome.finding.empty() && peak > before && peak > kMostMemory)
    outcome.finding = fmt::format("{} MiB of memory for {} bytes", peak >> 10, bytes.size());
  return outcome;
}

std::vector<std::string> damaged(std::string_view bytes) {
  std::vector<std::string> all;
  for (int i = 0; i < kCuts; ++i)
    all.emplace_back(bytes.substr(0, bytes.size() * static_cast<std::size_t>(i) / kCuts));
  if (bytes.empty()) return all;
  Rng rng(bytes.size(), hash_name("damage"));
  for (int i = 0; i < kChanged; ++i) {
    std::string& changed = all.emplace_back(bytes);
    for (int n = 0; n <= i % kMostChanges; ++n)
      changed[rng.below(static_cast<std::uint32_t>(changed.size()))] =
          static_cast<char>(rng.below(256));
  }
  return all;
}

}  // namespace glint::fuzz
