// SPDX-License-Identifier: MIT
#include "glint/core/presence.h"

#include <sys/stat.h>

#include "tests/support/as_nobody.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Matchers::Contains;

TEST_CASE("what is there is a file or a folder, also behind a link; what is not is absent") {
  const TempFolder folder;
  write_file(folder / "a.txt", "a");
  fs::create_directories(folder / "inner");
  fs::create_symlink("a.txt", folder / "to_file");
  fs::create_directory_symlink("inner", folder / "to_folder");
  for (const char* name : {"a.txt", "to_file"}) CHECK(is_file(folder / name));
  for (const char* name : {"inner", "to_folder"}) CHECK(is_folder(folder / name));
  CHECK_FALSE(is_folder(folder / "a.txt"));
  for (const char* name : {"b.txt", "b/c.txt", "a.txt/b"}) CHECK_FALSE(is_there(folder / name));
}

TEST_CASE("what cannot be looked up is not absent") {
  const TempFolder folder;
  fs::create_symlink("missing", folder / "dangling");
  fs::create_symlink("loop", folder / "loop");
  CHECK_THAT(
      error_of(ExitCode::kBadReference, [&] { is_there(folder / "dangling"); }),
      Contains("leads nowhere")
  );
  CHECK_THAT(
      error_of(ExitCode::kBadReference, [&] { is_there(folder / "loop"); }),
      Contains("leads to itself")
  );
  CHECK_THAT(
      error_of(ExitCode::kBadReference, [&] { is_there(folder / "loop/inner"); }),
      Contains("leads to itself")
  );
}

TEST_CASE("a folder that this user may not enter hides nothing in silence") {
  const TempFolder folder;
  write_file(folder / "closed/a.txt", "a");
  fs::permissions(folder.path(), fs::perms::all);
  fs::permissions(folder / "closed", fs::perms::none);
  const AsNobody nobody;
  if (nobody.lacks_privileges())
    CHECK_THAT(
        error_of(ExitCode::kEnvironment, [&] { is_file(folder / "closed/a.txt"); }),
        Contains("permission denied")
    );
}

TEST_CASE("a name is taken by whatever has it, and a folder's own by a folder alone") {
  const TempFolder folder;
  fs::create_symlink("missing", folder / "dangling");
  fs::create_directories(folder / "inner");
  fs::create_directory_symlink("inner", folder / "to_folder");
  CHECK(is_taken(folder / "dangling"));
  CHECK_FALSE(is_taken(folder / "missing"));
  CHECK_FALSE(is_taken(folder / "missing/below"));
  CHECK(is_real_folder(folder / "inner"));
  CHECK_FALSE(is_real_folder(folder / "to_folder"));
  CHECK_FALSE(is_real_folder(folder / "dangling"));
}

TEST_CASE("a folder's entries are listed whatever they are, files below it looked up") {
  const TempFolder folder;
  write_file(folder / "b.txt", "b");
  write_file(folder / "inner/.a.txt", "a");
  fs::create_directory_symlink("inner", folder / "to_folder");
  fs::create_symlink("b.txt", folder / "to_file");
  const std::vector<fs::path> files = {
      folder / "b.txt", folder / "inner/.a.txt", folder / "to_file"};
  CHECK(list_files_below(folder.path()) == files);
  CHECK(list_files_below(folder / "missing").empty());
  fs::create_symlink("missing", folder / "dangling");
  CHECK(list_entries(folder.path()).size() == 5);
  CHECK_THAT(
      error_of(ExitCode::kBadReference, [&] { list_files_below(folder.path()); }),
      Contains("dangling: is a link that leads nowhere")
  );
  const auto is_link = [](const fs::path& path) { return fs::is_symlink(path); };
  CHECK(list_files_below(folder.path(), is_link).size() == 2);
  CHECK_THAT(
      error_of(ExitCode::kBadReference, [&] { list_entries(folder / "b.txt"); }),
      Contains("is a file, expected a folder")
  );
  CHECK_FALSE(or_warn([&] { return is_there(folder / "dangling"); }));
  CHECK(or_warn([&] { return is_there(folder / "b.txt"); }));
}

TEST_CASE("pipes and devices are neither read nor waited for") {
  const TempFolder folder;
  const fs::path pipe = folder / "pipe.png";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  fs::create_symlink("/dev/zero", folder / "zero.png");
  CHECK_THAT(
      error_of(ExitCode::kBadReference, [&] { open_file(pipe); }),
      Contains("is a pipe, expected a file")
  );
  CHECK_THAT(
      error_of(ExitCode::kBadReference, [&] { is_file(folder / "zero.png"); }),
      Contains("is a device")
  );
}

TEST_CASE("a file is opened from its first byte; a folder or nothing is named") {
  const TempFolder folder;
  write_file(folder / "a.txt", "text");
  std::string text;
  open_file(folder / "a.txt") >> text;
  CHECK(text == "text");
  CHECK_THAT(
      error_of(ExitCode::kBadReference, [&] { open_file(folder.path()); }), Contains("is a folder")
  );
  CHECK_THAT(
      error_of(ExitCode::kBadReference, [&] { open_file(folder / "b.txt"); }),
      Contains("no such file")
  );
}
