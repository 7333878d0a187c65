// SPDX-License-Identifier: MIT
#include "glint/core/left_behind.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>
#include <optional>

#include "glint/core/error.h"
#include "glint/core/machine.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

constexpr std::string_view kUnfinished = ".part", kAside = ".old";

// Letters and digits of the machine's name, so that no dot of it ends a part of ours.
std::string host_mark() {
  std::string host;
  for (const char c : host_name().substr(0, 32))
    host += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return host.empty() ? "unknown" : host;
}

struct Writer {
  pid_t process = 0;
  std::string host;
};

// Of ".NAME.PID-HOST.part" with or without an extension; nothing: not one of ours.
std::optional<Writer> writer_of(const std::string& name, std::string_view with_mark = kUnfinished) {
  const std::size_t mark = name.rfind(with_mark);
  if (!name.starts_with(".") || mark == std::string::npos) return std::nullopt;
  const std::string rest = name.substr(mark + with_mark.size());
  if (!rest.empty() && !rest.starts_with(".")) return std::nullopt;
  const std::size_t dot = name.rfind('.', mark - 1);
  if (dot == std::string::npos || dot == 0) return std::nullopt;
  const std::string text = name.substr(dot + 1, mark - dot - 1);
  Writer writer;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), writer.process);
  if (end.ec != std::errc{} || end.ptr == text.data() + text.size() || *end.ptr != '-')
    return std::nullopt;
  writer.host = std::string(end.ptr + 1, text.data() + text.size());
  return writer;
}

bool has_ended(const Writer& writer, const fs::path& path) {
  if (writer.host == host_mark())
    return writer.process != ::getpid() && process_has_ended(writer.process);
  std::error_code code;
  const auto age = fs::file_time_type::clock::now() - fs::last_write_time(path, code);
  return !code && age > std::chrono::hours(24);
}

void add_left_behind(const fs::path& folder, bool recursive, std::vector<fs::path>& found) {
  for (const fs::path& path : or_warn([&] { return list_entries(folder); })) {
    const auto writer = writer_of(path.filename().string());
    if (writer && has_ended(*writer, path)) found.push_back(path);
    if (!writer && recursive && is_real_folder(path)) add_left_behind(path, recursive, found);
  }
}

constexpr std::size_t kLongest = 150;  // bytes of a name; file systems allow 255 in all

std::string marked_name(
    const fs::path& stem, std::string_view mark, const fs::path& extension = {}
) {
  static const std::string host = host_mark();
  const std::string name = stem.string().substr(0, kLongest);
  return fmt::format(".{}.{}-{}{}{}", name, ::getpid(), host, mark, extension.string());
}

}  // namespace

fs::path absolute_folder(const fs::path& folder) {
  return fs::absolute(folder / "").lexically_normal().parent_path();
}

fs::path unfinished_path(const fs::path& path) {
  return path.parent_path() / marked_name(path.stem(), kUnfinished, path.extension());
}

fs::path aside_path(const fs::path& folder) {
  return folder.parent_path() / marked_name(folder.filename(), kAside);
}

std::vector<fs::path> list_aside(const fs::path& folder) {
  std::vector<fs::path> found;
  const std::string start = fmt::format(".{}.", folder.filename().string().substr(0, kLongest));
  for (const fs::path& path : list_entries(folder.parent_path())) {
    const std::string name = path.filename();
    const auto writer = writer_of(name, kAside);
    // What follows has no dot but that of the mark: else it is of a folder with a longer name.
    const bool is_its =
        name.starts_with(start) && name.find('.', start.size()) == name.size() - kAside.size();
    if (writer && is_its && has_ended(*writer, path)) found.push_back(path);
  }
  return found;
}

std::vector<fs::path> list_left_behind(const fs::path& folder, bool recursive) {
  std::vector<fs::path> found;
  add_left_behind(folder, recursive, found);
  std::sort(found.begin(), found.end());
  return found;
}

void remove_left_behind(const fs::path& folder, bool recursive) {
  std::error_code code;
  for (const fs::path& path : list_left_behind(folder, recursive)) fs::remove_all(path, code);
}

UnfinishedFolder::UnfinishedFolder(const fs::path& final_path) {
  const fs::path target = absolute_folder(final_path);
  path_ = unfinished_path(target);
  std::error_code code;
  remove_left_behind(target.parent_path(), false);
  fs::remove_all(path_, code);
  fs::create_directories(path_, code);
  GLINT_CHECK(!code, kEnvironment, "{}: cannot be created ({})", path_.string(), code.message());
}

UnfinishedFolder::~UnfinishedFolder() {
  std::error_code code;
  fs::remove_all(path_, code);
}

}  // namespace glint
