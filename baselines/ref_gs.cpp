// SPDX-License-Identifier: MIT
// Ref-GS [Zhang25]: "Ref-GS: Directional Factorization for 2D Gaussian Splatting", CVPR 2025.
// Surfels carry albedo, roughness and a feature in place of a colour; these are rasterised, and
// each pixel is shaded: the mirrored direction is looked up in a learned map of directions at the
// level of the roughness, joined with the feature by an outer product, and decoded to specular
// radiance (SpecularField). rgb = sRGB(albedo + specular). L1 + SSIM, normal consistency, entropy
// of the opacities in view. The first iterations are plain 2DGS with spherical harmonics.
//
// The recipe is that of its real scenes, where a sphere tuned by hand parts what is shaded from
// what keeps its spherical harmonics. Here nothing is tuned: everything counts as inside, so the
// weight of the harmonics' picture and its loss are zero, and the picture is the shaded colour over
// a background, random in training and black in renders, with a gradient for alpha: the recipe of
// its synthetic scenes. Times an alpha that is held constant, as the blended weight of the inside
// is in the real ones, our one run ended without a surfel.
//
// Deviations: the map has 64 rows and the network 64 hidden values, for CPUs, which notes() say
// (map_height=512 hidden=256 are the published ones); features start small and random, not at zero,
// where normalising them multiplies the first gradient by 1e12 and freezes Adam; schedules of the
// published 31,000 iterations are scaled to the run, and rates of a shorter one grow as those of
// colours do (SurfelRates::for_shorter_run); views are drawn with replacement, as published. A
// distant map cannot be right indoors: the paper's table has it far behind in rooms.
#include <algorithm>
#include <cmath>

#include "baselines/deferred/specular_field.h"
#include "baselines/ref_gs_kernels.h"
#include "glint/core/rng.h"
#include "glint/render/map_ops.h"
#include "glint/scene/ply.h"
#include "glint/surfel_method.h"
#include "glint/train/geometry_losses.h"
#include "glint/train/initial_points.h"
#include "glint/train/photometric.h"
#include "glint/train/trainer.h"

namespace glint {

namespace {

constexpr int kPublishedIterations = 31000;
constexpr std::size_t kGrain = 1024;  // pixels a block

struct RefGsConfig {
  float lambda_ssim = 0.2f;
  float lambda_entropy = 0.001f;
  int warm_up = 700, sh_interval = 1000;  // published iterations
  int random_points = 30000;
  float initial_scale = 0.31622777f;   // sqrt(0.1), of the distance to neighbours
  float initial_albedo = 0.02706706f;  // e^-2 / 5, real scenes
  float initial_roughness = 0.5f, feature_spread = 0.1f;
  float rate_albedo = 5e-4f, rate_roughness = 2e-3f, rate_feature = 2e-3f;
  SpecularFieldConfig field;
  GeometryLossConfig geometry;
  DensifyConfig densify;
  SurfelRates rates;

