// SPDX-License-Identifier: MIT
#include "reports/run/import/import_photos.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "datasets/colmap_model.h"
#include "datasets/scene_index.h"
#include "datasets/side_maps.h"
#include "glint/core/error.h"
#include "glint/core/file_lock.h"
#include "glint/core/interrupt.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "reports/run/bench/child_process.h"

namespace glint {
namespace {

constexpr std::size_t kFewestPhotos = 3;
constexpr std::size_t kMostForPairs = 150;  // above, "auto" looks at neighbours alone
constexpr std::size_t kShownLines = 12;     // of COLMAP's words, in an error

using Words = ChildProcess::Words;

// Runs COLMAP: its words go to the log, and `line` sees each.
class Colmap {
 public:
  explicit Colmap(const fs::path& work) : log_(work / "colmap.log") {}

  // What it can do, as its help says. Errors (kEnvironment): not installed.
  static std::string help(const std::string& command) {
    const auto result = run_command({"env", "QT_QPA_PLATFORM=offscreen", "colmap", command, "-h"});
    GLINT_CHECK(
        result && result->end.code != 127,
        kEnvironment,
        "COLMAP is not installed, or not on PATH; `apt-get install colmap` brings it on Debian and "
        "Ubuntu"
    );
    return result->output;
  }

  void run(Words words, const std::function<void(std::string_view)>& line) {
    words.insert(words.begin(), "colmap");
    ChildProcess child(words, {"QT_QPA_PLATFORM=offscreen"});
    std::string text;
    while (child.output() >= 0) {
      throw_if_interrupted();
      pollfd waiting{child.output(), POLLIN, 0};
      ::poll(&waiting, 1, 200);
      take_lines(text += child.read(), line);
    }
    while (!child.end()) ::usleep(1000);
    check_end(*child.end(), words[1]);
  }

 private:
  void take_lines(std::string& text, const std::function<void(std::string_view)>& line) {
    for (std::size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
      const std::string one = text.substr(0, end);
      append_line(log_, one);
      last_.push_back(one);
      if (last_.size() > kShownLines) last_.erase(last_.begin());
      line(one);
    }
  }
  void check_end(ProcessEnd end, const std::string& command) const {
    if (end.good()) return;
    const std::string how =
        end.signal != 0 ? signal_name(end.signal) : fmt::format("exit code {}", end.code);
    throw Error(
        ExitCode::kEnvironment,
        fmt::format(
            "colmap {} ended with {}; all it said is in {}, and the last of it:\n{}",
            command,
            how,
            log_.string(),
            fmt::join(last_, "\n")
        )
    );
  }

  fs::path log_;
  std::vector<std::string> last_;
};

// The option of this COLMAP, whose groups have changed their names: "SiftExtraction.use_gpu" is
// "FeatureExtraction.use_gpu" since 3.12.
std::string option(const std::string& help, const std::string& group, const std::string& name) {
  const std::string earlier = fmt::format("--Sift{}.{}", group, name);
  const std::string later = fmt::format("--Feature{}.{}", group, name);
  return help.find(later) != std::string::npos ? later : earlier;
}

bool lies_in(const fs::path& file, const fs::path& folder) {
  const fs::path relative = fs::absolute(file).lexically_normal().lexically_relative(
      fs::absolute(folder / "").lexically_normal()
  );
  return !relative.empty() && *relative.begin() != "..";
}

// Of all photos below the folder, as COLMAP names them; `masks` are none.
std::vector<fs::path> find_photos(const fs::path& folder, const fs::path& masks) {
  check_exists(folder, "folder");
  const std::set<std::string> pictures{".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp"};
  std::vector<fs::path> photos;
  const auto is_other = [&](const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
      return static_cast<char>(std::tolower(c));
    });
    return (!masks.empty() && lies_in(path, masks)) ||
           (!pictures.contains(extension) && !is_real_folder(path));
  };
  for (const fs::path& file : list_files_below(folder, is_other))
    photos.push_back(file.lexically_relative(folder));
  GLINT_CHECK(
      photos.size() >= kFewestPhotos,
      kBadReference,
      "{}: {} photos (JPEG, PNG, TIFF), expected at least {} of one place from several sides",
      folder.string(),
      photos.size(),
      kFewestPhotos
  );
  std::sort(photos.begin(), photos.end());
  return photos;
}

