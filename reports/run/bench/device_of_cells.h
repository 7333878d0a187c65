// SPDX-License-Identifier: MIT
// On which device cells run: part of every key (stage_documents.h). That in use here, unless other
// processes run them.
#pragma once

#include <optional>

#include "glint/core/device.h"

namespace glint {

// For as long as it lives, cells are taken to run there, and not on the device in use here.
class DeviceOfCells {
 public:
  explicit DeviceOfCells(Device device) : before_(elsewhere_) { elsewhere_ = device; }
  ~DeviceOfCells() { elsewhere_ = before_; }
  DeviceOfCells(const DeviceOfCells&) = delete;
  DeviceOfCells& operator=(const DeviceOfCells&) = delete;

  static Device now() { return elsewhere_.value_or(current_device()); }

 private:
  static inline std::optional<Device> elsewhere_;
  std::optional<Device> before_;
};

}  // namespace glint
