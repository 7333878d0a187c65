// SPDX-License-Identifier: MIT
#include "glint/core/presence.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "glint/core/error.h"

namespace glint {
namespace {

bool is_link(const fs::path& path) {
  std::error_code code;
  return fs::is_symlink(fs::symlink_status(path, code));
}

[[noreturn]] void throw_unseen(const fs::path& path, const std::error_code& code) {
  const bool denied = code == std::errc::permission_denied;
  GLINT_CHECK(
      !denied,
      kEnvironment,
      "{}: permission denied; let this user read it and enter its folder",
      path.string()
  );
  GLINT_CHECK(
      code != std::errc::too_many_symbolic_link_levels,
      kBadReference,
      "{}: is a link that leads to itself; remove it, or let it lead to the file",
      path.string()
  );
  throw Error(
      ExitCode::kBadReference,
      fmt::format("{}: cannot be looked up ({})", path.string(), code.message())
  );
}

// What a link leads to may be missing; the link is not.
Presence absent(const fs::path& path) {
  GLINT_CHECK(
      !is_link(path),
      kBadReference,
      "{}: is a link that leads nowhere; remove it, or bring back what it leads to",
      path.string()
  );
  return Presence::kAbsent;
}

const char* name_of(fs::file_type type) {
  switch (type) {
    case fs::file_type::fifo:
      return "a pipe";
    case fs::file_type::character:
    case fs::file_type::block:
      return "a device";
    case fs::file_type::socket:
      return "a socket";
    default:
      return "something else";
  }
}

}  // namespace

Presence presence_of(const fs::path& path) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  switch (status.type()) {
    case fs::file_type::not_found:
      return absent(path);
    case fs::file_type::regular:
      return Presence::kFile;
    case fs::file_type::directory:
      return Presence::kFolder;
    case fs::file_type::none:
      throw_unseen(path, code);
    default:
      break;
  }
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: is {}, expected a file or a folder; copy what it holds into a file",
          path.string(),
          name_of(status.type())
      )
  );
}

bool is_there(const fs::path& path) { return presence_of(path) != Presence::kAbsent; }
bool is_file(const fs::path& path) { return presence_of(path) == Presence::kFile; }
bool is_folder(const fs::path& path) { return presence_of(path) == Presence::kFolder; }

bool is_taken(const fs::path& path) {
  std::error_code code;
  const fs::file_status status = fs::symlink_status(path, code);
  if (status.type() == fs::file_type::none) throw_unseen(path, code);
  return status.type() != fs::file_type::not_found;
}

bool is_real_folder(const fs::path& path) {
  std::error_code code;
  return fs::symlink_status(path, code).type() == fs::file_type::directory;
}

std::vector<fs::path> list_entries(const fs::path& folder) {
  const Presence presence = presence_of(folder);
  if (presence == Presence::kAbsent) return {};
  GLINT_CHECK(
      presence == Presence::kFolder,
      kBadReference,
      "{}: is a file, expected a folder",
      folder.string()
  );
  std::vector<fs::path> entries;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code))
    entries.push_back(it->path());
  GLINT_CHECK(
      code != std::errc::permission_denied,
      kEnvironment,
      "{}: permission denied; let this user read the folder",
      folder.string()
  );
  GLINT_CHECK(
      !code || code == std::errc::no_such_file_or_directory,  // has just been removed
      kBadReference,
      "{}: folder cannot be read ({})",
      folder.string(),
      code.message()
  );
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<fs::path> list_folders(const fs::path& folder) {
  std::vector<fs::path> folders = list_entries(folder);
  std::erase_if(folders, [](const fs::path& path) {
    return path.filename().string().starts_with('.') || !is_folder(path);
  });
  return folders;
}

namespace {

struct FilesBelow {
  const std::function<bool(const fs::path&)>& leaves_out;
  FolderLinks links;
  std::vector<fs::path> files;

  // `inside`: the folders around it, as they are called without links, where links are followed.
  void add(const fs::path& folder, std::vector<fs::path> inside) {
    if (links == FolderLinks::kFollowed) {
      const fs::path plain = fs::canonical(folder);
      GLINT_CHECK(
          std::find(inside.begin(), inside.end(), plain) == inside.end(),
          kBadReference,
          "{}: is a link that leads back to a folder around it; remove it",
          folder.string()
      );
      inside.push_back(plain);
    }
    for (const fs::path& path : list_entries(folder)) {
      if (leaves_out && leaves_out(path)) continue;
      if (is_file(path))
        files.push_back(path);
      else if (links == FolderLinks::kFollowed || !is_link(path))
        add(path, inside);
    }
  }
};

}  // namespace

std::vector<fs::path> list_files_below(
    const fs::path& folder,
    const std::function<bool(const fs::path& path)>& leaves_out,
    FolderLinks links
) {
  FilesBelow below{leaves_out, links, {}};
  if (links == FolderLinks::kPassedOver || is_there(folder)) below.add(folder, {});
  std::sort(below.files.begin(), below.files.end());
  return below.files;
}

std::ifstream open_file(const fs::path& path) {
  const Presence presence = presence_of(path);
  GLINT_CHECK(presence != Presence::kAbsent, kBadReference, "{}: no such file", path.string());
  GLINT_CHECK(
      presence == Presence::kFile, kBadReference, "{}: is a folder, expected a file", path.string()
  );
  std::ifstream in(path, std::ios::binary);
  const int why = errno;
  GLINT_CHECK(
      in.good() || (why != EACCES && why != EPERM),
      kEnvironment,
      "{}: permission denied; let this user read it",
      path.string()
  );
  GLINT_CHECK(
      in.good(), kBadReference, "{}: cannot be opened ({})", path.string(), std::strerror(why)
  );
  return in;
}

}  // namespace glint
