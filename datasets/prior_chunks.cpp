// SPDX-License-Identifier: MIT
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <numeric>
#include <set>

#include "datasets/prior_files.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

constexpr std::size_t kMostFrames = 4096;  // in a chunk; a length beyond is no chunk's

struct ChunkFile {
  std::size_t chunk = 0, frame = 0;
  std::string pass;
};

// "0012" -> 12; nothing for other texts and for more digits than anybody has.
std::optional<std::size_t> parse_index(std::string_view digits) {
  constexpr std::size_t kMostDigits = 6;
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole = error == std::errc() && end == digits.data() + digits.size();
  if (!whole || digits.empty() || digits.size() > kMostDigits) return std::nullopt;
  return value;
}

// The stem "0003.0017.normal"; nothing for other names.
std::optional<ChunkFile> parse_chunk_name(const std::string& stem) {
  const std::size_t first = stem.find('.');
  if (first == std::string::npos) return std::nullopt;
  const std::size_t second = stem.find('.', first + 1);
  if (second == std::string::npos) return std::nullopt;
  const auto chunk = parse_index(std::string_view(stem).substr(0, first));
  const auto frame = parse_index(std::string_view(stem).substr(first + 1, second - first - 1));
  if (!chunk || !frame) return std::nullopt;
  return ChunkFile{*chunk, *frame, stem.substr(second + 1)};
}

// Of one pass: its files by place.
using Pass = std::map<std::pair<std::size_t, std::size_t>, fs::path>;

struct Clip {
  fs::path folder;
  std::map<std::string, Pass> passes;
  ChunkGrid grid;
  bool jpeg = false;
};

Clip read_clip(const fs::path& folder) {
  Clip clip{folder};
  if (!is_folder(folder)) return clip;
  for (const fs::path& path : list_files(folder, kPictureExtensions)) {
    const auto file = parse_chunk_name(path.stem().string());
    if (!file) continue;
    clip.passes[file->pass][{file->chunk, file->frame}] = path;
    clip.grid.chunks = std::max(clip.grid.chunks, file->chunk + 1);
    clip.grid.frames = std::max(clip.grid.frames, file->frame + 1);
    clip.jpeg = clip.jpeg || path.extension() != ".png";
  }
  return clip;
}

std::vector<Clip> find_clips(const fs::path& folder) {
  std::vector<Clip> clips;
  for (const fs::path& place : {folder, folder / "gbuffer_frames"}) {
    std::vector<fs::path> folders = list_folders(place);
    folders.insert(folders.begin(), place);
    for (const fs::path& candidate : folders)
      if (Clip clip = read_clip(candidate); !clip.passes.empty()) clips.push_back(std::move(clip));
  }
  return clips;
}

// The only one; of several that with the scene's name, or "images".
Clip choose_clip(std::vector<Clip> clips, const fs::path& folder, const SceneIndex& index) {
  if (clips.size() == 1) return std::move(clips.front());
  std::vector<std::string> names;
  for (const std::string& wanted : {index.name, std::string("images")})
    for (Clip& clip : clips)
      if (clip.folder.filename() == wanted) return std::move(clip);
  for (const Clip& clip : clips) names.push_back(clip.folder.filename().string());
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: priors of several clips ({}), none is called '{}' or 'images'; name the clip's own "
          "folder",
          folder.string(),
          fmt::join(names, ", "),
          index.name
      )
  );
}

// Would a program that read `pictures` frames have written these chunks? The last one may be
// padded, or have been dropped because it was short; of a single chunk nothing is known.
bool fits(const ChunkGrid& grid, std::size_t pictures) {
  if (grid.overlap >= grid.frames) return false;
  if (grid.chunks <= 1) return true;
  return pictures + grid.step() > grid.covered() && pictures < grid.covered() + grid.step();
}

