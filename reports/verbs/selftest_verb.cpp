// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>

#include "glint/core/progress.h"
#include "reports/selftest/conformance.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

struct SelftestArguments {
  std::string export_to, vectors, check;
};

// The compiled-in vectors unpacked beside nothing of the user's, or a folder of theirs.
class VectorFolder {
 public:
  explicit VectorFolder(const std::string& given) : path_(given) {
    if (!given.empty()) return;
    std::string name = (fs::temp_directory_path() / "glint_vectors_XXXXXX").string();
    GLINT_CHECK(::mkdtemp(name.data()) != nullptr, kEnvironment, "{}: cannot be made", name);
    path_ = name;
    temporary_ = true;
    export_conformance(path_);
  }
  ~VectorFolder() {
    std::error_code code;
    if (temporary_) fs::remove_all(path_, code);
  }
  VectorFolder(const VectorFolder&) = delete;
  VectorFolder& operator=(const VectorFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  bool temporary_ = false;
};

std::size_t count(const std::vector<VectorResult>& results, VectorStatus status) {
  return static_cast<std::size_t>(std::count_if(
      results.begin(),
      results.end(),
      [&](const VectorResult& result) { return result.status == status; }
  ));
}

void print_results(const std::vector<VectorResult>& results) {
  std::vector<std::vector<std::string>> rows = {
      {"vector", "", "found", "expected", "tolerance", "made by", "convention"}};
  for (const VectorResult& result : results) {
    const ConformanceVector& vector = result.vector;
    const bool ran = result.status != VectorStatus::kSkipped;
    rows.push_back(
        {vector.id,
         Json(result.status).get<std::string>(),
         ran ? fmt::format("{:.6f}", result.found) : "-",
         fmt::format("{:.6f}", vector.expected),
         fmt::format("{:g}", vector.tolerance),
         vector.source,
         result.note.empty() ? vector.convention : result.note.substr(0, result.note.find('\n'))}
    );
  }
  print_text(aligned_rows(rows));
  print_text(fmt::format(
      "{} passed, {} failed, {} skipped\n",
      count(results, VectorStatus::kPassed),
      count(results, VectorStatus::kFailed),
      count(results, VectorStatus::kSkipped)
  ));
}

Json results_json(const std::vector<VectorResult>& results) {
  Json json = Json::array();
  for (const VectorResult& result : results) {
    Json entry = config_to_json(result.vector);
    entry["status"] = result.status;
    if (result.status != VectorStatus::kSkipped) entry["found"] = result.found;
    if (!result.note.empty()) entry["note"] = result.note;
    json.push_back(entry);
  }
  return {{"vectors", json}};
}

Json read_values(const std::string& path) {
  Json values = with_exit_code(ExitCode::kBadPrediction, [&] {
    return Json::parse(read_file(path), nullptr, false);
  });
  GLINT_CHECK(
      values.is_object(),
      kBadPrediction,
      "{}: expected a JSON object of vector ids and numbers, as in {{\"psnr/8bit\": 21.5}}",
      path
  );
  return values;
}

int run_selftest(const CommonOptions& common, const SelftestArguments& arguments) {
  if (!arguments.export_to.empty()) {
    export_conformance(arguments.export_to);
    print_text(fmt::format(
        "{}: {} files; vectors.json lists commands and values\n",
        arguments.export_to,
        conformance_files().size()
    ));
    return 0;
  }
  const VectorFolder folder(arguments.vectors);
  const auto vectors = read_vectors(folder.path());
  const auto results = arguments.check.empty()
                           ? run_vectors(vectors, folder.path())
                           : check_values(vectors, read_values(arguments.check));
  if (common.json)
    print_json(results_json(results));
  else
    print_results(results);
  const bool failed = count(results, VectorStatus::kFailed) > 0;
  return static_cast<int>(failed ? ExitCode::kCheckFailed : ExitCode::kSuccess);
}

}  // namespace

void add_selftest_verb(CommandLine& line) {
  auto arguments = std::make_shared<SelftestArguments>();
  CLI::App* verb = line.add_verb(
      line.app,
      "selftest",
      "score shipped files and compare with values by other software",
      [&line, arguments] { return run_selftest(line.common, *arguments); }
  );
  verb->add_option("--export", arguments->export_to, "write the files there and stop");
  verb->add_option("--vectors", arguments->vectors, "a folder like the exported one");
  verb->add_option(
      "--check", arguments->check, "JSON of another implementation: vector id -> its value"
  );
}

}  // namespace glint
