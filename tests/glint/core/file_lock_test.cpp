// SPDX-License-Identifier: MIT
#include "glint/core/file_lock.h"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "tests/support/as_nobody.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

std::string holder_of(const fs::path& file) {
  const auto taken = FileLock::take(file);
  return std::holds_alternative<FileLock>(taken) ? "" : std::get<std::string>(taken);
}

}  // namespace

TEST_CASE("Who holds a lock is told, and when it is let go the next one has it") {
  const test::TempFolder folder;
  const fs::path file = FileLock::file_beside(folder.path() / "runs" / "0");
  CHECK(file == folder.path() / "runs" / ".0.lock");
  CHECK(FileLock::file_beside(folder.path() / "runs" / "0" / "") == file);
  {
    const auto lock = FileLock::take(file);
    REQUIRE(std::holds_alternative<FileLock>(lock));
    CHECK_THAT(
        holder_of(file), Catch::StartsWith("process " + std::to_string(::getpid()) + " on ")
    );
  }
  CHECK(!fs::exists(file));
  CHECK(holder_of(file).empty());
}

TEST_CASE("A process that is killed holds nothing") {
  const test::TempFolder folder;
  const fs::path file = folder.path() / "lock";
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto lock = FileLock::take(file);
    [[maybe_unused]] const ssize_t told = ::write(ready[1], "x", 1);
    ::pause();
    ::_exit(0);
  }
  char byte = 0;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  CHECK_THAT(holder_of(file), Catch::StartsWith("process " + std::to_string(child) + " on "));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK(fs::exists(file));
  CHECK(holder_of(file).empty());
  CHECK(!fs::exists(file));
}

TEST_CASE("A folder that may not be made is named with the reason") {
  const test::TempFolder folder;
  fs::permissions(folder.path(), fs::perms(0555));
  {
    const test::AsNobody nobody;
    if (nobody.lacks_privileges())
      CHECK_THAT(
          test::error_of(ExitCode::kEnvironment, [&] { FileLock::take(folder / "runs" / "lock"); }),
          Catch::Contains("/runs: cannot be made (Permission denied)")
      );
  }
  fs::permissions(folder.path(), fs::perms::owner_all);
}

TEST_CASE("A worker whose parent was killed is waited for, any other one is not") {
  const test::TempFolder folder;
  const fs::path file = folder.path() / "lock";
  const pid_t ended = ::fork();
  if (ended == 0) ::_exit(0);
  ::waitpid(ended, nullptr, 0);
  const auto take_beside_worker_of = [&](pid_t parent, bool& waited) {
    int ready[2];
    REQUIRE(::pipe(ready) == 0);
    const pid_t worker = ::fork();
    if (worker == 0) {
      ::setenv(kWorksFor, std::to_string(parent).c_str(), 1);
      {
        const auto lock = FileLock::take(file);
        [[maybe_unused]] const ssize_t told = ::write(ready[1], "x", 1);
        ::usleep(200000);
      }
      ::_exit(0);
    }
    char byte = 0;
    REQUIRE(::read(ready[0], &byte, 1) == 1);
    const auto lock = FileLock::take_from_orphan(file, [&](const std::string& holder) {
      waited = holder.find(" for process ") != std::string::npos;
    });
    const bool taken = std::holds_alternative<FileLock>(lock);
    ::waitpid(worker, nullptr, 0);
    return taken;
  };
  bool waited = false;
  CHECK_FALSE(take_beside_worker_of(::getpid(), waited));
  CHECK_FALSE(waited);
  CHECK(take_beside_worker_of(ended, waited));
  CHECK(waited);
}
