// SPDX-License-Identifier: MIT
// GLINT [Na26]: "GLINT: Modeling Scene-Scale Transparency via Gaussian Radiance Transport", CVPR
// 2026. Three sets of surfels: the interface, rasterised to a G-buffer (depth, normal, transparency
// t, specularity s); transmission, what is seen straight through it; reflection, traced along
// mirrored rays. Composed by Eq. 5-9 (glint/render/transport.h), trained with the losses of Sec. 4.
//
// Deviations: transmission is rasterised with the interface's depth as the near limit instead of
// traced (thin glass does not bend the ray; `transmission=trace` traces). z_trans is the depth of
// the transmission set seen from the camera on its own. LPIPS is off: its network is not built in
// yet. What the paper leaves open (weights, initial t and s, windows) is in GlintConfig. Iterations
// are of the published 60,000 and scale with the run.
#include <algorithm>
#include <cmath>

#include "glint/core/rng.h"
#include "glint/method.h"
#include "glint/render/blend.h"
#include "glint/scene/ply.h"
#include "glint/train/depth_prior.h"
#include "glint/train/glass_transport.h"
#include "glint/train/normal_consistency.h"
#include "glint/train/normal_prior.h"
#include "glint/train/normal_smoothness.h"
#include "glint/train/photometric.h"
#include "glint/train/surfel_set.h"
#include "glint/train/trainer.h"
#include "glint/train/transparency_guidance.h"

namespace glint {

namespace {

constexpr int kPublishedIterations = 60000;

struct GlintConfig {
  // Radiance transport.
  bool with_transmission = true, with_reflection = true;
  std::string transmission = "raster";
  float f0 = 0.04f;
  bool detach_origins = false;
  float secondary_near = 0;  // metres behind the interface
  // Deviation: mirrored rays stop earlier than rasterised ones (1e-4, 256 hits). The new set is a
  // fog of faint surfels that would take hundreds of hits a ray, and what lies behind 2 % of
  // transmittance changes a pixel by 0.02 k_s, less than a step of 8 bits at the k_s of glass.
  float mirror_transmittance = 0.02f;
  int mirror_hits = 64;
  // Initial sets.
  float initial_transparency = 0.1f, initial_specular = 1e-3f;
  int random_points = 30000;
  // Deviation: the paper's 32^3 cells are for images of 480x270; smaller ones start with as many
  // points a pixel, for more could not be told apart by so few rays.
  int reflection_cells = 32, points_per_cell = 5;
  float reflection_points_per_pixel = 1.264f;
  // Phases, published iterations.
  int joint_from = 5000, freeze_from = 40000, sh_interval = 1000;
  // Losses.
  float lambda_ssim = 0.2f;
  float lambda_depth = 0.1f, lambda_normal = 0.1f, lambda_consistency = 0.05f;
  float lambda_smooth = 0.01f, lambda_transparency = 0.1f;
  int gate_from = 10000, smooth_from = 5000, transparency_from = 7000;
  float min_cosine = 0.3f;
  float depth_threshold = 0.01f, low_albedo = 0.05f;
  DensifyConfig densify;
  float reflection_gradient = 1e-4f;
  // Opacity resets of the secondary sets. Off: their gradient is weighted by t and k_s, so most of
  // their surfels would not recover before the next pruning.
  bool reset_secondary = false;
  SurfelRates rates;

