// SPDX-License-Identifier: MIT
#include "glint/train/find_mirrors.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "glint/core/evenly_chosen.h"
#include "glint/render/map_ops.h"

namespace glint {

namespace {

constexpr int kPixelStep = 3;              // of the pixels that points are made of, along each side
constexpr double kToleranceShare = 0.05;   // of the scene's scale: distance from a plane
constexpr double kStepShare = 0.015;       // of it: step of the search for where a plane is
constexpr double kInner = 0.9;             // of a rectangle's sides, without its frame
constexpr double kWide = 3;                // tolerances: points that tell how far a plane goes
constexpr int kScan = 6;                   // such steps forth and back
constexpr double kTurn = 0.017;            // a degree
constexpr double kPaneStep = 0.35;         // of a mirror's, of a pane: the interface is there
constexpr int kPaneFinest = 6;             // kFinest of a pane
constexpr double kWorthPlacing = 0.25;     // likeness from which a plane is placed more finely
constexpr int kRounds = 40, kFinest = 48;  // at most; the last step's share of the first
constexpr int kWindows = 3;                // along an image's height
constexpr double kLeastSeen = 0.75;        // of a window's pixels
constexpr double kLeastVariance = 1e-4;    // of a window of a photo: flatter ones say nothing
constexpr std::size_t kLeastWindows = 8, kMostViews = 24;
constexpr std::size_t kSearchEvery = 3;  // of these views, while a mirror is placed
constexpr float kFaint = -4.6f;          // logit of 0.01

bool is_dark(const Image& albedo, std::size_t i, float low) {
  const Vec3f a = get3(albedo.data(), i);
  return std::max({a.x, a.y, a.z}) < low;
}

// Whether the way from an eye before the plane to a point behind it crosses the rectangle.
bool is_seen_through(const MirrorPlane& plane, Vec3d eye, Vec3d behind) {
  const double a = plane.signed_distance(eye), b = plane.signed_distance(behind);
  if (a <= 0) return false;
  const Vec3d p = eye + (a / (a - b)) * (behind - eye) - plane.center;
  return std::abs(dot(p, plane.across)) <= plane.half_width &&
         std::abs(dot(p, plane.up())) <= plane.half_height;
}

// Where the interface is in dark pixels, and how a surface lies there by the prior, if there is
// one.
void add_points(
    const View& view, const RasterOutput& surface, float low, std::vector<SurfacePoint>& points
) {
  Image depth;
  expected_depth_map(surface, depth);
  const Image normal =
      unit_normals(view.priors.has("normal") ? view.priors["normal"] : surface.normal);
  const Mat3d& turn = view.camera.rotation_cam_from_world;
  const Vec3d eye = view.camera.center();
  for (int y = 0; y < depth.height(); y += kPixelStep)
    for (int x = 0; x < depth.width(); x += kPixelStep) {
      const std::size_t i = depth.view().offset(x, y);
      const double z = static_cast<double>(depth.data()[i]);
      const Vec3d n = cast<double>(get3(normal.data(), i));
      if (z <= 0 || length2(n) < 0.5 || !is_dark(view.priors["albedo"], i, low)) continue;
      const Vec3d ray = view.camera.ray_in_cam(x + 0.5, y + 0.5);
      const double towards = dot(n, ray) > 0 ? -1 : 1;
      points.push_back({view.camera.to_world(z * ray), transpose_times(turn, towards * n), eye});
    }
}

// A window of a photo and of what the camera in the mirror sees.
struct Window {
  std::vector<double> photo, mirrored;

  // None (0) where the photo is flat.
  bool correlation(double& result) const {
    const auto n = static_cast<double>(photo.size());
    const double a = std::accumulate(photo.begin(), photo.end(), 0.0) / n;
    const double b = std::accumulate(mirrored.begin(), mirrored.end(), 0.0) / n;
    double aa = 0, bb = 0, ab = 0;
    for (std::size_t i = 0; i < photo.size(); ++i) {
      aa += (photo[i] - a) * (photo[i] - a);
      bb += (mirrored[i] - b) * (mirrored[i] - b);
      ab += (photo[i] - a) * (mirrored[i] - b);
    }
    if (aa < kLeastVariance * n) return false;
    result = bb > 0 ? ab / std::sqrt(aa * bb) : 0;
    return true;
  }
};

// What all views say about a plane.
class Likeness {
 public:
  void add(const View& view, const MirrorView& mirror) {
    const ImageSize size = view.camera.size();
    const int side = std::max(4, size.height / kWindows);
    for (int y = 0; y + side <= size.height; y += side)
      for (int x = 0; x + side <= size.width; x += side) add_window(view, mirror, x, y, side);
  }
  void tell(MirrorPlane& plane, std::size_t least_windows) const {
    const auto count = static_cast<double>(correlations_.size());
    plane.likeness = correlations_.size() < least_windows
                         ? 0
                         : std::accumulate(correlations_.begin(), correlations_.end(), 0.0) / count;
    for (std::size_t c = 0; c < 3; ++c)
      plane.tint[c] =
          static_cast<float>(mirrored_[c] > 0 ? std::min(1.0, photo_[c] / mirrored_[c]) : 1);
  }

