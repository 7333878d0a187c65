// SPDX-License-Identifier: MIT
// One process at a time: a file beside what it guards, locked by the system, which lets go of it
// when the process ends, however it ends. Other machines see it where their file system takes part.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <variant>

#include "glint/core/files.h"

namespace glint {

// In the environment of a process that works for another one: its number.
inline constexpr const char* kWorksFor = "GLINT_WORKS_FOR";

class FileLock {
 public:
  // The lock, or who has it: "process 12 on node3 since 2026-01-31T12:00:00Z", a worker's "... for
  // process 10". Creates the parent
  // folder. Errors (kEnvironment): the folder or the file cannot be made. A file system without
  // locks is no obstacle: then nothing is guarded.
  static std::variant<FileLock, std::string> take(const fs::path& file);
  // take(), but one held by a worker whose parent was killed is waited for: it was told to end, and
  // does after what it is at. `waiting` is told who has it.
  static std::variant<FileLock, std::string> take_from_orphan(
      const fs::path& file, const std::function<void(const std::string& holder)>& waiting
  );
  // Waits until the lock can be taken; meanwhile `waiting` with who has it is told once. Errors: as
  // take(), and Interrupted.
  static FileLock wait_for(
      const fs::path& file, const std::function<void(const std::string& holder)>& waiting
  );
  // Of a folder: ".NAME.lock" beside it.
  static fs::path file_beside(const fs::path& folder);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();  // removes the file

 private:
  FileLock(fs::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}
  fs::path file_;
  int descriptor_;
};

}  // namespace glint
