// SPDX-License-Identifier: MIT
#include "datasets/prior_evidence.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "datasets/disparity_shift.h"
#include "datasets/known_surfaces.h"
#include "datasets/prior_files.h"
#include "datasets/prior_maps.h"
#include "glint/core/correlation.h"
#include "glint/core/error.h"
#include "glint/core/median.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

constexpr std::size_t kEnoughSamples = 100;
constexpr std::size_t kMostViews = 8;

// Up to kMostViews views that have the prior, evenly spaced; training views where there are any.
std::vector<const ViewSource*> sample_views(const SceneIndex& index, const MapRow& row) {
  std::vector<const ViewSource*> views;
  for (const bool train : {true, false}) {
    for (const ViewSource& view : index.views)
      if (view.is_train == train && view.priors.has(row)) views.push_back(&view);
    if (!views.empty()) break;
  }
  const std::size_t count = std::min(views.size(), kMostViews);
  std::vector<const ViewSource*> sampled;
  for (std::size_t i = 0; i < count; ++i) sampled.push_back(views[i * views.size() / count]);
  return sampled;
}

// A prior as stored, and what is known of the surfaces at its pixels.
struct PosedPrior {
  Camera camera;
  Image map;
  std::vector<KnownPixel> known;
};

// Compares priors with what is known; reads each file once for each kind of prior.
class PriorScale {
 public:
  explicit PriorScale(const SceneIndex& index) : index_(index) {
    // Of views whose priors are trained on; where test views alone have some, points tell.
    has_truth_ = std::any_of(index.views.begin(), index.views.end(), [](const ViewSource& view) {
      return view.is_train && view.truth.has("depth");
    });
  }

  std::optional<NormalEvidence> weigh_normals();
  std::optional<DepthEvidence> weigh_depth();

 private:
  // Nothing to compare with, or damaged files: no known pixels.
  PosedPrior read(const ViewSource& view, const MapRow& row);
  const KnownPoints& points() {
    if (!points_) points_.emplace(index_.points);
    return *points_;
  }

  const SceneIndex& index_;
  bool has_truth_ = false;
  std::optional<KnownPoints> points_;  // read when first asked for
};

PosedPrior PriorScale::read(const ViewSource& view, const MapRow& row) try {
  PosedPrior posed{camera_at(view, picture_size(view)), read_stored_prior(view, row), {}};
  if (has_truth_) {
    if (!view.truth.has("depth")) return posed;
    const Image depth = read_true_values(view.truth["depth"], MapKind::kDepth);
    posed.camera = resized(posed.camera, depth.size());
    posed.map = resize_prior(std::move(posed.map), row.kind, depth.size());
    posed.known = known_pixels(posed.camera, depth);
  } else {
    posed.camera = resized(posed.camera, posed.map.size());
    posed.known = points().seen_by(posed.camera);
  }
  return posed;
} catch (const OutOfMemory&) {
  throw;
} catch (const Error&) {
  return {};
}

std::optional<NormalEvidence> PriorScale::weigh_normals() {
  std::array<std::vector<double>, kPriorAxes.size()> cosines;
  const MapRow& row = MapId("normal").row();
  for (const ViewSource* view : sample_views(index_, row)) {
    const PosedPrior posed = read(*view, row);
    for (const KnownPixel& pixel : posed.known) {
      const float* n = posed.map.data() + 3 * (posed.map.width() * pixel.y + pixel.x);
      const Vec3d stored = cast<double>(Vec3f{n[0], n[1], n[2]});
      if (!pixel.normal || length2(stored) == 0) continue;
      for (std::size_t i = 0; i < cosines.size(); ++i)
        cosines[i].push_back(
            dot(normal_in_cam(stored, static_cast<PriorAxes>(i), posed.camera), *pixel.normal)
        );
    }
  }
  if (cosines[0].empty()) return std::nullopt;
  NormalEvidence evidence;
  evidence.source = has_truth_ ? "true depth" : "planes through points";
  evidence.num_samples = cosines[0].size();
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    const double sum = std::accumulate(cosines[i].begin(), cosines[i].end(), 0.0);
    evidence.mean_cosine[i] = sum / static_cast<double>(cosines[i].size());
    evidence.median_angle_deg[i] =
        std::acos(std::clamp(upper_median(cosines[i]), -1.0, 1.0)) * 180 / std::numbers::pi;
  }
  return evidence;
}

// The place of each value in ascending order.
std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return values[a] < values[b];
  });
  std::vector<double> places(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) places[order[i]] = static_cast<double>(i);
  return places;
}

// Stored depth and known depth of one view.
struct DepthPairs {
  std::vector<double> stored, z;

  DepthPairs middle() const {  // between the percentiles of z
    const std::vector<double> places = ranks(z);
    const double count = static_cast<double>(z.size());
    DepthPairs kept;
    for (std::size_t i = 0; i < z.size(); ++i) {
      if (places[i] < 0.05 * count || places[i] > 0.95 * count) continue;
      kept.stored.push_back(stored[i]);
      kept.z.push_back(z[i]);
    }
    return kept;
  }
};

