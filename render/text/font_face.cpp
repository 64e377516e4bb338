#include "render/text/font_face.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H
#include <hb.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

namespace gs::render {
namespace {

constexpr double kSlant = 0.2;  // horizontal shear that imitates italics
constexpr double kBoldStroke = 1.0 / 24;  // width in ems that imitates bold
constexpr int kMaxSegments = 64;  // maximum segments of a curve
constexpr std::size_t kContextLength = 5;  // characters before and after a run that HarfBuzz may examine

/// Returns the FreeType library of the process. It has no locks, so callers must hold one.
FT_Library free_type() {
  static const FT_Library library = [] {
    FT_Library made = nullptr;
    return FT_Init_FreeType(&made) == 0 ? made : nullptr;
  }();
  return library;
}

/// Receiver of curves from FT_Outline_Decompose. Replaces curves by segments, in font units.
struct Flattener {
  Contours contours;
  double tolerance;  // maximum deviation in font units

  static glm::dvec2 point(const FT_Vector* v) { return {static_cast<double>(v->x), static_cast<double>(v->y)}; }
  void add(const glm::dvec2& p) {
    if (contours.back().empty() || contours.back().back() != p) contours.back().push_back(p);
  }
  /// Returns the number of segments of a curve. `bend` is the second difference of its control points.
  [[nodiscard]] int segments(double bend) const {
    return std::clamp(static_cast<int>(std::ceil(std::sqrt(bend / tolerance))), 1, kMaxSegments);
  }
  static int move(const FT_Vector* to, void* self) {
    auto& all = *static_cast<Flattener*>(self);
    all.contours.emplace_back();
    all.add(point(to));
    return 0;
  }
  static int line(const FT_Vector* to, void* self) {
    static_cast<Flattener*>(self)->add(point(to));
    return 0;
  }
  static int conic(const FT_Vector* control, const FT_Vector* to, void* self) {
    auto& all = *static_cast<Flattener*>(self);
    const glm::dvec2 a = all.contours.back().back(), b = point(control), c = point(to);
    // The chord of a parabola deviates by an eighth of the second derivative, 2 (a - 2 b + c).
    const int count = all.segments(glm::length(a - 2.0 * b + c) / 4);
    for (int i = 1; i <= count; ++i) {
      const double t = static_cast<double>(i) / count, u = 1 - t;
      all.add(u * u * a + 2 * u * t * b + t * t * c);
    }
    return 0;
  }
  static int cubic(const FT_Vector* control_1, const FT_Vector* control_2, const FT_Vector* to, void* self) {
    auto& all = *static_cast<Flattener*>(self);
    const glm::dvec2 a = all.contours.back().back(), b = point(control_1), c = point(control_2), d = point(to);
    const int count = all.segments(std::max(glm::length(a - 2.0 * b + c), glm::length(b - 2.0 * c + d)) * 6 / 8);
    for (int i = 1; i <= count; ++i) {
      const double t = static_cast<double>(i) / count, u = 1 - t;
      all.add(u * u * u * a + 3 * u * u * t * b + 3 * u * t * t * c + t * t * t * d);
    }
    return 0;
  }
};

hb_direction_t direction_of(vrml::TextDirection direction) {
  switch (direction) {
    case vrml::TextDirection::right:
      return HB_DIRECTION_LTR;
    case vrml::TextDirection::left:
      return HB_DIRECTION_RTL;
    case vrml::TextDirection::down:
      return HB_DIRECTION_TTB;
    case vrml::TextDirection::up:
      return HB_DIRECTION_BTT;
  }
  return HB_DIRECTION_LTR;
}

/// Returns a rectangle with the area of a shape, at the centre of its bounding box.
vrml::GlyphShape bar_of(const vrml::GlyphShape& shape) {
  if (shape.triangles.empty()) return {};
  glm::vec2 lower = shape.points.front(), upper = lower;
  for (const glm::vec2& p : shape.points) lower = glm::min(lower, p), upper = glm::max(upper, p);
  double area = 0;
  for (std::size_t i = 0; i < shape.triangles.size(); i += 3) {
    const glm::dvec2 a(shape.points[shape.triangles[i]]), b(shape.points[shape.triangles[i + 1]]),
        c(shape.points[shape.triangles[i + 2]]);
    area += ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
  }
  const glm::vec2 size = upper - lower, middle = (lower + upper) * 0.5f;
  const double part = area / (double{size.x} * size.y);
  const glm::vec2 half = size * (0.5f * static_cast<float>(std::sqrt(std::clamp(part, 0.0, 1.0))));
  vrml::GlyphShape bar;
  bar.points = {
      middle - half, {middle.x + half.x, middle.y - half.y}, middle + half, {middle.x - half.x, middle.y + half.y}};
  bar.triangles = {0, 1, 2, 0, 2, 3};
  return bar;
}

std::size_t bytes_of(const vrml::GlyphShape& shape) {
  return sizeof(shape) + shape.points.size() * sizeof(glm::vec2) + shape.triangles.size() * sizeof(std::uint32_t);
}

/// Bar that represents a word: bounding box of its glyphs, and their area.
struct Word {
  double left = HUGE_VAL, right = -HUGE_VAL, area = 0, low = 0, high = 0;  // low, high: sums, weighted by area

