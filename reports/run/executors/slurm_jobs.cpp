// SPDX-License-Identifier: MIT
#include "reports/run/executors/slurm_jobs.h"

#include <charconv>
#include <sstream>

#include "glint/core/config.h"
#include "glint/core/presence.h"
#include "reports/run/bench/child_process.h"
#include "reports/run/executors/task_file.h"

namespace glint {
namespace {

fs::path jobs_file(const fs::path& profile_folder) {
  return slurm_folder(profile_folder) / "jobs.jsonl";
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, separator);) fields.push_back(field);
  return fields;
}

std::size_t number_of(std::string_view text) {
  std::size_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// "1234_[3,5-8%2]": each of its tasks; others: itself.
std::vector<std::string> jobs_of(const std::string& id) {
  constexpr std::size_t kMost = 100000;  // of a range: more than any array has
  const std::size_t bracket = id.find("_[");
  if (bracket == std::string::npos) return {id};
  std::string list = id.substr(bracket + 2);
  list = list.substr(0, list.find_first_of("%]"));
  std::vector<std::string> jobs;
  for (const std::string& part : split(list, ',')) {
    const std::size_t dash = part.find('-');
    const std::size_t first = number_of(part);
    const std::size_t last = dash == std::string::npos ? first : number_of(part.substr(dash + 1));
    for (std::size_t task = first; task <= last && jobs.size() < kMost; ++task)
      jobs.push_back(fmt::format("{}_{}", id.substr(0, bracket), task));
  }
  return jobs;
}

// "CANCELLED by 0" is CANCELLED.
std::string first_word(const std::string& text) { return text.substr(0, text.find(' ')); }

std::string ids_of(const std::vector<SlurmJob>& jobs) {
  std::string ids;
  for (const SlurmJob& job : jobs) ids += (ids.empty() ? "" : ",") + job.id;
  return ids;
}

std::map<std::string, SlurmState> ask_slurm(const std::vector<SlurmJob>& jobs) {
  const std::string ids = ids_of(jobs);
  const auto accounted = run_command(
      {"sacct", "-n", "-P", "-j", ids, "-o", "JobID,State,ExitCode,Elapsed,MaxRSS,NodeList"}
  );
  if (accounted && accounted->end.good()) return parse_sacct(accounted->output);
  const auto queued =
      run_command({"squeue", "-h", "-r", "-j", ids, "-t", "all", "-o", "%i|%T|%M|%N"});
  return queued && queued->end.good() ? parse_squeue(queued->output)
                                      : std::map<std::string, SlurmState>();
}

}  // namespace

fs::path slurm_folder(const fs::path& profile_folder) { return profile_folder / "slurm"; }

void append_job(const fs::path& profile_folder, const SlurmJob& job) {
  const Json line = {
      {"id", job.id},
      {"stage", job.stage},
      {"tasks", job.tasks},
      {"offset", job.offset},
      {"count", job.count}};
  append_line(jobs_file(profile_folder), line.dump());
}

std::vector<SlurmJob> read_jobs(const fs::path& profile_folder) {
  if (!is_there(jobs_file(profile_folder))) return {};
  std::vector<SlurmJob> jobs;
  std::istringstream lines(read_file(jobs_file(profile_folder)));
  for (std::string line; std::getline(lines, line);) {
    const Json json = parse_json(line);
    if (!json.is_object()) continue;
    try {
      jobs.push_back(
          {json.at("id"), json.at("stage"), json.at("tasks"), json.at("offset"), json.at("count")}
      );
    } catch (const nlohmann::json::exception&) {
    }
  }
  return jobs;
}

std::string SlurmState::text() const {
  std::string all = state + " " + job;
  if (!node.empty() && node != "None assigned") all += " on " + node;
  if (!elapsed.empty()) all += ", " + elapsed;
  if (!memory.empty()) all += ", " + memory;
  if (!exit_code.empty() && exit_code != "0:0") all += ", exit " + exit_code;
  return all;
}

std::map<std::string, SlurmState> parse_sacct(const std::string& lines) {
  std::map<std::string, SlurmState> states;
  for (const std::string& line : split(lines, '\n')) {
    const auto fields = split(line + "|", '|');
    if (fields.size() < 6) continue;
    const std::size_t dot = fields[0].find('.');
    if (dot != std::string::npos) {  // a step: of the task's script it knows the memory
      const auto task = states.find(fields[0].substr(0, dot));
      if (task != states.end() && !fields[4].empty()) task->second.memory = fields[4];
      continue;
    }
    for (const std::string& job : jobs_of(fields[0]))
      states[job] = {job, first_word(fields[1]), fields[5], fields[3], fields[2], fields[4]};
  }
  return states;
}

std::map<std::string, SlurmState> parse_squeue(const std::string& lines) {
  std::map<std::string, SlurmState> states;
  for (const std::string& line : split(lines, '\n')) {
    auto fields = split(line, '|');
    if (fields.size() < 3) continue;
    fields.resize(4);
    for (const std::string& job : jobs_of(fields[0]))
      states[job] = {job, fields[1], fields[3], fields[2], "", ""};
  }
  return states;
}

std::map<std::string, SlurmState> slurm_states(const fs::path& profile_folder) {
  const auto jobs = read_jobs(profile_folder);
  if (jobs.empty()) return {};
  const auto states = ask_slurm(jobs);
  std::map<std::string, SlurmState> by_cell;
  for (const SlurmJob& job : jobs) {
    if (job.stage != "cells") continue;
    if (!is_there(job.tasks)) continue;
    const auto cells = cells_of_tasks(job.tasks);
    for (std::size_t i = 0; i < job.count && job.offset + i < cells.size(); ++i)
      if (const auto state = states.find(fmt::format("{}_{}", job.id, i)); state != states.end())
        by_cell[cells[job.offset + i]] = state->second;
  }
  return by_cell;
}

}  // namespace glint
