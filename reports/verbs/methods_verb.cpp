// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/nearest.h"
#include "glint/method.h"
#include "reports/verbs/listing.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

// Beside photos, cameras and points, which all want.
std::string inputs_text(const Method& method) {
  const std::vector<std::string> inputs = method.inputs();
  return inputs.empty() ? "-" : comma_list(inputs);
}

// Beside what a method is.
std::string description_of(const MethodSpec& spec) {
  return spec.description + (spec.rival ? "" : "; not ranked in tables");
}

// "glint" of "glint/no-trans".
std::string base_of(const std::string& id) { return id.substr(0, id.find('/')); }

// Ids of the others of a method's family: "2dgs/bounded", "2dgs/prior" of "2dgs".
std::vector<std::string> variants_of(const std::string& id) {
  std::vector<std::string> variants;
  for (const auto& [other, spec] : Registry<MethodSpec>::all())
    if (other != id && base_of(other) == base_of(id)) variants.push_back(other);
  return variants;
}

Json spec_json(const MethodSpec& spec) {
  const auto method = create_method(spec.id);
  return {
      {"id", spec.id},
      {"title", spec.title},
      {"description", spec.description},
      {"citation", spec.citation},
      {"inputs", method->inputs()},
      {"overrides", spec.overrides},
      {"rival", spec.rival},
      {"source", spec.source}};
}

// Defaults are those of the family's first, "override" what the variant sets instead.
Json method_json(const MethodSpec& spec) {
  Json json = spec_json(spec);
  json["variants"] = variants_of(spec.id);
  json["fields"] = Json::array();
  const auto plain = spec.create(Json::object());
  for (const ConfigField& field : plain->fields()) {
    Json entry = {
        {"name", field.name},
        {"type", field.type()},
        {"default", field.value},
        {"meaning", field.meaning}};
    if (const auto it = spec.overrides.find(field.name); it != spec.overrides.end())
      entry["override"] = *it;
    json["fields"].push_back(std::move(entry));
  }
  return json;
}

std::string list_text() {
  std::vector<std::vector<std::string>> rows = {{"id", "title", "wants", "what it is"}};
  for (const auto& [id, spec] : Registry<MethodSpec>::all())
    rows.push_back({id, spec.title, inputs_text(*create_method(id)), description_of(spec)});
  return listing(rows, terminal_width()) +
         "\nwants: what training looks at beside photos, cameras and points; where it is missing, "
         "its "
         "loss is off, with a\nwarning. `glint-bench methods ID` lists the config fields of one.\n";
}

// 0.05, not 0.05000000074505806: a float's shortest text that reads back as it.
std::string value_text(const Json& value) {
  if (value.is_number_float()) return fmt::format("{}", value.get<float>());
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string method_text(const MethodSpec& spec) {
  const Json json = method_json(spec);
  const std::vector<std::string> variants = json["variants"];
  std::string text = fmt::format("{} ({}): {}\n", spec.id, spec.title, description_of(spec));
  text += fmt::format(
      "trained on: photos, cameras, points; wants {}\n", inputs_text(*create_method(spec.id))
  );
  if (!variants.empty()) text += fmt::format("same family: {}\n", comma_list(variants));
  text += fmt::format("set with: --set {}.NAME=VALUE\n\n", spec.id);
  const bool is_variant = !spec.overrides.empty();
  std::vector<std::vector<std::string>> rows = {{"field", "type", "default"}};
  if (is_variant) rows[0].push_back(spec.id);
  rows[0].emplace_back("meaning");
  for (const Json& field : json["fields"]) {
    std::vector<std::string> row = {field["name"], field["type"], value_text(field["default"])};
    if (is_variant) row.push_back(field.contains("override") ? value_text(field["override"]) : "");
    row.push_back(field["meaning"]);
    rows.push_back(std::move(row));
  }
  return text + listing(rows, terminal_width());
}

int run_methods(const CommonOptions& common, const std::string& id) {
  if (!common.json) {
    print_text(id.empty() ? list_text() : method_text(find_method(id)));
    return 0;
  }
  if (!id.empty()) {
    print_json(method_json(find_method(id)));
    return 0;
  }
  Json json = {{"methods", Json::array()}};
  for (const auto& [known, spec] : Registry<MethodSpec>::all())
    json["methods"].push_back(spec_json(spec));
  print_json(json);
  return 0;
}

void add_methods_verb(CommandLine& line) {
  auto id = std::make_shared<std::string>();
  line.add_verb(
          line.app,
          "methods",
          "list the methods; of one every config field",
          [&line, id] { return run_methods(line.common, *id); },
          kJsonOption
  )
      ->add_option("method", *id, "id, e.g. glint/release");
}

}  // namespace

GLINT_REGISTER(Verb, {"methods", add_methods_verb})

}  // namespace glint