  RefGsConfig() {
    geometry.lambda_consistency = 0.05f;
    geometry.consistency_from = warm_up;
    geometry.unit_consistency = true;
    rates.sh_dc = 0.002f;
    rates.sh_rest = 1e-4f;
  }
  template <class V>
  void visit(V&& v) {
    v("lambda_ssim", lambda_ssim, "weight of 1 - SSIM against L1");
    v("lambda_entropy", lambda_entropy, "weight of the entropy of the opacities in view");
    v("warm_up", warm_up, "iterations with spherical harmonics alone (of 31,000)");
    v("sh_interval", sh_interval, "iterations per SH degree (of 31,000)");
    v("random_points", random_points, "initial surfels of scenes without points");
    v("initial_scale", initial_scale, "of initial surfels, of the distance to neighbours");
    v("initial_albedo", initial_albedo, "albedo of the initial surfels, linear");
    v("initial_roughness", initial_roughness, "roughness of the initial surfels");
    v("feature_spread", feature_spread, "standard deviation of initial raw features");
    v("rate_albedo", rate_albedo, "learning rate of albedo");
    v("rate_roughness", rate_roughness, "learning rate of roughness");
    v("rate_feature", rate_feature, "learning rate of features");
    field.visit(v);
    geometry.visit(v);
    densify.visit(v);
    rates.visit(v);
  }
  // Behind the colour, in this order; rates `faster` times as high.
  std::vector<ExtraChannel> channels(float faster) const {
    std::vector<ExtraChannel> extra;
    for (const char* name : {"albedo_0", "albedo_1", "albedo_2"})
      extra.push_back({name, initial_albedo, faster * rate_albedo, Activation::kCappedExp});
    extra.push_back({"roughness", initial_roughness, faster * rate_roughness});
    add_feature_channels(faster * rate_feature, feature_spread, extra);
    return extra;
  }
  void scale_to(int iterations) {
    const auto scaled = [&](int published, int at_least = 1) {
      return scaled_step(published, iterations, at_least, kPublishedIterations);
    };
    for (int* window : {&warm_up, &sh_interval}) *window = scaled(*window);
    densify.scale(scaled);
    geometry.scale(scaled);
    rates = rates.for_shorter_run(static_cast<double>(kPublishedIterations) / iterations);
  }
};

constexpr int kAlbedo = 3;                           // of the rasterised features
constexpr SpecularChannels kSpecularChannels{6, 7};  // roughness, feature

class RefGs final : public MethodOf<RefGsConfig> {
 public:
  explicit RefGs(RefGsConfig config) : MethodOf(std::move(config)) {
    sets_ = {{"interface", &set_}};
  }

  void initialize(const Scene& scene, const RunOptions& options) override {
    scene_ = &scene;
    windows_ = config_;
    windows_.scale_to(options.iterations);
    warnings_ = geometry_.set_up(windows_.geometry, scene, "ref-gs");
    warn_without_points(scene, "ref-gs", warnings_);
    faster_ = faster_rates(static_cast<double>(kPublishedIterations) / options.iterations);
    InitialSurfels initial;
    initial.seed = options.seed;
    initial.scale = config_.initial_scale;
    initial.extra = config_.channels(faster_);
    const PointCloud points = initial_points(scene, config_.random_points, options.seed);
    set_ = TrainableSet(points, initial, training_on(scene, windows_.rates, windows_.densify));
    field_ = new_field(options.seed);
    view_rng_ = Rng(options.seed, hash_name("views"));
    background_rng_ = Rng(options.seed, hash_name("backgrounds"));
  }

  StepStats step(int iteration) override {
    const View& view =
        scene_->train[view_rng_.below(static_cast<std::uint32_t>(scene_->train.size()))];
    deferred_ = iteration >= windows_.warm_up;
    sh_degree_ = std::min(3, iteration / windows_.sh_interval);
    for (int c = 0; c < 3; ++c) background_[c] = background_rng_.uniform();
    const Image& image = forward(view.camera);
    StepStats stats;
    stats.iteration = iteration;
    clear_gradient(view.camera.size(), output_->features.channels(), gradient_);
    clear_image(dL_dimage_, view.camera.size(), 3);
    const PhotometricWeights weights{1 - config_.lambda_ssim, config_.lambda_ssim};
    const PhotometricTerms photo = photometric_.evaluate(image, view, weights, dL_dimage_);
    stats.terms["photometric"] = photo.weighted(weights);
    stats.psnr = photo.psnr();
    expected_depth_map(*output_, depth_);
    geometry_.add(view, iteration, *output_, depth_, gradient_, stats);
    if (deferred_) add_entropy(stats);
    for (const auto& [name, value] : stats.terms) stats.loss += value;
    backward();
    note_reset(set_.update(iteration + 1), "", stats);
    stats.num_surfels = set_.cloud().size();
    return stats;
  }

  MapSet render(const Camera& camera) override {
    background_ = {};
    MapSet out;
    out["rgb"] = forward(camera);
    expected_depth_map(*output_, out["depth"]);
    out["normal"] = unit_normals(output_->normal);
    add_depth_estimates(*output_, out);
    add_depth_modes(set_.pass().rasterizer, out);
    if (!deferred_) return out;
    fit(out["interface"], camera.size(), 3);
    fit(out["reflection"], camera.size(), 3);
    const DeferredParts parts{
        pixels(), out["interface"].on_device(), out["reflection"].on_device()};
    run_kernel(camera.size().num_pixels(), kGrain, parts);
    return out;
  }