  void add(const vrml::GlyphShape& bar, const glm::dvec2& at) {
    const glm::dvec2 lower = at + glm::dvec2(bar.points[0]), upper = at + glm::dvec2(bar.points[2]);
    const double more = (upper.x - lower.x) * (upper.y - lower.y);
    left = std::min(left, lower.x);
    right = std::max(right, upper.x);
    area += more;
    low += more * lower.y;
    high += more * upper.y;
  }
  void finish(std::vector<vrml::PlacedGlyph>& glyphs) {
    if (area > 0 && right > left) {
      const auto width = static_cast<float>(right - left), bottom = static_cast<float>(low / area),
                 top = static_cast<float>(high / area);
      const auto [from, to] = GlyphSheet::grey(area / ((right - left) * (high - low) / area), {width, top - bottom});
      auto bar = std::make_shared<vrml::GlyphShape>();
      bar->points = {{0, bottom}, {width, bottom}, {width, top}, {0, top}};
      bar->coordinates = {from, {to.x, from.y}, to, {from.x, to.y}};
      bar->triangles = {0, 1, 2, 0, 2, 3};
      glyphs.push_back({std::move(bar), glm::vec2(static_cast<float>(left), 0)});
    }
    *this = {};
  }
};

}  // namespace

struct FontFace::Handles {
  struct Destroy {
    void operator()(hb_blob_t* blob) const { hb_blob_destroy(blob); }
    void operator()(hb_face_t* face) const { hb_face_destroy(face); }
    void operator()(hb_font_t* font) const { hb_font_destroy(font); }
    void operator()(hb_buffer_t* buffer) const { hb_buffer_destroy(buffer); }
  };
  std::unique_ptr<hb_blob_t, Destroy> blob;
  std::unique_ptr<hb_face_t, Destroy> face;
  std::unique_ptr<hb_font_t, Destroy> font;
  std::unique_ptr<hb_buffer_t, Destroy> buffer;
  FT_Face outlines = nullptr;

