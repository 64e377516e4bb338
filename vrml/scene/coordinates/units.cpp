#include "vrml/scene/coordinates/units.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace gs::vrml {
namespace {

// Names of built-in SFFloat and MFFloat fields with an angle as value.
constexpr std::string_view kAngles[] = {"angle",       "beamWidth", "coneInnerAngle", "coneOuterAngle", "creaseAngle",
                                        "cutOffAngle", "diskAngle", "endAngle",       "fieldOfView",    "groundAngle",
                                        "llimit",      "maxAngle",  "minAngle",       "rotation",       "skyAngle",
                                        "startAngle",  "ulimit"};

// Names of built-in fields with forces as values.
constexpr std::string_view kForces[] = {"force", "forces", "maxForce", "minForce"};

template <class Names>
bool is_among(const Names& names, std::string_view name) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

}  // namespace

Measure measure_of(const NodeType& type, const InterfaceDeclaration& field) {
  if (field.type == FieldType::SFRotation || field.type == FieldType::MFRotation) return Measure::angle;
  const bool numbers = field.type == FieldType::SFFloat || field.type == FieldType::MFFloat;
  const bool vectors = field.type == FieldType::SFVec3f || field.type == FieldType::MFVec3f;
  if (type.kind != NodeType::Kind::built_in || (!numbers && !vectors)) return Measure::none;
  if (is_among(kForces, field.name)) return Measure::force;
  if (!numbers) return Measure::none;
  if (field.name == "mass") return Measure::mass;
  // The field of view of an orthographic viewpoint is a list: a rectangle.
  if (field.name == "fieldOfView" && is_multiple(field.type)) return Measure::none;
  return is_among(kAngles, field.name) ? Measure::angle : Measure::none;
}

void scale_measures(FieldValue& value, double factor) {
  const auto scaled = [factor](float one) { return static_cast<float>(double{one} * factor); };
  if (auto* number = std::get_if<SFFloat>(&value)) *number = scaled(*number);
  if (auto* rotation = std::get_if<SFRotation>(&value)) rotation->angle = scaled(rotation->angle);
  if (auto* vector = std::get_if<SFVec3f>(&value)) *vector = SFVec3f(glm::dvec3(*vector) * factor);
  if (auto* vectors = std::get_if<MFVec3f>(&value)) {
    MFVec3f all;
    for (const SFVec3f& one : *vectors) all.push_back(SFVec3f(glm::dvec3(one) * factor));
    *vectors = std::move(all);
  }
  if (auto* numbers = std::get_if<MFFloat>(&value)) {
    MFFloat all;
    for (const float number : *numbers) all.push_back(scaled(number));
    *numbers = std::move(all);
  }
  if (auto* rotations = std::get_if<MFRotation>(&value)) {
    MFRotation all;
    for (SFRotation rotation : *rotations) {
      rotation.angle = scaled(rotation.angle);
      all.push_back(rotation);
    }
    *rotations = std::move(all);
  }
}

void scale_content(SceneGraph& content, double factor) {
  const auto scale = static_cast<float>(factor);
  if (factor == 1 || !(scale > 0) || !std::isfinite(scale) || content.roots().empty()) return;
  const NodeId outer = content.create(built_in_node_type(NodeKind::transform));
  if (!outer) return;
  content.set<MFNode>(outer, "children", content.roots());
  content.set<SFVec3f>(outer, "scale", SFVec3f(scale));
  content.set_roots({outer});
}

}  // namespace gs::vrml
