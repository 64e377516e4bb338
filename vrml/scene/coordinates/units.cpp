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

}  // namespace

bool is_angle(const NodeType& type, const InterfaceDeclaration& field) {
  if (field.type == FieldType::SFRotation || field.type == FieldType::MFRotation) return true;
  if (field.type != FieldType::SFFloat && field.type != FieldType::MFFloat) return false;
  // The field of view of an orthographic viewpoint is a list: a rectangle.
  if (type.kind != NodeType::Kind::built_in || (field.name == "fieldOfView" && is_multiple(field.type))) return false;
  return std::find(std::begin(kAngles), std::end(kAngles), field.name) != std::end(kAngles);
}

void scale_angles(FieldValue& value, double factor) {
  const auto scaled = [factor](float angle) { return static_cast<float>(double{angle} * factor); };
  if (auto* number = std::get_if<SFFloat>(&value)) *number = scaled(*number);
  if (auto* rotation = std::get_if<SFRotation>(&value)) rotation->angle = scaled(rotation->angle);
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
