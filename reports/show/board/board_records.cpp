// SPDX-License-Identifier: MIT
#include "reports/show/board/board_records.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "glint/core/error.h"
#include "glint/core/left_behind.h"
#include "reports/run/records/merge_runs.h"
#include "reports/run/records/record_facts.h"
#include "reports/show/tables/compare.h"

namespace glint {
namespace {

// The parts of a store's path that name it.
std::vector<std::string> parts_of(const std::string& path) {
  fs::path whole = absolute_folder(path);
  if (whole.filename() == "records.jsonl") whole = whole.parent_path();
  if (whole.extension() == ".jsonl") whole.replace_extension();
  std::vector<std::string> parts;
  for (const fs::path& part : whole) parts.push_back(part.string());
  return parts;
}

// The last so many parts.
std::string end_of(const std::vector<std::string>& parts, std::size_t count) {
  const auto begin = parts.end() - static_cast<std::ptrdiff_t>(std::min(count, parts.size()));
  return fmt::format("{}", fmt::join(begin, parts.end(), "/"));
}

// As few of the last parts as no other path ends in.
std::string short_name(
    const std::vector<std::string>& parts, const std::vector<std::vector<std::string>>& all
) {
  for (std::size_t count = 1; count < parts.size(); ++count) {
    const std::string name = end_of(parts, count);
    const auto same = std::count_if(all.begin(), all.end(), [&](const auto& other) {
      return end_of(other, count) == name;
    });
    if (same < 2) return name;
  }
  return end_of(parts, parts.size());
}

std::vector<BoardRecord> records_of(const std::string& path, const std::string& name) {
  std::vector<BoardRecord> all;
  for (const Record& record : read_every_record(store_file(path)))
    all.push_back({record, name, training_revision(record), environment_text(record, "date")});
  return all;
}

bool is_unknown_length(const Record& record) {
  return record.iterations == 0 && !record.imported.empty();
}

// Whether a record may stand among those of a group, beside its data.
bool is_alike(const BoardGroup& group, const Record& record) {
  return group.dataset == record.dataset && group.resolution == record.resolution &&
         (group.steps == record.iterations || is_unknown_length(record));
}

bool has_scene(const BoardGroup& group, const Record& record) {
  const auto found = group.hashes.find(record.cell.scene);
  return found != group.hashes.end() && found->second == record.dataset_hash;
}

bool has_store(const BoardGroup& group, const std::string& store) {
  return std::any_of(group.all.begin(), group.all.end(), [&](const BoardRecord& one) {
    return one.store == store;
  });
}

class Grouping {
 public:
  // A group with its scene; else one of its store's where no scene of that name is; else any such.
  void add(const BoardRecord& one) {
    BoardGroup* group =
        group_for(one, [&](const BoardGroup& of) { return has_scene(of, one.record); });
    const auto is_free = [&](const BoardGroup& of) {
      return !of.hashes.contains(one.record.cell.scene);
    };
    if (group == nullptr)
      group = group_for(one, [&](const BoardGroup& of) {
        return is_free(of) && has_store(of, one.store);
      });
    if (group == nullptr) group = group_for(one, is_free);
    put(one, group == nullptr ? begin(one.record) : *group);
  }

  // Into every group of their data and size.
  void add_of_unknown_length(const BoardRecord& one) {
    bool is_placed = false;
    for (BoardGroup& group : groups_)
      if (is_alike(group, one.record) && has_scene(group, one.record)) {
        put(one, group);
        is_placed = true;
      }
    if (!is_placed) add(one);
  }

  std::vector<BoardGroup> take() {
    number_versions();
    std::stable_sort(groups_.begin(), groups_.end(), [](const auto& a, const auto& b) {
      return a.all.size() > b.all.size();
    });
    return std::move(groups_);
  }

 private:
  template <class F>
  BoardGroup* group_for(const BoardRecord& one, F&& fits) {
    for (BoardGroup& group : groups_)
      if (is_alike(group, one.record) && fits(group)) return &group;
    return nullptr;
  }

