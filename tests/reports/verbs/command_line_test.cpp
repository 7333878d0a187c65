// SPDX-License-Identifier: MIT
// glint-bench as a program: exit codes of wrong and right command lines.
#include <fcntl.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <iostream>
#include <vector>

#include "glint/core/device.h"
#include "glint/cuda/backend.h"
#include "reports/verbs/command_line.h"
#include "tests/reports/run_words.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

int run(std::initializer_list<const char*> words) {
  std::vector<const char*> arguments{"glint-bench"};
  arguments.insert(arguments.end(), words.begin(), words.end());
  return run_command_line(static_cast<int>(arguments.size()), arguments.data());
}

}  // namespace

TEST_CASE("help and version succeed") {
  CHECK(run({"--help"}) == 0);
  CHECK(run({"--version"}) == 0);
  CHECK(run({"all", "--help"}) == 0);
  CHECK(run({"dataset", "make", "--help"}) == 0);
}

TEST_CASE("wrong command lines exit with 1") {
  CHECK(run({}) == 1);
  CHECK(run({"fly"}) == 1);
  CHECK(run({"status", "--no-such-option"}) == 1);
  CHECK(run({"status", "--profile", "no-such-profile"}) == 1);
  CHECK(run({"status", "--seed", "minus one"}) == 1);
  CHECK(run({"status", "--threads", "-1"}) == 1);
  CHECK(run({"status", "--set", "nonsense"}) == 1);
  CHECK(run({"status", "--only", "room_9"}) == 1);
  CHECK(run({"status", "--only", "room_1,room_9"}) == 1);
  CHECK(run({"status", "--device", "tpu"}) == 1);
  CHECK(run({"table", "--format", "docx"}) == 1);
  CHECK(run({"table", "table9", "--profile", "ci"}) == 1);
  CHECK(run({"train", "--method", "2dgs"}) == 1);
  CHECK(run({"train", "--dataset", "nowhere", "--method", "no-such-method"}) == 1);
  CHECK(run({"dataset"}) == 1);
  CHECK(run({"dataset", "make", "glasshouse"}) == 1);
}

TEST_CASE("a predicted run that is none exits with 2, a dataset that is none with 3") {
  CHECK(run({"render", "--run", "does/not/exist"}) == 2);
  CHECK(run({"eval", "--run", "does/not/exist"}) == 2);
  CHECK(run({"train", "--dataset", "does/not/exist"}) == 3);
  CHECK(run({"dataset", "info", "does/not/exist"}) == 3);
  CHECK(run({"dataset", "check", "does/not/exist"}) == 3);
}

TEST_CASE("doctor exits with 6 where weights of LPIPS cannot be used") {
  const test::TempFolder folder;
  write_file(folder / "lpips_alex_v0.1.safetensors", "no weights");
  ::setenv("GLINT_LPIPS_WEIGHTS", (folder / "lpips_alex_v0.1.safetensors").c_str(), 1);
  CHECK(run({"doctor"}) == 6);
  ::setenv("GLINT_LPIPS_WEIGHTS", (folder / "nothing_there").c_str(), 1);
  CHECK(run({"doctor"}) == 0);
  ::unsetenv("GLINT_LPIPS_WEIGHTS");
}

TEST_CASE("doctor exits with 6 where there has to be a GPU and is none") {
  const int without = gpu::cuda_device().usable ? 0 : 6;
  ::setenv("GLINT_REQUIRE_GPU", "1", 1);
  CHECK(run({"doctor"}) == without);
  ::setenv("GLINT_REQUIRE_GPU", "0", 1);
  CHECK(run({"doctor"}) == 0);
  ::unsetenv("GLINT_REQUIRE_GPU");
  CHECK(run({"doctor"}) == 0);
}

TEST_CASE("a GPU is used where there is one; asking for it elsewhere exits with 6") {
  const bool has_gpu = gpu::cuda_device().usable;
  CHECK(run({"status", "--device", "cuda"}) == (has_gpu ? 0 : 6));
  CHECK(run({"status", "--device", "auto"}) == 0);
  CHECK(on_gpu() == has_gpu);
  CHECK(run({"status", "--device", "cpu"}) == 0);
  CHECK(!on_gpu());
  CHECK(has_gpu == gpu::cuda_device().why_not.empty());
}

TEST_CASE("damaged records exit with 2") {
  const test::TempFolder folder;
  write_file(folder.path() / "ci/records.jsonl", "{\"method\": 1}\n");
  CHECK(run({"table", "--out", folder.path().c_str()}) == 2);
}

