// SPDX-License-Identifier: MIT
#include "glint/core/left_behind.h"

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

// The number of a process that has ended.
pid_t ended_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

// unfinished_path() as that process called it.
fs::path of_process(const fs::path& path, pid_t process) {
  std::string name = unfinished_path(path).filename();
  const std::string own = fmt::format(".{}-", ::getpid());
  name.replace(name.find(own), own.size(), fmt::format(".{}-", process));
  return path.parent_path() / name;
}

}  // namespace

TEST_CASE("what a killed process left is found by its name, what is being written is not") {
  const TempFolder folder;
  const fs::path dead = of_process(folder / "a/x.png", ended_process());
  const fs::path whole = of_process(folder / "scene", ended_process());
  const fs::path mine = unfinished_path(folder / "a/x.png");
  CHECK(mine.extension() == ".png");
  write_file(dead, "half");
  write_file(whole / "images/0.png", "half");
  std::ofstream(mine) << "half";
  std::ofstream(of_process(folder / "y.json", ::getppid())) << "half";
  for (const char* name : {"a/.hidden", "a/.x.12.part", "a/.notes.12-a-b.txt", "x.1-host.part.png"})
    write_file(folder / name, "not ours");
  CHECK(list_left_behind(folder.path()) == std::vector<fs::path>{whole, dead});
  CHECK(list_left_behind(folder.path(), false) == std::vector<fs::path>{whole});
  remove_left_behind(folder.path());
  CHECK_FALSE(fs::exists(dead));
  CHECK_FALSE(fs::exists(whole));
  CHECK(fs::exists(mine));
  CHECK(fs::exists(folder / "a/.x.12.part"));
}

TEST_CASE("a process that has ended and was not waited for writes nothing any more") {
  const TempFolder folder;
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  siginfo_t info{};
  ::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT);  // it stays a zombie
  const fs::path file = of_process(folder / "x.png", child);
  std::ofstream(file) << "half";
  CHECK(list_left_behind(folder.path()) == std::vector<fs::path>{file});
  ::waitpid(child, nullptr, 0);
}

TEST_CASE("another machine's processes are not known: a day decides") {
  const TempFolder folder;
  const fs::path fresh = folder / ".x.1-elsewhere.part.png", old = folder / ".y.1-elsewhere.part";
  std::ofstream(fresh) << "half";
  std::ofstream(old) << "half";
  fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(25));
  CHECK(list_left_behind(folder.path()) == std::vector<fs::path>{old});
}
