// SPDX-License-Identifier: MIT
// TSGS [Li25]: "TSGS: Improving Gaussian Splatting for Transparent Surface Reconstruction via
// Normal and De-lighting Priors", ACM MM 2025. All of PGSR (baselines/planar/planar_model.h), and:
// a normal prior; for the first half of the run the target is de-lighted where the glass mask says
// so; then opacities stay as they are and the photo is the target; from 60 % of the run on lobes
// (baselines/planar/lobe_appearance.h, `lobes`) add to the colours; at views with a mask, depth on
// glass is that of the first surface instead of the last one before half the light is gone.
//
// Given: masks of the glass (prior folder diffrens/glass, else the dataset's truth), de-lighted
// photos (diffrens/delight) and normals (diffrens/normal). At views without one of them its part is
// off, and warnings and notes say so. Test views are given their masks, too, as published:
// render_view() looks at nothing else of a view. render() of a camera has no mask.
//
// Deviations: those of PGSR here; the window of the first surface is in scene units like all else;
// only glass is masked, not the background, which rooms have not: no loss on alpha; features of
// lobes are made when lobes start instead of at the start of the run, which is the same, since
// surfels stay the same ones from half of the run on and features are zero until then; their rates
// follow the rule of shorter runs. Lobes are its authors' network for rooms (is_real with
// is_indoor), not the larger one for objects. Left out: the transparency tau of each splat, which
// has its own loss and changes no output.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "baselines/planar/lobe_appearance.h"
#include "baselines/planar/planar_model.h"
#include "baselines/tsgs_kernels.h"
#include "glint/core/kernel.h"
#include "glint/render/map_ops.h"
#include "glint/surfel_method.h"
#include "glint/train/check_fits.h"
#include "glint/train/geometry_losses.h"
#include "glint/train/glass_masks.h"
#include "glint/train/share_kernels.h"

namespace glint {

namespace {

constexpr const char* kSceneFile = "scene_unit.json";

constexpr const char* kBaseColor = "basecolor";
constexpr const char* kLobesFile = "lobes.safetensors";
constexpr const char* kNoLobes = "off";
bool is_kind_of_lobes(std::string_view kind) { return kind == "real" || kind == kNoLobes; }

struct TsgsConfig {
  PlanarConfig planar;
  float lambda_normal = 0.1f, min_cosine = 0.3f;
  int gate_from = 3000, normal_until = 30000;
  bool delighted = true;
  // Or "basecolor", on whose maps glass is as opaque as on the best de-lighted photo.
  std::string delighted_by = "delighted";
  int photo_from = 15000;
  bool freeze_opacity = true;
  float surface_window = 0.03f;  // published scene units
  float surface_weight = 0.2f;   // what its code renders test views with; .1 elsewhere
  std::string lobes = "real";
  int lobes_from = 18000;
  LobeRates lobe_rates;

  TsgsConfig() {
    // Its own defaults; [Chen24]'s are brought to rooms by that paper's advice, these are not.
    planar.densify.min_opacity = 0.005f;
    planar.densify.max_abs_splits = 50000;
  }
  template <class V>
  void visit(V&& v) {
    planar.visit(v);
    v("lambda_normal", lambda_normal, "weight of the normal prior");
    v("min_cosine", min_cosine, "gate of the normal prior");
    v("gate_from", gate_from, "first published iteration of the normal prior's gate");
    v("normal_until", normal_until, "last published iteration of the normal prior, exclusive");
    v("delighted", delighted, "glass is compared with the de-lighted photo first");
    v("delighted_by", delighted_by, "prior that is the de-lighted photo: delighted or basecolor");
    v("photo_from", photo_from, "first published iteration with the photo everywhere");
    v("freeze_opacity", freeze_opacity, "opacities stay from then on");
    v("surface_window", surface_window, "of depths of the first surface, published scene units");
    v("surface_weight", surface_weight, "cumulative weight within which it is looked for");
    v("lobes", lobes, "lobes that add to colours: real or off");
    v("lobes_from", lobes_from, "first published iteration with lobes");
    lobe_rates.visit(v);
  }
  void scale_to(int iterations) {
    for (int* window : {&gate_from, &normal_until, &photo_from, &lobes_from})
      *window = scaled_step(*window, iterations);
    lobe_rates = lobe_rates.for_shorter_run(30000.0 / iterations);
  }
  MapId delighted_map() const {
    return delighted_by == kBaseColor ? MapId("basecolor") : MapId("delighted");
  }
  // Errors (kUsage): no such prior or lobes; surfels would come or go under their features.
  void check() const {
    GLINT_CHECK(
        delighted_by == "delighted" || delighted_by == kBaseColor,
        kUsage,
        "tsgs: delighted_by cannot be '{}'; expected delighted or basecolor",
        delighted_by
    );
    GLINT_CHECK(
        is_kind_of_lobes(lobes), kUsage, "tsgs: lobes cannot be '{}'; expected real or off", lobes
    );
    GLINT_CHECK(
        lobes == kNoLobes || std::max(planar.densify.until, planar.trim_until) <= lobes_from,
        kUsage,
        "tsgs: densify_until is {} and trim_until {}, expected at most lobes_from, which is {}: "
        "lobes have a feature for each surfel; set lobes_from later, or lobes=off",
        planar.densify.until,
        planar.trim_until,
        lobes_from
    );
  }
};

class Tsgs final : public MethodOf<TsgsConfig> {
 public:
  explicit Tsgs(TsgsConfig config) : MethodOf(std::move(config)), model_(set_) {
    sets_ = {{"interface", &set_}};
    config_.check();
  }