TEST_CASE("status works before anything was run, table exits with 2 and writes nothing") {
  const test::TempFolder folder;
  const char* out = folder.path().c_str();
  CHECK(run({"status", "--profile", "smoke", "--out", out}) == 0);
  CHECK(run({"status", "--profile", "smoke", "--out", out, "--json"}) == 0);
  CHECK(run({"status", "--profile", "smoke", "--out", out, "--leftovers"}) == 0);
  CHECK(run({"table", "--profile", "smoke", "--out", out}) == 2);
  CHECK(fs::is_empty(folder.path()));
}

TEST_CASE("--out is the folder above the profile's or the profile's own, for every verb") {
  const test::TempFolder folder;
  const fs::path own = folder.path() / "smoke";
  write_file(
      own / "records.jsonl",
      R"({"scene": "room_1", "method": "2dgs", "dataset": "glassroom", "profile": "smoke"})"
      "\n"
  );
  for (const std::string& out : {folder.path().string(), own.string()}) {
    fs::remove_all(own / "tables");
    fs::remove_all(own / "report");
    CHECK(run({"table", "--profile", "smoke", "--out", out.c_str()}) == 0);
    CHECK(run({"report", "--profile", "smoke", "--out", out.c_str()}) == 0);
    CHECK(run({"status", "--profile", "smoke", "--out", out.c_str()}) == 0);
    CHECK(fs::exists(own / "tables/table1_photometric.csv"));
    CHECK(fs::exists(own / "report/index.html"));
    CHECK_FALSE(fs::exists(own / "smoke"));
  }
  // Without --profile the folder's records are shown; what adds to it wants the right profile.
  CHECK(run({"table", "--out", own.c_str()}) == 0);
  CHECK(run({"all", "--out", own.c_str()}) == 1);
}

TEST_CASE("a choice of methods is printed, not written, and names what there is") {
  const test::TempFolder folder;
  const char* out = folder.path().c_str();
  write_file(
      folder / "smoke/records.jsonl",
      R"({"scene": "room_1", "method": "mine", "dataset": "glassroom", "profile": "smoke"})"
      "\n"
  );
  CHECK(run({"table", "--profile", "smoke", "--out", out, "--methods", "mine"}) == 0);
  CHECK(run({"table", "--profile", "smoke", "--out", out, "--only", "room_1"}) == 0);
  CHECK(run({"table", "--profile", "smoke", "--out", out, "--only", "room_9,room_1"}) == 0);
  CHECK_FALSE(fs::exists(folder / "smoke/tables"));
  CHECK(run({"table", "--profile", "smoke", "--out", out, "--methods", "2dgs"}) == 1);
  CHECK(run({"table", "--profile", "smoke", "--out", out, "--methods", "nothing"}) == 1);
  CHECK(run({"table", "--profile", "smoke", "--out", out, "--skip", "mine"}) == 1);
  CHECK(run({"report", "--profile", "smoke", "--out", out, "--methods", "mine"}) == 0);
  CHECK(run({"status", "--profile", "smoke", "--out", out, "--methods", "glint,pgsr"}) == 0);
  CHECK(run({"status", "--profile", "smoke", "--out", out, "--methods", "nothing"}) == 1);
  CHECK(run({"table", "--profile", "smoke", "--out", out, "--table", "summary"}) == 0);
}

TEST_CASE("a report needs records, and nothing else") {
  const test::TempFolder folder;
  const char* out = folder.path().c_str();
  CHECK(run({"report", "--profile", "smoke", "--out", out}) == 2);
  const fs::path records = folder.path() / "smoke/records.jsonl";
  write_file(
      records,
      R"({"scene": "room_1", "method": "2dgs", "dataset": "glassroom"})"
      "\n"
  );
  CHECK(run({"report", "--profile", "smoke", "--out", out}) == 0);
  CHECK(fs::exists(folder.path() / "smoke/report/index.html"));
  CHECK(fs::exists(folder.path() / "smoke/report/assets/data.js"));
  CHECK(run({"report", "--profile", "smoke", "--out", out, "--single-file"}) == 0);
  CHECK(!fs::exists(folder.path() / "smoke/report/assets"));
  write_file(records, "{\"method\": 1}\n");
  CHECK(run({"report", "--profile", "smoke", "--out", out}) == 2);
}