  Handles() = default;
  ~Handles() {
    if (outlines) FT_Done_Face(outlines);
  }
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
};

FontFace::FontFace(std::unique_ptr<Handles> handles, Synthetic synthetic, GlyphSheet* sheet)
    : handles_(std::move(handles)),
      sheet_(sheet),
      synthetic_(synthetic),
      units_per_em_(std::max<double>(handles_->outlines->units_per_EM, 1)) {}

FontFace::~FontFace() = default;

std::unique_ptr<FontFace> FontFace::open(const std::string& path, int index, Synthetic synthetic, GlyphSheet* sheet) {
  auto handles = std::make_unique<Handles>();
  handles->blob.reset(hb_blob_create_from_file_or_fail(path.c_str()));
  if (!handles->blob || !free_type()) return nullptr;
  unsigned length = 0;
  const char* bytes = hb_blob_get_data(handles->blob.get(), &length);
  if (FT_New_Memory_Face(free_type(), reinterpret_cast<const FT_Byte*>(bytes), static_cast<FT_Long>(length), index,
                         &handles->outlines) != 0)
    return nullptr;
  if (!FT_IS_SCALABLE(handles->outlines) || !FT_IS_SFNT(handles->outlines)) return nullptr;
  handles->face.reset(hb_face_create(handles->blob.get(), static_cast<unsigned>(index) & 0xFFFF));
  handles->font.reset(hb_font_create(handles->face.get()));
  const int units = std::max<int>(handles->outlines->units_per_EM, 1);
  hb_font_set_scale(handles->font.get(), units, units);
  const unsigned instance = static_cast<unsigned>(index) >> 16;
  if (instance > 0) hb_font_set_var_named_instance(handles->font.get(), instance - 1);
  handles->buffer.reset(hb_buffer_create());
  return std::unique_ptr<FontFace>(new FontFace(std::move(handles), synthetic, sheet));
}

bool FontFace::has(char32_t character) const {
  hb_codepoint_t glyph = 0;
  return hb_font_get_nominal_glyph(handles_->font.get(), character, &glyph) != 0;
}

vrml::LineEdges FontFace::edges() const {
  hb_font_extents_t extents{};
  hb_font_get_h_extents(handles_->font.get(), &extents);
  const double above = extents.ascender, below = -static_cast<double>(extents.descender);
  if (!(above > 0) || !(below >= 0)) return {};
  return {static_cast<float>(above / (above + below)), static_cast<float>(below / (above + below))};
}

Contours FontFace::contours(std::uint32_t glyph, double tolerance) {
  FT_Face face = handles_->outlines;
  if (FT_Load_Glyph(face, glyph, FT_LOAD_NO_SCALE | FT_LOAD_NO_BITMAP | FT_LOAD_IGNORE_TRANSFORM) != 0 ||
      face->glyph->format != FT_GLYPH_FORMAT_OUTLINE)
    return {};
  FT_Outline& outline = face->glyph->outline;
  if (synthetic_.bold) FT_Outline_Embolden(&outline, static_cast<FT_Pos>(kBoldStroke * units_per_em_));
  FT_Outline_Funcs functions{};
  functions.move_to = &Flattener::move;
  functions.line_to = &Flattener::line;
  functions.conic_to = &Flattener::conic;
  functions.cubic_to = &Flattener::cubic;
  // Half of the tolerance is for the segments, half for simplification.
  Flattener flattener{{}, tolerance * units_per_em_ / 2};
  if (FT_Outline_Decompose(&outline, &functions, &flattener) != 0) return {};
  for (auto& contour : flattener.contours) {
    if (contour.size() > 1 && contour.front() == contour.back()) contour.pop_back();
    contour = simplified(contour, flattener.tolerance);
    for (glm::dvec2& p : contour) {
      if (synthetic_.slanted) p.x += kSlant * p.y;
      p /= units_per_em_;
    }
  }
  return std::move(flattener.contours);
}

std::shared_ptr<const vrml::GlyphShape> FontFace::glyph(std::uint32_t index, std::size_t level) {
  const auto [found, fresh] = outlines_[level].try_emplace(index);
  if (fresh) {
    vrml::GlyphShape shape;
    if (level == vrml::kTextPictures) {
      shape = picture_of(index);
    } else {
      const std::size_t cut = std::min(level, vrml::kTextPictures - 1);
      shape = fill(contours(index, vrml::kTextTolerances[cut]), triangulator_);
      if (level == vrml::kTextBars) shape = bar_of(shape);
      kept_ += bytes_of(shape);
    }
    if (!shape.triangles.empty()) found->second = std::make_shared<const vrml::GlyphShape>(std::move(shape));
  }
  return found->second;
}

// Returns a glyph of the atlas. If the atlas is full, returns triangles at a completely covered position of the atlas.
vrml::GlyphShape FontFace::picture_of(std::uint32_t index) {
  if (sheet_)
    if (auto rectangle = sheet_->add(contours(index, vrml::kTextTolerances[1]))) return std::move(*rectangle);
  vrml::GlyphShape shape = fill(contours(index, vrml::kTextTolerances[vrml::kTextPictures]), triangulator_);
  shape.coordinates.assign(shape.points.size(), GlyphSheet::solid());
  return shape;
}

void FontFace::forget_outlines() {
  // A glyph keeps its position in the atlas, so keep atlas glyphs.
  for (std::size_t level = 0; level < outlines_.size(); ++level)
    if (level != vrml::kTextPictures) outlines_[level].clear();
  kept_ = 0;
}

double FontFace::shape(std::span<const char32_t> text, std::size_t first, std::size_t end, const RunStyle& style,
                       double pen, std::size_t level, std::vector<vrml::PlacedGlyph>& glyphs) {
  hb_buffer_t* buffer = handles_->buffer.get();
  hb_buffer_clear_contents(buffer);
  const std::size_t from = first - std::min(first, kContextLength), to = std::min(text.size(), end + kContextLength);
  hb_buffer_add_utf32(buffer, reinterpret_cast<const std::uint32_t*>(text.data() + from), static_cast<int>(to - from),
                      static_cast<unsigned>(first - from), static_cast<int>(end - first));
  hb_buffer_set_direction(buffer, direction_of(style.direction));
  hb_buffer_set_script(buffer, static_cast<hb_script_t>(style.script));
  hb_buffer_set_language(
      buffer, style.language.empty() ? hb_language_get_default() : hb_language_from_string(style.language.c_str(), -1));
  hb_shape(handles_->font.get(), buffer, nullptr, 0);
  unsigned count = 0;
  const hb_glyph_info_t* infos = hb_buffer_get_glyph_infos(buffer, &count);
  const hb_glyph_position_t* positions = hb_buffer_get_glyph_positions(buffer, &count);
  const bool vertical = HB_DIRECTION_IS_VERTICAL(direction_of(style.direction));
  double extent = 0;
  Word word;
  for (unsigned i = 0; i < count; ++i) {
    const double x = positions[i].x_offset / units_per_em_, y = positions[i].y_offset / units_per_em_;
    const double advance = (vertical ? -positions[i].y_advance : positions[i].x_advance) / units_per_em_;
    const glm::dvec2 at = vertical ? glm::dvec2(x, y - pen - extent) : glm::dvec2(pen + extent + x, y);
    auto shape = glyph(infos[i].codepoint, level);
    if (level == vrml::kTextBars && !vertical) {
      if (shape)
        word.add(*shape, at);
      else
        word.finish(glyphs);
    } else if (shape) {
      glyphs.push_back({std::move(shape), glm::vec2(at)});
    }
    extent += advance;
  }
  word.finish(glyphs);
  return std::max(extent, 0.0);
}

}  // namespace gs::render
