// SPDX-License-Identifier: MIT
// EnvGS [Xie25]: "EnvGS: Modeling View-Dependent Appearance with Environment Gaussian", CVPR 2025.
// A base set of surfels with a specularity s, rasterised, and an environment set traced along the
// mirrored rays: rgb = (1 - s) base + s environment, without Fresnel. L1 + SSIM, normal
// consistency, a monocular normal prior.
//
// Deviations: schedules of the published 40,000 iterations are scaled to the run; LPIPS is off
// where the user has no weights; SH see unit directions; the grid of the environment and the end of
// mirrored rays are those of GLINT here (ReflectionGrid, MirrorCutoffs); no pruning for opacity
// soon after an opacity reset (DensifyConfig::prune_holiday); surfels that a densification adds are
// not dropped by its cap, having no weights yet; normals get all of the gradient of the mirrored
// direction, of which the official tracer keeps the last hit's SH part; positions of the
// environment slow down by its own steps and the extent (there by the run's, and the extent
// squared); every pixel is traced. The real-scene setting: a synthetic one differs in windows and
// in the initial s, and weighs all depths alike.
//
// "envgs/simple" leaves out what the other baselines have no counterpart of: colour sabotage,
// normal propagation, resets of the environment and of s, splitting in five, caps by visibility,
// the slow window of densification, near-weighted consistency.
#include <algorithm>
#include <cmath>

#include "glint/render/glass_transport.h"
#include "glint/render/map_ops.h"
#include "glint/surfel_method.h"
#include "glint/train/geometry_losses.h"
#include "glint/train/initial_points.h"
#include "glint/train/mirrored_layer.h"
#include "glint/train/perceptual.h"
#include "glint/train/photometric.h"
#include "glint/train/reflection_bootstrap.h"
#include "glint/train/trainer.h"

namespace glint {

namespace {

constexpr int kPublishedIterations = 40000;

struct EnvGsConfig {
  float lambda_ssim = 0.2f;
  PerceptualConfig perceptual;
  float initial_specular = 1e-3f;
  int random_points = 30000;
  int environment_from = 3000, sh_interval = 1000;
  ReflectionGrid grid;
  MirrorCutoffs mirror;
  GeometryLossConfig geometry;
  DensifyConfig densify;
  bool reset_specular = true;
  BootstrapConfig bootstrap;
  // Density control of the environment; its steps are counted from `environment_clock` on.
  float environment_gradient = 1e-4f;
  int environment_clock = 0;
  int environment_densify_from = 3000, environment_densify_until = 21000;
  int environment_densify_interval = 500, environment_reset_interval = 6000;
  bool reset_environment = true;
  int environment_max_surfels = 700000;
  SurfelRates rates;
  float rate_specular = 0.01f;

