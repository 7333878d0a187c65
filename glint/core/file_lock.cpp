// SPDX-License-Identifier: MIT
#include "glint/core/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <thread>

#include "glint/core/error.h"
#include "glint/core/interrupt.h"
#include "glint/core/machine.h"

namespace glint {
namespace {

constexpr std::string_view kForProcess = " for process ";

std::string this_process() {
  std::array<char, 32> time{};
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::strftime(time.data(), time.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  const char* parent = std::getenv(kWorksFor);
  const std::string whose = parent == nullptr ? "" : fmt::format("{}{}", kForProcess, parent);
  return fmt::format("process {} on {} since {}{}", ::getpid(), host_name(), time.data(), whose);
}

// Of a worker of this machine whose parent has ended.
bool is_orphan(const std::string& holder) {
  const std::size_t at = holder.rfind(kForProcess);
  if (at == std::string::npos || holder.find(fmt::format(" on {} since ", host_name())) > at)
    return false;
  int parent = 0;
  const char* number = holder.data() + at + kForProcess.size();
  const auto [end, error] = std::from_chars(number, holder.data() + holder.size(), parent);
  return error == std::errc{} && parent > 0 && process_has_ended(parent);
}

std::string content_of(int descriptor) {
  std::array<char, 512> text{};
  const ssize_t bytes = ::pread(descriptor, text.data(), text.size(), 0);
  return bytes > 0 ? std::string(text.data(), static_cast<std::size_t>(bytes)) : "another process";
}

// Whoever had it removes it when done: a lock on a file without a name guards nothing.
bool still_has_its_name(const fs::path& file, int descriptor) {
  struct stat by_name {
  }, opened{};
  return ::stat(file.c_str(), &by_name) == 0 && ::fstat(descriptor, &opened) == 0 &&
         by_name.st_ino == opened.st_ino && by_name.st_dev == opened.st_dev;
}

int open_file(const fs::path& file) {
  std::error_code code;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), code);
  GLINT_CHECK(
      !code,
      kEnvironment,
      "{}: cannot be made ({}); let this user write there, or name another folder",
      file.parent_path().string(),
      code.message()
  );
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  GLINT_CHECK(
      descriptor >= 0, kEnvironment, "{}: cannot be made ({})", file.string(), std::strerror(errno)
  );
  return descriptor;
}

}  // namespace

FileLock FileLock::wait_for(
    const fs::path& file, const std::function<void(const std::string& holder)>& waiting
) {
  constexpr auto kPause = std::chrono::milliseconds(100);
  bool told = false;
  while (true) {
    auto lock = take(file);
    if (auto* taken = std::get_if<FileLock>(&lock)) return std::move(*taken);
    if (!std::exchange(told, true)) waiting(std::get<std::string>(lock));
    throw_if_interrupted();
    std::this_thread::sleep_for(kPause);
  }
}

std::variant<FileLock, std::string> FileLock::take_from_orphan(
    const fs::path& file, const std::function<void(const std::string& holder)>& waiting
) {
  auto lock = take(file);
  const auto* holder = std::get_if<std::string>(&lock);
  if (holder == nullptr || !is_orphan(*holder)) return lock;
  return wait_for(file, waiting);
}

fs::path FileLock::file_beside(const fs::path& folder) {
  const fs::path plain = fs::absolute(folder / "").lexically_normal().parent_path();
  return plain.parent_path() / fmt::format(".{}.lock", plain.filename().string());
}

std::variant<FileLock, std::string> FileLock::take(const fs::path& file) {
  while (true) {
    const int descriptor = open_file(file);
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      std::string holder = content_of(descriptor);
      ::close(descriptor);
      return holder;
    }
    FileLock lock(file, descriptor);
    if (!still_has_its_name(file, descriptor)) {
      lock.file_.clear();  // another one's by now
      continue;
    }
    const std::string text = this_process();
    [[maybe_unused]] const int cut = ::ftruncate(descriptor, 0);
    [[maybe_unused]] const ssize_t written = ::pwrite(descriptor, text.data(), text.size(), 0);
    return lock;
  }
}

FileLock::FileLock(FileLock&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock::~FileLock() {
  if (descriptor_ < 0) return;
  std::error_code code;
  if (!file_.empty()) fs::remove(file_, code);
  ::close(descriptor_);
}

}  // namespace glint