DepthPairs depth_pairs(const PosedPrior& posed) {
  DepthPairs pairs;
  for (const KnownPixel& pixel : posed.known) {
    const auto value = static_cast<double>(posed.map.at(pixel.x, pixel.y));
    if (!(value > 0)) continue;
    pairs.stored.push_back(value);
    pairs.z.push_back(pixel.depth);
  }
  return pairs;
}

std::optional<DepthEvidence> PriorScale::weigh_depth() {
  constexpr std::size_t kEnoughOfView = 20;
  DepthEvidence evidence;
  evidence.source = has_truth_ ? "true depth" : "points";
  std::vector<double> of_views;
  const MapRow& row = MapId("depth").row();
  for (const ViewSource* view : sample_views(index_, row)) {
    const DepthPairs pairs = depth_pairs(read(*view, row));
    if (pairs.z.size() < kEnoughOfView) continue;
    evidence.num_samples += pairs.z.size();
    of_views.push_back(correlation(ranks(pairs.stored), ranks(pairs.z)));
    DepthPairs middle = pairs.middle();
    evidence.correlation += correlation(middle.stored, middle.z);
    for (double& z : middle.z) z = 1 / z;
    evidence.inverse_correlation += correlation(middle.stored, middle.z);
  }
  if (of_views.empty()) return std::nullopt;
  evidence.num_views = of_views.size();
  const auto views = static_cast<double>(of_views.size());
  evidence.rank_correlation = mean_of(of_views);
  evidence.correlation /= views;
  evidence.inverse_correlation /= views;
  const auto agreeing = std::count_if(of_views.begin(), of_views.end(), [&](double r) {
    return r * evidence.rank_correlation > 0;
  });
  evidence.agreeing_views = static_cast<double>(agreeing) / views;
  return evidence;
}

// ---------------------------------------------------------------- what is taken, and why

std::string describe(const NormalEvidence& evidence, PriorAxes taken) {
  const std::size_t best = evidence.best();
  const auto id = static_cast<std::size_t>(taken);
  return fmt::format(
      "{} of {} samples: {} fits best, mean cosine {:.3f}, {:.3f} ahead of the next; as taken "
      "median "
      "angle {:.1f} deg",
      evidence.source,
      evidence.num_samples,
      kPriorAxes[best],
      evidence.mean_cosine[best],
      evidence.margin(),
      evidence.median_angle_deg[id]
  );
}

std::string describe(const DepthEvidence& evidence, PriorDepth taken) {
  return fmt::format(
      "{} of {} samples in {} views: correlation {:.3f} with depth, {:.3f} with 1 / depth; as "
      "taken "
      "an affine fit leaves {:.2f} of the spread",
      evidence.source,
      evidence.num_samples,
      evidence.num_views,
      evidence.rank_correlation,
      evidence.correlation,
      evidence.inverse_correlation,
      evidence.residual(taken)
  );
}

// The word of `names` that is forced; nothing: to be detected.
template <class Enum, class Names>
std::optional<Enum> forced_value(const std::string& word, const Names& names) {
  const auto found = std::find(names.begin(), names.end(), word);
  if (found == names.end()) return std::nullopt;
  return static_cast<Enum>(found - names.begin());
}

struct Settled {
  std::size_t value;
  std::string why;
};

// One choice of `names`: forced, detected or documented. `detected` is what the evidence says.
template <class Enum, class Evidence>
Settled settle(
    std::optional<Enum> forced,
    const std::optional<Evidence>& evidence,
    Enum detected,
    Enum documented,
    bool simulated
) {
  const bool decided = evidence && evidence->decided();
  const Enum taken = forced ? *forced : decided && !simulated ? detected : documented;
  std::string why =
      forced      ? "as stated"
      : simulated ? "simulated: as documented"
      : decided   ? taken == documented ? "detected, as documented" : "detected, not as documented"
      : evidence  ? "undecided, so as documented"
                  : "nothing to compare with, so as documented";
  if (evidence) why += "; " + describe(*evidence, taken);
  return {static_cast<std::size_t>(taken), why};
}

bool has_prior(const SceneIndex& index, MapId id) {
  return std::any_of(index.views.begin(), index.views.end(), [&](const ViewSource& view) {
    return view.priors.has(id);
  });
}

}  // namespace

std::size_t NormalEvidence::best() const {
  return static_cast<std::size_t>(
      std::max_element(mean_cosine.begin(), mean_cosine.end()) - mean_cosine.begin()
  );
}

double NormalEvidence::margin() const {
  auto sorted = mean_cosine;
  std::sort(sorted.begin(), sorted.end());
  return sorted[sorted.size() - 1] - sorted[sorted.size() - 2];
}

bool NormalEvidence::decided() const {
  constexpr double kFits = 0.5, kMargin = 0.1;
  return num_samples >= kEnoughSamples && mean_cosine[best()] >= kFits && margin() >= kMargin;
}