  EnvGsConfig() {
    geometry.lambda_consistency = 0.04f;
    geometry.lambda_normal = 0.01f;
    geometry.normal_l1 = 1;
    geometry.near_first = geometry.near_consistency = true;
    geometry.min_cosine = NormalPriorLoss::kNoGate;
    perceptual.lpips_from = 21000;
    perceptual.lpips_unit_range = true;  // as its code does
    densify.until = 21000;
    densify.slow_interval = 500;
    densify.split_large = densify.cap_by_visibility = true;
    densify.max_surfels = 2000000;
    grid.brightness = 1.0f / 255;  // as its code has it: black, but for what random numbers say
    mirror.share_below = 0;        // it would cost the mirrored part 0.2 dB (docs/design/tried.md)
    bootstrap.color_sabotage = bootstrap.normal_propagation = true;
  }
  template <class V>
  void visit(V&& v) {
    v("lambda_ssim", lambda_ssim, "weight of 1 - SSIM against L1");
    perceptual.visit(v);
    v("initial_specular", initial_specular, "s of the initial surfels");
    v("random_points", random_points, "initial surfels of scenes without points");
    v("environment_from", environment_from, "first iteration with the environment (of 40,000)");
    v("sh_interval", sh_interval, "iterations per SH degree (of 40,000)");
    grid.visit(v);
    mirror.visit(v);
    geometry.visit(v);
    v("near_consistency", geometry.near_consistency, "normal consistency weighs near pixels more");
    densify.visit(v);
    v("densify_slow_interval",
      densify.slow_interval,
      "steps between densifications of the base in the middle of a run; 0: as ever");
    v("split_large", densify.split_large, "large surfels are split in five, least seen ones pruned"
    );
    v("cap_by_visibility", densify.cap_by_visibility, "above 0.9 x max_surfels those least seen go"
    );
    rates.visit(v);
    v("rate_specular", rate_specular, "learning rate of specularity");
    v("reset_specular", reset_specular, "opacity resets lower s to its initial value, too");
    bootstrap.visit(v);
    v("environment_gradient", environment_gradient, "densification threshold of the environment");
    v("environment_clock", environment_clock, "iteration its density control counts from");
    v("environment_densify_from", environment_densify_from, "iteration of 40,000");
    v("environment_densify_until", environment_densify_until, "iteration of 40,000, exclusive");
    v("environment_densify_interval", environment_densify_interval, "steps, of the environment");
    v("environment_reset_interval", environment_reset_interval, "steps, of the environment");
    v("reset_environment", reset_environment, "opacity resets of the environment, too");
    v("environment_max_surfels", environment_max_surfels, "max_surfels of the environment");
  }
  void scale_to(int iterations) {
    const auto scaled = [&](int published, int at_least = 1) {
      return scaled_step(published, iterations, at_least, kPublishedIterations);
    };
    for (int* window : {&environment_from, &sh_interval, &perceptual.lpips_from})
      *window = scaled(*window);
    environment_densify_from = scaled(environment_densify_from, 0);
    environment_densify_until = scaled(environment_densify_until, 0);
    environment_clock = scaled(environment_clock, 0);
    const double shortening = static_cast<double>(kPublishedIterations) / iterations;
    rates = rates.for_shorter_run(shortening);
    // Sabotage and propagation ask for it 100 steps after a reset, not 1000.
    rate_specular *= faster_rates(shortening);
    geometry.scale(scaled);
    densify.scale(scaled);
    bootstrap.scale(scaled);
    environment_densify_interval = scaled(environment_densify_interval, 50);
    // At least 300 steps for each published 3000, as the base has them.
    environment_reset_interval =
        scaled(environment_reset_interval, environment_reset_interval / 10);
  }
  // Of the base, in a run's windows. s is first reset with the second reset of opacities.
  DensifyConfig base_densify(std::size_t training_views) const {
    DensifyConfig config = densify;
    const int second = densify.for_views(training_views).reset_interval + 1;
    if (reset_specular) config.channel_resets = {{kSpecular, initial_specular, second}};
    return config;
  }
  // Of the environment, in a run's windows.
  DensifyConfig environment_densify(ImageSize size) const {
    DensifyConfig config = densify;
    config.max_scale *= grid.coarseness(size);
    config.from = environment_densify_from - environment_clock;
    config.until = environment_densify_until - environment_clock;
    config.interval = environment_densify_interval;
    config.slow_interval = 0;
    config.wait_from(environment_from - environment_clock);
    config.gradient_threshold = environment_gradient;
    config.reset_interval = environment_reset_interval;
    config.resets = densify.resets && reset_environment;
    config.max_surfels = environment_max_surfels;
    return config;
  }
};

class EnvGs final : public MethodOf<EnvGsConfig> {
 public:
  explicit EnvGs(EnvGsConfig config) : MethodOf(std::move(config)) {
    sets_ = {{"interface", &base_}, {"reflection", &environment_}};
  }

