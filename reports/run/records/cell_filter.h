// SPDX-License-Identifier: MIT
// Which cells a command is about: --methods, --only and --skip of every verb.
#pragma once

#include <string>
#include <vector>

#include "reports/run/records/records.h"

namespace glint {

struct CellFilter {
  std::vector<std::string> only = {}, skip = {};  // globs; empty `only`: all
  std::vector<std::string> methods = {};          // globs of methods; empty: all
  std::vector<std::string> cells = {};            // "scene/method/seed" as they are; empty: all

  bool empty() const { return only.empty() && skip.empty() && methods.empty() && cells.empty(); }
};

bool any_glob_matches(const std::vector<std::string>& globs, const std::string& text);

// A pattern of `only` and `skip` matches a cell when it matches "scene/method/seed",
// "scene/method", the scene or the method; one of `methods` when it matches the method. '*' also
// runs over '/'.
bool filter_accepts(const CellFilter& filter, const CellKey& cell);

// Errors (kUsage): one of `filter.methods` is neither in the records nor a method of this program,
// or no record is left; both say what there is.
std::vector<Record> chosen_records(const std::vector<Record>& records, const CellFilter& filter);

// The methods of a profile: ids, and of a glob ("glint/no-*") all of this program that it fits.
// Errors (kUsage): a glob fits none.
std::vector<std::string> named_methods(const std::vector<std::string>& names);

// What `all` runs of a profile with these methods (named_methods): of each glob the profile's that
// match; where none does, the program's. Without globs the profile's. Errors (kUsage): a glob fits
// no method.
std::vector<std::string> planned_methods(
    const std::vector<std::string>& names, const std::vector<std::string>& globs
);

}  // namespace glint
