// SPDX-License-Identifier: MIT
// The methods of a store as figures name them: the same words, colours and lines in all.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "reports/run/records/records.h"
#include "reports/show/tables/method_title.h"

namespace glint {

// Which methods figures show: those of the globs; without any, pictures show methods but of their
// variants main_methods() alone (about eight fit beside the truth), and curves all but the rows of
// the ablation table, which has its own figure.
struct MethodChoice {
  std::vector<std::string> globs;

  bool in_pictures(const std::string& id) const;
  bool in_curves(const std::string& id) const;
  bool in_studies(const std::string& id) const;  // without globs: all that there are
};

// Columns and rows of pictures stand as the rows of the summary do: the paper's order, then others
// by id.
struct InTableOrder {
  bool operator()(const std::string& a, const std::string& b) const;
};
using PictureMethods = std::set<std::string, InTableOrder>;

// Every method with a finished record: methods, then variants, each by id. The place in the list is
// the index of series_style().
std::vector<std::string> figure_methods(const std::vector<Record>& records);

// These, for charts.
class ChartMethods {
 public:
  explicit ChartMethods(const std::vector<Record>& records) : ids_(figure_methods(records)) {}
  const std::vector<std::string>& ids() const { return ids_; }
  // Of series_style() and of ChartSheet::names.
  std::size_t index_of(const std::string& id) const;
  std::vector<std::string> titles() const;

 private:
  std::vector<std::string> ids_;
};

// Not a number: the record has none.
double metric_of(const Record& record, const std::string& id);

}  // namespace glint
