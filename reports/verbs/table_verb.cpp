// SPDX-License-Identifier: MIT
#include <memory>

#include "reports/verbs/report_verb.h"
#include "reports/verbs/result_tables.h"

namespace glint {

namespace {

struct TableVerbOptions {
  std::vector<std::string> ids;
  std::string format = "terminal";
  bool no_published = false;
};

std::string table_text(const Table& table, const std::string& format) {
  if (format == "md") return table_markdown(table);
  if (format == "tex") return table_latex(table);
  return table_csv(table);
}

// All tables of all records are written, too; a choice is printed only.
int run_table(const CommonOptions& common, const TableVerbOptions& options) {
  check_table_ids(options.ids);
  const fs::path folder = folder_with_records(common);
  auto tables = result_tables(folder, options.ids, common.filter());
  if (options.ids.empty() && common.filter().empty()) write_tables(folder, tables);
  if (options.no_published)
    for (Table& table : tables) table = without_published(table);
  if (common.json || options.format == "json") {
    Json json = {{"tables", Json::array()}};
    for (const Table& table : tables) json["tables"].push_back(table_json(table));
    print_json(json);
  } else if (options.format == "terminal") {
    print_tables(tables);
  } else {
    for (std::size_t i = 0; i < tables.size(); ++i)
      print_raw((i ? "\n" : "") + table_text(tables[i], options.format));
  }
  return 0;
}

void add_table_verb(CommandLine& line) {
  auto options = std::make_shared<TableVerbOptions>();
  CLI::App* verb = line.add_verb(
      line.app,
      "table",
      "print the tables of a profile from its records",
      [&line, options] { return run_table(line.common, *options); },
      kFolderOptions
  );
  auto* positional = verb->add_option(
      "tables", options->ids, "ids, e.g. table1_photometric; none: all, and written"
  );
  verb->add_option("--table", options->ids, "the same")->delimiter(',')->excludes(positional);
  verb->add_flag("--no-published", options->no_published, "measured columns only");
  verb->add_option("--format", options->format, "terminal, md, tex, csv or json")
      ->check(CLI::IsMember({"terminal", "md", "tex", "csv", "json"}))
      ->capture_default_str();
}

}  // namespace

GLINT_REGISTER(Verb, {"table", add_table_verb})

}  // namespace glint
