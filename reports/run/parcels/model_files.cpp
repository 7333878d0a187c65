// SPDX-License-Identifier: MIT
#include "reports/run/parcels/model_files.h"

#include <algorithm>
#include <cstring>

#include "glint/scene/ply.h"
#include "glint/scene/safetensors.h"
#include "reports/run/bench/run_stage.h"

namespace glint {
namespace {

constexpr float kUnseen = -20;  // logit of an opacity

std::optional<SurfelCloud> cloud_in(const fs::path& file) {
  if (file.extension() != ".ply") return std::nullopt;
  try {
    return read_surfel_ply(file);
  } catch (const Error&) {
    return std::nullopt;  // another kind of PLY file, or a name alone
  }
}

bool holds_arrays(const fs::path& file) {
  if (file.extension() != ".safetensors") return false;
  try {
    SafetensorsFile{file};
    return true;
  } catch (const Error&) {
    return false;
  }
}

// One that nobody sees.
SurfelCloud stand_in(const SurfelCloud& cloud) {
  SurfelCloud one;
  one.extra_names = cloud.extra_names;
  one.resize(std::min<std::size_t>(cloud.size(), 1));
  if (one.size() == 0) return one;
  std::copy_n(cloud.means.begin(), 3, one.means.begin());
  one.rotations[0] = 1;
  one.opacity_logits[0] = kUnseen;
  return one;
}

CompactFile cut_surfels(const SavedFile& file, const ModelCut& cut) {
  CompactFile compact{.name = file.name, .surfels = true, .count = file.cloud->size()};
  compact.empty = !cut.needs(file.name);
  if (compact.empty) {
    compact.code = pack_surfels(stand_in(*file.cloud), {});
    compact.code.order.assign(compact.code.order.size(), 0);
    return compact;
  }
  SurfelPacking packing{.tolerance = cut.tolerance};
  packing.seen = file.seen;
  packing.drop_below = cut.drop_below;
  packing.draft = cut.draft;
  for (const std::string& channel : file.cloud->extra_names)
    if (cut.needs_extra(file.name, channel)) packing.extras.push_back(channel);
  compact.code = pack_surfels(*file.cloud, packing);
  return compact;
}

// Arrays of a file, cut to the rows of kept surfels.
class ArrayCutter {
 public:
  explicit ArrayCutter(const std::vector<CompactFile>& surfels) : surfels_(surfels) {}

  std::string cut(const SavedFile& file, bool zeros) const {
    const TemporaryFolder folder("glint-parcel");
    write_file(folder / "in.safetensors", file.bytes);
    SafetensorsFile in(folder / "in.safetensors");
    std::vector<TensorToWrite> tensors;
    for (const std::string& name : in.names()) tensors.push_back(tensor(in, name, zeros));
    write_safetensors(folder / "out.safetensors", in.metadata(), tensors);
    return read_file(folder / "out.safetensors");
  }

 private:
  TensorToWrite tensor(SafetensorsFile& in, const std::string& name, bool zeros) const {
    TensorInfo info = *in.find(name);
    std::vector<std::byte> values(info.num_bytes());
    in.read_bytes(name, values);
    if (zeros && (info.type == TensorType::kF32 || info.type == TensorType::kF64))
      std::fill(values.begin(), values.end(), std::byte{0});
    if (const SurfelCode* code = code_of(info)) values = rows(values, *code, info);
    const auto fill = [values = std::move(values)](std::byte* to) {
      std::copy(values.begin(), values.end(), to);
    };
    return {name, info, fill};
  }

  // Of the surfels that the array has a row for; null: of none.
  const SurfelCode* code_of(const TensorInfo& info) const {
    if (info.shape.empty()) return nullptr;
    for (const CompactFile& file : surfels_)
      if (info.shape[0] == file.count) return &file.code;
    return nullptr;
  }

  static std::vector<std::byte> rows(
      const std::vector<std::byte>& values, const SurfelCode& code, TensorInfo& info
  ) {
    const std::size_t row = info.shape[0] == 0 ? 0 : values.size() / info.shape[0];
    std::vector<std::byte> kept;
    kept.reserve(row * code.order.size());
    for (const std::uint32_t i : code.order)
      kept.insert(
          kept.end(),
          values.begin() + static_cast<std::ptrdiff_t>(i * row),
          values.begin() + static_cast<std::ptrdiff_t>((i + 1) * row)
      );
    info.shape[0] = code.order.size();
    return kept;
  }

  const std::vector<CompactFile>& surfels_;
};

}  // namespace

std::vector<SavedFile> saved_files(const fs::path& run) {
  std::vector<SavedFile> files;
  for (const auto& [name, bytes] : finished_stage(run, Stage::kTrain, "train").files) {
    if (name == "env.json") continue;
    const fs::path path = run / name;
    SavedFile file{name, with_exit_code(ExitCode::kBadPrediction, [&] { return read_file(path); })};
    file.cloud = cloud_in(path);
    file.arrays = holds_arrays(path);
    files.push_back(std::move(file));
  }
  return files;
}

bool ModelCut::needs(const std::string& file) const {
  const auto found = needed.find(file);
  return found == needed.end() || found->second;
}

bool ModelCut::needs_extra(const std::string& file, const std::string& channel) const {
  const auto found = needed_extras.find(file + " " + channel);
  return found == needed_extras.end() || found->second;
}

std::vector<CompactFile> cut_files(const std::vector<SavedFile>& files, const ModelCut& cut) {
  std::vector<CompactFile> compact;
  for (const SavedFile& file : files)
    if (file.cloud) compact.push_back(cut_surfels(file, cut));
  const ArrayCutter cutter(compact);
  std::vector<CompactFile> others;
  for (const SavedFile& file : files) {
    if (file.cloud) continue;
    CompactFile other{.name = file.name, .bytes = file.bytes};
    other.zeroed = file.arrays && !cut.needs(file.name);
    if (file.arrays) other.bytes = cutter.cut(file, other.zeroed);
    others.push_back(std::move(other));
  }
  std::move(others.begin(), others.end(), std::back_inserter(compact));
  return compact;
}

}  // namespace glint
