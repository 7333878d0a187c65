// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/nearest.h"
#include "glint/core/rows.h"
#include "glint/method.h"
#include "glint/setting_guide.h"
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

Rows rows_of(const std::vector<const MethodSpec*>& specs) {
  Rows rows(
      {{"id", "id"}, {"title", "title"}, {"inputs", "wants"}, {"description", "what it is"}},
      "citation overrides rival source"
  );
  for (const MethodSpec* spec : specs) {
    const auto method = create_method(spec->id);
    rows.add(
        {spec->id,
         spec->title,
         {method->inputs(), inputs_text(*method)},
         {spec->description, description_of(*spec)},
         spec->citation,
         spec->overrides,
         spec->rival,
         spec->source}
    );
  }
  return rows;
}

Rows rows_of_all() {
  std::vector<const MethodSpec*> specs;
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) specs.push_back(&spec);
  return rows_of(specs);
}

// 0.05, not 0.05000000074505806: a float's shortest text that reads back as it.
Cell value_cell(const Json& value) {
  if (value.is_number_float()) return {value, fmt::format("{}", value.get<float>())};
  return {value, value.is_string() ? value.get<std::string>() : value.dump()};
}

// Defaults are those of the family's first, "override" what the variant sets instead; whose values
// and which group where the family has a guide.
std::vector<Column> columns_of(const MethodSpec& spec, bool guided) {
  std::vector<Column> columns{{"name", "field"}, {"type", "type"}, {"default", "default"}};
  if (!spec.overrides.empty()) columns.push_back({"override", spec.id});
  columns.push_back({"range", "range"});
  if (guided) columns.insert(columns.end(), {{"value_from", "from"}, {"group", "group"}});
  columns.push_back({"meaning", "meaning"});
  return columns;
}

std::vector<Cell> cells_of(const ListedSetting& setting, const MethodSpec& spec, bool guided) {
  const ConfigField& field = setting.field;
  std::vector<Cell> cells{field.name, field.type(), value_cell(field.value)};
  const auto set = spec.overrides.find(field.name);
  if (!spec.overrides.empty())
    cells.push_back(set == spec.overrides.end() ? Cell::absent() : value_cell(*set));
  cells.push_back(setting.range.empty() ? Cell::absent() : setting.range);
  if (guided) {
    cells.emplace_back(setting.value_from);
    cells.emplace_back(Json(setting.group), setting.is_first ? "first" : setting.group);
  }
  cells.emplace_back(field.meaning);
  cells.push_back(guided ? Cell(setting.is_first) : Cell::absent());
  return cells;
}

Rows fields_of(const MethodSpec& spec) {
  const std::vector<ListedSetting> settings = listed_settings(base_of(spec.id));
  const bool guided = !settings.empty() && !settings.front().group.empty();
  Rows rows(columns_of(spec, guided), "first");
  for (const ListedSetting& setting : settings) rows.add(cells_of(setting, spec, guided));
  return rows;
}

Json method_json(const MethodSpec& spec) {
  Json json = rows_of({&spec}).json().front();
  json["variants"] = variants_of(spec.id);
  json["fields"] = fields_of(spec).json();
  return json;
}

std::string list_text() {
  return rows_of_all().text(terminal_width()) +
         "\nwants: what training looks at beside photos, cameras and points; where it is missing, "
         "its "
         "loss is off, with a\nwarning. `glint-bench methods ID` lists the config fields of one.\n";
}

std::string method_text(const MethodSpec& spec) {
  const std::vector<std::string> variants = variants_of(spec.id);
  std::string text = fmt::format("{} ({}): {}\n", spec.id, spec.title, description_of(spec));
  text += fmt::format(
      "trained on: photos, cameras, points; wants {}\n", inputs_text(*create_method(spec.id))
  );
  if (!variants.empty()) text += fmt::format("same family: {}\n", comma_list(variants));
  text += fmt::format("set with: --set {}.NAME=VALUE\n\n", spec.id);
  return text + fields_of(spec).text(terminal_width());
}

int run_methods(const CommonOptions& common, const std::string& id) {
  if (!common.json)
    print_text(id.empty() ? list_text() : method_text(find_method(id)));
  else
    print_json(id.empty() ? Json{{"methods", rows_of_all().json()}} : method_json(find_method(id)));
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
