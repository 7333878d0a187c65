// SPDX-License-Identifier: MIT
#include "reports/run/parcels/find_parcels.h"

#include <algorithm>

#include "glint/core/interrupt.h"
#include "glint/core/presence.h"
#include "reports/run/parcels/tar_file.h"

namespace glint {
namespace {

constexpr std::size_t kMostParcelBytes = std::size_t{1} << 29;  // of an archive's

using Take = std::function<void(const Parcel&, const std::string&)>;

class ParcelFinder {
 public:
  explicit ParcelFinder(const Take& take) : take_(take) {}

  void file(const fs::path& path, const std::string& from) {
    throw_if_interrupted();
    std::optional<Parcel> parcel;
    try {
      parcel = read_parcel(path);
    } catch (const Error& error) {
      if (error.code() == ExitCode::kEnvironment) throw;
      lost.push_back({from, error.what()});
      return;
    }
    take_(*parcel, from);
  }

  void archive(const fs::path& path) {
    const TemporaryFolder folder("glint-parcel");
    const auto wanted = [&](const TarMember& member) {
      if (!member.name.ends_with(kParcelExtension)) return false;
      if (member.bytes > kMostParcelBytes)
        lost.push_back({name_in(path, member), fmt::format("{} bytes; no parcel", member.bytes)});
      return member.bytes <= kMostParcelBytes;
    };
    const std::string wrong =
        read_tar(path, wanted, [&](const TarMember& member, std::string&& content) {
          const fs::path copy = folder / fs::path(member.name).filename();
          write_file(copy, content);
          file(copy, name_in(path, member));
          fs::remove(copy);
        });
    if (!wrong.empty()) lost.push_back({path.string(), wrong + "; bring it again"});
  }

  std::vector<LostParcel> lost;

 private:
  static std::string name_in(const fs::path& archive, const TarMember& member) {
    return archive.string() + ": " + member.name;
  }

  const Take& take_;
};

}  // namespace

namespace {

// Whatever they are: one that cannot be read is lost, and the others are not.
std::vector<fs::path> parcels_in(const fs::path& folder) {
  std::vector<fs::path> parcels = list_entries(folder);
  std::erase_if(parcels, [](const fs::path& path) {
    return path.filename().string().starts_with('.') || path.extension() != kParcelExtension;
  });
  std::sort(parcels.begin(), parcels.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return parcels;
}

}  // namespace

bool holds_parcels(const fs::path& path) {
  const auto presence = with_exit_code(ExitCode::kBadPrediction, [&] { return presence_of(path); });
  if (presence != Presence::kFolder) return presence == Presence::kFile;
  return !parcels_in(path).empty();
}

std::vector<LostParcel> for_each_parcel(const fs::path& path, const Take& take) {
  ParcelFinder finder(take);
  if (is_folder(path)) {
    for (const fs::path& file : parcels_in(path)) finder.file(file, file.string());
  } else if (is_tar_file(path)) {
    finder.archive(path);
  } else {
    GLINT_CHECK(
        path.extension() == kParcelExtension,
        kBadPrediction,
        "{}: neither a parcel (*.parcel) nor a tar archive of such; a compressed archive has to be "
        "unpacked first",
        path.string()
    );
    finder.file(path, path.string());
  }
  return std::move(finder.lost);
}

}  // namespace glint
