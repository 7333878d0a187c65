// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <memory>

#include "glint/core/file_lock.h"
#include "glint/core/interrupt.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "reports/run/provenance/verify_run.h"
#include "reports/run/records/earlier_run.h"
#include "reports/verbs/single_cell.h"

namespace glint {

namespace {

struct VerifyArguments {
  std::string place, dataset;
  bool fast = false;
};

struct VerifiedRun {
  fs::path folder;
  std::vector<Checked> rows;

  CheckState state() const {
    CheckState worst = CheckState::kOk;
    for (const Checked& row : rows) worst = std::max(worst, row.state);
    return worst;
  }
};

// What is to be looked at: runs, and the records beside them.
struct VerifyPlan {
  std::vector<fs::path> runs;
  std::vector<Record> records;
  fs::path root;            // of the records
  bool is_one_run = false;  // that was named
};

bool is_folder_of_runs(const fs::path& folder) {
  return is_there(folder / "records.jsonl") || is_folder(folder / "runs");
}

// One whose config.json is damaged, too: it is told of.
bool is_chosen(const fs::path& run, const CellFilter& filter) try {
  const RunSpec spec = read_run_spec(run);
  return filter_accepts(filter, spec.cell());
} catch (const Error&) {
  return true;
}

VerifyPlan plan_of_folder(const fs::path& folder, const CellFilter& filter) {
  VerifyPlan plan{{}, read_records(folder / "records.jsonl"), folder, false};
  std::erase_if(plan.records, [&](const Record& record) {
    return !filter_accepts(filter, record.cell);
  });
  for (const fs::path& run : runs_below(folder / "runs"))
    if (is_chosen(run, filter)) plan.runs.push_back(run);
  GLINT_CHECK(
      !plan.runs.empty() || !plan.records.empty(),
      kBadPrediction,
      "{}: no runs and no records{}; make some with `glint-bench all`",
      folder.string(),
      filter.empty() ? "" : " that --methods, --only and --skip leave"
  );
  return plan;
}

// The records of a run lie above it, or in OUT/single.
VerifyPlan plan_of_run(const CommonOptions& common, const fs::path& run) {
  const RunSpec spec = read_run_spec(run);
  const fs::path root = records_folder(common, spec);
  return {{run}, read_records(root / "records.jsonl"), root, true};
}

VerifyPlan make_verify_plan(const CommonOptions& common, const VerifyArguments& arguments) {
  const bool is_one = with_exit_code(ExitCode::kBadPrediction, [&] {
    return is_there(fs::path(arguments.place) / "config.json");
  });
  GLINT_CHECK(
      is_one || arguments.dataset.empty(),
      kUsage,
      "--dataset is of one run: name its folder; rooms of several are looked for below --data, too"
  );
  if (arguments.place.empty()) {
    load_profile(common.profile);  // has the message where there is none
    return plan_of_folder(folder_with_records(common.out, common.profile), common.filter());
  }
  if (!is_one && is_folder_of_runs(arguments.place))
    return plan_of_folder(arguments.place, common.filter());
  return plan_of_run(common, arguments.place);
}

class Verification {
 public:
  Verification(const CommonOptions& common, const VerifyArguments& arguments)
      : arguments_(arguments),
        data_(common.data),
        sources_(load_profile(common.profile).sources()),
        plan_(make_verify_plan(common, arguments)),
        verifier_(arguments.fast) {}

  bool is_of_one_run() const { return plan_.is_one_run; }

  std::vector<VerifiedRun> run() {
    if (is_of_one_run()) check_dataset(plan_.runs.front());
    std::vector<VerifiedRun> verified;
    Progress progress("verify", plan_.runs.size());
    for (const fs::path& run : plan_.runs) {
      throw_if_interrupted();
      verified.push_back({run, rows_of(run)});
      progress.advance(1, run.string());
    }
    add_records_without_runs(verified);
    return verified;
  }

 private:
  // As other verbs that open a run.
  void check_dataset(const fs::path& run) const {
    const fs::path dataset = dataset_of(read_run_spec(run));
    GLINT_CHECK(
        is_there(dataset),
        kBadReference,
        "{}: not there, but {} was made from it; if the data have moved, give --dataset FOLDER",
        dataset.string(),
        run.string()
    );
  }

  // Rooms of a store that has moved lie below --data under the same name.
  fs::path dataset_of(const RunSpec& spec) const {
    if (!arguments_.dataset.empty()) return arguments_.dataset;
    const fs::path below = data_ / spec.dataset / spec.dataset_folder.filename();
    return !is_there(spec.dataset_folder) && is_there(below) ? below : spec.dataset_folder;
  }

  // One of many that cannot be read does not stop the others.
  std::vector<Checked> rows_of(const fs::path& run) try {
    const std::string holder = holder_of(run);
    GLINT_CHECK(
        holder.empty() || !is_of_one_run(),
        kUsage,
        "{}: {} is at work there; wait for it",
        run.string(),
        holder
    );
    if (!holder.empty())
      return {{"run", CheckState::kNote, holder + " is at work there: not looked at"}};
    const RunSpec spec = read_run_spec(run);
    const CellKey cell = spec.cell();
    return verifier_.verify(
        {run, dataset_of(spec), loader_of(spec), find_record(plan_.records, cell)}
    );
  } catch (const Error& error) {
    if (is_of_one_run()) throw;
    return {{"run", CheckState::kBad, error.what()}};
  }

