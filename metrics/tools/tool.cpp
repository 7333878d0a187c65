// SPDX-License-Identifier: MIT
#include "metrics/tools/tool.h"

#include <malloc.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <exception>
#include <iostream>
#include <new>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/core/printable.h"
#include "glint/core/process.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"
#include "metrics/tools/doubts.h"
#include "metrics/tools/numeric_options.h"
#include "metrics/tools/tool_output.h"

namespace glint {
namespace {

struct ToolOptions {
  PairingOptions pairing;
  bool json = false, csv = false, quiet = false;
  int threads = 0;
  std::string views = "test";
};

void add_common_options(CLI::App& app, ToolOptions& options) {
  PairingOptions& pairing = options.pairing;
  app.add_option("PREDICTION", pairing.prediction, "image, folder of images, or run folder")
      ->required();
  app.add_option(
         "REFERENCE",
         pairing.reference,
         "image, folder of images, or dataset (folder or packed): its test views"
  )
      ->required();
  app.add_option("--views", options.views, "of a dataset: test or all")
      ->check(CLI::IsMember({"test", "all"}))
      ->capture_default_str();
  app.add_option("--mask", pairing.mask, "pixels that count: image, or folder with one per name");
  app.add_option(
      "--glass", pairing.glass, "glass masks: also score the regions glass, glass-border and opaque"
  );
  app.add_option("--pattern", pairing.pattern, "which predictions of a folder, e.g. 'rgb.png'");
  app.add_flag("--allow-missing", pairing.allow_missing, "score the names that both sides have");
  auto* json = app.add_flag("--json", options.json, "one JSON document, numbers not rounded");
  app.add_flag("--csv", options.csv, "one row per image, numbers not rounded")->excludes(json);
  app.add_option("--threads", options.threads, "0: all cores")->check(at_least_zero());
  app.add_flag("--quiet", options.quiet, "no progress on standard error");
}

MaskView view_of(const MaskImage& mask) { return mask.empty() ? MaskView{} : MaskView(mask); }

// Of a dataset's view; empty: all pixels count.
MaskImage counted_of(const LoadedPair& pair) {
  return pair.files.view == nullptr ? MaskImage() : mask_of_map(pair.files.view->counted);
}

void check_mask_size(const std::string& name, const MaskImage& mask, ImageSize size) {
  GLINT_CHECK(
      mask.empty() || mask.size() == size,
      kBadReference,
      "{}: mask of {} x {} pixels for an image of {} x {}",
      name,
      mask.width(),
      mask.height(),
      size.width,
      size.height
  );
}

// The pixels of the mask that the dataset counts; empty: all.
MaskImage load_counted(const LoadedPair& pair) {
  MaskImage mask = load_mask(pair.files.mask, pair.reference.size());
  const MaskImage counted = counted_of(pair);
  if (mask.empty() || counted.empty()) return mask.empty() ? counted : mask;
  for (std::size_t i = 0; i < mask.num_pixels(); ++i) mask.data()[i] &= counted.data()[i];
  return mask;
}

// The whole image (or the mask), and the glass regions inside it.
std::vector<Region> load_regions(const LoadedPair& pair) {
  const MaskImage mask = load_counted(pair);
  const MaskImage glass = pair.files.glass_view
                              ? mask_of_map(map_of(*pair.files.glass_view, "glass"))
                              : load_mask(pair.files.glass, pair.reference.size());
  return evaluation_regions(view_of(glass), view_of(mask));
}

void check_sizes(const LoadedPair& pair, const std::string& hints = "") {
  GLINT_CHECK(
      pair.prediction.size() == pair.reference.size(),
      kBadPrediction,
      "{}: {} x {} pixels, but {} has {} x {}; render at the reference's size{}",
      pair.files.prediction.string(),
      pair.prediction.width(),
      pair.prediction.height(),
      pair.files.reference.string(),
      pair.reference.width(),
      pair.reference.height(),
      hints
  );
}

LoadedPair load_pair(const MetricTool& tool, const FilePair& files) {
  LoadedPair pair{files, {}, {}};
  pair.reference = with_exit_code(ExitCode::kBadReference, [&] {
    return files.view ? map_of(*files.view, tool.reference_map())
                      : tool.load_reference(files.reference);
  });
  pair.prediction = with_exit_code(ExitCode::kBadPrediction, [&] {
    return tool.load_prediction(files.prediction);
  });
  if (pair.prediction.size() != pair.reference.size())
    check_sizes(
        pair,
        orientation_hint(files.prediction) +
            (files.view == nullptr ? orientation_hint(files.reference) : "")
    );
  if (tool.reference_map() == "rgb")
    take_reference_where_uncounted(view_of(counted_of(pair)), pair.reference, pair.prediction);
  return pair;
}

// A side turned by its EXIF is the likely reason of a low score. Views of datasets are told of by
// what loads them.
std::vector<std::string> orientation_warnings(const FilePair& files) {
  std::vector<std::string> warnings;
  const auto add = [&](const fs::path& path) {
    const int orientation = stated_orientation(path);
    if (orientation != 1)
      warnings.push_back(fmt::format(
          "{}: states {}; its pixels are taken as stored",
          path.string(),
          orientation_words(orientation)
      ));
  };
  add(files.prediction);
  if (files.view == nullptr) add(files.reference);
  return warnings;
}

std::vector<std::string> color_warnings(const MetricTool& tool, const LoadedPair& pair) {
  std::vector<std::string> warnings;
  if (tool.reference_map() != "rgb") return warnings;
  const auto add = [&](const fs::path& path, const Image& image) {
    if (const std::string problem = color_range_problem(image); !problem.empty())
      warnings.push_back(fmt::format("{}: {}", path.string(), problem));
  };
  add(pair.files.prediction, pair.prediction);
  add(pair.files.reference, pair.reference);
  return warnings;
}

PairMetrics family_of(const MetricTool& tool, const LoadedPair& pair) {
  return tool.families()[pair.family ? *pair.family : tool.family_for(pair.files)];
}

bool has_scores(const std::vector<ToolScores>& regions) {
  return std::any_of(regions.begin(), regions.end(), [](const ToolScores& scores) {
    return !scores.empty();
  });
}

// Whose fault it is: a reference that cannot be scored against itself either is none.
[[noreturn]] void fail_unscored(
    const MetricTool& tool, const LoadedPair& pair, std::span<const Region> regions
) {
  const FilePair& files = pair.files;
  const std::string unfit =
      tool.why_unfit(family_of(tool, pair).metrics.front().id, pair.reference.size());
  GLINT_CHECK(unfit.empty(), kBadReference, "{}: {}", files.reference.string(), unfit);
  GLINT_CHECK(
      !has_scores(tool.score({files, pair.reference, pair.reference, pair.family}, regions)),
      kBadPrediction,
      "{}: no pixel to score: it has no value where {} has one; render it again",
      files.prediction.string(),
      files.reference.string()
  );
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: no pixel to score (empty mask or a reference without values)",
          files.reference.string()
      )
  );
}

