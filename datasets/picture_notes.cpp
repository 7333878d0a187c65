// SPDX-License-Identifier: MIT
#include "datasets/picture_notes.h"

#include <algorithm>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/rng.h"
#include "glint/scene/image_files_stored.h"

namespace glint {
namespace {

// A picture whose camera states another size, which intrinsics are scaled by.
struct Scaled {
  const ViewSource* view;
  ImageSize stored;

  double of_width() const { return 1.0 * stored.width / view->camera.width; }
  double of_height() const { return 1.0 * stored.height / view->camera.height; }
  // Nobody resizes by a few pixels; and what is resized by more may be off by one from rounding.
  bool looks_cut() const {
    constexpr double kNearlyAll = 0.9;
    const double ratio = std::min(of_width(), of_height());
    return of_width() != of_height() && ratio > kNearlyAll && ratio < 1 / kNearlyAll;
  }
};

std::vector<Scaled> scaled_pictures(const SceneIndex& index, std::span<const ImageSize> stored) {
  std::vector<Scaled> scaled;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const ViewSource& view = index.views[i];
    const bool is_stated = view.camera.width > 0 && view.camera.height > 0;
    if (is_stated && view.scales_with_image && stored[i].width > 0 &&
        view.camera.size() != stored[i])
      scaled.push_back({&view, stored[i]});
  }
  return scaled;
}

std::size_t num_read(std::span<const ImageSize> stored) {
  return static_cast<std::size_t>(std::ranges::count_if(stored, [](ImageSize size) {
    return size.width > 0;
  }));
}

// "b.png has 47 x 36 pixels, its camera states 48 x 36, ratios 0.9792 of the width and 1 of the
// height"
std::string words_of(const Scaled& picture) {
  return fmt::format(
      "{} has {} x {} pixels, its camera states {} x {}, {}",
      picture.view->image.filename().string(),
      picture.stored.width,
      picture.stored.height,
      picture.view->camera.width,
      picture.view->camera.height,
      picture.of_width() == picture.of_height()
          ? fmt::format("a ratio of {:.4g}", picture.of_width())
          : fmt::format(
                "ratios {:.4g} of the width and {:.4g} of the height",
                picture.of_width(),
                picture.of_height()
            )
  );
}

// Empty: all are as stated.
std::string scaled_note(const SceneIndex& index, std::span<const ImageSize> stored) {
  const std::vector<Scaled> scaled = scaled_pictures(index, stored);
  if (scaled.empty()) return {};
  const auto cut = std::ranges::find_if(scaled, &Scaled::looks_cut);
  return fmt::format(
      "{} of {} pictures are of another size than their cameras state, and their intrinsics are "
      "scaled by the ratio: {}{}",
      scaled.size(),
      num_read(stored),
      words_of(cut == scaled.end() ? scaled.front() : *cut),
      cut == scaled.end() ? "" : "; if it was cut instead of scaled, that is wrong"
  );
}

// Empty: none states one.
std::string orientation_note(const SceneIndex& index, std::span<const ImageSize> stored) {
  std::size_t count = 0;
  std::string example;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored[i].width == 0) continue;
    const fs::path& image = index.views[i].image;
    const int orientation = stated_orientation(image);
    if (orientation == 1) continue;
    if (count++ == 0)
      example = fmt::format("{}: {}", image.filename().string(), orientation_words(orientation));
  }
  if (count == 0) return {};
  return fmt::format(
      "{} of {} pictures state an orientation other than as stored, as {}: pixels are taken as "
      "stored, as COLMAP and PIL do",
      count,
      num_read(stored),
      example
  );
}

std::string_view words_of(AlphaUse use) {
  switch (use) {
    case AlphaUse::kBlack:
      return "they are laid on black";
    case AlphaUse::kWhite:
      return "they are laid on white";
    case AlphaUse::kMask:
      return "pixels that are more than half transparent do not count";
    default:
      return "it is dropped, and what is transparent has the colour that the file has there";
  }
}

std::vector<const ViewSource*> views_with_alpha(const SceneIndex& index) {
  std::vector<const ViewSource*> views;
  for (const ViewSource& view : index.views)
    if (is_file(view.image) && has_alpha(view.image)) views.push_back(&view);
  return views;
}

// Empty: none has the channel.
std::string alpha_note(const SceneIndex& index) {
  std::vector<const ViewSource*> with_alpha = views_with_alpha(index);
  if (with_alpha.empty()) return {};
  const AlphaUse use = with_alpha.front()->alpha;
  std::string note = fmt::format(
      "{} of {} pictures have an alpha channel: {} (\"alpha\" in scene.json: black, white, mask or "
      "stored)",
      with_alpha.size(),
      index.views.size(),
      words_of(use)
  );
  constexpr std::size_t kMostLookedAt = 4;
  with_alpha.resize(std::min(with_alpha.size(), kMostLookedAt));
  if (use != AlphaUse::kStored && std::ranges::all_of(with_alpha, [](const ViewSource* view) {
        return looks_premultiplied(view->image);
      }))
    note +=
        "; no colour of theirs is brighter than its alpha, as where it is multiplied by it "
        "already, which PNG does not allow: if it is, \"stored\" lays them on black";
  return note;
}

}  // namespace

void check_picture_sizes(
    const SceneIndex& index, std::span<const ImageSize> stored, std::vector<Finding>& findings
) {
  const std::vector<Scaled> scaled = scaled_pictures(index, stored);
  const auto add = [&](const Scaled& first, std::string message) {
    findings.push_back({"intrinsics-size", first.view->image.string(), std::move(message)});
  };
  const auto cut = std::ranges::find_if(scaled, &Scaled::looks_cut);
  if (cut != scaled.end())
    add(*cut,
        fmt::format(
            "{}, as {} of {} pictures look: cut instead of scaled, which scaled intrinsics do not "
            "fit; use the whole pictures, or state the size and the principal point of these",
            words_of(*cut),
            std::ranges::count_if(scaled, &Scaled::looks_cut),
            num_read(stored)
        ));
  else if (!scaled.empty() && scaled.size() < num_read(stored))
    add(scaled.front(),
        fmt::format(
            "{}: {} of {} pictures are of another size than stated, the others are as stated; "
            "give all of them from one source",
            words_of(scaled.front()),
            scaled.size(),
            num_read(stored)
        ));
}

std::vector<std::string> picture_notes(const SceneIndex& index, std::span<const ImageSize> stored) {
  std::vector<std::string> notes;
  for (std::string note :
       {scaled_note(index, stored), orientation_note(index, stored), alpha_note(index)})
    if (!note.empty()) notes.push_back(std::move(note));
  return notes;
}

void mark_alpha_use(SceneIndex& index) {
  const std::vector<const ViewSource*> views = views_with_alpha(index);
  if (views.empty() || views.front()->alpha == AlphaUse::kStored) return;
  const int use = static_cast<int>(views.front()->alpha);
  index.spec_hash =
      fmt::format("{:016x}", hash_name(fmt::format("{} alpha {}", index.spec_hash, use)));
}

}  // namespace glint