  void initialize(const Scene& scene, const RunOptions& options) override {
    scene_ = &scene;
    windows_ = config_;
    windows_.scale_to(options.iterations);
    set_up_losses();
    InitialSurfels initial;
    initial.seed = options.seed;
    initial.extra = {{kSpecular, config_.initial_specular, windows_.rate_specular}};
    const PointCloud points = initial_points(scene, config_.random_points, options.seed);
    base_ = new_set(points, initial, windows_.base_densify(scene.train.size()));
    initial = {};
    initial.seed = options.seed + 2;
    const PointCloud grid = config_.grid.points(scene, options.seed);
    environment_ =
        new_set(grid, initial, windows_.environment_densify(scene.train.front().camera.size()));
    bootstrap_ = ReflectionBootstrap(windows_.bootstrap, options.seed);
    views_ = ViewSampler(scene.train.size(), options.seed);
  }

  StepStats step(int iteration) override {
    const View& view = scene_->train[views_.next()];
    StepStats stats;
    stats.iteration = iteration;
    with_environment_ = iteration >= windows_.environment_from;
    base_degree_ = std::min(3, iteration / windows_.sh_interval);
    environment_degree_ =
        std::clamp((iteration - windows_.environment_from) / windows_.sh_interval, 0, 3);
    const Image& image = forward(view.camera, iteration);
    clear_gradient(view.camera.size(), base_output_->features.channels(), dL_dbase_);
    clear_image(dL_dimage_, view.camera.size(), 3);
    const PhotometricWeights weights{1 - config_.lambda_ssim, config_.lambda_ssim};
    const PhotometricTerms photo = photometric_.evaluate(image, view, weights, dL_dimage_);
    stats.terms["photometric"] = photo.weighted(weights);
    stats.psnr = photo.psnr();
    add_perceptual(
        perceptual_.get(), windows_.perceptual, iteration, image, view, dL_dimage_, stats
    );
    geometry_.add(view, iteration, *base_output_, transport_.buffer().depth, dL_dbase_, stats);
    for (const auto& [name, value] : stats.terms) stats.loss += value;
    backward(view.camera);
    note_reset(base_.update(iteration + 1), "base", stats);
    bootstrap_.update(iteration + 1, base_);
    if (with_environment_) {
      const int clock = iteration - windows_.environment_clock + 1;
      note_reset(environment_.update(clock), "environment", stats);
    }
    stats.sets = {{"base", base_.cloud().size()}, {"environment", environment_.cloud().size()}};
    stats.num_surfels = num_surfels();
    return stats;
  }

  MapSet render(const Camera& camera) override {
    MapSet out;
    out["rgb"] = forward(camera, step_of_render());
    const GlassBuffer& buffer = transport_.buffer();
    out["depth"] = buffer.depth;
    out["normal"] = buffer.normal;
    add_depth_estimates(*base_output_, out);
    add_depth_modes(base_.pass().rasterizer, out);
    out["specularity"] = buffer.specularity;
    out["interface"] = layers_.interface;
    if (!with_environment_) return out;
    out["reflection"] = layers_.reflection;
    Image& reflected = out["reflected"] = layers_.reflection;
    for (std::size_t i = 0; i < reflected.values().size(); ++i)
      reflected.values()[i] *= buffer.specularity.data()[i / 3];
    return out;
  }

  const Image& picture(const Camera& camera) override { return forward(camera, step_of_render()); }
  void render_quickly(bool quickly) override { quickly_ = quickly; }

  void load(const std::string& folder) override {
    MethodOf::load(folder);
    check_channels(folder, {kSpecular});
    with_environment_ = true;
    base_degree_ = environment_degree_ = 3;
  }
  std::vector<std::string> inputs() const override {
    std::vector<std::string> inputs;
    config_.geometry.add_inputs(inputs);
    config_.perceptual.add_inputs(inputs);
    return inputs;
  }
  bool visit_state(TrainingState& state) override {
    state("views", views_);
    state("bootstrap", bootstrap_);
    return MethodOf::visit_state(state);
  }

