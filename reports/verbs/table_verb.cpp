// SPDX-License-Identifier: MIT
#include <memory>

#include "reports/verbs/result_tables.h"

namespace glint {

namespace {

struct TableVerbOptions {
  std::vector<std::string> ids;
  std::string format = "terminal";
};

std::string table_text(const Table& table, const std::string& format) {
  if (format == "md") return table_markdown(table);
  if (format == "tex") return table_latex(table);
  if (format == "html") return table_html(table);
  return table_csv(table);
}

int run_table(const CommonOptions& common, const TableVerbOptions& options) {
  const fs::path folder = common.profile_folder(common.resolved_profile());
  const auto tables = result_tables(folder, options.ids);
  if (options.ids.empty()) write_tables(folder, tables);
  if (common.json || options.format == "json") {
    Json json = {{"tables", Json::array()}};
    for (const Table& table : tables) json["tables"].push_back(table_json(table));
    print_json(json);
  } else if (options.format == "terminal") {
    print_tables(tables);
  } else {
    for (std::size_t i = 0; i < tables.size(); ++i)
      print_text((i ? "\n" : "") + table_text(tables[i], options.format));
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
  verb->add_option("tables", options->ids, "ids, e.g. table1_photometric; none: all, and written");
  verb->add_option("--format", options->format, "terminal, md, tex, csv, html or json")
      ->check(CLI::IsMember({"terminal", "md", "tex", "csv", "html", "json"}))
      ->capture_default_str();
}

}  // namespace

GLINT_REGISTER(Verb, {"table", add_table_verb})

}  // namespace glint
