// SPDX-License-Identifier: MIT
// A user without privileges while it lives: tests may run as root, to whom nothing is denied.
#pragma once

#include <unistd.h>

#include <cstdlib>

namespace glint::test {

class AsNobody {
 public:
  AsNobody() : was_root_(::geteuid() == 0), changed_(was_root_ && ::seteuid(kNobody) == 0) {}
  ~AsNobody() {
    if (changed_ && ::seteuid(0) != 0) std::abort();
  }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;

  // False: this machine knows no such user.
  bool lacks_privileges() const { return changed_ || !was_root_; }

 private:
  static constexpr uid_t kNobody = 65534;
  bool was_root_, changed_;
};

}  // namespace glint::test
