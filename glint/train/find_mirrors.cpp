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
constexpr double kWorthPlacing = 0.25;     // likeness from which a plane is placed more finely
constexpr int kRounds = 40, kFinest = 48;  // at most; the last step's share of the first
constexpr int kWindows = 3;                // along an image's height
constexpr double kLeastSeen = 0.75;        // of a window's pixels
constexpr double kLeastVariance = 1e-4;    // of a window of a photo: flatter ones say nothing
constexpr std::size_t kLeastWindows = 8, kMostViews = 24;
constexpr float kFaint = -4.6f;  // logit of 0.01

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
  void tell(MirrorPlane& plane) const {
    const auto count = static_cast<double>(correlations_.size());
    plane.likeness = correlations_.size() < kLeastWindows
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

// How well planes explain what the photos show.
class MirrorSearch {
 public:
  MirrorSearch(const Scene& scene, MirroredSets sets, MirrorsCall call, const FindMirrors& settings)
      : sets_(sets), call_(std::move(call)) {
    for (const std::size_t i : evenly_chosen(kMostViews, scene.train.size()))
      views_.push_back(&scene.train[i]);
    RasterPass pass;
    for (const View* view : views_) {
      const RasterOutput& surface =
          sets.interface.forward(pass, view->camera, call_.interface_degree, call_.settings);
      expected_depth_map(surface, depths_.emplace_back());
      if (view->priors.has("albedo")) add_points(*view, surface, settings.low_albedo, points_);
    }
    const double scale = static_cast<double>(scene.spatial_scale);
    step_ = kStepShare * scale;
    fit_.tolerance = kToleranceShare * scale;
  }

  std::vector<MirrorPlane> run() {
    std::vector<MirrorPlane> planes;
    for (PlaneOfPoints& fitted : fit_planes(points_, fit_)) {
      place(fitted);
      PlaneFit wide = fit_;
      wide.tolerance *= kWide;
      fitted.points = points_on(fitted.plane, points_, wide);
      fit_rectangle(fitted);
      planes.push_back(fitted.plane);
    }
    return planes;
  }

 private:
  void look_at(MirrorPlane& plane) {
    Likeness likeness;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (!is_in_view(plane, views_[i]->camera)) continue;
      call_.camera = views_[i]->camera;
      mirror_.see(sets_, call_, plane, depths_[i]);
      likeness.add(*views_[i], mirror_);
    }
    likeness.tell(plane);
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
  // Forth and back, then also turned, by ever smaller steps: interface surfels before a mirror are
  // off by up to a decimetre, for the photos draw them to where the mirrored room appears to be.
  void place(PlaneOfPoints& fitted) {
    MirrorPlane best = fitted.plane;
    best.half_width *= kInner, best.half_height *= kInner;
    look_at(best);
    const MirrorPlane start = best;
    for (int k = -kScan; k <= kScan; ++k) {
      MirrorPlane moved = start;
      moved.center += (k * step_) * start.normal;
      look_at(moved);
      if (moved.likeness > best.likeness) best = moved;
    }
    double step = step_ / 2, turn = kTurn;
    if (best.likeness <= kWorthPlacing) step = 0;
    for (int round = 0; round < kRounds && step > step_ / kFinest; ++round) {
      bool better = false;
      for (const double sign : {-1.0, 1.0}) {
        better = try_moved(best, sign * step, 0, 0) || better;
        better = try_moved(best, 0, sign * turn, 0) || better;
        better = try_moved(best, 0, 0, sign * turn) || better;
      }
      if (!better) step /= 2, turn /= 2;
    }
    fitted.plane = best;
  }

  MirroredSets sets_;
  MirrorsCall call_;
  std::vector<const View*> views_;
  std::vector<Image> depths_;
  std::vector<SurfacePoint> points_;  // of all dark pixels
  PlaneFit fit_;
  MirrorView mirror_;
  double step_ = 0;  // metres
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