  void initialize(const Scene& scene, const RunOptions& options) override {
    windows_ = config_;
    windows_.scale_to(options.iterations);
    options_ = options;
    stop_lobes();
    warnings_ = model_.set_up(config_.planar, scene, options, "tsgs");
    scene_unit_ = model_.scene_unit();
    require_prior(scene, "normal", "L_normal", "tsgs", windows_.lambda_normal, warnings_);
    float wanted = config_.delighted ? 1.0f : 0.0f;
    require_prior(
        scene, config_.delighted_map(), "the de-lighted target", "tsgs", wanted, warnings_
    );
    windows_.delighted = wanted > 0;
    const MaskCounts masks = count_glass_masks(scene.train);
    notes_ = {"glass masks, test views' too: " + glass_mask_note(masks)};
    if (config_.delighted)
      notes_.push_back(fmt::format(
          "de-lighted photos: {}", windows_.delighted ? config_.delighted_by + " priors" : "none"
      ));
    if (config_.lobes != TsgsConfig{}.lobes) notes_.push_back("lobe appearance: " + config_.lobes);
    if (masks.none())
      warnings_.push_back(fmt::format(
          "tsgs: {} has no glass masks (diffrens/glass); the de-lighted target and the depth of "
          "the first surface are off",
          scene.name
      ));
  }

  StepStats step(int iteration) override {
    StepStats stats;
    if (iteration == windows_.photo_from && config_.freeze_opacity) set_.freeze_opacity();
    if (iteration >= windows_.lobes_from && config_.lobes != kNoLobes && !lobes_)
      start_lobes(config_.lobes);
    const View& view = model_.forward(iteration, stats);
    model_.add_losses({target_of(view, iteration), view.counted}, stats);
    if (windows_.lambda_normal > 0 && iteration < windows_.normal_until &&
        view.priors.has("normal"))
      add_normal_prior(view, iteration, stats);
    model_.backward(stats);
    if (lobes_) lobes_->step(iteration, options_.iterations);
    return stats;
  }

  MapSet render(const Camera& camera) override { return rendered(camera, {}); }
  MapSet render_view(const View& view) override { return rendered(view.camera, glass_mask(view)); }
  const Image& picture(const Camera& camera) override { return model_.draw(camera).features; }
  void save(const std::string& folder) const override {
    MethodOf::save(folder);
    if (lobes_) write_safetensors(fs::path(folder) / kLobesFile, {}, lobes_->tensors("lobes"));
    const Json scene{{"scene_unit", scene_unit_}, {"lobes", kind_of_lobes_}};
    write_file(fs::path(folder) / kSceneFile, scene.dump() + "\n");
  }
  void load(const std::string& folder) override {
    MethodOf::load(folder);
    model_.use_all_degrees();
    const fs::path file = fs::path(folder) / kSceneFile;
    const Json json = read_json_object(file, ExitCode::kBadPrediction);
    GLINT_CHECK(
        json.contains("scene_unit") && json["scene_unit"].is_number(),
        kBadPrediction,
        "{}: expected the number scene_unit, metres; train the run again",
        file.string()
    );
    scene_unit_ = json["scene_unit"].get<float>();
    load_lobes(folder, json.value("lobes", Json(kNoLobes)));  // older runs have none
  }
  std::vector<std::string> inputs() const override {
    std::vector<std::string> inputs;
    if (config_.lambda_normal > 0) inputs.push_back(prior_input("normal"));
    if (config_.delighted) inputs.push_back(prior_input(config_.delighted_map()));
    inputs.push_back(kGlassMasks);
    return inputs;
  }
  void check_finite() const override {
    MethodOf::check_finite();
    if (lobes_) lobes_->check_finite("lobes");
  }
  bool visit_state(TrainingState& state) override {
    MethodOf::visit_state(state);
    state("model", model_);
    std::string kind = kind_of_lobes_;
    state("kind_of_lobes", kind);
    if (state.reading() && kind != kNoLobes) start_lobes(kind);
    if (lobes_) state("lobes", *lobes_);
    return true;
  }
  std::vector<std::string> notes() const override { return notes_; }