// Sets the overlap. What the program does by default goes first: 6 frames, of the Cosmos version 0.
void settle_overlap(Clip& clip, std::size_t pictures, int stated) {
  ChunkGrid& grid = clip.grid;
  GLINT_CHECK(
      grid.frames <= kMostFrames,
      kBadReference,
      "{}: frame {} of a chunk; expected at most {} frames in each",
      clip.folder.string(),
      grid.frames - 1,
      kMostFrames
  );
  std::vector<std::size_t> candidates{6, 0};
  if (clip.jpeg) std::swap(candidates[0], candidates[1]);
  if (stated >= 0) candidates = {static_cast<std::size_t>(stated)};
  if (grid.chunks <= 1) candidates = {0};
  for (const std::size_t overlap : candidates) {
    grid.overlap = overlap;
    if (fits(grid, pictures)) return;
  }
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: {} chunks of {} frames do not fit {} pictures with an overlap of {} frames; they "
          "are "
          "of other pictures, or have another overlap: state it (--prior-overlap, prior_overlap)",
          clip.folder.string(),
          grid.chunks,
          grid.frames,
          pictures,
          fmt::join(candidates, " or ")
      )
  );
}

// Indices of the views in the order in which a program that lists the pictures reads them.
std::vector<std::size_t> picture_order(const std::vector<ViewSource>& views) {
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return views[a].image.generic_string() < views[b].image.generic_string();
  });
  return order;
}

// A file that should be there and is not is named as it should be, for the message of the reader.
fs::path file_of(const Clip& clip, const std::string& pass, ChunkFrame at) {
  const Pass& files = clip.passes.at(pass);
  const auto found = files.find({at.chunk, at.frame});
  if (found != files.end()) return found->second;
  return clip.folder /
         fmt::format("{:04}.{:04}.{}{}", at.chunk, at.frame, pass, clip.jpeg ? ".jpg" : ".png");
}

void add_notes(const Clip& clip, std::size_t pictures, FoundPriors& found) {
  std::vector<std::string> passes;
  for (const auto& [pass, files] : clip.passes) passes.push_back(pass);
  found.notes.push_back(fmt::format(
      "priors of {}: {} x {} frames, overlap {}, passes {}",
      found.program,
      clip.grid.chunks,
      clip.grid.frames,
      clip.grid.overlap,
      fmt::join(passes, ", ")
  ));
  if (clip.grid.covered() < pictures)
    found.notes.push_back(fmt::format(
        "only the first {} of {} pictures have priors of it; let the program process all chunks",
        clip.grid.covered(),
        pictures
    ));
}

}  // namespace

ChunkFrame frame_of_picture(const ChunkGrid& grid, std::size_t i) {
  ChunkFrame best{std::min(i / grid.step(), grid.chunks - 1), 0};
  best.frame = i - grid.step() * best.chunk;
  const auto distance = [&](std::size_t frame) {  // to the middle, in half frames
    const auto twice = static_cast<std::ptrdiff_t>(2 * frame);
    return std::abs(twice - static_cast<std::ptrdiff_t>(grid.frames - 1));
  };
  for (std::size_t chunk = best.chunk; chunk-- > 0;) {
    const std::size_t frame = i - grid.step() * chunk;
    if (frame >= grid.frames) break;
    if (distance(frame) < distance(best.frame)) best = {chunk, frame};
  }
  return best;
}

std::optional<FoundPriors> find_chunked_priors(
    const fs::path& folder, const SceneIndex& index, int overlap
) {
  std::vector<Clip> clips = find_clips(folder);
  if (clips.empty()) return std::nullopt;
  Clip clip = choose_clip(std::move(clips), folder, index);
  settle_overlap(clip, index.views.size(), overlap);
  FoundPriors found(index.views.size());
  found.program = clip.jpeg ? "DiffusionRenderer, Cosmos" : "DiffusionRenderer, SVD";
  found.documented.axes = PriorAxes::kOpengl;
  const std::vector<std::size_t> order = picture_order(index.views);
  const std::size_t count = std::min(order.size(), clip.grid.covered());
  for (std::size_t i = 0; i < count; ++i) {
    const ChunkFrame at = frame_of_picture(clip.grid, i);
    for (const MapRow& row : maps())
      if (!row.prior.empty() && clip.passes.contains(std::string(row.prior)))
        found.files[order[i]][row] = file_of(clip, std::string(row.prior), at);
    if (clip.passes.contains("metallic")) found.metallic[order[i]] = file_of(clip, "metallic", at);
  }
  add_notes(clip, order.size(), found);
  return found;
}

}  // namespace glint