 private:
  void add_window(const View& view, const MirrorView& mirror, int left, int top, int side) {
    Window window;
    const int width = view.camera.width;
    for (int y = top; y < top + side; ++y)
      for (int x = left; x < left + side; ++x) {
        if (mirror.seen().at(x, y) <= 0) continue;
        const Vec3f a = get3(view.rgb.pixel(x, y), 0);
        const Vec3f b = get3(mirror.picture().pixel(width - 1 - x, y), 0);
        window.photo.push_back(static_cast<double>(a.x + a.y + a.z) / 3);
        window.mirrored.push_back(static_cast<double>(b.x + b.y + b.z) / 3);
        for (int c = 0; c < 3; ++c) {
          photo_[static_cast<std::size_t>(c)] += static_cast<double>(a[c]);
          mirrored_[static_cast<std::size_t>(c)] += static_cast<double>(b[c]);
        }
      }
    double correlation = 0;
    if (static_cast<double>(window.photo.size()) >= kLeastSeen * side * side &&
        window.correlation(correlation))
      correlations_.push_back(correlation);
  }

  std::vector<double> correlations_;
  std::array<double, 3> photo_{}, mirrored_{};
};

// A view as the sets show it without what its glass mirrors.
struct KnownView {
  const View* view;
  Image depth;    // [H][W][1] metres, of the interface
  Image without;  // [H][W][3] where nothing is mirrored
  Image share;    // [H][W][1] k_s
};

// What of the photos is left for mirrored rays, and what they would add by a pane's plane: their
// correlation about the means of windows, for the sets make up for what is missing on average.
class Remainder {
 public:
  void add(const KnownView& known, const MirrorView& mirror) {
    const ImageSize size = known.view->camera.size();
    const int side = std::max(4, size.height / kWindows);
    for (int y = 0; y < size.height; y += side)
      for (int x = 0; x < size.width; x += side) add_window(known, mirror, x, y, side);
  }
  double correlation() const {
    return photo_ > 0 && mirrored_ > 0 ? both_ / std::sqrt(photo_ * mirrored_) : 0;
  }

 private:
  void add_window(const KnownView& known, const MirrorView& mirror, int left, int top, int side) {
    const ImageSize size = known.view->camera.size();
    double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (int y = top; y < std::min(top + side, size.height); ++y)
      for (int x = left; x < std::min(left + side, size.width); ++x) {
        if (mirror.seen().at(x, y) <= 0) continue;
        const Vec3f rest =
            get3(known.view->rgb.pixel(x, y), 0) - get3(known.without.pixel(x, y), 0);
        const Vec3f m =
            known.share.at(x, y) * get3(mirror.picture().pixel(size.width - 1 - x, y), 0);
        const auto r = static_cast<double>(rest.x + rest.y + rest.z);
        const auto s = static_cast<double>(m.x + m.y + m.z);
        n += 1, a += r, b += s, aa += r * r, bb += s * s, ab += r * s;
      }
    if (n < 2) return;
    photo_ += aa - a * a / n, mirrored_ += bb - b * b / n, both_ += ab - a * b / n;
  }

  double photo_ = 0, mirrored_ = 0, both_ = 0;
};

// How well planes explain what the photos show.
class MirrorSearch {
 public:
  MirrorSearch(const Scene& scene, MirroredSets sets, MirrorsCall call, const FindMirrors& settings)
      : sets_(sets), call_(std::move(call)), settings_(settings) {
    RasterPass passes[2];
    for (const std::size_t i : evenly_chosen(kMostViews, scene.train.size())) {
      const View& view = scene.train[i];
      const RasterOutput& surface =
          sets.interface.forward(passes[0], view.camera, call_.interface_degree, call_.settings);
      know(view, surface, passes[1]);
      if (view.priors.has("albedo")) add_points(view, surface, settings.low_albedo, points_);
    }
    const double scale = static_cast<double>(scene.spatial_scale);
    step_ = kStepShare * scale;
    fit_.tolerance = kToleranceShare * scale;
  }

  std::vector<MirrorPlane> run() {
    std::vector<MirrorPlane> planes;
    for (const PlaneOfPoints& fitted : fit_planes(points_, fit_)) {
      PlaneOfPoints placed = fitted;
      place(placed);
      if (placed.plane.likeness >= settings_.least_likeness)
        planes.push_back(with_its_rectangle(placed));
      else
        planes.push_back(settings_.panes ? pane(fitted) : placed.plane);
    }
    return planes;
  }