  GlintConfig() {
    densify.until = 30000;
    rates.extra = 0.05f;
  }
  template <class V>
  void visit(V&& v) {
    v("with_transmission", with_transmission, "false: t counts as 0");
    v("with_reflection", with_reflection, "false: k_s counts as 0");
    v("transmission", transmission, "raster or trace");
    v("f0", f0, "reflectance at normal incidence");
    v("detach_origins", detach_origins, "no gradient from reflections to the interface's depth");
    v("secondary_near", secondary_near, "metres behind the interface where transmission starts");
    v("mirror_transmittance", mirror_transmittance, "transmittance at which mirrored rays stop");
    v("mirror_hits", mirror_hits, "most surfels a mirrored ray meets");
    v("initial_transparency", initial_transparency, "t of the interface's initial surfels");
    v("initial_specular", initial_specular, "s of the interface's initial surfels");
    v("random_points", random_points, "initial surfels of scenes without points");
    v("reflection_cells", reflection_cells, "most cells of the reflection grid along each axis");
    v("reflection_points_per_pixel", reflection_points_per_pixel, "fewer cells in small images");
    v("points_per_cell", points_per_cell, "initial reflection surfels of each cell");
    v("joint_from", joint_from, "iterations of the interface alone (of 60,000)");
    v("freeze_from", freeze_from, "first iteration with a frozen interface (of 60,000)");
    v("sh_interval", sh_interval, "iterations per SH degree (of 60,000)");
    v("lambda_ssim", lambda_ssim, "weight of 1 - SSIM against L1");
    v("lambda_depth", lambda_depth, "weight of the depth prior");
    v("lambda_normal", lambda_normal, "weight of the normal prior");
    v("lambda_consistency", lambda_consistency, "weight of normal consistency");
    v("lambda_smooth", lambda_smooth, "weight of edge-aware normal smoothness");
    v("lambda_transparency", lambda_transparency, "weight of transparency guidance");
    v("gate_from", gate_from, "first iteration of the normal prior's gate (of 60,000)");
    v("smooth_from", smooth_from, "first iteration of normal smoothness (of 60,000)");
    v("transparency_from", transparency_from, "first iteration of guidance (of 60,000)");
    v("min_cosine", min_cosine, "tau_n: the gate of the normal prior");
    v("depth_threshold", depth_threshold, "tau_d: metres between the layers at glass");
    v("low_albedo", low_albedo, "gamma_a: albedo of glass lies below");
    v("reflection_gradient", reflection_gradient, "densification threshold of the reflection set");
    v("reset_secondary", reset_secondary, "opacity resets of transmission and reflection too");
    densify.visit(v);
  }
  int cells_for(ImageSize size) const {
    const double points =
        static_cast<double>(reflection_points_per_pixel) * static_cast<double>(size.num_pixels());
    return std::clamp(
        static_cast<int>(std::lround(std::cbrt(points / points_per_cell))), 1, reflection_cells
    );
  }
  // Windows of this run.
  void scale_to(int iterations) {
    const auto scaled = [&](int published, int at_least = 1) {
      return scaled_step(published, iterations, at_least, kPublishedIterations);
    };
    for (int* window :
         {&joint_from,
          &freeze_from,
          &sh_interval,
          &gate_from,
          &smooth_from,
          &transparency_from,
          &densify.from,
          &densify.until})
      *window = scaled(*window);
    densify.interval = scaled(densify.interval, 50);
    densify.reset_interval = scaled(densify.reset_interval, 300);
    rates.means_steps = scaled(rates.means_steps);
  }
};

// Uniform points in the cells of the scene's bounds [Na26 supplement]; dark, as in the release.
PointCloud reflection_points(const Scene& scene, int cells, int per_cell, std::uint64_t seed) {
  Rng rng(seed, hash_name("reflection points"));
  const Vec3f cell = (1.0f / static_cast<float>(cells)) * (scene.bounds_max - scene.bounds_min);
  PointCloud points;
  for (int z = 0; z < cells; ++z)
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x)
        for (int i = 0; i < per_cell; ++i) {
          const Vec3f place{
              static_cast<float>(x) + rng.uniform(),
              static_cast<float>(y) + rng.uniform(),
              static_cast<float>(z) + rng.uniform()};
          points.positions.push_back(scene.bounds_min + hadamard(place, cell));
          points.colors.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
        }
  return points;
}

// The colour channels of a rasterised interface.
void copy_color(const Image& features, Image& color) {
  if (color.size() != features.size()) color = Image(features.width(), features.height(), 3);
  for (std::size_t i = 0; i < color.num_pixels(); ++i)
    std::copy_n(features.data() + i * features.channels(), 3, color.data() + 3 * i);
}

void clear(Image& image, ImageSize size, int channels) {
  if (image.size() != size || image.channels() != channels)
    image = Image(size.width, size.height, channels);
  else
    std::fill(image.values().begin(), image.values().end(), 0.0f);
}

class Glint final : public Method {
 public:
  explicit Glint(const Json& overrides) {
    config_from_json(config_, overrides, "glint");
    GLINT_CHECK(
        config_.transmission == "raster" || config_.transmission == "trace",
        kUsage,
        "glint: transmission is '{}', expected raster or trace",
        config_.transmission
    );
  }

