// SPDX-License-Identifier: MIT
#include "reports/run/records/cell_filter.h"

#include <algorithm>
#include <set>

#include "glint/method.h"

namespace glint {

namespace {

bool matches_cell(const std::vector<std::string>& globs, const CellKey& cell) {
  const std::string scene_method = cell.scene + "/" + cell.method;
  for (const std::string& text : {cell.text(), scene_method, cell.scene, cell.method})
    if (any_glob_matches(globs, text)) return true;
  return false;
}

std::vector<std::string> registered_methods() {
  std::vector<std::string> ids;
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) ids.push_back(id);
  return ids;
}

std::vector<std::string> matching_ids(
    const std::vector<std::string>& ids, const std::string& glob
) {
  std::vector<std::string> found;
  for (const std::string& id : ids)
    if (glob_match(glob, id)) found.push_back(id);
  return found;
}

std::string methods_in(const std::vector<Record>& records) {
  std::set<std::string> methods;
  for (const Record& record : records) methods.insert(record.cell.method);
  return fmt::format("{}", fmt::join(methods, ", "));
}

void check_method_globs(const std::vector<Record>& records, const CellFilter& filter) {
  for (const std::string& glob : filter.methods)
    GLINT_CHECK(
        !matching_ids(registered_methods(), glob).empty() ||
            std::any_of(
                records.begin(),
                records.end(),
                [&](const Record& record) { return glob_match(glob, record.cell.method); }
            ),
        kUsage,
        "--methods {}: no such method; there are results of {}",
        glob,
        methods_in(records)
    );
}

}  // namespace

bool any_glob_matches(const std::vector<std::string>& globs, const std::string& text) {
  return std::any_of(globs.begin(), globs.end(), [&](const std::string& glob) {
    return glob_match(glob, text);
  });
}

bool filter_accepts(const CellFilter& filter, const CellKey& cell) {
  return (filter.methods.empty() || any_glob_matches(filter.methods, cell.method)) &&
         (filter.only.empty() || matches_cell(filter.only, cell)) &&
         (filter.cells.empty() ||
          std::find(filter.cells.begin(), filter.cells.end(), cell.text()) != filter.cells.end()) &&
         !matches_cell(filter.skip, cell);
}

std::vector<Record> chosen_records(const std::vector<Record>& records, const CellFilter& filter) {
  check_method_globs(records, filter);
  std::vector<Record> chosen;
  for (const Record& record : records)
    if (filter_accepts(filter, record.cell)) chosen.push_back(record);
  GLINT_CHECK(
      !chosen.empty() || records.empty(),
      kUsage,
      "none of {} cells passes --methods, --only and --skip; there are results of {}",
      records.size(),
      methods_in(records)
  );
  return chosen;
}

std::vector<std::string> named_methods(const std::vector<std::string>& names) {
  std::vector<std::string> methods;
  for (const std::string& name : names) {
    const bool is_glob = name.find_first_of("*?[") != std::string::npos;
    const auto found = is_glob ? matching_ids(registered_methods(), name) : std::vector{name};
    GLINT_CHECK(!found.empty(), kUsage, "methods: {} fits no method", name);
    for (const std::string& id : found)
      if (std::ranges::find(methods, id) == methods.end()) methods.push_back(id);
  }
  return methods;
}

std::vector<std::string> planned_methods(
    const std::vector<std::string>& names, const std::vector<std::string>& globs
) {
  const std::vector<std::string> of_profile = named_methods(names);
  if (globs.empty()) return of_profile;
  std::vector<std::string> methods;
  for (const std::string& glob : globs) {
    std::vector<std::string> found = matching_ids(of_profile, glob);
    if (found.empty()) found = matching_ids(registered_methods(), glob);
    if (found.empty()) find_method(glob);  // its error says which there are
    for (std::string& id : found)
      if (std::find(methods.begin(), methods.end(), id) == methods.end())
        methods.push_back(std::move(id));
  }
  return methods;
}

}  // namespace glint