 private:
  MirrorPlane with_its_rectangle(PlaneOfPoints& placed) const {
    PlaneFit wide = fit_;
    wide.tolerance *= kWide;
    placed.points = points_on(placed.plane, points_, wide);
    fit_rectangle(placed);
    return placed.plane;
  }
  // As the priors say how it lies (the mean of many is off by less than a degree), about where the
  // interface is, which guidance of t holds to glass but for some centimetres.
  MirrorPlane pane(PlaneOfPoints fitted) {
    MirrorPlane& plane = fitted.plane;
    plane.pane = true;
    plane.half_width *= kInner, plane.half_height *= kInner;
    plane = best_of_scan(plane, kPaneStep * step_);
    move_and_turn(plane, kPaneStep * step_ / 2, kTurn / 4, kPaneFinest);
    return with_its_rectangle(fitted);
  }
  // The view with its glass mirroring black, as GlintModel composes it but for GLINT+'s second face
  // of glass: what the panes of docs/results were found with.
  void know(const View& view, const RasterOutput& surface, RasterPass& behind) {
    GlassTransport transport;
    transport.set_options(
        {.channels = interface_channels(sets_.interface.cloud()),
         .transmission = call_.transmission,
         .linear_light = call_.linear_light}
    );
    const GlassBuffer& buffer = transport.read_interface(view.camera, surface);
    GlassLayers layers;
    copy_color(surface.features, layers.interface);
    clear_image(layers.reflection, view.camera.size(), 3);
    if (call_.transmission)
      copy_color(
          sets_.transmission
              .forward(behind, view.camera, call_.transmission_degree, {}, buffer.depth)
              .features,
          layers.transmission
      );
    views_.push_back({&view, buffer.depth, transport.compose(layers), buffer.specularity});
  }
  // Sets its likeness, and a mirror's tint.
  void look_at(MirrorPlane& plane) {
    Likeness likeness;
    Remainder remainder;
    for (std::size_t i = 0; i < views_.size(); i += every_) {
      const KnownView& known = views_[i];
      if (!is_in_view(plane, known.view->camera)) continue;
      MirrorsCall call = call_;
      call.camera = known.view->camera;
      // To spare time: what a pane mirrors seldom stands behind another.
      call.transmission = call_.transmission && !plane.pane;
      mirror_.see(sets_, call, plane, known.depth);
      if (plane.pane)
        remainder.add(known, mirror_);
      else
        likeness.add(*known.view, mirror_);
    }
    if (plane.pane)
      plane.likeness = remainder.correlation();
    else
      likeness.tell(plane, kLeastWindows / every_);
  }
  bool try_moved(MirrorPlane& best, double forth, double about_up, double about_across) {
    MirrorPlane moved = best;
    moved.center += forth * best.normal;
    moved.normal = normalize(
        best.normal + std::tan(about_up) * best.across + std::tan(about_across) * best.up()
    );
    moved.across = normalize(best.across - dot(best.across, moved.normal) * moved.normal);
    look_at(moved);
    if (moved.likeness <= best.likeness) return false;
    best = moved;
    return true;
  }
  MirrorPlane best_of_scan(const MirrorPlane& start, double step) {
    MirrorPlane best = start;
    look_at(best);
    for (int k = -kScan; k <= kScan; ++k) {
      MirrorPlane moved = start;
      moved.center += (k * step) * start.normal;
      look_at(moved);
      if (moved.likeness > best.likeness) best = moved;
    }
    return best;
  }
  // Forth and back, then also turned, by ever smaller steps: interface surfels before a mirror are
  // off by up to a decimetre, for the photos draw them to where the mirrored room appears to be.
  void place(PlaneOfPoints& fitted) {
    MirrorPlane best = fitted.plane;
    best.half_width *= kInner, best.half_height *= kInner;
    every_ = kSearchEvery;
    best = best_of_scan(best, step_);
    if (best.likeness > kWorthPlacing) move_and_turn(best, step_ / 2, kTurn, kFinest);
    every_ = 1;
    look_at(best);  // all views decide
    fitted.plane = best;
  }
  // Until steps are 2 / finest of the first.
  void move_and_turn(MirrorPlane& best, double step, double turn, int finest) {
    const double least = 2 * step / finest;
    for (int round = 0; round < kRounds && step > least; ++round) {
      bool better = false;
      for (const double sign : {-1.0, 1.0}) {
        better = try_moved(best, sign * step, 0, 0) || better;
        better = try_moved(best, 0, sign * turn, 0) || better;
        better = try_moved(best, 0, 0, sign * turn) || better;
      }
      if (!better) step /= 2, turn /= 2;
    }
  }

  MirroredSets sets_;
  MirrorsCall call_;
  std::vector<KnownView> views_;
  std::vector<SurfacePoint> points_;  // of all dark pixels
  PlaneFit fit_;
  MirrorView mirror_;
  double step_ = 0;        // metres
  std::size_t every_ = 1;  // of the views that are looked at
  FindMirrors settings_;
};

}  // namespace

std::vector<MirrorPlane> candidate_mirrors(
    const Scene& scene, MirroredSets sets, MirrorsCall call, const FindMirrors& settings
) {
  return MirrorSearch(scene, sets, std::move(call), settings).run();
}

void fade_behind(const MirrorPlane& plane, const std::vector<View>& views, SurfelCloud& cloud) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3d at = cast<double>(get3(cloud.means.data(), i));
    if (plane.signed_distance(at) < 0 &&
        std::any_of(views.begin(), views.end(), [&](const View& v) {
          return is_seen_through(plane, v.camera.center(), at);
        }))
      cloud.opacity_logits[i] = std::min(cloud.opacity_logits[i], kFaint);
  }
}

}  // namespace glint