// Metrics without a value where the pair has others, each with the reason.
std::vector<std::string> left_out(
    const MetricTool& tool, const LoadedPair& pair, const ToolScores& scores
) {
  std::vector<std::string> warnings;
  for (const Metric& metric : family_of(tool, pair).metrics) {
    const auto is_it = [&](const auto& score) { return score.first == metric.id; };
    if (std::any_of(scores.begin(), scores.end(), is_it)) continue;
    const std::string why = tool.why_unfit(metric.id, pair.reference.size());
    warnings.push_back(fmt::format(
        "{}: {} is left out: {}",
        pair.files.reference.string(),
        metric.id,
        why.empty() ? "no pixel that counts has a value of it" : why
    ));
  }
  return warnings;
}

ImageScores score_regions(
    const MetricTool& tool,
    const LoadedPair& pair,
    const std::vector<Region>& regions,
    std::vector<std::string> warnings
) {
  const FilePair& files = pair.files;
  ImageScores image{files, {}, std::move(warnings)};
  std::vector<ToolScores> scores;
  try {
    scores = tool.score(pair, regions);
    for (std::size_t r = 0; r < regions.size(); ++r)
      for (const auto& [id, value] : scores[r])
        image.scores.emplace_back(regions[r].name.empty() ? id : id + "@" + regions[r].name, value);
  } catch (const Error& error) {
    const fs::path& file =
        error.code() == ExitCode::kBadPrediction ? files.prediction : files.reference;
    throw Error(error.code(), file.string() + ": " + error.what());
  }
  if (!has_scores(scores)) fail_unscored(tool, pair, regions);
  for (std::string& warning : left_out(tool, pair, scores[0]))
    image.warnings.push_back(std::move(warning));
  return image;
}

