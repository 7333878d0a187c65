// SPDX-License-Identifier: MIT
// What methods of surfel sets have in common: their config, their files, their state; and how the
// variants of one class are told apart.
#pragma once

#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "glint/method.h"
#include "glint/removed_settings.h"
#include "glint/train/trainable_set.h"
#include "glint/train/training_state.h"

namespace glint {

class SurfelMethod : public Method {
 public:
  void save(const std::string& folder) const override;
  void load(const std::string& folder) override;
  void check_finite() const override;
  bool visit_state(TrainingState& state) override;
  std::size_t num_surfels() const override;
  std::vector<MethodSet> sets() const override { return sets_; }
  std::vector<std::string> warnings() const final { return warnings_; }

 protected:
  // Errors (kBadPrediction): the first set's file, in this folder, has other extra channels.
  void check_channels(
      const std::string& folder, const std::vector<std::string>& names, std::size_t set = 0
  ) const;

  std::vector<MethodSet> sets_;  // members of what derives from this, whose constructor says which
  std::vector<std::string> warnings_;
};

template <class C>
class MethodOf : public SurfelMethod {
 public:
  using Config = C;
  Json config() const final { return config_to_json(config_); }
  std::vector<ConfigField> fields() const final { return config_fields(config_); }

 protected:
  explicit MethodOf(C config) : config_(std::move(config)) {}

  C config_;
};

// One of the methods that a class is, with what it sets of the config; the first of a list sets
// nothing.
template <class Config>
struct Variant {
  const char *id, *title, *paper_row, *description;
  void (*set)(Config&) = nullptr;
  bool rival = true;
};

// What a config has other than a method's plain one.
inline Json changed_fields(const Json& plain, const Json& config) {
  Json changed = Json::object();
  for (const auto& field : config.items())
    if (plain.at(field.key()) != field.value()) changed[field.key()] = field.value();
  return changed;
}

// Registers them as methods of `file` (__FILE__). A class is made from its config.
template <class M>
bool register_methods(
    const char* file,
    const char* citation,
    std::initializer_list<Variant<typename M::Config>> variants
) {
  using Config = typename M::Config;
  bool all_new = true;
  for (const Variant<Config>& variant : variants) {
    Config set;
    if (variant.set != nullptr) variant.set(set);
    MethodSpec spec;
    spec.id = variant.id;
    spec.title = variant.title;
    spec.citation = citation;
    spec.paper_row = variant.paper_row;
    spec.description = variant.description;
    spec.overrides = changed_fields(config_to_json(Config{}), config_to_json(set));
    spec.rival = variant.rival;
    spec.create = [set, id = spec.id](const Json& json) {
      Config config = set;
      Json offered = json;
      drop_removed_settings(id, config_to_json(config), offered);
      config_from_json(config, offered, id);
      return std::make_unique<M>(std::move(config));
    };
    all_new = Registry<MethodSpec>::add(std::move(spec), file) && all_new;
  }
  return all_new;
}

}  // namespace glint