PriorDepth DepthEvidence::best() const {
  if (rank_correlation > 0) return PriorDepth::kLinear;
  return inverse_correlation > -correlation ? PriorDepth::kDisparity : PriorDepth::kInverted;
}

bool DepthEvidence::decided() const {
  constexpr double kTells = 0.4, kAgreeing = 0.75;
  return num_samples >= kEnoughSamples && std::abs(rank_correlation) >= kTells &&
         agreeing_views >= kAgreeing;
}

double DepthEvidence::residual(PriorDepth as) const {
  const double r = as == PriorDepth::kDisparity ? inverse_correlation : correlation;
  return std::sqrt(std::max(0.0, 1 - r * r));
}

PriorEvidence weigh_priors(const SceneIndex& index) {
  PriorScale scale(index);
  return {scale.weigh_normals(), scale.weigh_depth()};
}

void settle_readings(
    const PriorOptions& options, const PriorEvidence& evidence, SceneIndex& index
) {
  const PriorOptions merged = merged_priors(options, index.stated_priors);
  const PriorReading& documented = index.documented_priors;
  PriorReading reading = documented;
  if (has_prior(index, "normal")) {
    const Settled settled = settle(
        forced_value<PriorAxes>(merged.axes, kPriorAxes),
        evidence.normal,
        static_cast<PriorAxes>(evidence.normal ? evidence.normal->best() : 0),
        documented.axes,
        index.simulated_priors
    );
    reading.axes = static_cast<PriorAxes>(settled.value);
    index.prior_notes.push_back(
        fmt::format("normal priors: {} axes, {}", kPriorAxes[settled.value], settled.why)
    );
  }
  if (has_prior(index, "depth")) {
    const Settled settled = settle(
        forced_value<PriorDepth>(merged.depth, kPriorDepths),
        evidence.depth,
        evidence.depth ? evidence.depth->best() : PriorDepth::kLinear,
        documented.depth,
        index.simulated_priors
    );
    reading.depth = static_cast<PriorDepth>(settled.value);
    index.prior_notes.push_back(
        fmt::format("depth priors: {}, {}", kPriorDepths[settled.value], settled.why)
    );
  }
  for (ViewSource& view : index.views) view.prior_reading = reading;
  if (has_prior(index, "depth") && reading.depth == PriorDepth::kDisparity)
    tell_disparity_shifts(index);
}

std::vector<Finding> check_readings(
    const PriorOptions& options, const PriorEvidence& evidence, const SceneIndex& index
) {
  const PriorOptions merged = merged_priors(options, index.stated_priors);
  const auto axes =
      forced_value<PriorAxes>(merged.axes, kPriorAxes).value_or(index.documented_priors.axes);
  const auto depth =
      forced_value<PriorDepth>(merged.depth, kPriorDepths).value_or(index.documented_priors.depth);
  const std::string where = index.folder.string();
  std::vector<Finding> findings;
  if (const auto& normal = evidence.normal; normal && normal->decided() &&
                                            normal->best() != static_cast<std::size_t>(axes) &&
                                            normal->source != "true depth")
    findings.push_back(
        {"normal-axes",
         where,
         fmt::format(
             "normal priors: {} axes expected, but {}; state prior_axes in scene.json or mend them",
             kPriorAxes[static_cast<std::size_t>(axes)],
             describe(*normal, axes)
         )}
    );
  if (const auto& known = evidence.depth; known && known->decided() && known->best() != depth)
    findings.push_back(
        {"depth-polarity",
         where,
         fmt::format(
             "depth priors: {} expected, {} found: {}; state prior_depth in scene.json or mend "
             "them",
             kPriorDepths[static_cast<std::size_t>(depth)],
             kPriorDepths[static_cast<std::size_t>(known->best())],
             describe(*known, depth)
         )}
    );
  return findings;
}

std::vector<std::string> prior_coverage(const Scene& scene) {
  std::vector<std::string> lines;
  for (const MapRow& row : maps()) {
    double views = 0, pixels = 0;
    for (const View& view : scene.train) {
      const Image& map = view.priors[row];
      if (map.empty()) continue;
      const auto channels = static_cast<std::size_t>(map.channels());
      std::size_t filled = 0;
      for (std::size_t i = 0; i < map.num_pixels(); ++i) {
        const float* values = map.data() + channels * i;
        if (std::any_of(values, values + channels, [](float v) { return v != 0; })) ++filled;
      }
      views += 1;
      pixels += static_cast<double>(filled) / static_cast<double>(map.num_pixels());
    }
    if (views == 0) continue;
    const bool holes = row.kind == MapKind::kDepth || row.kind == MapKind::kNormal;  // 0: nothing
    lines.push_back(
        fmt::format(
            "prior {}: {:.0f} % of training views",
            row.id,
            100 * views / static_cast<double>(scene.train.size())
        ) +
        (holes ? fmt::format(", {:.1f} % of their pixels", 100 * pixels / views) : "")
    );
  }
  return lines;
}

}  // namespace glint