TEST_CASE("compare exits with 4 on a regression and with 2 where there are no records") {
  const test::TempFolder folder;
  const auto store = [&](const char* name, double psnr) {
    const fs::path path = folder.path() / name;
    write_file(
        path / "records.jsonl",
        fmt::format(R"({{"scene": "room_1", "method": "2dgs", "metrics": {{"psnr": {}}}}})", psnr) +
            "\n"
    );
    return path.string();
  };
  const std::string before = store("before", 30), slight = store("slight", 29.8),
                    worse = store("worse", 29.6), none = folder / "none.jsonl",
                    table = folder / "change.md";
  CHECK(run({"compare", before.c_str(), slight.c_str()}) == 0);
  CHECK(run({"compare", before.c_str(), slight.c_str(), "--tolerance", "0.001"}) == 4);
  CHECK(run({"compare", before.c_str(), worse.c_str(), "--markdown", table.c_str()}) == 4);
  CHECK(read_file(table).find("| room_1/2dgs | psnr ↑ | 30 | 29.6 | -0.4 |") != std::string::npos);
  CHECK(run({"compare", worse.c_str(), before.c_str(), "--markdown", "-"}) == 0);
  CHECK(run({"compare", before.c_str(), none.c_str(), "--json"}) == 2);
  write_file(none, "\x89PNG\r\n\x1a\n");
  CHECK(run({"compare", before.c_str(), none.c_str()}) == 2);
  CHECK(run({"compare", before.c_str()}) == 1);
  // Nothing in common: no cell, or no metric.
  const fs::path other = folder.path() / "other";
  write_file(
      other / "records.jsonl",
      R"({"scene": "room_2", "method": "2dgs", "metrics": {"psnr": 30}})"
      "\n"
  );
  CHECK(run({"compare", before.c_str(), other.c_str()}) == 4);
  CHECK(run({"compare", before.c_str(), slight.c_str(), "--metric", "nothing"}) == 1);  // misspelt
  CHECK(run({"compare", before.c_str(), slight.c_str(), "--methods", "glint"}) == 1);   // none left
  CHECK(run({"compare", before.c_str(), slight.c_str(), "--methods", "2dgs"}) == 0);
  CHECK(run({"compare", before.c_str(), worse.c_str(), "--tolerance", "-1"}) == 1);
}

TEST_CASE("an output folder that cannot be written exits with 6") {
  const test::TempFolder folder;
  write_file(
      folder / "records.jsonl",
      R"({"scene": "room_1", "method": "2dgs"})"
      "\n"
  );
  const std::string store = folder.path().string();
  CHECK(run({"compare", store.c_str(), store.c_str(), "--markdown", "/proc/nowhere/x"}) == 6);
}

TEST_CASE("output that nobody takes is an error of the environment") {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"methods"}, {"methods", "--json"}, {"--help"}, {"--version"}}) {
    std::fflush(stdout);
    std::cout.flush();
    const int kept = ::dup(1), full = ::open("/dev/full", O_WRONLY);
    ::dup2(full, 1);
    const int code = test::run(words);
    ::dup2(kept, 1);
    ::close(kept), ::close(full);
    std::clearerr(stdout);
    std::cout.clear();
    INFO(words.back());
    CHECK(code == 6);
  }
}

TEST_CASE("numbers that are not finite are usage errors") {
  for (const char* number : {"nan", "inf", "-1e999"}) {
    int code = 0;
    const std::string errors = test::captured(2, [&] {
      code = test::run({"mesh", "--run", "x", "--max-memory", number});
    });
    CHECK(code == 1);
    CHECK_THAT(errors, Catch::Contains("--max-memory"));
  }
}

TEST_CASE("seeds that no 64 bits hold and numbers out of range are told in a short line") {
  const auto errors_of = [](const std::vector<std::string>& words) {
    return test::captured(2, [&] { CHECK(test::run(words) == 1); });
  };
  for (const char* seed : {"-1", "-5", "99999999999999999999"})
    CHECK_THAT(
        errors_of({"status", "--seed", seed}),
        Catch::Contains(std::string("--seed is ") + seed + "; expected a whole number from 0 to")
    );
  const std::string errors = errors_of({"status", "--iterations", "0"});
  CHECK_THAT(errors, Catch::Contains("--iterations: '0' must be above 0"));
  CHECK(errors.size() < 200);
  CHECK_THAT(
      errors_of({"status", "--checkpoint-seconds", "nan"}), Catch::Contains("must be at least 0")
  );
}

TEST_CASE("verbs that others do now say which") {
  const test::TempFolder folder;
  const std::string out = folder.path().string();
  const auto said = [](const std::vector<std::string>& words, int code) {
    return test::captured(2, [&] { CHECK(test::run(words) == code); });
  };
  CHECK_THAT(said({"clean", "--yes"}, 1), Catch::Contains("status --leftovers"));
  CHECK_THAT(said({"audit", "--methods", "2dgs"}, 1), Catch::Contains("glint-bench compare"));
  const std::vector<std::string> plan{"plan", "--profile", "smoke", "--out", out};
  CHECK_THAT(said(plan, 0), Catch::Contains("use `glint-bench status`"));
  const std::string unknown = said({"run", "--profile", "smoke", "--cell", "room_9/2dgs/0"}, 1);
  CHECK_THAT(unknown, Catch::Contains("use `glint-bench all --no-tables`"));
  CHECK_THAT(unknown, Catch::Contains("none of that name"));
  CHECK_THAT(said({"--help"}, 0), !Catch::Contains("audit"));
}