  BoardGroup& begin(const Record& record) {
    BoardGroup group;
    group.dataset = record.dataset;
    group.resolution = record.resolution;
    group.steps = record.iterations;
    return groups_.emplace_back(std::move(group));
  }

  static void put(const BoardRecord& one, BoardGroup& group) {
    group.hashes.emplace(one.record.cell.scene, one.record.dataset_hash);
    group.all.push_back(one);
  }

  void number_versions() {
    std::map<std::tuple<std::string, std::string, int>, int> counts;
    for (BoardGroup& group : groups_)
      group.version = ++counts[{group.dataset, group.resolution, group.steps}];
  }

  std::vector<BoardGroup> groups_;
};

// Which of the records of one cell is shown.
class CellChoice {
 public:
  explicit CellChoice(std::vector<Contradiction>& contradictions)
      : contradictions_(contradictions) {}

  void add(const BoardRecord& next) {
    const auto [it, is_new] = chosen_.try_emplace(next.record.cell, next);
    if (is_new) return order_.push_back(next.record.cell);
    BoardRecord& shown = it->second;
    if (shown.store == next.store ? next.record.ok() || !shown.record.ok() : takes(next, shown))
      shown = next;
  }

  std::vector<BoardRecord> take() {
    std::vector<BoardRecord> all;
    for (const CellKey& cell : order_) all.push_back(std::move(chosen_.at(cell)));
    return all;
  }

 private:
  // Of another store.
  bool takes(const BoardRecord& next, const BoardRecord& shown) {
    const MergedCell judged = judge_merge(next.record, &shown.record, next.store);
    if (judged.verdict != MergeVerdict::kConflict) return judged.verdict == MergeVerdict::kTaken;
    const bool imported = !next.record.imported.empty() || !shown.record.imported.empty();
    if (!imported && next.commit != shown.commit) return next.date > shown.date;
    contradictions_.push_back(
        {next.record.cell, shown.store, next.store, score_differences(shown.record, next.record)}
    );
    return false;
  }

  std::vector<Contradiction>& contradictions_;
  std::map<CellKey, BoardRecord> chosen_;
  std::vector<CellKey> order_;
};

void check_stores(const std::vector<std::string>& paths) {
  std::set<fs::path> known;
  for (const std::string& path : paths)
    GLINT_CHECK(
        known.insert(fs::weakly_canonical(store_file(path))).second,
        kUsage,
        "{}: is named twice; a store counts once",
        path
    );
}

}  // namespace

std::string BoardGroup::title() const {
  std::string text = fmt::format("{} at {}", dataset, resolution.empty() ? "?" : resolution);
  text += steps > 0 ? fmt::format(", {} steps", steps) : ", steps not recorded";
  return version > 1 ? fmt::format("{}, other data ({})", text, version) : text;
}

std::vector<Record> BoardGroup::records() const {
  std::vector<Record> all;
  for (const BoardRecord& one : shown) all.push_back(one.record);
  return all;
}

std::vector<std::string> store_names(const std::vector<std::string>& paths) {
  std::vector<std::vector<std::string>> all;
  for (const std::string& path : paths) all.push_back(parts_of(path));
  std::vector<std::string> names;
  for (const auto& parts : all) names.push_back(short_name(parts, all));
  return names;
}

Board make_board(const std::vector<std::string>& paths) {
  check_stores(paths);
  const std::vector<std::string> names = store_names(paths);
  Board board;
  Grouping grouping;
  std::vector<BoardRecord> of_unknown_length;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const auto records = records_of(paths[i], names[i]);
    GLINT_CHECK(!records.empty(), kBadPrediction, "{}: holds no record that is whole", paths[i]);
    board.stores.push_back({names[i], records.size()});
    for (const BoardRecord& one : records)
      if (is_unknown_length(one.record))
        of_unknown_length.push_back(one);
      else
        grouping.add(one);
  }
  for (const BoardRecord& one : of_unknown_length) grouping.add_of_unknown_length(one);
  board.groups = grouping.take();
  for (BoardGroup& group : board.groups) {
    CellChoice choice(board.contradictions);
    for (const BoardRecord& one : group.all) choice.add(one);
    group.shown = choice.take();
  }
  return board;
}

}  // namespace glint
