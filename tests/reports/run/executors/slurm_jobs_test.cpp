// SPDX-License-Identifier: MIT
#include "reports/run/executors/slurm_jobs.h"

#include <catch2/catch.hpp>

#include "glint/core/error.h"
#include "reports/run/executors/task_file.h"
#include "tests/support/temp_folder.h"

using namespace glint;

TEST_CASE("what sacct says of tasks, of those that wait and of their memory") {
  const auto states = parse_sacct(
      "12_0|COMPLETED|0:0|00:01:05||node1\n"
      "12_0.batch|COMPLETED|0:0|00:01:05|123456K|node1\n"
      "12_1|CANCELLED by 0|0:15|00:00:10||node2\n"
      "12_[2-4%2]|PENDING|0:0|00:00:00||None assigned\n"
      "13|RUNNING|0:0|00:00:01||node1\n"
  );
  REQUIRE(states.size() == 6);
  CHECK(states.at("12_0").text() == "COMPLETED 12_0 on node1, 00:01:05, 123456K");
  CHECK(states.at("12_1").text() == "CANCELLED 12_1 on node2, 00:00:10, exit 0:15");
  CHECK(states.at("12_3").text() == "PENDING 12_3, 00:00:00");
  CHECK(states.at("13").state == "RUNNING");
}

TEST_CASE("what squeue says of tasks") {
  const auto states = parse_squeue("12_0|RUNNING|1:05|node1\n12_[1,3-4]|PENDING|0:00|\n");
  REQUIRE(states.size() == 4);
  CHECK(states.at("12_0").text() == "RUNNING 12_0 on node1, 1:05");
  CHECK(states.at("12_4").text() == "PENDING 12_4, 0:00");
}

TEST_CASE("lines that are none of theirs are left out, huge ranges are cut") {
  CHECK(parse_sacct("").empty());
  CHECK(parse_sacct("Slurm accounting storage is disabled\n|||\n").empty());
  CHECK(parse_squeue("12_[0-99999999999]|PENDING|0:00|\n").size() <= 100000);
}

TEST_CASE("submitted jobs are read as they were written, torn lines are not") {
  const test::TempFolder folder;
  CHECK(read_jobs(folder.path()).empty());
  append_job(folder.path(), {"12", "cells", "tasks-1.tsv", 3, 7});
  append_line(slurm_folder(folder.path()) / "jobs.jsonl", "{\"id\": 3");
  const auto jobs = read_jobs(folder.path());
  REQUIRE(jobs.size() == 1);
  CHECK(jobs[0].id == "12");
  CHECK(jobs[0].offset == 3);
  CHECK(jobs[0].count == 7);
}

TEST_CASE("a task is a line of its file; others are usage errors") {
  const test::TempFolder folder;
  write_file(folder / "tasks.tsv", "room_1/glint/0\t12\nroom_1/2dgs/0\t\n");
  CHECK(cell_of_task(folder / "tasks.tsv", 0) == "room_1/glint/0");
  CHECK(cell_of_task(folder / "tasks.tsv", 1) == "room_1/2dgs/0");
  CHECK_THROWS_WITH(cell_of_task(folder / "tasks.tsv", 2), Catch::Contains("has 2 lines"));
  CHECK_THROWS_AS(cell_of_task(folder / "none.tsv", 0), Error);
}