ImageScores score_pair(const MetricTool& tool, const LoadedPair& pair) {
  std::vector<std::string> warnings = orientation_warnings(pair.files);
  for (std::string& warning : color_warnings(tool, pair)) warnings.push_back(std::move(warning));
  return score_regions(tool, pair, load_regions(pair), std::move(warnings));
}

// work(file) of every file side by side; errors come in the order of the files.
template <class F>
auto side_by_side(std::span<const FilePair> files, F&& work) {
  std::vector<decltype(work(files[0]))> results(files.size());
  std::vector<std::exception_ptr> errors(files.size());
  parallel_for(files.size(), 1, [&](std::size_t i) {
    try {
      results[i] = work(files[i]);
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
  return results;
}

// Of few enough pairs that an error is told soon, and of enough that no thread waits for long.
class Batches {
 public:
  Batches(const MetricTool& tool, Progress* progress) : tool_(tool), progress_(progress) {}

  std::size_t size() const {
    const auto threads = static_cast<std::size_t>(std::max(1, num_threads()));
    return tool_.one_at_a_time() ? threads : 8 * threads;
  }

  std::vector<ImageScores> score(std::span<const FilePair> files) const {
    const auto load = [&](const FilePair& pair) { return load_pair(tool_, pair); };
    if (!tool_.one_at_a_time())
      return side_by_side(files, [&](const FilePair& pair) { return scored(load(pair)); });
    std::vector<ImageScores> scores;
    for (const LoadedPair& pair : side_by_side(files, load)) scores.push_back(scored(pair));
    return scores;
  }

 private:
  ImageScores scored(const LoadedPair& pair) const {
    ImageScores scores = score_pair(tool_, pair);
    if (progress_ != nullptr) progress_->advance(1, pair.files.name);
    return scores;
  }

  const MetricTool& tool_;
  Progress* progress_;
};

void add_doubt(const MetricTool& tool, const LoadedPair& first, std::vector<std::string>& doubts) {
  if (const std::string doubt = tool.doubt(first); !doubt.empty())
    doubts.push_back(fmt::format("{}: {}", first.files.prediction.string(), doubt));
}

// Of all pairs alike, so the first is looked at; told with its scores. Colours have no conventions
// that a doubt may be about, and are not read again.
std::vector<std::string> doubts_of(const MetricTool& tool, std::span<const FilePair> pairs) {
  std::vector<std::string> doubts;
  if (tool.reference_map() != "rgb") add_doubt(tool, load_pair(tool, pairs.front()), doubts);
  if (std::string lossy = lossy_doubt(pairs); !lossy.empty()) doubts.push_back(std::move(lossy));
  return doubts;
}

ToolReport score_all(MetricTool& tool, const PairingOptions& options) {
  const Pairing pairing = pair_files(options);
  if (!pairing.pairs.empty()) tool.look_at(pairing.pairs.front());
  ToolReport report{
      options.prediction, options.reference, options.mask, options.glass, {}, pairing.missing};
  if (!pairing.pairs.empty() && pairing.pairs.front().view)
    log::info(fmt::format(
        "{} {} views of {}",
        pairing.pairs.size(),
        options.all_views ? "of all" : "test",
        options.reference.string()
    ));
  if (!pairing.missing.empty())
    log::warn(fmt::format("{} names left out, only on one side", pairing.missing.size()));
  std::unique_ptr<Progress> progress;
  if (pairing.pairs.size() > 1)
    progress = std::make_unique<Progress>(tool.name(), pairing.pairs.size());
  const std::span<const FilePair> files = pairing.pairs;
  const Batches batches(tool, progress.get());
  for (std::size_t begin = 0; begin < files.size(); begin += batches.size())
    for (ImageScores& image :
         batches.score(files.subspan(begin, std::min(batches.size(), files.size() - begin))))
      report.images.push_back(std::move(image));
  if (!files.empty())
    for (std::string& doubt : doubts_of(tool, files))
      report.images.front().warnings.push_back(std::move(doubt));
  for (const ImageScores& image : report.images)
    for (const std::string& warning : image.warnings) log::warn(warning);
  return report;
}

void run(MetricTool& tool, ToolOptions& options, std::ostream& out) {
  tool.check_options();
  set_quiet(options.quiet);
  if (options.threads > 0) set_num_threads(options.threads);
  options.pairing.prediction_layout = tool.prediction_layout();
  options.pairing.reference_layout = tool.reference_layout();
  options.pairing.reference_map = tool.reference_map();
  options.pairing.all_views = options.views == "all";
  options.pairing.mask_layout = mask_layout();
  const ToolReport report = score_all(tool, options.pairing);
  if (options.json)
    print_json(tool, report, out);
  else if (options.csv)
    print_csv(report, out);
  else
    print_text(tool, report, out);
}

}  // namespace

std::vector<ToolScores> MetricTool::score(const LoadedPair& pair, std::span<const Region> regions)
    const {
  const PairMetrics family = family_of(*this, pair);
  std::vector<ToolScores> scores(regions.size());
  const std::vector<MetricValues> rows = family.score(pair.prediction, pair.reference, regions);
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t m = 0; m < rows[r].size(); ++m)
      if (rows[r][m]) scores[r].emplace_back(family.metrics[m].id, *rows[r][m]);
  return scores;
}

Json MetricTool::protocol(const std::string& metric_id) const {
  for (const PairMetrics& family : families())
    for (const Metric& metric : family.metrics) {
      if (metric.id != metric_id) continue;
      Json protocol = metric.protocol;
      protocol.update(protocol_of_options());
      return protocol;
    }
  return nullptr;
}

ImageScores score_maps(const MetricTool& tool, MapPair pair, bool first) {
  check_sizes(pair);
  for (const auto& [name, mask] : {std::pair{"mask", &pair.mask}, {"glass", &pair.glass}})
    check_mask_size(name, *mask, pair.reference.size());
  tool.prepare_prediction(pair.prediction);
  tool.prepare_reference(pair.reference);
  const std::vector<Region> regions = evaluation_regions(view_of(pair.glass), view_of(pair.mask));
  ImageScores image = score_regions(tool, pair, regions, color_warnings(tool, pair));
  if (first) add_doubt(tool, pair, image.warnings);
  return image;
}

int run_program(
    CLI::App& app,
    const std::vector<std::string>& args,
    std::ostream& out,
    std::ostream& err,
    const std::function<void()>& body
) {
  const auto fail = [&](std::string_view message, ExitCode code) {
    err << app.get_name() << ": " << printable(message) << "\n";
    return static_cast<int>(code);
  };
  ignore_file_size_signal();
  fill_standard_streams();
  try {
    if (args.empty()) {
      err << app.help();
      return static_cast<int>(ExitCode::kUsage);
    }
    app.parse(std::vector<std::string>(args.rbegin(), args.rend()));
    check_numbers(app);
    body();
  } catch (const CLI::ParseError& error) {
    if (app.exit(error, out, err) != 0) return static_cast<int>(ExitCode::kUsage);
  } catch (const Error& error) {
    return fail(error.what(), error.code());
  } catch (const std::exception& error) {
    return fail(out_of_memory_message(error).value_or(error.what()), ExitCode::kEnvironment);
  }
  out.flush();
  return out.good() ? static_cast<int>(ExitCode::kSuccess)
                    : fail(kNoOutput, ExitCode::kEnvironment);
}

int run_tool(
    MetricTool& tool, const std::vector<std::string>& args, std::ostream& out, std::ostream& err
) {
  CLI::App app(tool.description(), tool.name());
  app.footer("Example:\n  " + tool.example() + "\n");
  ToolOptions options;
  add_common_options(app, options);
  tool.add_options(app);
  return run_program(app, args, out, err, [&] { run(tool, options, out); });
}

int run_tool(std::unique_ptr<MetricTool> tool, int argc, char** argv) {
  // One pair of pictures follows another: memory is kept instead of given back and asked for again.
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the largest that it takes
  ::mallopt(M_TRIM_THRESHOLD, 1 << 30);
  return run_tool(*tool, std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr);
}

MaskImage load_mask(const fs::path& path, ImageSize size) {
  if (path.empty()) return {};
  MaskImage mask = with_exit_code(ExitCode::kBadReference, [&] { return read_mask(path); });
  check_mask_size(path.string(), mask, size);
  if (has_alpha(path) && std::ranges::all_of(mask.values(), [](auto value) { return value != 0; }))
    log::warn(fmt::format(
        "{}: white throughout, so that every pixel counts, and has an alpha channel, which is not "
        "looked at: if it holds the mask, write that as the picture itself",
        path.string()
    ));
  return mask;
}

const FolderLayout& mask_layout() {
  static const FolderLayout layout{{"gt/glass", "masks"}, {}};
  return layout;
}

}  // namespace glint
