// SPDX-License-Identifier: MIT
// Tables of 10,000 records are made while one waits: it was once 6.5 s.
#include <catch2/catch.hpp>

#include <ctime>
#include <set>

#include "reports/run/records/records.h"
#include "reports/show/tables/tables.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

constexpr int kScenes = 200, kMethods = 10, kSeeds = 5;
constexpr double kLongest = 3;  // s of CPU time; the whole test took 0.7

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::vector<std::string> methods_of(const std::vector<TableDefinition>& definitions) {
  std::set<std::string> methods;
  for (const TableDefinition& definition : definitions)
    for (const TableRowDefinition& row : definition.rows) methods.insert(row.method);
  REQUIRE(methods.size() >= kMethods);
  return {methods.begin(), std::next(methods.begin(), kMethods)};
}

// With values for all columns of the first table.
void write_records(const fs::path& file, const std::vector<TableDefinition>& definitions) {
  std::string text;
  int number = 0;  // of the method
  for (const std::string& method : methods_of(definitions)) {
    ++number;
    for (int scene = 0; scene < kScenes; ++scene)
      for (int seed = 0; seed < kSeeds; ++seed) {
        Record record;
        record.cell = {"room_" + std::to_string(scene), method, static_cast<std::uint64_t>(seed)};
        record.dataset = definitions.front().dataset;
        for (const TableColumn& column : definitions.front().columns)
          if (!column.metric.empty())
            record.metrics[column.metric] = 0.01 * ((scene * 7 + seed * 3 + number * 13) % 89);
        text += record_to_json(record).dump() + "\n";
      }
  }
  write_file(file, text);
}

}  // namespace

TEST_CASE("10,000 records become tables in seconds") {
  const test::TempFolder folder;
  const auto definitions = table_definitions();
  write_records(folder / "records.jsonl", definitions);
  const double begin = cpu_seconds();
  const auto records = read_records(folder / "records.jsonl");
  REQUIRE(records.size() == kScenes * kMethods * kSeeds);
  for (const TableDefinition& definition : definitions) build_table(definition, records);
  CHECK(cpu_seconds() - begin < kLongest);
}
