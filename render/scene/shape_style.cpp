#include "render/scene/shape_style.h"

#include <cstdlib>
#include <initializer_list>

namespace gs::render {
namespace {

constexpr int kSide = 32;  // columns and rows of a hatch pattern
constexpr int kHatches = 19;

/// Returns a pattern of dashes and gaps, in bits. The sum of all lengths is 32.
constexpr std::uint32_t dashes(std::initializer_list<int> lengths) {
  std::uint32_t pattern = 0;
  int at = 0;
  bool drawn = true;
  for (const int length : lengths) {
    for (int i = 0; i < length; ++i, ++at)
      if (drawn) pattern |= std::uint32_t{1} << at;
    drawn = !drawn;
  }
  return pattern;
}

/// Canvas of a pattern that repeats in both directions.
class Canvas {
 public:
  void point(int x, int y) {
    rows_[static_cast<std::size_t>(y & (kSide - 1))] |= std::uint32_t{1} << (x & (kSide - 1));
  }
  /// Calls `is_line(x, y)` for each point and draws those for which it returns true.
  template <class Test>
  Canvas& where(const Test& is_line) {
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        if (is_line(x, y)) point(x, y);
    return *this;
  }
  /// Draws lines with a positive or negative slope of 45 degrees. `distance` divides 32.
  Canvas& slope(int sign, int distance, int shift = 0) {
    return where([=](int x, int y) { return ((y - sign * x - shift) & (distance - 1)) == 0; });
  }
  [[nodiscard]] const ShapeStyle::Hatch& rows() const { return rows_; }

 private:
  ShapeStyle::Hatch rows_{};
};

/// Reports whether a point of a sloped line belongs to a dash.
bool dashed(int along, int period, int length) { return (along & (period - 1)) < length; }

/// Returns a pattern of the ISO register of graphical items (ISO/IEC 9973), after X3D table 12.4.
ShapeStyle::Hatch make_hatch(int style) {
  Canvas canvas;
  const auto falls = [](int x, int y, int distance) { return ((y + x) & (distance - 1)) == 0; };
  switch (style) {
    case 2:  // vertical
      return canvas.where([](int x, int) { return (x & 7) == 0; }).rows();
    case 3:  // positive slope
      return canvas.slope(1, 8).rows();
    case 4:  // negative slope
      return canvas.slope(-1, 8).rows();
    case 5:  // horizontal and vertical
      return canvas.where([](int x, int y) { return (x & 7) == 0 || (y & 7) == 0; }).rows();
    case 6:  // both slopes
      return canvas.slope(1, 8).slope(-1, 8).rows();
    case 7:  // cast iron, and general use
      return canvas.slope(1, 16).rows();
    case 8:  // steel: pairs of lines
      return canvas.slope(1, 16).slope(1, 16, 4).rows();
    case 9:  // bronze, brass, copper: solid and dashed lines
      return canvas.slope(1, 16).where([](int x, int y) { return ((y - x - 8) & 15) == 0 && dashed(x, 8, 5); }).rows();
    case 10:  // white metal, zinc, lead: crossing lines
      return canvas.slope(1, 16).slope(-1, 16).rows();
    case 11:  // magnesium, aluminium: pairs of solid and dashed lines
      return canvas.slope(1, 16).where([](int x, int y) { return ((y - x - 4) & 15) == 0 && dashed(x, 8, 5); }).rows();
    case 12:  // rubber, plastic, electrical insulation: groups of three lines
      return canvas.slope(1, 32).slope(1, 32, 4).slope(1, 32, 8).rows();
    case 13:  // cork, felt, fabric: short strokes
      return canvas
          .where([&](int x, int y) {
            return (((y - x) & 15) == 0 && dashed(x, 16, 6)) || (falls(x + 8, y, 16) && dashed(x + 4, 16, 6));
          })
          .rows();
    case 14:  // thermal insulation: zigzag
      return canvas.where([](int x, int y) { return (y & 15) == std::abs((x & 15) - 8); }).rows();
    case 15:  // titanium, refractory material: crossing lines of two widths
      return canvas.slope(1, 16).slope(1, 16, 1).slope(-1, 16).rows();
    case 16:  // marble, slate, glass: strokes in rows
      return canvas
          .where([](int x, int y) {
            return ((y & 7) == 0 && dashed(x + 4 * y, 32, 20)) || ((y & 7) == 4 && dashed(x + 4 * y, 16, 5));
          })
          .rows();
    case 17:  // earth: squares of horizontal and vertical strokes
      return canvas.where([](int x, int y) { return (((x >> 3) + (y >> 3)) & 1) == 0 ? (x & 3) == 1 : (y & 3) == 1; })
          .rows();
    case 18: {  // sand: scattered dots
      std::uint32_t state = 12345;
      for (int i = 0; i < 60; ++i) {
        state = state * 1664525u + 1013904223u;
        canvas.point(static_cast<int>(state >> 24), static_cast<int>(state >> 16 & 255));
      }
      return canvas.rows();
    }
    case 19:  // dots
      return canvas.where([](int x, int y) { return (x & 7) < 2 && (y & 7) < 2; }).rows();
    default:  // horizontal
      return canvas.where([](int, int y) { return (y & 7) == 0; }).rows();
  }
}

}  // namespace

std::uint32_t line_pattern(int line_type) {
  switch (line_type) {
    case 2:   // dashed
    case 16:  // pattern of the user
      return dashes({8, 8, 8, 8});
    case 3:  // dotted
      return dashes({2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2});
    case 4:  // dashed-dotted
      return dashes({14, 7, 4, 7});
    case 5:  // dash-dot-dot
      return dashes({12, 5, 3, 4, 3, 5});
    case 9:  // stitch line
      return dashes({4, 4, 4, 4, 4, 4, 4, 4});
    case 10:  // chain line
      return dashes({18, 4, 6, 4});
    case 11:  // center line
      return dashes({16, 4, 8, 4});
    case 12:  // hidden line
      return dashes({6, 2, 6, 2, 6, 2, 6, 2});
    case 13:  // phantom line
      return dashes({13, 4, 4, 4, 4, 3});
    default:
      return ShapeStyle::kSolidLine;
  }
}

const ShapeStyle::Hatch& hatch_pattern(int hatch_style) {
  static const std::array<ShapeStyle::Hatch, kHatches> kAll = [] {
    std::array<ShapeStyle::Hatch, kHatches> all;
    for (int i = 0; i < kHatches; ++i) all[static_cast<std::size_t>(i)] = make_hatch(i + 1);
    return all;
  }();
  return kAll[hatch_style >= 1 && hatch_style <= kHatches ? static_cast<std::size_t>(hatch_style - 1) : 0];
}

}  // namespace gs::render
