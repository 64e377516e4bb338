#include "vrml/printing/equivalents.h"
#include "vrml/scene/values/field_numbers.h"
#include "vrml/scene/values/transformation.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

namespace gs::vrml {
namespace {

// Returns the elements of a list in single precision, without numbers beyond those of T.
template <class T>
Array<T> shortened(const FieldValue& list) {
  Array<T> elements;
  std::visit(
      [&](const auto& from) {
        using From = std::decay_t<decltype(from)>;
        if constexpr (requires { from.span(); }) {
          using Element = ElementOf<From>;
          if constexpr (ElementNumbers<Element>::kCount >= ElementNumbers<T>::kCount &&
                        !std::is_integral_v<typename ElementNumbers<Element>::Number>)
            for (const Element& element : from) {
              T made{};
              for (int i = 0; i < ElementNumbers<T>::kCount; ++i)
                numbers_of(made)[i] = static_cast<float>(numbers_of(element)[i]);
              elements.push_back(made);
            }
        }
      },
      list);
  return elements;
}

const FieldValue& field_of(const SceneGraph& scene, NodeId node, std::string_view field) {
  return scene.node(node).values[scene.node(node).type->find_field(field)->slot];
}

// Returns the nodes of the fields, in order.
MFNode nodes_in(const SceneGraph& scene, NodeId node, std::initializer_list<std::string_view> fields) {
  MFNode nodes;
  for (const std::string_view field : fields) {
    const FieldValue& value = field_of(scene, node, field);
    if (const auto* const one = std::get_if<SFNode>(&value); one && *one) nodes.push_back(*one);
    if (const auto* const many = std::get_if<MFNode>(&value))
      for (const NodeId each : *many) nodes.push_back(each);
  }
  return nodes;
}

}  // namespace

// The view has the height of the rectangle at the distance of the centre of rotation.
MadeNode viewpoint_of_ortho(const SceneGraph& scene, NodeId node, const NodeType& type) {
  constexpr float kAngle = 0.1F;
  const auto& rectangle = scene.get<MFFloat>(node, "fieldOfView");
  float left = -1, bottom = -1, right = 1, top = 1;
  if (rectangle.size() >= 4) left = rectangle[0], bottom = rectangle[1], right = rectangle[2], top = rectangle[3];
  const float size = std::min(std::abs(right - left), std::abs(top - bottom));
  const SFRotation orientation = scene.get<SFRotation>(node, "orientation");
  const glm::dmat3 turn = rotation_matrix(orientation);
  const glm::dvec3 position(scene.get<SFVec3f>(node, "position"));
  const glm::dvec3 center(scene.get<SFVec3f>(node, "centerOfRotation"));
  const double distance = size / 2 / std::tan(kAngle / 2) - glm::dot(position - center, turn[2]);
  const glm::dvec3 middle = position + turn * glm::dvec3((left + right) / 2, (bottom + top) / 2, distance);
  MadeNode made(type);
  made.set("position", SFVec3f(middle));
  made.set("orientation", orientation);
  made.set("fieldOfView", SFFloat{kAngle});
  made.set("description", scene.get<SFString>(node, "description"));
  made.set("jump", scene.get<SFBool>(node, "jump"));
  return made;
}

MadeNode color_of_color_rgba(const SceneGraph& scene, NodeId node, const NodeType& type) {
  MadeNode made(type);
  made.set("color", shortened<SFColor>(field_of(scene, node, "color")));
  return made;
}

MadeNode coordinate_of_doubles(const SceneGraph& scene, NodeId node, const NodeType& type) {
  MadeNode made(type);
  made.set("point", shortened<SFVec3f>(field_of(scene, node, "point")));
  return made;
}

MadeNode material_of_unlit(const SceneGraph& scene, NodeId node, const NodeType& type) {
  MadeNode made(type);
  made.set("ambientIntensity", 0.0f);
  made.set("diffuseColor", SFColor{});
  made.set("emissiveColor", field_of(scene, node, "emissiveColor"));
  made.set("transparency", field_of(scene, node, "transparency"));
  return made;
}

MadeNode material_of_physical(const SceneGraph& scene, NodeId node, const NodeType& type) {
  MadeNode made(type);
  made.set("diffuseColor", field_of(scene, node, "baseColor"));
  made.set("emissiveColor", field_of(scene, node, "emissiveColor"));
  made.set("transparency", field_of(scene, node, "transparency"));
  return made;
}

MadeNode group_of_cad_face(const SceneGraph& scene, NodeId node, const NodeType& type) {
  MadeNode made(type);
  made.set("children", nodes_in(scene, node, {"shape"}));
  return made;
}

MadeNode transform_of_humanoid(const SceneGraph& scene, NodeId node, const NodeType& type) {
  MadeNode made(type);
  for (const std::string_view field : {"center", "rotation", "scale", "scaleOrientation", "translation"})
    made.set(field, field_of(scene, node, field));
  made.set("children", nodes_in(scene, node, {"skeleton", "skin", "viewpoints"}));
  return made;
}

}  // namespace gs::vrml
