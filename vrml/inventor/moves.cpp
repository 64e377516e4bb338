#include "vrml/inventor/converter.h"
#include "vrml/inventor/item_types.h"

#include <glm/matrix.hpp>

// Nodes that change the transformation.
namespace gs::vrml::inventor {
namespace {

constexpr std::string_view kTransformFields = R"(
  SFVec3f translation 0 0 0
  SFRotation rotation 0 0 1 0
  SFVec3f scaleFactor 1 1 1
  SFRotation scaleOrientation 0 0 1 0
  SFVec3f center 0 0 0)";

void add_fields(Converter& converter, TransformFields fields) { converter.output().add_transform({fields, {}}); }

void apply_transform(Converter& converter, const Item& item) {
  TransformFields fields;
  fields.translation = item.get<SFVec3f>("translation");
  fields.rotation = item.get<SFRotation>("rotation");
  fields.scale = item.get<SFVec3f>("scaleFactor");
  fields.scale_orientation = item.get<SFRotation>("scaleOrientation");
  fields.center = item.get<SFVec3f>("center");
  add_fields(converter, fields);
}

void apply_translation(Converter& converter, const Item& item) {
  TransformFields fields;
  fields.translation = item.get<SFVec3f>("translation");
  if (!item.is_ignored("translation")) add_fields(converter, fields);
}

void apply_rotation(Converter& converter, const Item& item) {
  TransformFields fields;
  fields.rotation = item.get<SFRotation>("rotation");
  if (!item.is_ignored("rotation")) add_fields(converter, fields);
}

void apply_rotation_about_axis(Converter& converter, const Item& item) {
  TransformFields fields;
  const std::string_view axis = item.word("axis");
  fields.rotation = {axis == "Y" || axis == "Z" ? 0.0F : 1.0F, axis == "Y" ? 1.0F : 0.0F, axis == "Z" ? 1.0F : 0.0F,
                     item.get<SFFloat>("angle")};
  add_fields(converter, fields);
}

void apply_scale(Converter& converter, const Item& item) {
  TransformFields fields;
  fields.scale = item.get<SFVec3f>("scaleFactor");
  if (!item.is_ignored("scaleFactor")) add_fields(converter, fields);
}

// The file has row vectors: the translation is in the last four numbers.
void apply_matrix(Converter& converter, const Item& item) {
  const MFFloat& numbers = item.get<MFFloat>("matrix");
  if (numbers.size() < 16) return;
  converter.output().add_transform({{}, matrix_of(numbers, 0)});
}

void apply_reset(Converter& converter, const Item& item) {
  if (item.word("whatToReset").find("TRANSFORM") == std::string_view::npos &&
      item.word("whatToReset").find("ALL") == std::string_view::npos)
    return;
  const glm::dmat4 world = converter.output().world_matrix();
  if (glm::determinant(world) != 0) converter.output().add_transform({{}, glm::inverse(world)});
}

void apply_units(Converter& converter, const Item& item) {
  struct Unit {
    std::string_view name;
    double meters;
  };
  static constexpr Unit kUnits[] = {{"METERS", 1},         {"CENTIMETERS", 1e-2},   {"MILLIMETERS", 1e-3},
                                    {"MICROMETERS", 1e-6}, {"MICRONS", 1e-6},       {"NANOMETERS", 1e-9},
                                    {"ANGSTROMS", 1e-10},  {"KILOMETERS", 1e3},     {"FEET", 0.3048},
                                    {"INCHES", 0.0254},    {"POINTS", 0.0254 / 72}, {"YARDS", 0.9144},
                                    {"MILES", 1609.344},   {"NAUTICAL_MILES", 1852}};
  double meters = 1;
  for (const Unit& unit : kUnits)
    if (unit.name == item.word("units")) meters = unit.meters;
  // Units are absolute: a second Units node replaces the first.
  const double before = converter.unit();
  converter.set_unit(meters);
  if (meters == before) return;
  TransformFields fields;
  fields.scale = SFVec3f(static_cast<float>(meters / before));
  add_fields(converter, fields);
}

constexpr ItemRow kTransformRows[] = {
    {"Transform", ItemClass::plain, false, apply_transform, kTransformFields},
    {"TrackballManip HandleBoxManip JackManip TabBoxManip TransformBoxManip TransformerManip CenterballManip "
     "TransformManip",
     ItemClass::kit, false, apply_transform, kTransformFields, "its handles are not shown"},
    {"Translation", ItemClass::plain, false, apply_translation, "SFVec3f translation 0 0 0"},
    {"Rotation", ItemClass::plain, false, apply_rotation, "SFRotation rotation 0 0 1 0"},
    {"RotationXYZ", ItemClass::plain, false, apply_rotation_about_axis, "SFEnum axis X SFFloat angle 0"},
    {"Scale", ItemClass::plain, false, apply_scale, "SFVec3f scaleFactor 1 1 1"},
    {"MatrixTransform", ItemClass::plain, false, apply_matrix, "SFMatrix matrix 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"},
    {"ResetTransform", ItemClass::plain, false, apply_reset, "SFBitMask whatToReset TRANSFORM"},
    {"Units", ItemClass::plain, false, apply_units, "SFEnum units METERS"},
    {"AntiSquish SurroundScale", ItemClass::plain, false, nullptr,
     "SFEnum sizing AVERAGE_DIMENSION SFBool recalcAlways TRUE SFInt32 numNodesUpToContainer 0 SFInt32 "
     "numNodesUpToReset 0",
     "not supported; ignored"},
};

}  // namespace

glm::dmat4 matrix_of(const MFFloat& numbers, std::size_t first) {
  glm::dmat4 matrix(1);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) matrix[column][row] = numbers[first + static_cast<std::size_t>(4 * column + row)];
  return matrix;
}

std::span<const ItemRow> transform_rows() { return kTransformRows; }

}  // namespace gs::vrml::inventor