  void initialize(const Scene& scene, const RunOptions& options) override {
    scene_ = &scene;
    windows_ = config_;
    windows_.scale_to(options.iterations);
    switch_off_missing_priors();
    const PointCloud points = initial_points(scene, config_.random_points, options.seed);
    interface_ = new_set(points, options.seed, true, windows_.densify);
    DensifyConfig secondary = windows_.densify;
    if (!config_.reset_secondary) secondary.reset_interval = options.iterations + 1;
    transmission_ = new_set(points, options.seed + 1, false, secondary);
    DensifyConfig traced = secondary;
    traced.gradient_threshold = config_.reflection_gradient;
    reflection_ = new_set(
        reflection_points(
            scene,
            config_.cells_for(scene.train.front().camera.size()),
            config_.points_per_cell,
            options.seed
        ),
        options.seed + 2,
        false,
        traced
    );
    views_ = ViewSampler(scene.train.size(), options.seed);
  }

  StepStats step(int iteration) override {
    const View& view = scene_->train[views_.next()];
    StepStats stats;
    stats.iteration = iteration;
    set_phase(iteration);
    render_sets(view.camera);
    const Image& image = transport_.compose(layers_);
    clear_gradients(view.camera.size());
    const PhotometricWeights weights{1 - config_.lambda_ssim, config_.lambda_ssim};
    const PhotometricTerms photo = photometric_.evaluate(image, view.rgb, weights, dL_dimage_);
    stats.terms["photometric"] = photo.weighted(weights);
    stats.psnr = -10 * std::log10(std::max(photo.mse, 1e-10));
    if (!frozen_) add_geometry_losses(view, iteration, stats);
    if (joint_ && !frozen_ && iteration >= windows_.transparency_from) add_guidance(view, stats);
    for (const auto& [name, value] : stats.terms) stats.loss += value;
    backward(view.camera);
    update(iteration);
    stats.num_surfels = num_surfels();
    return stats;
  }

  RenderOutput render(const Camera& camera) const override {
    // Rendering needs the same buffers as training: a copy keeps this call const.
    Glint copy(config_, *this);
    copy.render_sets(camera);
    RenderOutput out;
    const GlassBuffer& buffer = copy.transport_.buffer();
    out.rgb = copy.transport_.compose(copy.layers_);
    out.depth = buffer.depth;
    out.normal = buffer.normal;
    out.alpha = copy.interface_out_->alpha;
    out.layers["transparency"] = buffer.transparency;
    out.layers["specularity"] = buffer.mirrored;
    out.layers["interface"] = copy.layers_.interface;
    if (config_.with_transmission) out.layers["transmission"] = copy.layers_.transmission;
    if (config_.with_transmission) out.layers["behind_depth"] = copy.transmission_depth(camera);
    if (config_.with_reflection) out.layers["reflection"] = copy.layers_.reflection;
    copy.add_components(out);
    return out;
  }

  void save(const std::string& folder) const override {
    write_surfel_ply(fs::path(folder) / "interface.ply", interface_.cloud());
    write_surfel_ply(fs::path(folder) / "transmission.ply", transmission_.cloud());
    write_surfel_ply(fs::path(folder) / "reflection.ply", reflection_.cloud());
  }
  void load(const std::string& folder) override {
    const auto read = [&](const char* name) {
      return SurfelSet(read_surfel_ply(fs::path(folder) / name), {}, {}, 1, 0);
    };
    interface_ = read("interface.ply");
    transmission_ = read("transmission.ply");
    reflection_ = read("reflection.ply");
    GLINT_CHECK(
        interface_.cloud().extra_names == std::vector<std::string>({"transparency", "specular"}),
        kBadPrediction,
        "{}/interface.ply: expected the extra fields transparency and specular; was it trained by "
        "another method?",
        folder
    );
    joint_ = true;
    interface_degree_ = secondary_degree_ = 3;
    transport_ = GlassTransport(joint_options());
  }
  Json config() const override { return config_to_json(config_); }
  void check_finite() const override {
    glint::check_finite(interface_.cloud(), "interface");
    glint::check_finite(transmission_.cloud(), "transmission");
    glint::check_finite(reflection_.cloud(), "reflection");
  }
  std::size_t num_surfels() const override {
    return interface_.cloud().size() + transmission_.cloud().size() + reflection_.cloud().size();
  }
  std::vector<std::string> warnings() const override { return warnings_; }