 private:
  TrainableSet new_set(
      const PointCloud& points, const InitialSurfels& initial, const DensifyConfig& densify
  ) const {
    return TrainableSet(points, initial, training_on(*scene_, windows_.rates, densify));
  }
  void set_up_losses() {
    warnings_ = geometry_.set_up(windows_.geometry, *scene_, "envgs");
    perceptual_ = wanted_perceptual_loss(windows_.perceptual, *scene_, "envgs", warnings_);
    warn_without_points(*scene_, "envgs", warnings_);
  }

  // Quick renders share mirrored rays, as training does.
  std::optional<int> step_of_render() const {
    return quickly_ ? std::optional<int>(MirrorCutoffs::kSharingStep) : std::nullopt;
  }
  // step: of training, or none.
  const Image& forward(const Camera& camera, std::optional<int> step = {}) {
    GlassOptions options;
    options.channels = interface_channels(base_.cloud());
    options.transmission = options.fresnel = false;
    options.reflection = with_environment_;
    transport_.set_options(options);
    base_output_ = &base_.forward(camera, base_degree_);
    const GlassBuffer& buffer = transport_.read_interface(camera, *base_output_);
    copy_color(base_output_->features, layers_.interface);
    if (with_environment_)
      mirrored_.trace(
          buffer, environment_, environment_degree_, config_.mirror, step, layers_.reflection
      );
    return transport_.compose(layers_);
  }
  void backward(const Camera& camera) {
    const GlassLayers& dL_dlayers = transport_.compose_vjp(layers_, dL_dimage_);
    const Rays* dL_drays = nullptr;
    if (with_environment_)
      dL_drays = &mirrored_.trace_backward(environment_, dL_dlayers.reflection);
    transport_.interface_vjp(camera, *base_output_, dL_drays, {}, dL_dbase_);
    base_.backward(dL_dbase_);
  }

  EnvGsConfig windows_;
  const Scene* scene_ = nullptr;
  ViewSampler views_;
  TrainableSet base_, environment_;
  ReflectionBootstrap bootstrap_;
  bool quickly_ = false;
  bool with_environment_ = true;  // step() says; when nothing is left to train: all there is
  int base_degree_ = 3, environment_degree_ = 3;
  GlassTransport transport_;
  const RasterOutput* base_output_ = nullptr;
  GlassLayers layers_;
  PhotometricLoss photometric_;
  std::unique_ptr<PerceptualLoss> perceptual_;
  GeometryLosses geometry_;
  Image dL_dimage_;
  RasterOutputGradient dL_dbase_;
  MirroredLayer mirrored_;
};

// As the other methods' density control has it, to see what the rest does.
void simplify(EnvGsConfig& config) {
  config.bootstrap.color_sabotage = config.bootstrap.normal_propagation = false;
  config.reset_specular = config.reset_environment = false;
  config.densify.split_large = config.densify.cap_by_visibility = false;
  config.densify.max_surfels = config.environment_max_surfels = 1000000;
  config.densify.slow_interval = 0;
  config.environment_clock = 3000;
  config.environment_densify_from = 3500;
  config.environment_densify_until = 24000;
  config.environment_reset_interval = 3000;
  config.geometry.near_consistency = false;
}

[[maybe_unused]] const bool registered = register_methods<EnvGs>(
    __FILE__,
    "xie2025envgs",
    {{"envgs", "EnvGS", "EnvGS", "a base set with specularity and an environment set, traced"},
     {"envgs/simple",
      "EnvGS (simplified)",
      "",
      "EnvGS without what helps its environment along, density control as in 2DGS",
      simplify},
     // Control: priors alone may explain a gain. The losses, weights and gate of GLINT's priors.
     {"envgs/prior",
      "EnvGS + priors",
      "",
      "EnvGS with the depth and normal priors of GLINT",
      [](EnvGsConfig& config) { config.geometry.use_priors(kPublishedIterations); }}}
);

}  // namespace

}  // namespace glint
