// SPDX-License-Identifier: MIT
#include "glint/core/files.h"

#include <fcntl.h>
#include <fnmatch.h>
#include <sys/file.h>

#include <unistd.h>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "glint/core/error.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"

namespace glint {

namespace {

// A name that is on the disk has its content there, whatever happens to the machine. File systems
// that cannot say so are believed.
void sync_to_disk(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  const bool failed = ::fsync(file) != 0 && (errno == EIO || errno == ENOSPC || errno == EDQUOT);
  const int why = errno;
  ::close(file);
  GLINT_CHECK(
      !failed,
      kEnvironment,
      "{}: writing to the disk failed ({}); free some disk space or choose another --out",
      path.string(),
      std::strerror(why)
  );
}

bool means_full(int why) { return why == ENOSPC || why == EDQUOT || why == EFBIG; }

// Writers of images do not say why they failed; the disk does. A quota or a limit on the size of
// files is told by errno alone, where that still stands.
bool is_full(const fs::path& folder) {
  constexpr std::uintmax_t kLeast = 64
                                    << 10;  // bytes: a file that failed wanted more than one block
  if (means_full(errno)) return true;
  std::error_code code;
  const fs::space_info space = fs::space(folder, code);
  return !code && space.available < kLeast;
}

// What to do about a file that was not written.
const char* mend_of_write(int why) {
  const bool denied = why == EACCES || why == EPERM || why == EROFS;
  return denied ? "give write permission to its folder, or choose another --out"
                : "free some disk space or choose another --out";
}

std::string read_whole(std::istream& in, std::size_t block) {
  std::string content;
  for (std::size_t size = 0; in.good(); content.resize(size)) {
    content.resize(size + block);
    in.read(&content[size], static_cast<std::streamsize>(block));
    size += static_cast<std::size_t>(in.gcount());
  }
  return content;
}

}  // namespace

void throw_out_of_memory(const fs::path& path) {
  std::error_code code;
  const std::uintmax_t bytes = fs::file_size(path, code);
  throw OutOfMemory(fmt::format(
      "{}: out of memory while reading it ({} bytes on disk); use smaller images or fewer threads",
      path.string(),
      code ? 0 : bytes
  ));
}

void check_exists(const fs::path& path, std::string_view what) {
  GLINT_CHECK(is_there(path), kBadReference, "{}: no such {}", path.string(), what);
}

void check_not_input(const fs::path& output, const fs::path& input) {
  std::error_code code;
  GLINT_CHECK(
      output.empty() || input.empty() || !fs::equivalent(output, input, code),
      kUsage,
      "{}: is read, and would be written over; name another file to write",
      output.string()
  );
}

std::string read_file(const fs::path& path) {
  std::ifstream in = open_file(path);
  std::error_code code;
  // The size it claims may be wrong; where it is right, one read ends the file.
  constexpr std::uintmax_t kSmallest = 1 << 16, kLargest = 1 << 26;
  const std::uintmax_t claimed = fs::file_size(path, code);
  const std::size_t block = std::clamp(code ? kSmallest : claimed + 1, kSmallest, kLargest);
  std::string content = read_within_memory(path, [&] { return read_whole(in, block); });
  GLINT_CHECK(!in.bad(), kBadReference, "{}: reading failed", path.string());
  return content;
}

std::string read_text(const fs::path& path) {
  std::string text = read_file(path);
  GLINT_CHECK(
      !text.starts_with("\xff\xfe") && !text.starts_with("\xfe\xff"),
      kBadReference,
      "{}: text in UTF-16, as Windows PowerShell's '>' writes it; save it as UTF-8",
      path.string()
  );
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  return text;
}

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  std::error_code code;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), code);
  GLINT_CHECK(
      !code, kEnvironment, "{}: cannot create its folder ({})", path.string(), code.message()
  );
  const fs::path temporary = unfinished_path(path);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const auto give_up = [&](const std::string& why) {
    const bool full = is_full(folder);  // while what there was room for still lies there
    fs::remove(temporary, code);
    if (full) throw DiskFull(why);
  };
  errno = 0;
  try {
    write(temporary);
    sync_to_disk(temporary);
    fs::rename(temporary, path);
    sync_to_disk(folder);
  } catch (const fs::filesystem_error& error) {
    const bool is_taken = error.code() == std::errc::is_a_directory;
    const std::string why = fmt::format(
        "{}: cannot be written ({}{})",
        path.string(),
        error.code().message(),
        is_taken ? "; move the folder of that name away" : ""
    );
    give_up(why);
    throw Error(ExitCode::kEnvironment, why);
  } catch (const Error& error) {
    give_up(error.what());
    throw;
  } catch (...) {
    fs::remove(temporary, code);
    throw;
  }
}

