// SPDX-License-Identifier: MIT
// A parcel: what one cell that ended leaves for another machine, in one small file. It holds files
// of the run folder, and what is left of the model (compact_model.h). docs/reference/records.md has
// the format.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reports/run/parcels/compact_model.h"
#include "reports/run/records/merge_runs.h"

namespace glint {

inline constexpr const char* kParcelExtension = ".parcel";

struct Parcel {
  Record record;
  std::map<std::string, std::string> files;  // of the run folder, record.json among them
  CompactModel model;                        // without files: the cell has none
  std::string sha256;                        // of the file; set by read_parcel()
};

// "room_1+glint+plus+0.parcel": a name for people, nothing is read from it.
std::string parcel_name(const CellKey& cell);

// Atomically. Errors (kEnvironment): as write_file.
void write_parcel(const fs::path& path, const Parcel& parcel);

// Nothing of it is believed before it was compared with the file: names stay below a folder, sizes
// are what the bytes can hold, every field has its SHA-256, surfels are finite. Errors
// (kBadPrediction), naming the file: cut off, damaged, of a newer version, no parcel.
Parcel read_parcel(const fs::path& path);

// By which a parcel knows its own parts: 20 hexadecimal digits of their SHA-256.
std::string parcel_hash(std::string_view bytes);

// The record of a parcel, without reading the rest. Errors: those of read_parcel().
Record read_parcel_record(const fs::path& path);

}  // namespace glint