// Of those photos that have one. Errors (kBadReference): no such folder; none has.
std::map<fs::path, fs::path> find_masks(
    const fs::path& folder, const std::vector<fs::path>& photos
) {
  std::map<fs::path, fs::path> masks;
  if (folder.empty()) return masks;
  check_exists(folder, "folder");
  for (const fs::path& photo : photos)
    for (const fs::path& name :
         {fs::path(photo.string() + ".png"), fs::path(photo).replace_extension(".png")})
      if (is_file(folder / name)) {
        masks.emplace(photo, folder / name);
        break;
      }
  GLINT_CHECK(
      !masks.empty(),
      kBadReference,
      "{}: no mask of any photo; expected PNG files of their paths, such as {}",
      folder.string(),
      (folder / photos.front()).replace_extension(".png").string()
  );
  return masks;
}

// One lens for all where they are of one size.
bool are_of_one_size(const fs::path& folder, const std::vector<fs::path>& photos) {
  const auto size = [&](const fs::path& photo) {
    return with_exit_code(ExitCode::kBadReference, [&] { return read_image_size(folder / photo); });
  };
  return std::all_of(photos.begin(), photos.end(), [&](const fs::path& photo) {
    return size(photo) == size(photos.front());
  });
}

class PhotoImport {
 public:
  PhotoImport(const fs::path& photos, const fs::path& out, const PhotoOptions& options)
      : folder_(photos),
        out_(out),
        work_(out.string() + ".colmap"),
        options_(options),
        colmap_(work_) {
    GLINT_CHECK(
        list_entries(out).empty(),
        kUsage,
        "{}: holds files; name another folder with --out",
        out.string()
    );
    auto lock = FileLock::take(FileLock::file_beside(out));
    if (const auto* holder = std::get_if<std::string>(&lock))
      throw Error(
          ExitCode::kUsage,
          fmt::format(
              "{}: {} is at work there; wait for it, or choose another --out", out.string(), *holder
          )
      );
    lock_.emplace(std::get<FileLock>(std::move(lock)));
    photos_ = find_photos(photos, options.masks);
    masks_ = find_masks(options.masks, photos_);
    result_.photos = photos_.size();
    result_.matcher = options.matcher != "auto"         ? options.matcher
                      : photos_.size() <= kMostForPairs ? "exhaustive"
                                                        : "sequential";
  }

  PhotoModel run() {
    const std::string extraction = Colmap::help("feature_extractor"),
                      matching = Colmap::help(result_.matcher + "_matcher");
    std::error_code ignored;
    fs::remove_all(work_ / "sparse", ignored);  // features and matches are gone on from, models not
    fs::create_directories(work_ / "sparse");
    extract(extraction);
    match(matching);
    map();
    finish();
    return result_;
  }

 private:
  std::string threads() const {
    return std::to_string(options_.threads > 0 ? options_.threads : -1);
  }
  Words with_database(const std::string& command) const {
    return {command, "--database_path", (work_ / "database.db").string()};
  }

  void extract(const std::string& help) {
    Words words = with_database("feature_extractor");
    const auto add = [&](const std::string& name, const std::string& value) {
      words.push_back(name);
      words.push_back(value);
    };
    add("--image_path", folder_.string());
    add("--ImageReader.camera_model", options_.lens);
    add("--ImageReader.single_camera", are_of_one_size(folder_, photos_) ? "1" : "0");
    if (!masks_.empty()) add("--ImageReader.mask_path", masks_for_colmap().string());
    add(option(help, "Extraction", "use_gpu"), "0");
    add(option(help, "Extraction", "num_threads"), threads());
    add(option(help, "Extraction", "max_image_size"), std::to_string(options_.max_side));
    Progress progress("features", photos_.size());
    colmap_.run(words, [&](std::string_view line) {
      if (line.find("Processed file [") != std::string_view::npos) progress.advance();
    });
  }

  // A folder with the names that it looks for.
  fs::path masks_for_colmap() const {
    for (const auto& [photo, mask] : masks_)
      write_file(work_ / "masks" / (photo.string() + ".png"), read_file(mask));
    return work_ / "masks";
  }