  const Image& picture(const Camera& camera) override {
    background_ = {};
    return forward(camera);
  }

  void save(const std::string& folder) const override {
    MethodOf::save(folder);
    field_.save(folder, deferred_ ? 1 : 0);
  }
  void load(const std::string& folder) override {
    const fs::path file = fs::path(folder) / "interface.ply";
    SurfelCloud cloud = read_surfel_ply(file);
    set_activations(config_.channels(1), file.string(), cloud);
    set_.load(std::move(cloud));
    field_ = new_field(0);  // of the config's sizes
    deferred_ = field_.load(folder, 2) == 1;
    sh_degree_ = 3;
  }
  std::vector<std::string> inputs() const override {
    std::vector<std::string> inputs;
    config_.geometry.add_inputs(inputs);
    return inputs;
  }
  void check_finite() const override {
    MethodOf::check_finite();
    field_.check_finite();
  }
  bool visit_state(TrainingState& state) override {
    state("field", field_);
    state("view_rng", view_rng_);
    state("background_rng", background_rng_);
    return MethodOf::visit_state(state);
  }
  std::vector<std::string> notes() const override { return config_.field.notes(); }

 private:
  SpecularField new_field(std::uint64_t seed) const {
    return SpecularField(config_.field, std::vector<float>(3, std::log(0.25f)), seed);
  }
  DeferredPixels pixels() const {
    return {
        output_->features.channels(),
        kAlbedo,
        output_->features.on_device(),
        output_->alpha.on_device(),
        field_.directions().on_device(),
        network_outputs_->on_device(),
        background_};
  }
  const Image& forward(const Camera& camera) {
    output_ = &set_.forward(camera, sh_degree_);
    if (!deferred_) {
      copy_color(output_->features, image_);
      return image_;
    }
    network_outputs_ = &field_.forward(camera, *output_, kSpecularChannels);
    fit(image_, camera.size(), 3);
    run_kernel(image_.num_pixels(), kGrain, ShadeDeferred{pixels(), image_.on_device()});
    return image_;
  }
  void backward() {
    if (!deferred_) {
      add_color(dL_dimage_, gradient_.features);
      return set_.backward(gradient_);
    }
    dL_doutputs_.resize(network_outputs_->size());
    run_kernel(
        image_.num_pixels(),
        kGrain,
        ShadeDeferredVjp{
            pixels(),
            dL_dimage_.on_device(),
            gradient_.features.on_device(),
            gradient_.alpha.on_device(),
            dL_doutputs_.on_device()}
    );
    field_.backward(dL_doutputs_, gradient_);
    set_.backward(gradient_);
    field_.step(faster_);  // now it is known whether the step is void
  }
  void add_entropy(StepStats& stats) {
    const float weight = config_.lambda_entropy;
    const double entropy = set_.penalise_opacity_entropy(weight, output_->in_view);
    stats.terms["entropy"] = static_cast<double>(weight) * entropy;
  }

  RefGsConfig windows_;
  const Scene* scene_ = nullptr;
  TrainableSet set_;
  SpecularField field_;
  Rng view_rng_{0}, background_rng_{0};
  Vec3f background_;
  float faster_ = 1;  // than the published rates
  bool deferred_ = true;
  int sh_degree_ = 3;
  const RasterOutput* output_ = nullptr;
  const FloatArray* network_outputs_ = nullptr;
  Image image_, depth_, dL_dimage_;
  FloatArray dL_doutputs_;
  PhotometricLoss photometric_;
  GeometryLosses geometry_;
  RasterOutputGradient gradient_;
};

[[maybe_unused]] const bool registered = register_methods<RefGs>(
    __FILE__,
    "zhang2025refgs",
    {{"ref-gs", "Ref-GS", "Ref-GS", "deferred shading by a learned map of directions"}}
);

}  // namespace

}  // namespace glint
