// SPDX-License-Identifier: MIT
#include "reports/show/tables/published.h"

#include <algorithm>

#include "glint/core/config.h"
#include "reports/run/records/embedded.h"

namespace glint {

namespace {

PublishedValue value_of(const Json& cell) {
  PublishedValue value;
  value.table = cell.at("table");
  value.dataset = cell.at("dataset");
  value.row = cell.at("row");
  value.column = cell.at("column");
  value.decimals = cell.at("decimals");
  value.unit = cell.at("unit");
  value.direction = cell.at("direction");
  value.source = cell.at("source");
  const std::string digits = cell.at("value");
  value.text = cell.value("printed", digits);
  value.value = std::stod(digits) * (value.unit == "h" ? 60.0 : 1.0);
  if (value.unit == "h") value.unit = "min";
  return value;
}

std::vector<PublishedValue> parse_published() {
  std::vector<PublishedValue> values;
  const Json paper = Json::parse(embedded_files().at("paper/glint.json"));
  for (const Json& cell : paper.at("cells")) values.push_back(value_of(cell));
  return values;
}

}  // namespace

const std::vector<PublishedValue>& published_values() {
  static const std::vector<PublishedValue> values = parse_published();
  return values;
}

const PublishedValue* find_published(
    const std::string& table,
    const std::string& dataset,
    const std::string& row,
    const std::string& column
) {
  const auto& values = published_values();
  const auto it = std::find_if(values.begin(), values.end(), [&](const PublishedValue& value) {
    return value.table == table && value.dataset == dataset && value.row == row &&
           value.column == column;
  });
  return it == values.end() ? nullptr : &*it;
}

}  // namespace glint