  void match(const std::string& help) {
    Words words = with_database(result_.matcher + "_matcher");
    const Words more{
        option(help, "Matching", "use_gpu"),
        "0",
        option(help, "Matching", "num_threads"),
        threads()};
    words.insert(words.end(), more.begin(), more.end());
    // A line for each photo (sequential), or for each block of 50 by 50 (exhaustive).
    const std::size_t blocks = (photos_.size() + 49) / 50;
    const bool pairs = result_.matcher == "exhaustive";
    Progress progress("matches", pairs ? blocks * blocks : photos_.size());
    colmap_.run(words, [&](std::string_view line) {
      if (line.find("Matching ") != std::string_view::npos &&
          line.find('[') != std::string_view::npos)
        progress.advance();
    });
  }

  void map() {
    Words words = with_database("mapper");
    const Words more{
        "--image_path",
        folder_.string(),
        "--output_path",
        (work_ / "sparse").string(),
        "--Mapper.num_threads",
        threads()};
    words.insert(words.end(), more.begin(), more.end());
    Progress progress("cameras", photos_.size());
    colmap_.run(words, [&](std::string_view line) {
      if (line.find("Registering image #") != std::string_view::npos) progress.advance();
      if (line.find("Initializing with image pair #") != std::string_view::npos)
        progress.advance(2);
    });
  }

  // The model with most photos, and how many others there are.
  std::pair<fs::path, ColmapModel> largest_model() {
    std::pair<fs::path, ColmapModel> best;
    std::size_t models = 0;
    for (const fs::path& folder : list_folders(work_ / "sparse")) {
      ColmapModel model = read_colmap_model(folder);
      ++models;
      const bool better = model.images.size() > best.second.images.size() ||
                          (model.images.size() == best.second.images.size() && folder < best.first);
      if (better) best = {folder, std::move(model)};
    }
    GLINT_CHECK(
        best.second.images.size() >= kFewestPhotos,
        kBadReference,
        "{}: COLMAP found no place for {} photos together; they need much overlap, sharpness and "
        "the same scene (its words: {})",
        folder_.string(),
        kFewestPhotos,
        (work_ / "colmap.log").string()
    );
    result_.other_models = models - 1;
    return best;
  }

  // Under the names of the views, as the loader calls them.
  void write_counted(const fs::path& made, const std::set<fs::path>& posed) {
    std::vector<ViewSource> views;
    for (const fs::path& photo : posed) views.push_back({.name = photo.string()});
    shorten_names(views);
    std::size_t i = 0;
    for (const fs::path& photo : posed) {
      const std::string name = views[i++].name;
      const auto mask = masks_.find(photo);
      if (mask == masks_.end()) continue;
      write_file(made / counted_file(name), read_file(mask->second));
      ++result_.masks;
    }
    if (result_.masks > 0) write_file(made / "scene.json", "{}\n");
  }

  void finish() {
    const auto [folder, model] = largest_model();
    result_.points = read_colmap_points(folder / "points3D.bin").positions.size();
    std::set<fs::path> posed;
    for (const ColmapImage& image : model.images) posed.insert(image.name);
    const fs::path made = work_ / "dataset";
    std::error_code ignored;
    fs::remove_all(made, ignored);
    for (const fs::path& photo : photos_) {
      if (!posed.contains(photo)) {
        result_.unposed.push_back(photo.string());
        continue;
      }
      write_file(made / "images" / photo, read_file(folder_ / photo));
    }
    write_counted(made, posed);
    for (const char* file : {"cameras.bin", "images.bin", "points3D.bin"})
      write_file(made / "sparse/0" / file, read_file(folder / file));
    fs::remove(out_, ignored);  // empty
    fs::rename(made, out_);
    fs::remove_all(work_, ignored);
  }

  fs::path folder_, out_, work_;
  std::optional<FileLock> lock_;  // nobody else's COLMAP works on the same database
  PhotoOptions options_;
  Colmap colmap_;
  std::vector<fs::path> photos_;
  std::map<fs::path, fs::path> masks_;  // of photos
  PhotoModel result_;
};

}  // namespace

PhotoModel import_photos(const fs::path& photos, const fs::path& out, const PhotoOptions& options) {
  return PhotoImport(photos, out, options).run();
}

}  // namespace glint
