// SPDX-License-Identifier: MIT
#include "glint/core/files.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>

#include "glint/core/process.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

// While alive, no file of this process can grow beyond `bytes`: what a full disk does to a writer.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit old_{};
};

std::size_t count_entries(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator())
  );
}

std::vector<std::string> names_in(
    const fs::path& folder, const std::vector<std::string>& extensions
) {
  std::vector<std::string> names;
  for (const fs::path& path : list_files(folder, extensions)) names.push_back(path.filename());
  return names;
}

}  // namespace

TEST_CASE("digit runs compare by value") {
  CHECK(natural_less("img2", "img10"));
  CHECK_FALSE(natural_less("img10", "img2"));
  CHECK(natural_less("img", "img0"));
  CHECK(natural_less("a9b", "a10a"));
  CHECK(natural_less("99999999999999999999998", "99999999999999999999999"));
  CHECK_FALSE(natural_less("x", "x"));
  // Equal values still have one order, so sorting is deterministic.
  CHECK(natural_less("007", "7") != natural_less("7", "007"));
}

TEST_CASE("patterns of --only match runs, single characters and sets") {
  CHECK(glob_match("room_*", "room_1"));
  CHECK(glob_match("room_?", "room_1"));
  CHECK_FALSE(glob_match("room_?", "room_10"));
  CHECK(glob_match("room_[12]", "room_2"));
  CHECK_FALSE(glob_match("room_[12]", "room_3"));
}

TEST_CASE("a folder is listed in natural order, by extension, without hidden files and folders") {
  const TempFolder folder;
  for (const char* name : {"10.png", "9.PNG", "1.jpg", ".2.png", "notes.txt"})
    write_file(folder / name, "x");
  fs::create_directory(folder / "3.png");
  CHECK(names_in(folder.path(), {".png"}) == std::vector<std::string>{"9.PNG", "10.png"});
  CHECK(names_in(folder.path(), {}).size() == 4);
}

TEST_CASE("a file where a folder is expected is an error that names it") {
  const TempFolder folder;
  write_file(folder / "file", "x");
  const std::string message = bad_reference([&] { list_files(folder / "file"); });
  CHECK(message.find("file: not a folder") != std::string::npos);
  bad_reference([&] { list_files(folder / "missing"); });
}

TEST_CASE("a link that leads nowhere is not left out of a folder's files") {
  const TempFolder folder;
  write_file(folder / "0.png", "");
  fs::create_symlink("gone.png", folder / "1.png");
  CHECK_THAT(
      error_of(ExitCode::kBadReference, [&] { list_files(folder.path(), {".png"}); }),
      Catch::Matchers::Contains("1.png: is a link that leads nowhere")
  );
}

TEST_CASE("an unreadable folder and an unreadable file are errors that name them") {
  if (::geteuid() == 0) {
    WARN("skipped: the superuser may read everything");
    return;
  }
  const TempFolder folder;
  fs::create_directory(folder / "closed");
  write_file(folder / "closed.txt", "x");
  ::chmod((folder / "closed").c_str(), 0);
  ::chmod((folder / "closed.txt").c_str(), 0);
  CHECK(bad_reference([&] { list_files(folder / "closed"); }).find("closed") != std::string::npos);
  CHECK(bad_reference([&] {
          read_file(folder / "closed.txt");
        }).find("closed.txt") != std::string::npos);
  ::chmod((folder / "closed").c_str(), 0700);
}

TEST_CASE("reading a missing file or a folder is an error that names it") {
  const TempFolder folder;
  CHECK(bad_reference([&] { read_file(folder / "no"); }).find("no such file") != std::string::npos);
  CHECK(bad_reference([&] { read_file(folder.path()); }).find("is a folder") != std::string::npos);
}

TEST_CASE("what is written is read back, through folders made on the way") {
  const TempFolder folder;
  const std::string content("a\0b\nc", 5);
  write_file(folder / "x/y/z.bin", content);
  CHECK(read_file(folder / "x/y/z.bin") == content);
  CHECK(count_entries(folder / "x/y") == 1);
}

TEST_CASE("a writer that fails leaves neither a new file nor a temporary one") {
  const TempFolder folder;
  CHECK_THROWS_AS(
      write_atomically(
          folder / "x.txt",
          [](const fs::path& temporary) {
            write_file(temporary, "half");
            throw std::runtime_error("broken");
          }
      ),
      std::runtime_error
  );
  CHECK(count_entries(folder.path()) == 0);
}