 private:
  void start_lobes(const std::string& kind) {
    kind_of_lobes_ = kind;
    LobeAppearanceConfig sizes;
    sizes.rates = windows_.lobe_rates;
    lobes_.emplace(sizes, set_.cloud().size(), options_.seed);
    model_.add_lobes(&*lobes_);
  }
  void stop_lobes() {
    model_.add_lobes(nullptr);
    lobes_.reset();
    kind_of_lobes_ = kNoLobes;
  }
  void load_lobes(const fs::path& folder, const Json& kind) {
    GLINT_CHECK(
        kind.is_string() && is_kind_of_lobes(kind.get<std::string>()),
        kBadPrediction,
        "{}: lobes is {}, expected real or off; train the run again",
        (folder / kSceneFile).string(),
        kind.dump()
    );
    stop_lobes();
    if (kind == kNoLobes) return;
    start_lobes(kind.get<std::string>());
    SafetensorsFile file(folder / kLobesFile);
    lobes_->read(file, "lobes");
  }

  // The photo; in the first stage de-lighted on glass.
  const Image& target_of(const View& view, int iteration) {
    const Image &mask = glass_mask(view), &delighted = view.priors[config_.delighted_map()];
    const bool in_time = windows_.delighted && iteration < windows_.photo_from;
    if (!in_time || mask.empty() || delighted.empty()) return view.rgb;
    check_fits("glass mask", mask, view.rgb.size(), 1);
    check_fits("de-lighted photo", delighted, view.rgb.size(), 3);
    fit(target_, view.rgb.size(), 3);
    run_kernel(
        target_.num_pixels(),
        4096,
        ChooseByMask{
            mask.on_device(), delighted.on_device(), view.rgb.on_device(), target_.on_device()}
    );
    return target_;
  }

  // sum M |prior - N|_1 / sum M, N as composited.
  void add_normal_prior(const View& view, int iteration, StepStats& stats) {
    const Image &normal = model_.output().normal, &prior = view.priors["normal"];
    check_fits("normal prior", prior, normal.size(), 3);
    constexpr float kNoGate = -1e30f;
    const GatedNormals gate{
        normal.on_device(),
        prior.on_device(),
        iteration >= windows_.gate_from ? windows_.min_cosine : kNoGate};
    Array<double> counted;
    Array<float> scale;
    sum_kernel_to(normal.size(), CountGatedNormals{gate}, counted);
    share_of(counted.on_device(), windows_.lambda_normal, scale);
    const double sum = sum_kernel(
        normal.size(), GatedNormalAt{gate, scale.on_device(), model_.gradient().normal.on_device()}
    );
    const double count = told(counted);
    if (count == 0) return;
    stats.terms["normal"] = static_cast<double>(windows_.lambda_normal) * sum / count;
  }

  // Without a mask no pixel sees through glass.
  MapSet rendered(const Camera& camera, const Image& mask) {
    MapSet maps = model_.render(camera);
    add_depth_modes(set_.pass().rasterizer, maps);
    if (mask.empty()) {
      maps["depth"] = model_.output().depth_median;
      return maps;
    }
    check_fits("glass mask", mask, camera.size(), 1);
    const FirstSurfaceSettings settings{
        config_.surface_window * scene_unit_, config_.surface_weight};
    set_.first_surface(mask, settings, maps["depth"]);
    return maps;
  }

  TsgsConfig windows_;
  std::vector<std::string> notes_;
  TrainableSet set_;
  PlanarModel model_;
  std::optional<LobeAppearance> lobes_;   // once they started
  std::string kind_of_lobes_ = kNoLobes;  // of those
  RunOptions options_;
  Image target_;
  float scene_unit_ = 1;  // metres that a published scene unit stands for
};

[[maybe_unused]] const bool registered = register_methods<Tsgs>(
    __FILE__,
    "li2025tsgs",
    {{"tsgs",
      "TSGS",
      "TSGS",
      "PGSR with glass masks, normal and de-lighting priors, first-surface depth"},
     // GlassRoom has no de-lighted photos: its simulated base colours take their place on glass.
     {"tsgs/basecolor",
      "TSGS + base colour",
      "",
      "TSGS with the base colour prior as its de-lighted photo",
      [](TsgsConfig& config) { config.delighted_by = kBaseColor; }}}
);

}  // namespace

}  // namespace glint