 private:
  Glint(const GlintConfig& config, const Glint& from) : config_(config) {
    for (auto [to, set] :
         {std::pair{&interface_, &from.interface_},
          {&transmission_, &from.transmission_},
          {&reflection_, &from.reflection_}})
      *to = SurfelSet(set->cloud(), {}, {}, 1, 0);
    joint_ = from.joint_;
    interface_degree_ = from.interface_degree_;
    secondary_degree_ = from.secondary_degree_;
    transport_ = GlassTransport(joint_ ? joint_options() : GlassOptions{config_.f0, false, false});
  }

  GlassOptions joint_options() const {
    return {config_.f0, config_.with_transmission, config_.with_reflection, config_.detach_origins};
  }
  SurfelSet new_set(
      const PointCloud& points, std::uint64_t seed, bool is_interface, const DensifyConfig& densify
  ) const {
    InitialSurfels initial;
    initial.seed = seed;
    if (is_interface) {
      initial.extra_names = {"transparency", "specular"};
      initial.extra_values = {config_.initial_transparency, config_.initial_specular};
    }
    return SurfelSet(
        surfels_from_points(points, initial), windows_.rates, densify, scene_->spatial_scale, seed
    );
  }
  void switch_off_missing_priors() {
    const auto missing = [&](Image Priors::*field) {
      return std::any_of(scene_->train.begin(), scene_->train.end(), [&](const View& view) {
        return (view.priors.*field).empty();
      });
    };
    const auto require =
        [&](Image Priors::*field, float& weight, const char* prior, const char* loss) {
          if (weight == 0 || !missing(field)) return;
          weight = 0;
          warnings_.push_back(
              fmt::format("glint: {} has no {} prior; {} is off", scene_->name, prior, loss)
          );
        };
    warnings_ = {"glint: LPIPS is off: its network is not built in"};
    if (scene_->points.positions.empty())
      warnings_.push_back(
          fmt::format("glint: {} has no points; starts from random ones", scene_->name)
      );
    require(&Priors::depth, windows_.lambda_depth, "depth", "L_depth");
    require(&Priors::normal, windows_.lambda_normal, "normal", "L_normal");
    require(&Priors::albedo, windows_.lambda_transparency, "albedo", "L_trans");
    if (!config_.with_transmission) windows_.lambda_transparency = 0;
  }

  void set_phase(int iteration) {
    const bool joint = iteration >= windows_.joint_from;
    if (joint != joint_ || iteration == 0) {
      joint_ = joint;
      transport_ = GlassTransport(joint ? joint_options() : GlassOptions{config_.f0, false, false});
    }
    frozen_ = iteration >= windows_.freeze_from;
    interface_degree_ = std::min(3, iteration / windows_.sh_interval);
    secondary_degree_ = std::clamp((iteration - windows_.joint_from) / windows_.sh_interval, 0, 3);
  }

  TraceSettings mirror_settings() const {
    TraceSettings settings;
    settings.min_transmittance = config_.mirror_transmittance;
    settings.max_hits = config_.mirror_hits;
    return settings;
  }

