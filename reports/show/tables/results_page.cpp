// SPDX-License-Identifier: MIT
#include "reports/show/tables/results_page.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "glint/core/rows.h"
#include "reports/run/records/record_facts.h"
#include "reports/show/tables/order_by_length.h"
#include "reports/show/tables/table_writers.h"

namespace glint {
namespace {

using Texts = std::set<std::string>;

template <class F>
Texts collect(const std::vector<Record>& records, F&& text_of) {
  Texts texts;
  for (const Record& record : records)
    if (const std::string text = text_of(record); !text.empty()) texts.insert(text);
  return texts;
}

// "trained by revision ..." of records that were scored by another one.
Texts trained_by(const std::vector<Record>& records) {
  Texts texts;
  for (const Record& record : records)
    for (const std::string& warning : record.warnings)
      if (warning.starts_with(kTrainedBy)) texts.insert(warning);
  return texts;
}

// Of cells that ran side by side on a GPU.
std::string shared_card_text(const std::vector<Record>& records) {
  double most = 1;
  for (const Record& record : records)
    most = std::max(most, number_or(record.environment, "cells_on_card", 1));
  return most > 1 ? fmt::format(", which up to {:.0f} cells shared: times are too long", most) : "";
}

std::string joined(const Texts& texts) { return fmt::format("{}", fmt::join(texts, ", ")); }

std::vector<std::string> source_facts(const ResultsInfo& info) {
  return {fmt::format("Command: `{}`", info.command), fmt::format("Records: `{}`", info.records)};
}

std::string item_list(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += fmt::format("- {}\n", item);
  return text;
}

std::vector<std::string> facts(const ResultsInfo& info, const std::vector<Record>& records) {
  const auto environment = [&](const char* key) {
    return joined(collect(records, [&](const Record& r) { return environment_text(r, key); }));
  };
  const Texts dates = collect(records, [](const Record& r) { return environment_text(r, "date"); });
  std::vector<std::string> all = source_facts(info);
  all.push_back(fmt::format(
      "Scenes: {}; test views of {} pixels",
      joined(collect(records, [](const Record& r) { return r.dataset + "/" + r.cell.scene; })),
      joined(collect(records, [](const Record& r) { return r.resolution; }))
  ));
  all.push_back(fmt::format("Scored by revision {}", environment("git_revision")));
  if (const Texts trained = trained_by(records); !trained.empty())
    all.back() += fmt::format("; {}", joined(trained));
  all.push_back(fmt::format(
      "{} to {} (UTC)", dates.empty() ? "" : *dates.begin(), dates.empty() ? "" : *dates.rbegin()
  ));
  all.push_back(fmt::format(
      "Machine: {}, {} threads, device {}{}",
      environment("cpu"),
      environment("threads"),
      environment("device"),
      shared_card_text(records)
  ));
  if (!info.remarks.empty()) all.push_back(info.remarks);
  return all;
}

std::vector<Record> shown_records(const ResultsInfo& info, std::vector<Record> records) {
  const auto is_left_out = [&](const Record& record) {
    return !info.cells.empty() &&
           std::none_of(info.cells.begin(), info.cells.end(), [&](const std::string& glob) {
             return glob_match(glob, record.cell.text());
           });
  };
  std::erase_if(records, is_left_out);
  return records;
}

// Prose and items of lists in lines of at most 118 characters; rows of tables cannot be broken.
std::string in_lines(const std::string& markdown) {
  std::string text;
  std::istringstream lines(markdown);
  for (std::string line; std::getline(lines, line);) {
    const bool stays = line.empty() || line.front() == '|' || line.front() == '#';
    const char* indent = line.starts_with("- ") ? "\n  " : "\n";
    text += (stays ? line : fmt::format("{}", fmt::join(wrapped(line, 116), indent))) + "\n";
  }
  return text;
}

// Of the summary what fits a screen: five columns, without intervals.
Table front_page_table(const std::vector<Record>& records) {
  static const std::set<std::string> shown{
      "psnr", "psnr@glass", "normal-mae@glass", "depth-absrel@glass", "mesh-cd"};
  TableDefinition summary = table_definition("summary");
  std::erase_if(summary.columns, [](const TableColumn& column) {
    return !shown.contains(column.metric);
  });
  Table table = build_table(summary, records);
  table.caption.clear();
  for (TableColumn& column : table.columns) column.group.clear();
  for (TableRow& row : table.rows)
    for (TableCell& cell : row.cells) cell.interval.reset();
  std::erase_if(table.notes, [](const std::string& note) {
    return note.starts_with(kIntervalNote);
  });
  return table;
}

std::string section_markdown(const ResultsSection& section) {
  std::string text = section.title.empty() ? "" : fmt::format("# {}\n\n", section.title);
  text += item_list(section.facts);
  for (const Table& table : section.tables) text += fmt::format("\n{}", table_markdown(table));
  return text;
}

}  // namespace

std::vector<fs::path> results_parts(const fs::path& root) {
  const fs::path folder = root / "docs/results/parts";
  std::vector<fs::path> parts = list_files(folder, {".json"});
  GLINT_CHECK(
      !parts.empty(), kBadReference, "{}: no part of the results (*.json)", folder.string()
  );
  return parts;
}

ResultsInfo read_results_info(const fs::path& file) {
  ResultsInfo info;
  config_from_json(info, read_json_object(file), file.string());
  return info;
}

// Captions, scenes of means and published columns are those of our rooms.
Table of_other_data(const Table& table) {
  Table result = without_empty_columns(without_published(table));
  result.caption.clear();
  result.notes.clear();
  return result;
}

ResultsSection results_section(const ResultsInfo& info, std::vector<Record> records) {
  records = shown_records(info, std::move(records));
  ResultsSection section{info.title, facts(info, records), {}};
  const auto is_in = [](const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
  };
  for (TableDefinition& definition : table_definitions()) {
    if (!info.tables.empty() && !is_in(info.tables, definition.id)) continue;
    std::erase_if(definition.columns, [&](const TableColumn& column) {
      return is_in(info.without, column.metric);
    });
    if (info.measured_alone || info.other_data) keep_rows_with_records(definition, records);
    Table table = build_table(definition, records);
    if (info.other_data) table = of_other_data(table);
    if (has_measurement(table)) section.tables.push_back(std::move(table));
  }
  return section;
}

std::vector<ResultsSection> results_sections(const fs::path& root) {
  std::vector<ResultsSection> sections;
  for (const fs::path& file : results_parts(root)) {
    const ResultsInfo info = read_results_info(file);
    const auto records = read_records(root / info.records);
    GLINT_CHECK(!records.empty(), kBadPrediction, "{}: no records", info.records);
    sections.push_back(results_section(info, records));
  }
  return sections;
}

std::string results_part(const ResultsInfo& info, std::vector<Record> records) {
  return section_markdown(results_section(info, std::move(records)));
}

std::string results_markdown(const fs::path& root) {
  std::string text =
      "# Results\n\n"
      "This page has the tables of the committed records, written by `glint-bench results`; a test "
      "fails when they differ. `index.html` beside it has the same for a browser. For all tables "
      "of a part, copy its records to "
      "`out/NAME/records.jsonl` and run `glint-bench table --out out/NAME`.\n\n" +
      order_markdown(order_by_length(root));
  for (const ResultsSection& section : results_sections(root))
    text += "\n" + section_markdown(section);
  return in_lines(text);
}

std::string readme_results(const ResultsInfo& info, std::vector<Record> records) {
  records = shown_records(info, std::move(records));
  const std::string text = table_markdown(front_page_table(records));
  return in_lines(fmt::format(  // without the table's heading
      "\n{}\n{}{}- All tables, with intervals: "
      "[docs/results/RESULTS.md](docs/results/RESULTS.md), [page](docs/results/index.html)\n",
      text.substr(text.find('|')),
      item_list(source_facts(info)),
      info.remarks.empty() ? "" : fmt::format("- {}\n", info.remarks)
  ));
}

std::string with_results(const std::string& readme, const std::string& results) {
  const std::size_t begin = readme.find(kResultsBegin), end = readme.find(kResultsEnd);
  GLINT_CHECK(
      begin != std::string::npos && end != std::string::npos && begin < end,
      kBadReference,
      "README: no lines '{}' and '{}' to write the results between",
      kResultsBegin,
      kResultsEnd
  );
  const std::size_t from = begin + std::string_view(kResultsBegin).size();
  return fmt::format("{}\n{}{}", readme.substr(0, from), results, readme.substr(end));
}

}  // namespace glint
