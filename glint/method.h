// SPDX-License-Identifier: MIT
// The contract of a method, and the registry. One file in baselines/ per method; it registers
// itself and is then trained, rendered, scored, tabulated and tested without another line anywhere.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/registry.h"
#include "glint/scene/scene.h"

namespace glint {

class TrainableSet;
class TrainingState;

// A set of a method, which is the file NAME.ply.
struct MethodSet {
  const char* name;
  TrainableSet* set;
};

struct StepStats {
  int iteration = 0;
  double loss = 0;
  double psnr = 0;  // of the training view of this step
  std::size_t num_surfels = 0;
  std::map<std::string, std::size_t> sets;  // surfels of each, of methods with several
  std::map<std::string, double> terms;      // each loss term, weighted
  std::vector<std::string> events;          // of this step, for the log: "opacities reset"
};

// Options of one run that every method gets.
struct RunOptions {
  int iterations = 30000;  // schedules scale with it
  std::uint64_t seed = 0;
};

class Method {
 public:
  virtual ~Method() = default;
  // Called once before step(). `scene` outlives the method; only scene.train and scene.points may
  // be looked at. Errors: kUsage (config), kBadReference (scene lacks what the method needs).
  virtual void initialize(const Scene& scene, const RunOptions& options) = 0;
  virtual StepStats step(int iteration) = 0;  // iteration counts from 0
  // Maps of one view, all of the camera's size; rgb is not clamped. Not const: buffers are kept
  // from one view to the next, and shared with step().
  virtual MapSet render(const Camera& camera) = 0;
  // The same for a view of the dataset. A method that was published with an input mask at test
  // views overrides it; it looks at the view's mask alone, never at its picture, and notes() say
  // so.
  virtual MapSet render_view(const View& view) { return render(view.camera); }
  // The picture alone, not clamped, left on the device where it was made: what FPS counts and what
  // moving viewers see. Valid until the next call of any kind.
  virtual const Image& picture(const Camera& camera) { return picture_ = render(camera)["rgb"]; }
  // From now on the two above are quicker where that is possible, and as near to what they were as
  // training takes it: for viewers that move.
  virtual void render_quickly(bool) {}
  // Surfel sets as PLY files and whatever else is needed to render again.
  virtual void save(const std::string& folder) const = 0;
  // After initialize(), step() goes on from what is loaded; else it can only be rendered.
  virtual void load(const std::string& folder) = 0;
  virtual Json config() const = 0;
  // The same with meanings, for `glint-bench methods`: config_fields(config_). Else without.
  virtual std::vector<ConfigField> fields() const;
  // What training with this config looks at beside photos, cameras and points, a word or two each:
  // "depth prior", "glass masks", "LPIPS weights".
  virtual std::vector<std::string> inputs() const { return {}; }
  // Throws Error naming the parameter array and surfel when a parameter is not finite.
  virtual void check_finite() const = 0;
  // Names all that one step leaves for the next (glint/train/training_state.h), to be written or,
  // after initialize(), to be read: so a training that was stopped goes on. False: nothing is said,
  // and it starts anew.
  virtual bool visit_state(TrainingState&) { return false; }
  virtual std::size_t num_surfels() const = 0;
  // The sets that it renders, by name; they live as long as the method. Empty: it has none.
  virtual std::vector<MethodSet> sets() const { return {}; }
  virtual std::vector<std::string> warnings() const { return {}; }  // losses off, missing priors
  // What readers of tables have to know of this run, a line each: which masks it was given, say.
  virtual std::vector<std::string> notes() const { return {}; }

 private:
  Image picture_;
};

// Registered with GLINT_REGISTER(MethodSpec, ...); all of them: Registry<MethodSpec>::all().
struct MethodSpec {
  std::string id;           // "2dgs"; ablations and controls: "glint/no-trans", "2dgs/prior"
  std::string title;        // as printed in tables
  std::string citation;     // BibTeX key
  std::string paper_row;    // row of reports/paper/glint.json, empty when the paper has none
  std::string description;  // one line
  Json overrides = Json::object();  // config fields that make this variant
  // From a config with all overrides. Call create_method(), which adds the variant's own.
  std::function<std::unique_ptr<Method>(const Json& config)> create;
  bool rival = true;        // false: is given the truth of test views, and has no rank
  std::string source = {};  // the file that registers it (GLINT_REGISTER fills it in)
};

// Errors (kUsage): unknown id; the message lists the known ones and the nearest.
const MethodSpec& find_method(const std::string& id);
// The method with its variant's overrides, and the user's on top. Errors (kUsage): unknown id or
// config field, a number that is none of those a setting may be (setting_ranges.h).
std::unique_ptr<Method> create_method(const std::string& id, const Json& config = Json::object());

}  // namespace glint
