// SPDX-License-Identifier: MIT
#include "glint/train/find_mirrors.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "glint/core/evenly_chosen.h"
#include "glint/render/map_ops.h"
#include "glint/train/mirror_likeness.h"
#include "glint/train/pane_outlines.h"

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
constexpr int kOutlineRows = 24;           // of a view, at most, by which a pane is placed
constexpr double kOutlinedReach = 0.15;    // tolerances from where outlines say that a pane is
constexpr double kOutlinedCosine = 0.9998;  // a degree about how priors say that it lies
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
  return plane.holds(eye + (a / (a - b)) * (behind - eye));
}

// f(pixel's index, what is there) for every step-th pixel of a view with albedo priors, along each
// side; `normal`: camera space, unit or 0. What has none is not dark: nothing can be said of it.
template <class F>
void visit_pixels(const View& view, const Image& normal, float low, int step, F&& f) {
  const Camera& camera = view.camera;
  const Vec3d eye = camera.center();
  for (int y = 0; y < normal.height(); y += step)
    for (int x = 0; x < normal.width(); x += step) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(normal.width()) +
                     static_cast<std::size_t>(x);
      const Vec3d n =
          transpose_times(camera.rotation_cam_from_world, cast<double>(get3(normal.data(), i)));
      const Vec3d ray = camera.ray_in_world(x + 0.5, y + 0.5);
      const bool dark = length2(n) > 0.5 && is_dark(view.priors["albedo"], i, low);
      f(i, OutlinePixel{eye, ray, (dot(n, ray) > 0 ? -1.0 : 1.0) * n, dark});
    }
}

// How well planes explain what the photos show.
class MirrorSearch {
 public:
  MirrorSearch(const Scene& scene, MirroredSets sets, MirrorsCall call, const FindMirrors& settings)
      : sets_(sets), call_(std::move(call)), settings_(settings) {
    const double scale = static_cast<double>(scene.spatial_scale);
    step_ = kStepShare * scale;
    fit_.tolerance = kToleranceShare * scale;
    outlines_ = PaneOutlines(fit_);
    RasterPass passes[2];
    for (const std::size_t i : evenly_chosen(kMostViews, scene.train.size())) {
      const View& view = scene.train[i];
      const RasterOutput& surface =
          sets.interface.forward(passes[0], view.camera, call_.interface_degree, call_.settings);
      know(view, surface, passes[1]);
      if (view.priors.has("albedo")) add_pixels(view, surface);
    }
  }

  std::vector<MirrorPlane> run() {
    std::vector<MirrorPlane> planes;
    for (const PlaneOfPoints& fitted : fit_planes(points_, fit_)) {
      PlaneOfPoints placed = fitted;
      place(placed);
      if (placed.plane.likeness >= settings_.least_likeness)
        planes.push_back(with_its_rectangle(placed));
      else
        add_pane(settings_.panes ? pane(fitted) : placed.plane, planes);
    }
    return planes;
  }

 private:
  // Where the interface is in dark pixels, and how a surface lies there by the prior, if there is
  // one.
  void add_pixels(const View& view, const RasterOutput& surface) {
    Image depth;
    expected_depth_map(surface, depth);
    const Image normal =
        unit_normals(view.priors.has("normal") ? view.priors["normal"] : surface.normal);
    const float low = settings_.low_albedo;
    visit_pixels(view, normal, low, kPixelStep, [&](std::size_t i, const OutlinePixel& pixel) {
      const auto z = static_cast<double>(depth.data()[i]);
      if (z > 0 && pixel.dark)
        points_.push_back({pixel.eye + z * pixel.ray, pixel.normal, pixel.eye});
    });
    const int step = std::max(kPixelStep, depth.height() / kOutlineRows);
    visit_pixels(view, normal, low, step, [&](std::size_t, const OutlinePixel& pixel) {
      outlines_.add(pixel);
    });
  }
  // But one that is known: its surfels may lie at two depths.
  void add_pane(const MirrorPlane& pane, std::vector<MirrorPlane>& planes) const {
    const bool known = std::any_of(planes.begin(), planes.end(), [&](const MirrorPlane& other) {
      return pane.pane && other.pane && lies_on(pane, other, fit_);
    });
    if (!known) planes.push_back(pane);
  }
  MirrorPlane with_its_rectangle(PlaneOfPoints& placed) const {
    PlaneFit wide = fit_;
    wide.tolerance *= kWide;
    placed.points = points_on(placed.plane, points_, wide);
    fit_rectangle(placed);
    return placed.plane;
  }
  // As the priors say how it lies (the mean of many is off by less than a degree), where outlines
  // agree; where these do not tell, about where the interface is, which guidance of t holds to
  // glass but for some centimetres.
  MirrorPlane pane(PlaneOfPoints fitted) {
    MirrorPlane& plane = fitted.plane;
    plane.pane = true;
    plane.outlined = outlines_.place(fitted);
    plane.half_width *= kInner, plane.half_height *= kInner;
    if (plane.outlined > 0) outlined_ = plane;
    plane = best_of_scan(plane, kPaneStep * step_);
    move_and_turn(plane, kPaneStep * step_ / 2, kTurn / 4, kPaneFinest);
    outlined_.reset();
    fit_rectangle(fitted);
    return plane;
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
    MirrorLikeness mirror;
    PaneLikeness pane;
    for (std::size_t i = 0; i < views_.size(); i += every_) {
      const KnownView& known = views_[i];
      if (!is_in_view(plane, known.view->camera)) continue;
      MirrorsCall call = call_;
      call.camera = known.view->camera;
      // To spare time: what a pane mirrors seldom stands behind another.
      call.transmission = call_.transmission && !plane.pane;
      mirror_.see(sets_, call, plane, known.depth);
      if (plane.pane)
        pane.add(known, mirror_.seen(), mirror_.picture());
      else
        mirror.add(*known.view, mirror_);
    }
    if (plane.pane)
      plane.likeness = pane.partial_correlation();
    else
      mirror.tell(plane, kLeastWindows / every_);
  }
  bool try_moved(MirrorPlane& best, double forth, double about_up, double about_across) {
    MirrorPlane moved = best;
    moved.center += forth * best.normal;
    moved.normal = normalize(
        best.normal + std::tan(about_up) * best.across + std::tan(about_across) * best.up()
    );
    moved.across = normalize(best.across - dot(best.across, moved.normal) * moved.normal);
    if (!is_near_outlines(moved)) return false;
    look_at(moved);
    if (moved.likeness <= best.likeness) return false;
    best = moved;
    return true;
  }
  bool is_near_outlines(const MirrorPlane& moved) const {
    return !outlined_ ||
           (std::abs(outlined_->signed_distance(moved.center)) <= kOutlinedReach * fit_.tolerance &&
            dot(outlined_->normal, moved.normal) >= kOutlinedCosine);
  }
  MirrorPlane best_of_scan(const MirrorPlane& start, double step) {
    MirrorPlane best = start;
    look_at(best);
    for (int k = -kScan; k <= kScan; ++k) {
      MirrorPlane moved = start;
      moved.center += (k * step) * start.normal;
      if (!is_near_outlines(moved)) continue;
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
  PaneOutlines outlines_;
  std::optional<MirrorPlane> outlined_;  // what is placed stays near it
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
