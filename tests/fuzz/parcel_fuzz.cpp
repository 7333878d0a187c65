// SPDX-License-Identifier: MIT
// What comes home from other machines: parcels, and the tar archives that they lie in.
#include "reports/run/parcels/parcel_file.h"
#include "reports/run/parcels/tar_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

Parcel tiny_parcel() {
  Parcel parcel;
  parcel.record.cell = {"room_1", "2dgs", 0};
  parcel.files = {{kRecordFile, record_to_json(parcel.record).dump()}, {"config.json", "{}"}};
  SurfelCloud cloud;
  cloud.extra_names = {"transparency"};
  cloud.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    cloud.means[3 * i] = static_cast<float>(i);
    cloud.rotations[4 * i] = 1;
  }
  CompactFile surfels{.name = "interface.ply", .surfels = true, .count = 3};
  surfels.code = pack_surfels(cloud, {.tolerance = 1e-3, .extras = {"transparency"}});
  parcel.model = {{surfels}, {1e-5, 0}, 1e-3};
  return parcel;
}

// Its parts have hashes, which damage does not pass: surfels are a target of their own.
bool read(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.parcel"), again = input_folder() / "again.parcel";
  return accepts([&] {
    const Parcel parcel = read_parcel(file);
    write_parcel(again, parcel);
    if (read_parcel(again).files != parcel.files)
      throw Finding("a parcel that is another one when it is written again");
  });
}

std::vector<FuzzInput> seeds() {
  return {written("parcel", [](const fs::path& path) { write_parcel(path, tiny_parcel()); })};
}

// "about" as JSON in a line, then the fields one after the other, each behind "NAME LENGTH\n".
bool read_surfels(std::string_view bytes) {
  const fs::path name = input_folder() / "input.surfels";
  const auto line = [&] {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    const std::string text(bytes.substr(0, end));
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    return text;
  };
  const Json about = parse_json(line());
  std::map<std::string, std::string> fields;
  while (!bytes.empty()) {
    const std::string head = line();
    const std::size_t space = head.rfind(' ');
    const std::size_t size =
        space == std::string::npos ? 0 : std::strtoul(head.c_str() + space, nullptr, 10);
    fields[head.substr(0, space)] = bytes.substr(0, size);
    bytes.remove_prefix(std::min(size, bytes.size()));
  }
  return accepts([&] { unpack_surfels(about, fields, name.string()); });
}

std::vector<FuzzInput> surfel_seeds() {
  const SurfelCode code = tiny_parcel().model.files[0].code;
  std::string bytes = code.about.dump() + "\n";
  for (const auto& [name, field] : code.fields)
    bytes += fmt::format("{} {}\n", name, field.size()) + field;
  return {{"surfels", bytes}};
}

bool read_archive(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.tar");
  std::string wrong;
  const bool read = accepts([&] {
    wrong = read_tar(
        file, [](const TarMember&) { return true; }, [](const TarMember&, std::string&&) {}
    );
  });
  return read && wrong.empty();
}

std::vector<FuzzInput> archive_seeds() {
  std::string block(512, '\0');
  block.replace(0, 8, "a.parcel");
  block.replace(124, 11, "00000000003");
  block.replace(148, 8, "        ");
  block[156] = '0';
  unsigned sum = 0;
  for (const char c : block) sum += static_cast<unsigned char>(c);
  block.replace(148, 7, fmt::format("{:06o}", sum) + '\0');
  std::string content = "one";
  content.resize(512);
  return {{"archive", block + content + std::string(1024, '\0')}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"parcel", read, seeds})
GLINT_REGISTER(FuzzTarget, {"packed_surfels", read_surfels, surfel_seeds})
GLINT_REGISTER(FuzzTarget, {"tar", read_archive, archive_seeds})

}  // namespace glint::fuzz
