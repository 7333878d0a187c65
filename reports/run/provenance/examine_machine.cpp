// SPDX-License-Identifier: MIT
#include "reports/run/provenance/examine_machine.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "glint/core/machine.h"

namespace glint {
namespace {

constexpr rlim_t kEnoughFiles = 256;  // libraries, threads and maps of a view stay well below

// A file of its own that is closed and removed in the end.
class TrialFile {
 public:
  explicit TrialFile(const fs::path& folder)
      : path_(folder / fmt::format(".glint-doctor-{}", ::getpid())),
        descriptor_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)),
        why_(descriptor_ < 0 ? std::strerror(errno) : "") {}
  ~TrialFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    std::error_code code;
    fs::remove(path_, code);
  }
  TrialFile(const TrialFile&) = delete;
  TrialFile& operator=(const TrialFile&) = delete;

  // Why nothing can be written; empty: it can.
  std::string why_not_written() const {
    if (descriptor_ < 0) return why_;
    constexpr std::string_view kText = "glint-bench doctor\n";
    const bool written =
        ::write(descriptor_, kText.data(), kText.size()) == static_cast<ssize_t>(kText.size());
    return written ? "" : std::strerror(errno);
  }
  std::string why_not_synced() const {
    return ::fsync(descriptor_) == 0 ? "" : std::strerror(errno);
  }
  // Locks hold when a second one is refused.
  std::string why_not_locked() const {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) return std::strerror(errno);
    const int second = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
    const bool taken_twice = second >= 0 && ::flock(second, LOCK_EX | LOCK_NB) == 0;
    if (second >= 0) ::close(second);
    return taken_twice ? "two processes get the same lock" : "";
  }

 private:
  fs::path path_;
  int descriptor_;
  std::string why_;
};

std::string utc_text(std::time_t time) {
  std::array<char, 32> text{};
  std::tm parts{};
  ::gmtime_r(&time, &parts);
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M UTC", &parts);
  return text.data();
}

}  // namespace

Checked examine_folder(const std::string& name, const fs::path& folder, const std::string& option) {
  const fs::path place = nearest_existing(folder);
  const TrialFile file(place);
  if (const std::string why = file.why_not_written(); !why.empty())
    return {
        name,
        CheckState::kBad,
        fmt::format("{}: cannot be written ({})", place.string(), why),
        fmt::format("give write permission, or choose another {}", option)};
  if (const std::string why = file.why_not_synced(); !why.empty())
    return {
        name,
        CheckState::kNote,
        fmt::format("{}: fsync fails ({})", place.string(), why),
        "what was written may be gone when the machine stops"};
  if (const std::string why = file.why_not_locked(); !why.empty())
    return {
        name,
        CheckState::kNote,
        fmt::format("{}: files cannot be locked ({})", place.string(), why),
        "let one process at a time work there"};
  return {name, CheckState::kOk, place.string() + ": can be written, synced and locked"};
}

Checked examine_clock(std::time_t now, std::time_t built) {
  if (now >= built) return {"clock", CheckState::kOk, utc_text(now)};
  return {
      "clock",
      CheckState::kBad,
      fmt::format("{}, before this program was written ({})", utc_text(now), utc_text(built)),
      "set it: dates of records and locks are this machine's"};
}

Checked examine_open_files() {
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  const bool enough = limit.rlim_cur >= kEnoughFiles;
  return {
      "files",
      enough ? CheckState::kOk : CheckState::kNote,
      fmt::format("{} may be open at once", limit.rlim_cur),
      enough ? "" : fmt::format("ulimit -n {}", kEnoughFiles)};
}

}  // namespace glint
