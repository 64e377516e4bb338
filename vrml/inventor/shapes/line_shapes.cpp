#include "vrml/inventor/item_types.h"
#include "vrml/inventor/shapes/geometries.h"

#include <algorithm>
#include <utility>

// Shapes of lines and points.
namespace gs::vrml::inventor {
namespace {

bool is_by_segment(const State& state) {
  return state.material_binding == Binding::per_part || state.material_binding == Binding::per_part_indexed;
}

// Splits polylines into their segments, for a material for each segment.
FaceList segments_of(const FaceList& lines) {
  FaceList segments;
  std::int32_t segment = 0;
  const auto number = [&](std::size_t i) { return lines.vertex.empty() ? lines.index[i] : lines.vertex[i]; };
  for (std::size_t i = 1; i < lines.index.size(); ++i) {
    if (lines.index[i] < 0 || lines.index[i - 1] < 0) continue;
    for (const std::size_t at : {i - 1, i}) segments.corner(lines.index[at], number(at), static_cast<std::int32_t>(at));
    segments.end_face(segment++);
  }
  return segments;
}

void add(Converter& converter, const Item& item, const State& state, const FaceList& lines, const OwnIndices& own) {
  add_lines(converter, item, state, is_by_segment(state) ? segments_of(lines) : lines, own);
}

bool admits_lines(Converter& converter, const Item& item, std::size_t corners) {
  return converter.sink().limits().admits_string(corners * 3 * sizeof(std::int32_t), item.location);
}

void apply_indexed_lines(Converter& converter, const Item& item) {
  const State state = state_of_shape(converter, item);
  FaceList lines;
  lines.index = item.get<MFInt32>("coordIndex");
  if (!admits_lines(converter, item, is_by_segment(state) ? 2 * lines.index.size() : 0)) return;
  add(converter, item, state, lines, {item.get<MFInt32>("materialIndex"), {}, {}, true});
}

void apply_lines(Converter& converter, const Item& item) {
  const State state = state_of_shape(converter, item);
  const auto start = static_cast<std::size_t>(std::max(item.get<SFInt32>("startIndex"), 0));
  std::size_t left = state.points.size() - std::min(start, state.points.size());
  if (!admits_lines(converter, item, 2 * left)) return;
  FaceList lines;
  auto at = static_cast<std::int32_t>(start);
  std::int32_t number = 0, line = 0;
  for (const std::int32_t length : item.get<MFInt32>("numVertices")) {
    const std::size_t count = length < 0 ? left : std::min(left, static_cast<std::size_t>(length));
    if (count == 0) break;
    left -= count;
    for (std::size_t i = 0; i < count; ++i) lines.corner(at++, number++, -1);
    lines.end_face(line++);
  }
  add(converter, item, state, lines, {{}, {}, {}, false});
}

void apply_points(Converter& converter, const Item& item) {
  const State state = state_of_shape(converter, item);
  const auto start = static_cast<std::size_t>(std::max(item.get<SFInt32>("startIndex"), 0));
  const SFInt32 number = item.get<SFInt32>("numPoints");
  add_points(converter, item, state, start, number < 0 ? state.points.size() : static_cast<std::size_t>(number));
}

constexpr ItemRow kLineRows[] = {
    {"IndexedLineSet", ItemClass::shape, false, apply_indexed_lines, R"(
  MFInt32 coordIndex 0
  MFInt32 materialIndex -1
  MFInt32 normalIndex -1
  MFInt32 textureCoordIndex -1
  SFNode vertexProperty)"},
    {"LineSet", ItemClass::shape, false, apply_lines,
     "SFInt32 startIndex 0 MFInt32 numVertices -1 SFNode vertexProperty"},
    {"PointSet", ItemClass::shape, false, apply_points,
     "SFInt32 startIndex 0 SFInt32 numPoints -1 SFNode vertexProperty"},
    {"MarkerSet", ItemClass::shape, false, apply_points,
     "SFInt32 startIndex 0 SFInt32 numPoints -1 SFNode vertexProperty MFInt32 markerIndex 0",
     "its markers are shown as points"},
};

}  // namespace

std::span<const ItemRow> line_rows() { return kLineRows; }

}  // namespace gs::vrml::inventor