void write_file(const fs::path& path, std::string_view content) {
  write_atomically(path, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    GLINT_CHECK(
        out.good(),
        kEnvironment,
        "{}: writing failed ({}); {}",
        path.string(),
        std::strerror(errno),
        mend_of_write(errno)
    );
  });
}

TemporaryFolder::TemporaryFolder(std::string_view prefix) {
  std::string pattern = (fs::temp_directory_path() / fmt::format("{}_XXXXXX", prefix)).string();
  GLINT_CHECK(
      ::mkdtemp(pattern.data()) != nullptr,
      kEnvironment,
      "{}: cannot be made ({}); TMPDIR names another folder for temporary files",
      pattern,
      std::strerror(errno)
  );
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code code;
  fs::remove_all(path_, code);
}

namespace {

// In one piece; where there is no room for all of it, none of it stays. errno, or 0.
int append_piece(int file, std::string_view line) {
  const off_t end = ::lseek(file, 0, SEEK_END);
  char last = '\n';
  if (end > 0 && ::pread(file, &last, 1, end - 1) != 1) last = '\n';
  const std::string text = fmt::format("{}{}\n", last == '\n' ? "" : "\n", line);
  errno = 0;
  if (::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size())) return 0;
  const int why = errno == 0 ? ENOSPC : errno;
  if (end >= 0) [[maybe_unused]]
    const int cut = ::ftruncate(file, end);
  return why;
}

}  // namespace

// One process at a time: two that append to one file mix no lines.
void append_line(const fs::path& path, std::string_view line) {
  is_there(path);  // what is written into a pipe or a device is lost
  std::error_code code;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), code);
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  int why = file < 0 ? errno : 0;
  if (file >= 0) {
    ::flock(file, LOCK_EX);  // file systems without locks do without
    why = append_piece(file, line);
    ::close(file);
  }
  const auto message = [&] {
    return fmt::format("{}: appending failed ({})", path.string(), std::strerror(why));
  };
  if (means_full(why)) throw DiskFull(message());
  GLINT_CHECK(why == 0, kEnvironment, "{}", message());
}

bool natural_less(std::string_view a, std::string_view b) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    std::size_t i_end = i, j_end = j;
    while (i_end < a.size() && digit(a[i_end])) ++i_end;
    while (j_end < b.size() && digit(b[j_end])) ++j_end;
    std::string_view x = a.substr(i, i_end - i), y = b.substr(j, j_end - j);
    x.remove_prefix(std::min(x.find_first_not_of('0'), x.size()));
    y.remove_prefix(std::min(y.find_first_not_of('0'), y.size()));
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
    i = i_end, j = j_end;
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;
}

std::vector<fs::path> list_files(
    const fs::path& folder, const std::vector<std::string>& extensions
) {
  GLINT_CHECK(is_folder(folder), kBadReference, "{}: not a folder", folder.string());
  std::vector<fs::path> files;
  for (const fs::path& path : list_entries(folder)) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
      return static_cast<char>(std::tolower(c));
    });
    const bool wanted =
        extensions.empty() ||
        std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
    const bool hidden = path.filename().string().starts_with('.');
    if (wanted && !hidden && is_file(path)) files.push_back(path);
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

bool glob_match(std::string_view pattern, std::string_view text) {
  return ::fnmatch(std::string(pattern).c_str(), std::string(text).c_str(), 0) == 0;
}

}  // namespace glint
