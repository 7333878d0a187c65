// SPDX-License-Identifier: MIT
// Letters by pango.
#include <pango/pangocairo.h>

#include <cctype>
#include <memory>
#include <numbers>

#include "glint/drawing/canvas.h"

namespace glint {

namespace {

constexpr double kPixelsPerInch = 72;                     // a size is in points, and so is the page
constexpr double kLoweredSize = 0.72, kLoweredBy = 0.16;  // of subscripts, to the text's size

struct ObjectDeleter {
  void operator()(void* object) const { g_object_unref(object); }
};
using Context = std::unique_ptr<PangoContext, ObjectDeleter>;
using Layout = std::unique_ptr<PangoLayout, ObjectDeleter>;

struct FontDeleter {
  void operator()(PangoFontDescription* font) const { pango_font_description_free(font); }
};
using Font = std::unique_ptr<PangoFontDescription, FontDeleter>;

struct AttributesDeleter {
  void operator()(PangoAttrList* list) const { pango_attr_list_unref(list); }
};
using Attributes = std::unique_ptr<PangoAttrList, AttributesDeleter>;

Context make_context() {
  Context context(pango_font_map_create_context(pango_cairo_font_map_get_default()));
  pango_cairo_context_set_resolution(context.get(), kPixelsPerInch);
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  pango_cairo_context_set_font_options(context.get(), options);
  cairo_font_options_destroy(options);
  pango_context_set_round_glyph_positions(context.get(), FALSE);
  return context;
}

Font font_of(const TextStyle& style) {
  Font font(pango_font_description_new());
  pango_font_description_set_family(font.get(), kFontFamily);
  pango_font_description_set_size(font.get(), pango_units_from_double(style.size));
  if (style.bold) pango_font_description_set_weight(font.get(), PANGO_WEIGHT_SEMIBOLD);
  return font;
}

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

// The '_' at `i` lowers what follows: one letter stands before it, a letter behind it.
bool lowers(const std::string& text, std::size_t i) {
  return text[i] == '_' && i > 0 && i + 1 < text.size() && is_letter(text[i - 1]) &&
         is_letter(text[i + 1]) && (i == 1 || text[i - 2] == ' ' || text[i - 2] == '\n');
}

// Text without the '_' of subscripts, and where it is lowered.
struct Lowered {
  std::string text;
  Attributes attributes{pango_attr_list_new()};

  void lower(std::size_t begin, std::size_t end, double size) {
    for (PangoAttribute* attribute :
         {pango_attr_size_new(pango_units_from_double(kLoweredSize * size)),
          pango_attr_rise_new(-pango_units_from_double(kLoweredBy * size))}) {
      attribute->start_index = static_cast<guint>(begin);
      attribute->end_index = static_cast<guint>(end);
      pango_attr_list_insert(attributes.get(), attribute);
    }
  }
};

Lowered lowered(const std::string& text, double size) {
  Lowered result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!lowers(text, i)) {
      result.text += text[i];
      continue;
    }
    const std::size_t begin = result.text.size();
    while (i + 1 < text.size() && is_letter(text[i + 1])) result.text += text[++i];
    result.lower(begin, result.text.size(), size);
  }
  return result;
}

Layout layout_of(const std::string& text, const TextStyle& style) {
  const Context context = make_context();
  Layout layout(pango_layout_new(context.get()));
  const Lowered parts = lowered(text, style.size);
  pango_layout_set_text(layout.get(), parts.text.data(), static_cast<int>(parts.text.size()));
  pango_layout_set_attributes(layout.get(), parts.attributes.get());
  pango_layout_set_font_description(layout.get(), font_of(style).get());
  pango_layout_set_wrap(layout.get(), PANGO_WRAP_WORD_CHAR);
  if (style.wrap > 0) pango_layout_set_width(layout.get(), pango_units_from_double(style.wrap));
  constexpr PangoAlignment kAlignments[] = {
      PANGO_ALIGN_LEFT, PANGO_ALIGN_CENTER, PANGO_ALIGN_RIGHT};
  pango_layout_set_alignment(layout.get(), kAlignments[static_cast<int>(style.align)]);
  return layout;
}

// Where the layout's own left edge stands, from the point that it is drawn at.
double shift_of(PangoLayout* layout, const TextStyle& style) {
  int width = 0;
  pango_layout_get_size(layout, &width, nullptr);
  if (style.wrap > 0) width = pango_units_from_double(style.wrap);
  return -pango_units_to_double(width) * static_cast<int>(style.align) / 2;
}

double last_baseline_of(PangoLayout* layout) {
  PangoLayoutIter* lines = pango_layout_get_iter(layout);
  while (pango_layout_iter_next_line(lines)) continue;
  const int baseline = pango_layout_iter_get_baseline(lines);
  pango_layout_iter_free(lines);
  return pango_units_to_double(baseline);
}

}  // namespace

std::string found_font_family() {
  const Context context = make_context();
  PangoFont* font = pango_context_load_font(context.get(), font_of({}).get());
  if (font == nullptr) return "none";
  const Font description(pango_font_describe(font));
  g_object_unref(font);
  return pango_font_description_get_family(description.get());
}

TextSize measure_text(const std::string& text, const TextStyle& style) {
  const Layout layout = layout_of(text, style);
  int width = 0, height = 0;
  pango_layout_get_size(layout.get(), &width, &height);
  return {
      pango_units_to_double(width),
      pango_units_to_double(height),
      pango_units_to_double(pango_layout_get_baseline(layout.get())),
      last_baseline_of(layout.get())};
}

void Canvas::text(const std::string& text, Point at, const TextStyle& style) {
  const Layout layout = layout_of(text, style);
  cairo_save(cairo_);
  cairo_set_source_rgb(cairo_, style.color.red, style.color.green, style.color.blue);
  cairo_translate(cairo_, at.x + shift_of(layout.get(), style), at.y);
  cairo_move_to(cairo_, 0, 0);
  pango_cairo_update_layout(cairo_, layout.get());
  pango_cairo_show_layout(cairo_, layout.get());
  cairo_restore(cairo_);
}

void Canvas::text_upwards(const std::string& text, Point at, const TextStyle& style) {
  cairo_save(cairo_);
  cairo_translate(cairo_, at.x, at.y);
  cairo_rotate(cairo_, -std::numbers::pi / 2);
  this->text(text, {0, 0}, style);
  cairo_restore(cairo_);
}

}  // namespace glint
