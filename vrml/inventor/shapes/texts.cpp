#include "vrml/inventor/item_types.h"
#include "vrml/inventor/shapes/geometries.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

// AsciiText, Text2, Text3 and NURBS.
namespace gs::vrml::inventor {
namespace {

// Sets the FontStyle. Texts with the same font share it.
void set_font(Converter& converter, const Item& item, NodeId text, float size) {
  converter.read(Part::font);
  Output& output = converter.output();
  const FontState& font = converter.state().font;
  const std::string_view justification = item.word("justification");
  const char* const justify = justification == "CENTER" ? "MIDDLE" : justification == "RIGHT" ? "END" : "BEGIN";
  const float spacing = item.get<SFFloat>("spacing");
  const std::string identity = "font " + font.family.str() + ' ' + font.style.str() + ' ' + std::to_string(size) + ' ' +
                               std::to_string(spacing) + justify;
  NodeId& known = converter.looks().property(identity);
  const NodeTarget target = output.field(text, "fontStyle");
  if (known) return output.place(known, target);
  const NodeId node = output.begin("FontStyle", target, item.location);
  if (!node) return;
  output.set(node, "size", size);
  output.set(node, "family", MFString{font.family});
  output.set(node, "style", font.style);
  output.set(node, "justify", MFString{justify});
  output.set(node, "spacing", spacing);
  output.end(node);
  converter.looks().property(identity) = node;
}

void apply_text(Converter& converter, const Item& item) {
  converter.read(Part::draw_style);
  if (converter.state().draw_style == DrawStyle::invisible) return;
  const Look look = converter.looks().of(converter.state(), ShapeKind::text, false);
  const NodeId text = begin_geometry(converter, item, converter.state(), look, "Text");
  if (!text) return;
  Output& output = converter.output();
  output.set(text, "string", item.get<MFString>("string"));
  if (item.type->find("width")) {
    const MFFloat& widths = item.get<MFFloat>("width");
    if (std::any_of(widths.begin(), widths.end(), [](float width) { return width > 0; }))
      output.set(text, "length", widths);
  }
  set_font(converter, item, text, converter.state().font.size);
  output.end(text);
}

// Converts text of constant size in pixels. Chooses the world size that looks equal from the camera.
void apply_screen_text(Converter& converter, const Item& item) {
  constexpr double kWindowHeight = 600;
  converter.read(Part::draw_style);
  if (converter.state().draw_style == DrawStyle::invisible) return;
  Output& output = converter.output();
  const auto target = output.target();
  if (!target) return;
  const glm::dmat4 world = output.world_matrix();
  const double stretch = std::cbrt(std::abs(glm::determinant(glm::dmat3(world))));
  double size = converter.state().font.size / 100.0;
  if (const auto& camera = converter.camera()) {
    const double distance = glm::length(glm::dvec3(world[3]) - camera->position);
    const double height = camera->height > 0 ? camera->height : 2 * distance * std::tan(camera->height_angle / 2);
    size = converter.state().font.size * height / kWindowHeight;
  }
  if (stretch > 0) size /= stretch;
  if (!std::isfinite(size) || size <= 0) return;
  const NodeId billboard = output.open_group_in(*target, "Billboard", item.location);
  if (billboard) {
    output.set(billboard, "axisOfRotation", SFVec3f{0, 0, 0});
    const Look look = converter.looks().of(converter.state(), ShapeKind::lines, false);
    const NodeId text = begin_geometry(converter, item, converter.state(), look, "Text");
    if (text) {
      output.set(text, "string", item.get<MFString>("string"));
      set_font(converter, item, text, static_cast<float>(size));
      output.end(text);
    }
  }
  output.close_group();
}

// Returns the control points of a NURBS shape, and sets their weights.
MFVec3f control_points(const State& state, const MFInt32& index, MFFloat& weights) {
  if (index.empty()) {
    weights = state.weights;
    return state.points;
  }
  MFVec3f points;
  for (const std::int32_t i : index) {
    if (i < 0 || static_cast<std::size_t>(i) >= state.points.size()) continue;
    points.push_back(state.points[static_cast<std::size_t>(i)]);
    if (!state.weights.empty()) weights.push_back(state.weights[static_cast<std::size_t>(i)]);
  }
  return points;
}

// Returns the order of a curve, which the number of its knots determines.
SFInt32 order_of(const MFFloat& knots, std::int32_t points) {
  const std::int64_t order = static_cast<std::int64_t>(knots.size()) - points;
  return static_cast<SFInt32>(std::clamp<std::int64_t>(order, 2, 32));
}

void apply_nurbs_surface(Converter& converter, const Item& item) {
  converter.read(Part::draw_style);
  converter.read(Part::coordinates);
  converter.read(Part::hints);
  const State& state = converter.state();
  if (state.draw_style == DrawStyle::invisible) return;
  const Look look = converter.looks().of(state, ShapeKind::faces, false);
  const NodeId surface = begin_geometry(converter, item, state, look, "NurbsSurface");
  if (!surface) return;
  Output& output = converter.output();
  const SFInt32 u = item.get<SFInt32>("numUControlPoints"), v = item.get<SFInt32>("numVControlPoints");
  MFFloat weights;
  output.set(surface, "controlPoint", control_points(state, item.get<MFInt32>("coordIndex"), weights));
  output.set(surface, "weight", weights);
  output.set(surface, "uDimension", u);
  output.set(surface, "vDimension", v);
  output.set(surface, "uKnot", item.get<MFFloat>("uKnotVector"));
  output.set(surface, "vKnot", item.get<MFFloat>("vKnotVector"));
  output.set(surface, "uOrder", order_of(item.get<MFFloat>("uKnotVector"), u));
  output.set(surface, "vOrder", order_of(item.get<MFFloat>("vKnotVector"), v));
  output.set(surface, "solid", false);
  output.end(surface);
}

void apply_nurbs_curve(Converter& converter, const Item& item) {
  converter.read(Part::draw_style);
  converter.read(Part::coordinates);
  const State& state = converter.state();
  if (state.draw_style == DrawStyle::invisible) return;
  const Look look = converter.looks().of(state, ShapeKind::lines, false);
  const NodeId curve = begin_geometry(converter, item, state, look, "NurbsCurve");
  if (!curve) return;
  Output& output = converter.output();
  MFFloat weights;
  output.set(curve, "controlPoint", control_points(state, item.get<MFInt32>("coordIndex"), weights));
  output.set(curve, "weight", weights);
  output.set(curve, "knot", item.get<MFFloat>("knotVector"));
  output.set(curve, "order", order_of(item.get<MFFloat>("knotVector"), item.get<SFInt32>("numControlPoints")));
  output.end(curve);
}

constexpr std::string_view kSurfaceFields = R"(
  SFInt32 numUControlPoints 0
  SFInt32 numVControlPoints 0
  SFInt32 numSControlPoints 0
  SFInt32 numTControlPoints 0
  MFFloat uKnotVector []
  MFFloat vKnotVector []
  MFFloat sKnotVector []
  MFFloat tKnotVector []
  MFInt32 coordIndex []
  MFInt32 textureCoordIndex [])";
constexpr std::string_view kCurveFields = "SFInt32 numControlPoints 0 MFFloat knotVector [] MFInt32 coordIndex []";

constexpr ItemRow kTextRows[] = {
    {"AsciiText", ItemClass::shape, false, apply_text,
     "MFString string \"\" SFFloat spacing 1 SFEnum justification LEFT MFFloat width 0"},
    {"Text3", ItemClass::shape, false, apply_text,
     "MFString string \"\" SFFloat spacing 1 SFEnum justification LEFT SFBitMask parts FRONT"},
    {"Text2", ItemClass::shape, false, apply_screen_text,
     "MFString string \"\" SFFloat spacing 1 SFEnum justification LEFT",
     "text of constant screen size is not supported; converted to text of fixed world size"},
    {"NurbsSurface IndexedNurbsSurface", ItemClass::shape, false, apply_nurbs_surface, kSurfaceFields},
    {"NurbsCurve IndexedNurbsCurve", ItemClass::shape, false, apply_nurbs_curve, kCurveFields},
};

}  // namespace

std::span<const ItemRow> text_rows() { return kTextRows; }

}  // namespace gs::vrml::inventor
