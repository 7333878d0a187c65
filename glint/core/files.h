// SPDX-License-Identifier: MIT
// Files read whole and written safely: a writer fills a temporary name and renames it, so a reader
// never sees half a file and a full disk leaves nothing under the final name.
#pragma once

#include <filesystem>
#include <functional>
#include <new>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

namespace fs = std::filesystem;

[[noreturn]] void throw_out_of_memory(const fs::path& path);  // while reading it

// Errors: there is no such file or folder (kBadReference); it cannot be looked up: those of
// presence_of() (presence.h).
void check_exists(const fs::path& path, std::string_view what = "file");

// The whole file. Errors: those of open_file() (presence.h); (kBadReference) reading fails;
// (kEnvironment) it is larger than the memory.
std::string read_file(const fs::path& path);

// The same of text that people and other programs write: without the mark of UTF-8 in front that
// programs on Windows put there. Errors besides (kBadReference): UTF-16.
std::string read_text(const fs::path& path);

// What `read` makes of a file; where memory runs out, the error names the file and its size.
template <class F>
auto read_within_memory(const fs::path& path, F&& read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
    throw_out_of_memory(path);
  }
}

// Errors (kUsage): `output` is the file `input`, which would be written over; empty paths are none.
void check_not_input(const fs::path& output, const fs::path& input);

// Calls `write(temporary)`, then renames to `path`; on any exception removes the temporary and
// throws on. Creates the parent folder. Errors (kEnvironment): cannot create, write, or rename;
// DiskFull where there was no room.
void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write);
void write_file(const fs::path& path, std::string_view content);

// Appends one line and flushes it; a torn last line of an earlier crash is closed first.
void append_line(const fs::path& path, std::string_view line);

// An empty folder of its own among the system's temporary files, removed with the object. Errors
// (kEnvironment): cannot be made.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(std::string_view prefix);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const fs::path& path() const { return path_; }
  fs::path operator/(const fs::path& name) const { return path_ / name; }

 private:
  fs::path path_;
};

// Regular files in a folder whose extension (lower case, with dot) is one of `extensions` (all when
// empty), in natural order ("2" before "10"). Errors (kBadReference): not a readable folder.
std::vector<fs::path> list_files(
    const fs::path& folder, const std::vector<std::string>& extensions = {}
);

// "img2" < "img10": digit runs compare by value.
bool natural_less(std::string_view a, std::string_view b);

// '*' any run, '?' one character, '[ab]' a set. Used by --only and --skip.
bool glob_match(std::string_view pattern, std::string_view text);

}  // namespace glint
