// SPDX-License-Identifier: MIT
#include "glint/core/replace_folder.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "glint/core/left_behind.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Matchers::Contains;

namespace {

constexpr int kFiles = 20;

// Ours is what the folder lists.
std::set<std::string> listed(const fs::path& old, const fs::path&) {
  std::set<std::string> names = {"list"};
  std::istringstream list(read_file(old / "list"));
  for (std::string name; list >> name;) names.insert(name);
  return names;
}

void write_ours(const fs::path& folder, const std::string& content) {
  std::string list;
  for (int i = 0; i < kFiles; ++i) {
    const std::string name = fmt::format("images/{}_{}.png", content, i);
    write_file(folder / name, content);
    list += name + "\n";
  }
  write_file(folder / "list", list);
}

std::vector<std::string> make_anew(const fs::path& folder, const std::string& content) {
  const UnfinishedFolder made(folder);
  write_ours(made.path(), content);
  return replace_folder(made.path(), folder, listed);
}

bool is_whole(const fs::path& folder) {
  const std::set<std::string> there = leaves_below(folder);
  const std::set<std::string> ours = listed(folder, folder);
  return std::includes(there.begin(), there.end(), ours.begin(), ours.end());
}

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator())
  );
}

// As another process, which has ended, called it.
fs::path aside_of_ended(const fs::path& folder) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  std::string name = aside_path(folder).filename();
  const std::string own = fmt::format(".{}-", ::getpid());
  name.replace(name.find(own), own.size(), fmt::format(".{}-", child));
  return folder.parent_path() / name;
}

}  // namespace

TEST_CASE("a folder of ours is replaced, what others put there stays and is named") {
  const TempFolder place;
  const fs::path folder = place / "EX";
  CHECK(make_anew(folder, "first").empty());
  write_file(folder / "notes.txt", "mine");
  write_file(folder / "outputs/model/a.bin", "theirs");
  fs::create_directories(folder / "empty");
  fs::create_symlink("nowhere", folder / "images/link");
  const std::vector<std::string> foreign = make_anew(folder, "second");
  CHECK(
      foreign ==
      std::vector<std::string>{"empty", "images/link", "notes.txt", "outputs/model/a.bin"}
  );
  CHECK(read_file(folder / "notes.txt") == "mine");
  CHECK(read_file(folder / "outputs/model/a.bin") == "theirs");
  CHECK(is_whole(folder));
  CHECK(fs::exists(folder / "images/second_0.png"));
  CHECK_FALSE(fs::exists(folder / "images/first_0.png"));
  CHECK(leaves_below(folder).size() == kFiles + 1 + foreign.size());
  CHECK(entries(place.path()) == 1);
}

TEST_CASE("a name that a new file needs and somebody else has taken changes nothing") {
  const TempFolder place;
  const fs::path folder = place / "EX";
  make_anew(folder, "first");
  write_file(folder / "images/second_3.png", "mine");
  CHECK_THAT(
      error_of(ExitCode::kUsage, [&] { make_anew(folder, "second"); }),
      Contains("second_3.png: was put there")
  );
  CHECK(read_file(folder / "images/second_3.png") == "mine");
  CHECK(is_whole(folder));
  CHECK(fs::exists(folder / "images/first_0.png"));
}

TEST_CASE("what a killed replacement left aside comes back, or its foreign files move over") {
  const TempFolder place;
  const fs::path folder = place / "EX", aside = aside_of_ended(folder);
  write_ours(aside, "old");
  write_file(aside / "notes.txt", "mine");
  SECTION("no folder stands there") {
    recover_folder(folder, listed);
    CHECK(fs::exists(folder / "images/old_0.png"));
  }
  SECTION("the new one does") {
    write_ours(folder, "new");
    recover_folder(folder, listed);
    CHECK(fs::exists(folder / "images/new_0.png"));
    CHECK_FALSE(fs::exists(folder / "images/old_0.png"));
  }
  CHECK(read_file(folder / "notes.txt") == "mine");
  CHECK(is_whole(folder));
  CHECK(entries(place.path()) == 1);
}

TEST_CASE("a folder whose files of ours have gone is nobody else's") {
  const TempFolder place;
  const fs::path folder = place / "EX";
  make_anew(folder, "first");
  for (const auto& entry : fs::directory_iterator(folder / "images")) fs::remove(entry);
  CHECK(make_anew(folder, "second").empty());
  CHECK(is_whole(folder));
}

TEST_CASE("a foreign file whose name is taken keeps all that stands aside") {
  const TempFolder place;
  const fs::path folder = place / "EX", aside = aside_of_ended(folder);
  write_ours(aside, "old");
  write_file(aside / "notes.txt", "mine");
  write_ours(folder, "new");
  write_file(folder / "notes.txt", "another's");
  recover_folder(folder, listed);
  CHECK(read_file(aside / "notes.txt") == "mine");
  CHECK(is_whole(aside));
  CHECK(read_file(folder / "notes.txt") == "another's");
  CHECK(is_whole(folder));
}

TEST_CASE("what stood aside for a folder with a longer name is not ours") {
  const TempFolder place;
  write_ours(aside_of_ended(place / "EX.b"), "old");
  recover_folder(place / "EX", listed);
  CHECK_FALSE(fs::exists(place / "EX"));
}

TEST_CASE("killed at any moment, a replacement leaves one whole folder and loses no foreign file") {
  const TempFolder place;
  const fs::path folder = place / "EX";
  make_anew(folder, "0");
  write_file(folder / "outputs/a.bin", "theirs");
  for (int round = 0; round < 40; ++round) {
    const pid_t child = ::fork();
    if (child == 0)
      for (int i = 0;; ++i) make_anew(folder, fmt::format("{}_{}", round, i));
    std::this_thread::sleep_for(std::chrono::microseconds(2000 + 1370 * round));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    recover_folder(folder, listed);
    REQUIRE(is_whole(folder));
    REQUIRE(read_file(folder / "outputs/a.bin") == "theirs");
  }
  make_anew(folder, "last");
  CHECK(leaves_below(folder).size() == kFiles + 2);
  CHECK(entries(place.path()) == 1);
}
