// SPDX-License-Identifier: MIT
// What the programs glint-psnr, glint-ssim, glint-lpips, glint-depth and glint-normal share:
// command line, files in pairs, masks and regions, and the three forms of output. A program is a
// family of metrics (pair_metrics.h) and its options.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/image.h"
#include "metrics/pair_metrics.h"
#include "metrics/tools/pairing.h"

namespace CLI {
class App;
}

namespace glint {

using ToolScores = std::vector<std::pair<std::string, double>>;  // metric id, value; in print order

struct LoadedPair {
  FilePair files;
  Image prediction, reference;
  std::optional<std::size_t> family = {};  // that scores it, whatever its files are
};

// Maps that are in memory. Its names stand in messages where paths would; the maps are as files of
// floats hold them.
struct MapPair : LoadedPair {
  MaskImage mask, glass;  // empty: all pixels count; glass is not known
};

struct ImageScores {
  FilePair files;
  ToolScores scores;                  // "psnr", then "psnr@glass", ...
  std::vector<std::string> warnings;  // of its files, and of metrics that are left out
};

class MetricTool {
 public:
  virtual ~MetricTool() = default;

  virtual std::string name() const = 0;  // "glint-psnr"
  virtual std::string description() const = 0;
  virtual std::string example() const = 0;
  virtual FolderLayout prediction_layout() const = 0;
  virtual FolderLayout reference_layout() const = 0;
  virtual std::string reference_map() const = 0;  // of a dataset's views: "rgb", "depth", "normal"

  virtual void add_options(CLI::App&) {}
  // After parsing, before the first pair. Errors: kUsage; kEnvironment for files it needs.
  virtual void check_options() {}

  // Before the first pair is loaded: what all of them have in common. Errors as load_prediction().
  virtual void look_at(const FilePair&) {}

  // One of a pair's files as the metric wants it; called by several threads. Errors
  // (kBadReference): see image_files.h.
  virtual Image load_prediction(const fs::path& path) const = 0;
  virtual Image load_reference(const fs::path& path) const = 0;
  // What is done to floats that were read, as the options say: other axes, say.
  virtual void prepare_prediction(Image&) const {}
  virtual void prepare_reference(Image&) const {}
  // What pairs are scored by, as the options say; family_for() chooses for a pair.
  virtual std::vector<PairMetrics> families() const = 0;
  virtual std::size_t family_for(const FilePair&) const { return 0; }
  // Why pictures of that size have no value of the metric; empty: they may have one.
  virtual std::string why_unfit(const std::string& /*metric_id*/, ImageSize) const { return {}; }
  // What looks like another convention than the one that the options say; empty: nothing does.
  virtual std::string doubt(const LoadedPair&) const { return {}; }
  // Pairs are scored by several threads otherwise.
  virtual bool one_at_a_time() const { return false; }
  // What the options add to the protocol of every metric.
  virtual Json protocol_of_options() const { return Json::object(); }
  // Further results over all images, printed below the means.
  virtual Json summary(std::span<const ImageScores>) const { return Json::object(); }

  // One entry per region; an empty one where nothing can be scored. Sizes agree already.
  std::vector<ToolScores> score(const LoadedPair& pair, std::span<const Region> regions) const;
  Json protocol(const std::string& metric_id) const;
};

// Parses and calls `body`: help without arguments, errors to `err` behind the program's name, the
// exit code of whatever went wrong.
int run_program(
    CLI::App& app,
    const std::vector<std::string>& args,
    std::ostream& out,
    std::ostream& err,
    const std::function<void()>& body
);

// As run_tool() scores files; the options are set, and looked at by check_options(). `first` of
// several pairs: the one that is looked at for other conventions. Errors: of run_tool() with the
// names of the pair.
ImageScores score_maps(const MetricTool& tool, MapPair pair, bool first = true);

// The whole program but for main(). `args` without the program's name. Results go to `out`, errors
// and usage to `err`. Returns the exit code.
int run_tool(
    MetricTool& tool, const std::vector<std::string>& args, std::ostream& out, std::ostream& err
);
int run_tool(std::unique_ptr<MetricTool> tool, int argc, char** argv);

std::unique_ptr<MetricTool> make_psnr_tool();
std::unique_ptr<MetricTool> make_ssim_tool();
std::unique_ptr<MetricTool> make_depth_tool();
std::unique_ptr<MetricTool> make_normal_tool();
std::unique_ptr<MetricTool> make_lpips_tool();

// The mask of an image of that size; an empty path gives an empty mask. Errors (kBadReference):
// those of read_mask(), another size.
MaskImage load_mask(const fs::path& path, ImageSize size);
// Where a dataset folder has its masks.
const FolderLayout& mask_layout();

}  // namespace glint