TEST_CASE("a full disk is an environment error and leaves the old file as it was") {
  const TempFolder folder;
  write_file(folder / "x.txt", "old");
  {
    const FileSizeLimit limit(4096);
    const std::string message = error_of(ExitCode::kEnvironment, [&] {
      write_file(folder / "x.txt", std::string(1 << 20, 'a'));
    });
    CHECK(message.find("x.txt") != std::string::npos);
  }
  CHECK(read_file(folder / "x.txt") == "old");
  CHECK(count_entries(folder.path()) == 1);
}

TEST_CASE("writing below a file is an environment error") {
  const TempFolder folder;
  write_file(folder / "file", "x");
  error_of(ExitCode::kEnvironment, [&] { write_file(folder / "file/below.txt", "y"); });
}

TEST_CASE("appending closes a line that a crash tore") {
  const TempFolder folder;
  append_line(folder / "log/x.jsonl", "one");
  append_line(folder / "log/x.jsonl", "two");
  CHECK(read_file(folder / "log/x.jsonl") == "one\ntwo\n");
  write_file(folder / "log/x.jsonl", "one\ntor");
  append_line(folder / "log/x.jsonl", "three");
  CHECK(read_file(folder / "log/x.jsonl") == "one\ntor\nthree\n");
}

TEST_CASE("A temporary folder goes with all that is in it") {
  fs::path path;
  {
    const TemporaryFolder folder("glint_files_test"), other("glint_files_test");
    path = folder.path();
    CHECK(path != other.path());
    CHECK(fs::is_empty(path));
    write_file(folder / "a" / "b.txt", "text");
  }
  CHECK_FALSE(fs::exists(path));
}

TEST_CASE("a path that cannot be looked up is not called missing") {
  const TempFolder folder;
  const std::string message = bad_reference([&] { read_file(folder / std::string(300, 'x')); });
  CHECK_THAT(message, Catch::Contains("cannot be looked up"));
  CHECK_THAT(bad_reference([&] { read_file(folder / "x"); }), Catch::Contains("no such file"));
  if (::geteuid() == 0) return;  // may read everything
  write_file(folder / "closed/x", "x");
  fs::permissions(folder / "closed", fs::perms::none);
  const std::string closed =
      error_of(ExitCode::kEnvironment, [&] { read_file(folder / "closed/x"); });
  fs::permissions(folder / "closed", fs::perms::owner_all);
  CHECK_THAT(closed, Catch::Contains("permission denied"));
}

TEST_CASE("memory that runs out names the file and its size") {
  const TempFolder folder;
  write_file(folder / "x", "12345");
  const std::string message = error_of(ExitCode::kEnvironment, [&] {
    read_within_memory(folder / "x", []() -> int { throw std::bad_alloc(); });
  });
  CHECK_THAT(message, Catch::Contains("/x: out of memory") && Catch::Contains("5 bytes on disk"));
}

TEST_CASE("a limit on the size of files is an error of the writer, not a signal") {
  const auto before = std::signal(SIGXFSZ, SIG_DFL);
  ignore_file_size_signal();
  CHECK(std::signal(SIGXFSZ, before) == SIG_IGN);
}

TEST_CASE("a line that there is no room for leaves nothing of it, and says so as a full disk does"
) {
  const test::TempFolder folder;
  const fs::path file = folder / "records.jsonl";
  append_line(file, "first");
  {
    const FileSizeLimit limit(10);
    CHECK_THROWS_AS(append_line(file, "a line that is too long"), DiskFull);
    CHECK_THROWS_AS(write_file(folder / "other", "more than ten bytes"), DiskFull);
  }
  CHECK(read_file(file) == "first\n");
  append_line(file, "second");
  CHECK(read_file(file) == "first\nsecond\n");
}

TEST_CASE("a folder where a file is to be written is named in our words") {
  const test::TempFolder folder;
  fs::create_directories(folder / "x.json/inside");
  CHECK_THROWS_WITH(
      write_file(folder / "x.json", "1"),
      Catch::Contains("x.json: cannot be written (Is a directory; move the folder")
  );
  CHECK(list_files(folder.path()).empty());
}
