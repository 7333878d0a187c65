// SPDX-License-Identifier: MIT
#include "reports/run/parcels/tar_file.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "glint/core/error.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

// A header as tar writes it: name, size, type, sum.
std::string header(const std::string& name, std::size_t bytes, char type = '0') {
  std::string block(512, '\0');
  block.replace(0, name.size(), name);
  block.replace(124, 11, fmt::format("{:011o}", bytes));
  block.replace(148, 8, "        ");
  block[156] = type;
  block.replace(257, 5, "ustar");
  unsigned sum = 0;
  for (const char c : block) sum += static_cast<unsigned char>(c);
  block.replace(148, 7, fmt::format("{:06o}", sum) + '\0');
  return block;
}

std::string member(const std::string& name, std::string content, char type = '0') {
  const std::string head = header(name, content.size(), type);
  content.resize((content.size() + 511) / 512 * 512);
  return head + content;
}

struct Contents {
  std::vector<std::string> files;  // "name: content"
  std::string wrong;
};

Contents contents_of(const std::string& archive) {
  const test::TempFolder folder;
  const fs::path path = folder / "results.tar";
  write_file(path, archive);
  Contents contents;
  contents.wrong = read_tar(
      path,
      [](const TarMember& file) { return file.name.ends_with(".parcel"); },
      [&](const TarMember& file, std::string&& content) {
        contents.files.push_back(file.name + ": " + content);
      }
  );
  return contents;
}

const std::string kEnd(1024, '\0');

}  // namespace

TEST_CASE("files of a tar archive are read in their order, others passed over") {
  const std::string large(5000, 'x');
  const Contents contents = contents_of(
      member("results/", "", '5') + member("a.parcel", "one") + member("b.txt", large) +
      member("link.parcel", "", '2') + member("results/c.parcel", large) + kEnd
  );
  CHECK(contents.wrong.empty());
  CHECK(contents.files == std::vector<std::string>{"a.parcel: one", "results/c.parcel: " + large});
}

TEST_CASE("long names come from the records in front of them") {
  const std::string name = std::string(150, 'n') + ".parcel";
  const Contents gnu = contents_of(
      member("././@LongLink", name + '\0', 'L') + member(name.substr(0, 100), "one") + kEnd
  );
  CHECK(gnu.files == std::vector<std::string>{name + ": one"});
  const Contents pax = contents_of(
      member("PaxHeaders/x", fmt::format("{} path={}\n", name.size() + 10, name), 'x') +
      member(name.substr(0, 100), "two") + kEnd
  );
  CHECK(pax.files == std::vector<std::string>{name + ": two"});
}

TEST_CASE("of an archive that was cut off, what is whole is taken, and the place is named") {
  const std::string archive =
      member("a.parcel", "one") + member("b.parcel", std::string(3000, 'b')) + kEnd;
  CHECK(contents_of(archive).wrong.empty());
  const Contents cut = contents_of(archive.substr(0, 2500));
  CHECK(cut.files == std::vector<std::string>{"a.parcel: one"});
  CHECK(cut.wrong == "cut off in b.parcel: 964 of 3000 bytes");
  const Contents without_end = contents_of(archive.substr(0, archive.size() - 1024));
  CHECK(without_end.files.size() == 2);
  CHECK(without_end.wrong == "cut off behind its last file");
  for (std::size_t bytes = 0; bytes < archive.size(); bytes += 97)
    CHECK(contents_of(archive.substr(0, bytes)).files.size() <= 2);
}

TEST_CASE("damaged headers end the reading") {
  const std::string first = member("a.parcel", "one"), second = member("b.parcel", "two");
  std::string damaged = first + second + kEnd;
  damaged[first.size() + 130] = '7';  // of the size
  const Contents contents = contents_of(damaged);
  CHECK(contents.files.size() == 1);
  CHECK(contents.wrong == "no tar header at byte 1024");
  CHECK(contents_of("words").wrong == "cut off behind its last file");
  std::string huge = header("a.parcel", 0);
  huge.replace(124, 11, "77777777777");
  CHECK_THAT(contents_of(huge).wrong, Catch::StartsWith("no tar header"));
}

TEST_CASE("an archive by tar itself") {
  const test::TempFolder folder;
  write_file(folder / "in/a.parcel", "one");
  write_file(folder / "in/b.parcel", std::string(2000, 'b'));
  const fs::path archive = folder / "results.tar";
  const std::string command =
      fmt::format("tar -cf {} -C {} in", archive.string(), folder.path().string());
  REQUIRE(std::system(command.c_str()) == 0);
  CHECK(is_tar_file(archive));
  CHECK(!is_tar_file(folder / "in/b.parcel"));
  std::size_t files = 0;
  const std::string wrong = read_tar(
      archive,
      [](const TarMember&) { return true; },
      [&](const TarMember&, std::string&&) { ++files; }
  );
  CHECK(wrong.empty());
  CHECK(files == 2);
}