  // Stores that cannot be written to have nobody at work.
  static std::string holder_of(const fs::path& run) try {
    const auto lock = FileLock::take(FileLock::file_beside(run));
    const auto* holder = std::get_if<std::string>(&lock);
    return holder ? *holder : "";
  } catch (const Error&) {
    return "";
  }

  // As the profile says.
  std::string loader_of(const RunSpec& spec) const {
    for (const SceneSource& source : sources_)
      if (source.scene == spec.scene && source.dataset == spec.dataset) return source.loader;
    return "";
  }

  // A number in a table has to have a run that it comes from.
  void add_records_without_runs(std::vector<VerifiedRun>& verified) const {
    if (is_of_one_run()) return;
    for (const Record& record : plan_.records) {
      const fs::path run = run_folder(plan_.root, record.cell);
      if (record.ok() && !is_our_run(run))
        verified.push_back(
            {run, {{"record", CheckState::kBad, "there are values of it, but no run folder"}}}
        );
    }
  }

  const VerifyArguments& arguments_;
  fs::path data_;
  std::vector<SceneSource> sources_;
  VerifyPlan plan_;
  RunVerifier verifier_;
};

bool all_match(const std::vector<VerifiedRun>& runs) {
  return std::all_of(runs.begin(), runs.end(), [](const VerifiedRun& run) {
    return run.state() != CheckState::kBad;
  });
}

Json verify_json(const std::vector<VerifiedRun>& runs) {
  Json json = {{"matches", all_match(runs)}, {"runs", Json::array()}};
  for (const VerifiedRun& run : runs) {
    Json rows = Json::array();
    for (const Checked& row : run.rows)
      rows.push_back(
          {{"check", row.name}, {"verdict", state_word(row.state)}, {"detail", row.detail}}
      );
    json["runs"].push_back(
        {{"run", run.folder.string()},
         {"verdict", state_word(run.state())},
         {"checks", std::move(rows)}}
    );
  }
  return json;
}

using Lines = std::vector<std::vector<std::string>>;

Lines every_row(const VerifiedRun& run) {
  Lines lines;
  for (const Checked& row : run.rows)
    lines.push_back({run.folder.string(), row.name, std::string(state_word(row.state)), row.detail}
    );
  return lines;
}

// Of several runs: each with what does not match, and what is worth knowing once for all that have
// it.
Lines folded_rows(const std::vector<VerifiedRun>& runs) {
  Lines lines;
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> notes;
  for (const VerifiedRun& run : runs) {
    const std::string name = run.folder.string();
    std::size_t good = 0;
    for (const Checked& row : run.rows) {
      if (row.state == CheckState::kBad) lines.push_back({name, row.name, "BAD", row.detail});
      if (row.state == CheckState::kNote) notes[{row.name, row.detail}].push_back(name);
      good += row.state == CheckState::kOk;
    }
    if (good > 0) lines.push_back({name, fmt::format("{} checks", good), "ok", ""});
  }
  for (const auto& [row, names] : notes)
    lines.push_back(
        {names.size() == 1 ? names.front() : fmt::format("{} runs", names.size()),
         row.first,
         "note",
         row.second}
    );
  return lines;
}

std::string verify_text(const std::vector<VerifiedRun>& runs, bool is_one) {
  Lines lines{{"run", "check", "verdict", "detail"}};
  const Lines rows = is_one ? every_row(runs.front()) : folded_rows(runs);
  lines.insert(lines.end(), rows.begin(), rows.end());
  const auto bad = std::count_if(runs.begin(), runs.end(), [](const VerifiedRun& run) {
    return run.state() == CheckState::kBad;
  });
  return aligned_rows(lines) + fmt::format(
                                   "{} of {} runs match{}\n",
                                   static_cast<std::ptrdiff_t>(runs.size()) - bad,
                                   runs.size(),
                                   bad > 0 ? fmt::format(", {} do not", bad) : ""
                               );
}

int run_verify(const CommonOptions& common, const VerifyArguments& arguments) {
  install_interrupt_handler();
  Verification verification(common, arguments);
  const auto runs = verification.run();
  if (common.json)
    print_json(verify_json(runs));
  else
    print_text(verify_text(runs, verification.is_of_one_run()));
  return static_cast<int>(all_match(runs) ? ExitCode::kSuccess : ExitCode::kCheckFailed);
}

void add_verify_verb(CommandLine& line) {
  auto arguments = std::make_shared<VerifyArguments>();
  CLI::App* verb = line.add_verb(
      line.app,
      "verify",
      "compute keys, hashes and metrics of finished runs again, and say what does not match",
      [&line, arguments] { return run_verify(line.common, *arguments); },
      kFolderOptions | kDataOption | kDeviceOption | kThreadsOption
  );
  verb->add_option(
      "RUN", arguments->place, "a run folder, or a folder of runs; else the profile's folder"
  );
  verb->add_flag("--fast", arguments->fast, "do not compute metrics again");
  add_moved_dataset_option(*verb, arguments->dataset);
}

}  // namespace

GLINT_REGISTER(Verb, {"verify", add_verify_verb})

}  // namespace glint
