// SPDX-License-Identifier: MIT
// The daemon of MPS that a pool starts and ends, and cells that share a card by it; MPS and the
// card are stand-ins.
#include "reports/run/executors/mps_server.h"

#include <unistd.h>
#include <catch2/catch.hpp>

#include <csignal>

#include "glint/core/interrupt.h"
#include "reports/run/executors/card_share.h"
#include "tests/reports/run/executors/fake_mps.h"
#include "tests/reports/run/executors/pool.h"
#include "tests/reports/run_words.h"

using namespace glint;
using test::FakeMps;
using test::look_at_fake_card;
using test::Pool;

namespace {

constexpr double kCardBytes = 80e9;

std::string value_of(const ChildProcess::Words& settings, const std::string& name) {
  for (const std::string& setting : settings)
    if (setting.starts_with(name + "=")) return setting.substr(name.size() + 1);
  return "";
}

ExecutorOptions on_card(int jobs) {
  ExecutorOptions how;
  how.jobs = jobs;
  how.look_at_card = look_at_fake_card(kCardBytes);
  return how;
}

// What a pool of two cells on the card says and does.
std::string run_on_card(Pool& pool) {
  pool.how.jobs = 2;
  pool.how.look_at_card = look_at_fake_card(kCardBytes);
  return test::captured(2, [&] { CHECK(pool.run().ran == 4); });
}

bool within_seconds(int seconds, const std::function<bool()>& happens) {
  for (int i = 0; i < 100 * seconds; ++i, ::usleep(10'000))
    if (happens()) return true;
  return false;
}

}  // namespace

TEST_CASE("the worker", "[.worker]") { test::run_worker(); }

TEST_CASE("a daemon has a folder of its own, which nobody else may look into, and takes it along") {
  const FakeMps mps;
  fs::path pipes;
  {
    const MpsServer server;
    pipes = value_of(server.settings(), "CUDA_MPS_PIPE_DIRECTORY");
    CHECK(fs::is_directory(value_of(server.settings(), "CUDA_MPS_LOG_DIRECTORY")));
    CHECK(fs::status(pipes.parent_path()).permissions() == fs::perms::owner_all);
    CHECK(server.is_alive());
    CHECK(mps_servers(server.settings()) == "");  // no client yet
    CHECK(mps.folders_left() == 1);
  }
  CHECK_FALSE(fs::exists(pipes));
  CHECK(mps.folders_left() == 0);
  CHECK(mps.asked() == std::vector<std::string>{"start", "get_server_list", "quit"});
}

TEST_CASE("a long name of the folder for temporary files is not taken: sockets lie there") {
  const FakeMps mps;
  const fs::path far = mps.path() / std::string(80, 'x');
  fs::create_directory(far);
  const test::Variable temporary("TMPDIR", far.string());
  const MpsServer server;
  CHECK(value_of(server.settings(), "CUDA_MPS_PIPE_DIRECTORY").starts_with("/tmp/glint-mps-"));
}

TEST_CASE("the daemon has the one card that cells use, and they see it as the first") {
  const FakeMps mps;
  const auto visible = [](const std::string& cards) {
    const test::Variable all("CUDA_VISIBLE_DEVICES", cards);
    return value_of(MpsServer().settings(), "CUDA_VISIBLE_DEVICES");
  };
  CHECK(visible("") == "0");
  CHECK(visible("3,1") == "0");
  CHECK(visible("GPU-7a,GPU-7b") == "GPU-7a");
}

TEST_CASE("a daemon that does not start is an error with its words, and leaves nothing") {
  const FakeMps mps("fails");
  CHECK(test::error_of(ExitCode::kEnvironment, [] {
          const MpsServer server;
        }) == "nvidia-cuda-mps-control -d: not permitted");
  CHECK(mps.folders_left() == 0);
}

TEST_CASE("without the program on PATH there is no MPS") {
  const test::TempFolder nothing;
  const test::Variable path("PATH", nothing.path().string());
  CHECK(mps_control().empty());
  CHECK_FALSE(mps_servers());
  CHECK_THROWS_WITH(MpsServer(), Catch::Contains("is not on PATH"));
}

TEST_CASE("cells on a card run side by side, with a daemon that they alone know") {
  const FakeMps mps;
  Pool pool;
  run_on_card(pool);
  CHECK(mps.count("start") == 1);
  CHECK(mps.count("quit") == 1);
  CHECK(mps.folders_left() == 0);
  CHECK(mps_folder() == (mps.path() / "none").string());  // of this program
  const auto begun = pool.begun();
  REQUIRE(begun.size() == 4);
  for (const std::string& line : begun) CHECK_THAT(line, Catch::Contains(" jobs=2 mps=/"));
  for (const std::string& line : begun) CHECK_THAT(line, Catch::Contains("/glint-mps-"));
}

TEST_CASE("where MPS is not to be had, cells take turns, and one line says why") {
  const auto [how, why] = GENERATE(table<std::string, std::string>(
      {{"fails", "nvidia-cuda-mps-control -d: not permitted"},
       {"deaf", "MPS does not serve this card"}}
  ));
  const FakeMps mps(how);
  Pool pool;
  CHECK(run_on_card(pool) == "warning: --jobs 2: cells take turns on the GPU: " + why + "\n");
  CHECK(mps.folders_left() == 0);
  const auto begun = pool.begun();
  REQUIRE(begun.size() == 4);
  for (const std::string& line : begun)
    CHECK_THAT(line, Catch::Contains(" jobs= mps=" + mps_folder()));
}

TEST_CASE("a daemon that answers where the environment says is used, and goes on") {
  const FakeMps mps;
  mps.start_daemon();
  Pool pool;
  CHECK(run_on_card(pool).empty());
  CHECK(mps.count("start") == 1);
  CHECK(mps.count("quit") == 0);
  for (const std::string& line : pool.begun())
    CHECK_THAT(line, Catch::EndsWith(" jobs=2 mps=" + mps_folder()));
  CHECK(run_command({"sh", "-c", "echo quit | nvidia-cuda-mps-control"})->end.good());
}

TEST_CASE("one cell at a time, the CPU, or no GPU need no MPS") {
  const FakeMps mps;
  ExecutorOptions no_card;
  no_card.jobs = 3;
  no_card.look_at_card = test::look_at_no_card();
  for (const ExecutorOptions& how : {on_card(1), no_card, ExecutorOptions{.jobs = 3}}) {
    CardShare share(how);
    test::captured(2, [&] { share.begin(); });
    CHECK(share.jobs() == how.jobs);
    CHECK(share.on_gpu() == (how.jobs == 1));
    CHECK(share.settings().empty());
  }
  CHECK(mps.asked().empty());
}

TEST_CASE("a GPU that is asked for and not there is an error before any cell") {
  ExecutorOptions how = on_card(1);
  how.on_gpu = true;
  const auto error = [&] {
    return test::error_of(ExitCode::kEnvironment, [&] { const CardShare share(how); });
  };
  how.look_at_card = test::look_at_no_card();
  CHECK(error() == "--device cuda: no NVIDIA driver; use --device cpu");
  how.look_at_card = {"sh", "-c", "echo 'error: the disk is on fire'; exit 6"};
  CHECK(error() == "--device cuda: the disk is on fire; use --device cpu");
  how.look_at_card = {"sh", "-c", "kill -SEGV $$"};
  CHECK_THAT(error(), Catch::Contains("ended without a word"));
  how.look_at_card = {"glint-no-such-program"};
  CHECK_THAT(error(), Catch::Contains("cannot be started"));
}

TEST_CASE("what fills the card does not begin beside others") {
  const FakeMps mps;
  const auto most_at_once = [](double card) {
    Pool pool;
    for (const char* method : {"fake", "fake/other"}) {
      Record record;
      record.cell = {"room_9", method, 0};
      record.metrics["device-memory"] = 30e3;  // MB: with what the driver has, 38 GB
      append_record(pool.folder / "records.jsonl", record);
    }
    pool.fails = "slow";
    pool.options.profile.iterations = 200;  // of one cell 2 s
    pool.how.jobs = 2;
    pool.how.look_at_card = look_at_fake_card(card);
    CHECK(pool.run().ran == 4);
    return pool.most_at_once();
  };
  CHECK(most_at_once(80e9) == 2);
  CHECK(most_at_once(60e9) == 1);
}

TEST_CASE("when the daemon ends by itself, cells that begin later take turns") {
  const FakeMps mps;
  ExecutorOptions how = on_card(2);
  set_quiet(true);
  CardShare share(how);
  share.begin();
  CHECK(share.jobs() == 2);
  CHECK(share.free_bytes() == kCardBytes);
  run_command({"sh", "-c", "echo quit | nvidia-cuda-mps-control"}, share.settings());
  const std::string said = test::captured(2, [&] {
    CHECK(within_seconds(5, [&] {
      share.heed_end_of_mps();
      return share.jobs() == 1;
    }));
  });
  CHECK(said == "warning: --jobs 2: cells take turns on the GPU: the daemon of MPS has ended\n");
  CHECK(share.settings().empty());
  CHECK(mps.folders_left() == 0);
}

// A pool of its own program, whose cells do not end.
TEST_CASE("the pool", "[.pool]") {
  install_interrupt_handler();
  Pool pool;
  pool.fails = "slow";
  pool.options.profile.iterations = 100000;
  pool.options.filter.only = {"room_1/fake/0"};
  pool.how.jobs = 2;
  pool.how.look_at_card = look_at_fake_card(kCardBytes);
  std::_Exit(exit_code_of(pool.run()));
}

TEST_CASE("the daemon ends with the pool, however that ends") {
  const int signal = GENERATE(SIGINT, SIGTERM, SIGKILL);
  INFO(signal_name(signal));
  const FakeMps mps;
  ChildProcess pool({fs::read_symlink("/proc/self/exe").string(), "[.pool]"});
  REQUIRE(within_seconds(30, [&] { return mps.count("get_server_list") >= 2; }));
  REQUIRE(within_seconds(30, [&] { return mps.folders_left() == 1; }));
  ::usleep(300'000);
  pool.send(signal);
  REQUIRE(within_seconds(30, [&] { return pool.end().has_value(); }));
  CHECK(within_seconds(10, [&] { return mps.count("quit") == 1; }));
  CHECK(within_seconds(10, [&] { return mps.folders_left() == 0; }));
}
