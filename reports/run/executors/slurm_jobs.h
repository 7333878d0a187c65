// SPDX-License-Identifier: MIT
// What was handed to Slurm, and what Slurm says about it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

// An array of tasks, or one job; a line of OUT/PROFILE/slurm/jobs.jsonl.
struct SlurmJob {
  std::string id;                     // "1234"
  std::string stage;                  // "data", "cells", "tables"
  std::string tasks;                  // file of the array's cells; empty: one job
  std::size_t offset = 0, count = 1;  // its part of the file
};

fs::path slurm_folder(const fs::path& profile_folder);
void append_job(const fs::path& profile_folder, const SlurmJob& job);
// Nothing was submitted: empty. Lines that cannot be read are left out.
std::vector<SlurmJob> read_jobs(const fs::path& profile_folder);

struct SlurmState {
  std::string job;                               // "1234_7"
  std::string state;                             // "RUNNING", "PENDING", "PREEMPTED", ...
  std::string node, elapsed, exit_code, memory;  // empty: not known
  std::string text() const;                      // "RUNNING 1234_7 on node3, 12:30"
};

// Tasks of sacct's lines "JobID|State|ExitCode|Elapsed|MaxRSS|NodeList", by job ("1234_7", "1235");
// of "1234_[5-8%2]" each, of "1234_7.batch" the memory.
std::map<std::string, SlurmState> parse_sacct(const std::string& lines);
// The same of squeue's "%i|%T|%M|%N".
std::map<std::string, SlurmState> parse_squeue(const std::string& lines);

// By cell, of the last job that each was in; asks sacct, and squeue where nothing is accounted.
// Empty: nothing was submitted, or there is no Slurm here.
std::map<std::string, SlurmState> slurm_states(const fs::path& profile_folder);

}  // namespace glint
