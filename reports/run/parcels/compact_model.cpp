// SPDX-License-Identifier: MIT
#include "reports/run/parcels/compact_model.h"

#include <algorithm>
#include <cmath>

#include "glint/core/evenly_chosen.h"
#include "glint/scene/ply.h"
#include "reports/run/bench/stages.h"
#include "reports/run/parcels/model_files.h"

namespace glint {
namespace {

constexpr std::size_t kViewsToTry = 8, kViewsToMeasure = 16;
constexpr int kMostTries = 6, kMostRetries = 3;
constexpr double kFirstGuess = 0.2;                // tolerance of grids, of the limit
constexpr double kAim = 0.85, kGoodEnough = 0.65;  // of the limit
constexpr double kUnseenShare = 0.1;               // of the limits
constexpr double kMostTolerance = 0.01;            // metres

// Renders what is left of a model, and searches.
class Compactor {
 public:
  Compactor(const RunSpec& spec, const Scene& scene, double limit)
      : spec_(spec), scene_(scene), limit_(limit), files_(saved_files(spec.folder)) {
    whole_ = fused_depths(*load_trained(spec), scene, all_views());
  }

  CompactModel compact() {
    find_needed();
    if (auto model = on_coarsest_grids()) return std::move(*model);
    cut_ = {};  // a view that was not tried may need what the others do not
    if (auto model = on_coarsest_grids()) return std::move(*model);
    return without_loss();
  }

 private:
  std::vector<std::size_t> all_views() const {
    return evenly_chosen(scene_.train.size(), scene_.train.size());
  }

  std::vector<std::size_t> some_views() const {
    return evenly_chosen(kViewsToMeasure, scene_.train.size());
  }

  // Nothing: what is left cannot be loaded.
  std::optional<DepthDifference> difference(
      const std::vector<CompactFile>& files, const std::vector<std::size_t>& views
  ) const {
    const TemporaryFolder folder("glint-parcel");
    for (const CompactFile& file : files) write_compact_file(file, folder.path());
    const auto method = create_method(spec_.method, spec_.config);
    try {
      method->load(folder.path().string());
    } catch (const Error&) {
      return std::nullopt;
    }
    std::vector<FusedDepth> before;
    for (const std::size_t view : views) before.push_back(whole_[view]);
    return depth_difference(before, fused_depths(*method, scene_, views));
  }

  std::vector<CompactFile> draft() const {
    ModelCut cut = cut_;
    cut.draft = true;
    return cut_files(files_, cut);
  }

  bool changes_nothing() const {
    const auto found = difference(draft(), evenly_chosen(kViewsToTry, scene_.train.size()));
    return found && *found == DepthDifference{};
  }

  // Sets first: of one that is not needed, no channel is.
  void find_needed() {
    const bool several = std::count_if(files_.begin(), files_.end(), [](const SavedFile& file) {
                           return file.cloud.has_value();
                         }) > 1;
    for (const SavedFile& file : files_)
      if (file.cloud && several) try_without(cut_.needed, {file.name});
    std::vector<std::string> arrays, channels;
    for (const SavedFile& file : files_) {
      if (file.arrays) arrays.push_back(file.name);
      if (file.cloud && cut_.needs(file.name))
        for (const std::string& channel : file.cloud->extra_names)
          channels.push_back(file.name + " " + channel);
    }
    try_without(cut_.needed, arrays);
    try_without(cut_.needed_extras, channels);
    find_unseen();
  }

  // Of sets that are needed. They may be seen otherwise than each on its own, behind glass, say: so
  // dropping is tried.
  void find_unseen() {
    for (SavedFile& file : files_)
      if (file.cloud && cut_.needs(file.name)) file.seen = pixels_seen(*file.cloud, scene_.train);
    for (const float pixels : {0.5f, 0.0f}) {
      cut_.drop_below = pixels;
      const auto found = difference(draft(), some_views());
      if (found && found->mean <= kUnseenShare * limit_ &&
          found->one_sided <= kUnseenShare * kOneSidedLimit)
        return;
    }
    cut_.drop_below = kDropNone;
  }

  // All of them together, else one by one.
  void try_without(std::map<std::string, bool>& needed, const std::vector<std::string>& names) {
    if (names.empty()) return;
    for (const std::string& name : names) needed[name] = false;
    if (changes_nothing()) return;
    for (const std::string& name : names) needed[name] = true;
    if (names.size() == 1) return;
    for (const std::string& name : names) try_without(needed, {name});
  }

  // Nothing: no grid keeps the limits in all views.
  std::optional<CompactModel> on_coarsest_grids() const {
    double tolerance = find_tolerance();
    for (int tries = 0; tolerance > 0 && tries < kMostRetries; ++tries, tolerance *= 0.7)
      if (auto model = on_grids(tolerance, all_views()); model && is_near(*model)) return model;
    return std::nullopt;
  }

  // The largest that was found to be fine enough; 0: none was.
  double find_tolerance() const {
    const auto views = some_views();
    double tolerance = kFirstGuess * limit_, fine = 0, coarse = 2 * kMostTolerance;
    for (int tries = 0; tries < kMostTries; ++tries) {
      const auto model = on_grids(tolerance, views);
      if (!model) return 0;
      const bool good = is_near(*model);
      (good ? fine : coarse) = tolerance;
      const double mean = model->difference.mean;
      if (good && mean > kGoodEnough * limit_) break;
      const double factor = std::clamp(kAim * limit_ / std::max(mean, 1e-12), 1.0 / 16, 16.0);
      tolerance = good ? tolerance * factor : tolerance * std::min(factor, 0.5);
      if (tolerance <= fine || tolerance >= coarse) tolerance = std::sqrt(fine * coarse);
      tolerance = std::min(tolerance, kMostTolerance);
      if (tolerance <= fine) break;
    }
    return fine;
  }

  bool is_near(const CompactModel& model) const {
    return model.difference.mean <= limit_ && model.difference.one_sided <= kOneSidedLimit;
  }

  std::optional<CompactModel> on_grids(double tolerance, const std::vector<std::size_t>& views)
      const {
    ModelCut cut = cut_;
    cut.tolerance = tolerance;
    CompactModel model{.files = cut_files(files_, cut), .tolerance = tolerance};
    const auto found = difference(model.files, views);
    if (!found) return std::nullopt;
    model.difference = *found;
    return model;
  }

  // With everything.
  CompactModel without_loss() const {
    CompactModel model{.files = cut_files(files_, {})};
    const auto found = difference(model.files, all_views());
    if (found) model.difference = *found;
    GLINT_CHECK(
        found && is_near(model),
        kBadPrediction,
        "{}: its model does not render the same depth when it is loaded again; train again",
        spec_.folder.string()
    );
    return model;
  }

  const RunSpec& spec_;
  const Scene& scene_;
  double limit_;
  std::vector<SavedFile> files_;
  std::vector<FusedDepth> whole_;
  ModelCut cut_;
};

}  // namespace

CompactModel compact_model(const RunSpec& spec, const Scene& scene, double limit) {
  return Compactor(spec, scene, limit).compact();
}

void write_compact_file(const CompactFile& file, const fs::path& folder) {
  if (!file.surfels) return write_file(folder / file.name, file.bytes);
  write_surfel_ply(
      folder / file.name, unpack_surfels(file.code.about, file.code.fields, file.name)
  );
}

}  // namespace glint
