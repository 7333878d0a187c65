// SPDX-License-Identifier: MIT
// Arrays of NumPy and images of ours. What comes in is checked: float32, [H][W][C]. What goes out
// is the image's own memory, which the owner keeps alive.
#pragma once

#include <pybind11/numpy.h>

#include <memory>
#include <string>

#include "glint/core/image.h"
#include "glint/scene/maps.h"

namespace glint::python {

// A copy of an array [H][W][channels]; of one channel [H][W], too. `name` opens messages. Throws
// TypeError (no array, not float32) and ValueError (shape), which say what to do.
Image image_of(pybind11::handle array, const std::string& name, int channels);

// bool, uint8 (not 0: counts) or float32 (above a half: counts), [H][W] or [H][W][1]; None: empty.
MaskImage mask_of(pybind11::handle array, const std::string& name);

// Rows of `columns` numbers: float32 [N][columns]. Throws as image_of().
template <class Row>
std::vector<Row> rows_of(pybind11::handle array, const std::string& name);

// Maps by id, each with the channels of its row in the table (glint/scene/maps.h). Throws
// ValueError for an id that is none.
MapSet maps_of(const pybind11::dict& maps, const std::string& name);

// float32 [H][W][C], not to be written.
pybind11::array array_of(const Image& image, pybind11::handle owner);
// {id: array} of maps that live in `owner`.
pybind11::dict arrays_of(const MapSet& maps, pybind11::handle owner);
// The same of maps that nobody else has: they may be written.
pybind11::dict arrays_of(MapSet&& maps);

}  // namespace glint::python
