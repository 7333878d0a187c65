// SPDX-License-Identifier: MIT
// Maps in the samples that they were made of: a photo's bytes, the 8 bits a channel of a normal
// that was brought to unit length, the two bytes of a depth. Packed scenes keep those
// (sample_codec.h codes them) and decode them as the loaders do, to the very floats.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "glint/scene/maps.h"

namespace glint {

// Maps of one kind in one string, by the code with the fewest bits that gives all of them back bit
// for bit. Its first bytes say which, and what belongs to it.
std::string encode_maps(MapKind kind, std::span<const Image* const> maps);

// The same maps again, into images that have their sizes and channels; masks become 0 or 1.
// Returns what is wrong with the bytes; empty: nothing.
std::string decode_maps(std::string_view coded, MapKind kind, std::span<Image* const> maps);

// Whether so many bytes can hold so many samples: asked before room is made for them.
bool can_hold(std::size_t bytes, std::size_t samples);

// For truth that is only scored: depth in steps of a power of two (an eighth of a millimetre for
// rooms of up to 8 m), radiance in 16-bit floats. Normals and masks stay as they are.
void round_truth(MapKind kind, Image& map);

}  // namespace glint