  // ---- forward ----
  void render_sets(const Camera& camera) {
    interface_out_ = &interface_.forward(camera, interface_degree_, settings_);
    const GlassBuffer& buffer = transport_.read_interface(camera, *interface_out_);
    copy_color(interface_out_->features, layers_.interface);
    if (!joint_) return;
    if (config_.with_transmission) render_transmission(camera, buffer);
    if (config_.with_reflection)
      layers_.reflection =
          reflection_.trace(buffer.reflected, secondary_degree_, mirror_settings()).color;
  }
  void render_transmission(const Camera& camera, const GlassBuffer& buffer) {
    near_limit_ = buffer.depth;
    for (float& z : near_limit_.values()) z += z > 0 ? config_.secondary_near : 0;
    if (config_.transmission == "trace") {
      through_ = camera_rays(camera);
      // Rays start at the camera: the parameter of a ray with z = 1 is depth, so the limit is the
      // origin's shift.
      for (std::size_t i = 0; i < near_limit_.num_pixels(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
          through_.origins.data()[3 * i + k] +=
              near_limit_.data()[i] * through_.directions.data()[3 * i + k];
      layers_.transmission = transmission_.trace(through_, secondary_degree_, {}).color;
      return;
    }
    transmission_out_ = &transmission_.forward(camera, secondary_degree_, settings_, near_limit_);
    layers_.transmission = transmission_out_->features;
  }
  // Depth of the transmission set behind the interface; where nothing is, the interface's.
  Image transmission_depth(const Camera& camera) {
    Image depth;
    const RasterOutput& out =
        transmission_.forward(camera, secondary_degree_, settings_, near_limit_);
    expected_depth_map(out, depth);
    for (std::size_t i = 0; i < depth.num_pixels(); ++i)
      if (depth.data()[i] <= 0) depth.data()[i] = transport_.buffer().depth.data()[i];
    return depth;
  }
  void add_components(RenderOutput& out) const {
    const GlassBuffer& buffer = transport_.buffer();
    Image transmitted = layers_.transmission, reflected = layers_.reflection;
    for (std::size_t i = 0; i < transmitted.values().size(); ++i)
      transmitted.values()[i] *=
          (1 - buffer.mirrored.data()[i / 3]) * buffer.transparency.data()[i / 3];
    for (std::size_t i = 0; i < reflected.values().size(); ++i)
      reflected.values()[i] *= buffer.mirrored.data()[i / 3];
    if (config_.with_transmission) out.layers["transmitted"] = std::move(transmitted);
    if (config_.with_reflection) out.layers["reflected"] = std::move(reflected);
  }

  // ---- losses ----
  void clear_gradients(ImageSize size) {
    clear(dL_dimage_, size, 3);
    clear(dL_dinterface_.features, size, kInterfaceChannels);
    clear(dL_dinterface_.normal, size, 3);
    clear(dL_dinterface_.alpha, size, 1);
    clear(dL_dinterface_.depth_sum, size, 1);
    clear(dL_ddepth_, size, 1);
    clear(dL_dtransparency_, size, 1);
  }
  void add_geometry_losses(const View& view, int iteration, StepStats& stats) {
    const GlassBuffer& buffer = transport_.buffer();
    const auto add = [&](const char* name, float weight, auto&& evaluate) {
      if (weight > 0) stats.terms[name] = static_cast<double>(weight) * evaluate(weight);
    };
    add("depth", windows_.lambda_depth, [&](float w) {
      return depth_prior_.evaluate(buffer.depth, view.priors.depth, {}, w, dL_ddepth_);
    });
    normal_prior_.min_cosine =
        iteration >= windows_.gate_from ? config_.min_cosine : NormalPriorLoss::kNoGate;
    add("normal", windows_.lambda_normal, [&](float w) {
      return normal_prior_.evaluate(
          interface_out_->normal, view.priors.normal, {}, w, dL_dinterface_.normal
      );
    });
    add("consistency", config_.lambda_consistency, [&](float w) {
      return consistency_.evaluate(
          view.camera,
          interface_out_->normal,
          buffer.depth,
          interface_out_->alpha,
          w,
          dL_dinterface_.normal,
          dL_ddepth_
      );
    });
    if (iteration >= windows_.smooth_from)
      add("smooth", config_.lambda_smooth, [&](float w) {
        return smoothness_.evaluate(interface_out_->normal, view.rgb, w, dL_dinterface_.normal);
      });
    for (std::size_t i = 0; i < dL_ddepth_.num_pixels(); ++i)
      expected_depth_vjp(
          interface_out_->depth_sum.data()[i],
          interface_out_->alpha.data()[i],
          dL_ddepth_.data()[i],
          dL_dinterface_.depth_sum.data()[i],
          dL_dinterface_.alpha.data()[i]
      );
  }
  void add_guidance(const View& view, StepStats& stats) {
    if (windows_.lambda_transparency <= 0) return;
    ActivatedSurfels activated;
    activate(
        transmission_.cloud(), cast<float>(view.camera.center()), secondary_degree_, activated
    );
    RasterOutput out;
    depth_rasterizer_.forward(
        raster_input(transmission_.cloud(), activated), view.camera, settings_, out
    );
    expected_depth_map(out, z_trans_);
    TransparencyGuidance guidance = TransparencyGuidance::paper();
    guidance.depth_threshold = config_.depth_threshold;
    guidance.low_albedo = config_.low_albedo;
    TransparencyCues cues;
    cues.interface_depth = transport_.buffer().depth;
    cues.transmission_depth = z_trans_;
    cues.albedo = view.priors.albedo;
    stats.terms["transparency"] =
        static_cast<double>(windows_.lambda_transparency) * guidance.evaluate(
                                                                transport_.buffer().transparency,
                                                                guidance.masks(cues),
                                                                windows_.lambda_transparency,
                                                                dL_dtransparency_
                                                            );
  }

  // ---- backward ----
  void backward(const Camera& camera) {
    const GlassLayers& g = transport_.compose_vjp(layers_, dL_dimage_);
    const Rays* dL_drays = nullptr;
    if (joint_ && config_.with_reflection) {
      dL_dtrace_.color = g.reflection;
      dL_drays = &reflection_.trace_backward(
          transport_.buffer().reflected, secondary_degree_, mirror_settings(), dL_dtrace_
      );
    }
    if (joint_ && config_.with_transmission) transmission_vjp(camera, g.transmission);
    if (frozen_) return;
    transport_.interface_vjp(camera, *interface_out_, dL_drays, dL_dtransparency_, dL_dinterface_);
    interface_.backward(camera, interface_degree_, settings_, dL_dinterface_);
  }
  void transmission_vjp(const Camera& camera, const Image& dL_dradiance) {
    if (config_.transmission == "trace") {
      dL_dtrace_.color = dL_dradiance;
      transmission_.trace_backward(through_, secondary_degree_, {}, dL_dtrace_);
      return;
    }
    dL_dtransmission_.features = dL_dradiance;
    transmission_.backward(camera, secondary_degree_, settings_, dL_dtransmission_, near_limit_);
  }
  // The secondary sets count steps from where they start.
  void update(int iteration) {
    if (!frozen_) interface_.update(iteration + 1);
    if (!joint_) return;
    const int step = iteration - windows_.joint_from + 1;
    if (config_.with_transmission) transmission_.update(step);
    if (config_.with_reflection) reflection_.update(step);
  }

  GlintConfig config_, windows_;
  const Scene* scene_ = nullptr;
  std::vector<std::string> warnings_;
  SurfelSet interface_, transmission_, reflection_;
  ViewSampler views_;
  bool joint_ = false, frozen_ = false;
  int interface_degree_ = 3, secondary_degree_ = 3;
  RasterSettings settings_;
  GlassTransport transport_;
  const RasterOutput *interface_out_ = nullptr, *transmission_out_ = nullptr;
  GlassLayers layers_;
  Image near_limit_, z_trans_;
  Rays through_;
  Rasterizer depth_rasterizer_;
  PhotometricLoss photometric_;
  DepthPriorLoss depth_prior_;
  NormalPriorLoss normal_prior_;
  NormalConsistencyLoss consistency_;
  NormalSmoothnessLoss smoothness_;
  Image dL_dimage_, dL_ddepth_, dL_dtransparency_;
  RasterOutputGradient dL_dinterface_, dL_dtransmission_;
  TraceOutputGradient dL_dtrace_;
};

MethodSpec glint_spec(
    const char* id,
    const char* title,
    const char* row,
    const char* description,
    Json overrides = Json::object()
) {
  MethodSpec spec;
  spec.id = id;
  spec.title = title;
  spec.citation = "na2026glint";
  spec.paper_row = row;
  spec.description = description;
  spec.overrides = std::move(overrides);
  spec.create = [](const Json& config) { return std::make_unique<Glint>(config); };
  return spec;
}

}  // namespace

GLINT_REGISTER(glint_spec("glint", "GLINT", "GLINT", "interface, transmission and reflection sets"))
GLINT_REGISTER(glint_spec(
    "glint/no-trans",
    "w/o G_trans",
    "w/o G_trans",
    "no transmission set: t counts as 0",
    {{"with_transmission", false}}
))
GLINT_REGISTER(glint_spec(
    "glint/no-refl",
    "w/o G_refl",
    "w/o G_refl",
    "no reflection set: k_s counts as 0",
    {{"with_reflection", false}}
))
GLINT_REGISTER(glint_spec(
    "glint/no-ltrans",
    "w/o L_trans",
    "w/o L_trans",
    "no transparency guidance",
    {{"lambda_transparency", 0.0}}
))
GLINT_REGISTER(glint_spec(
    "glint/no-lnormal", "w/o L_normal", "w/o L_normal", "no normal prior", {{"lambda_normal", 0.0}}
))
GLINT_REGISTER(glint_spec(
    "glint/no-ldepth", "w/o L_depth", "w/o L_depth", "no depth prior", {{"lambda_depth", 0.0}}
))
GLINT_REGISTER(glint_spec(
    "glint/no-lgeo",
    "w/o L_geo",
    "w/o L_geo",
    "neither normal nor depth prior",
    {{"lambda_normal", 0.0}, {"lambda_depth", 0.0}}
))

}  // namespace glint
