#pragma once

#include "vrml/scene/scene_graph.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <unordered_map>

namespace gs::render {

using vrml::NodeKind;

// Indexes of the fields of each node type, in their row of the schema table (collect_schema.cpp).
struct LayerSetFields {
  enum : int { layers };
};
struct GroupFields {
  enum : int { children };
};
struct LayoutGroupFields : GroupFields {
  enum : int { layout = children + 1, viewport };
};
struct LayoutFields {
  enum : int { align, offset, offset_units, scale_mode, size, size_units };
};
struct CollisionFields {
  enum : int { children, collide, proxy };
};
struct TransformFields {
  enum : int { children, center, rotation, scale, scale_orientation, translation };
};
struct HumanoidFields {  // the first ones are those of a Transform
  enum : int { skeleton, skin = TransformFields::translation + 1 };
};
struct BillboardFields {
  enum : int { children, axis_of_rotation };
};
struct SwitchFields {
  enum : int { choice, which_choice };
};
struct LodFields {
  enum : int { level, center, range };
};
struct ShapeFields {
  enum : int { appearance, geometry };
};
struct LightFields {
  enum : int {
    on,
    color,
    intensity,
    ambient_intensity,
    direction,
    location,
    attenuation,
    radius,
    beam_width,
    cut_off_angle,
    global
  };
};
struct ViewpointFields {
  enum : int {
    position,
    orientation,
    field_of_view,
    description,
    jump,
    center_of_rotation,
    view_all,
    retain_offsets,
    near_distance,
    far_distance,
    navigation_info
  };
};
struct ViewpointGroupFields {
  enum : int { children, displayed, retain_offsets, description, center, size };
};
struct NavigationFields {
  enum : int { type, avatar_size, speed, visibility_limit, headlight, transition_type, transition_time };
};
struct BackgroundFields {
  enum : int {
    sky_color,
    sky_angle,
    ground_color,
    ground_angle,
    transparency,
    back_texture,  // of TextureBackground; the other faces follow in the order of Background::Face
    bottom_texture,
    front_texture,
    left_texture,
    right_texture,
    top_texture
  };
};
struct FogFields {
  enum : int { color, fog_type, visibility_range };
};
struct LocalFogFields : FogFields {
  enum : int { enabled = 3 };
};
struct AppearanceFields {
  enum : int { line_properties, fill_properties, point_properties };
};
struct LineFields {
  enum : int { applied, line_type, width };
};
struct FillFields {
  enum : int { filled, hatched, hatch_color, hatch_style };
};
struct PointFields {
  enum : int { size, smallest, largest, attenuation };
};
struct ClipPlaneFields {
  enum : int { enabled, plane };
};
struct CadFaceFields {
  enum : int { shape };
};
struct MaterialFields {
  enum : int { diffuse_color, emissive_color, specular_color, ambient_intensity, shininess, transparency };
};
struct TextureFields {
  enum : int { repeat_s, repeat_t, image, properties, repeat_r };
};
struct TextureTransformFields {
  enum : int { center, rotation, scale, translation };
};

struct SoundFields {
  enum : int { direction, intensity, location, max_back, max_front, min_back, min_front, priority, source, spatialize };
};

struct QnvFields {
  enum : int { detail };
};

/// Kind of a node type, and the slots of the fields that this room reads. A slot is -1 if the type lacks the field.
struct Schema {
  static constexpr int kFields = 11;
  NodeKind kind = NodeKind::other;
  std::array<int, kFields> slots{};
  int visible = -1, box_display = -1;  // slots of the fields of X3DBoundedObject
};

/// Node with its schema.
struct NodeView {
  const vrml::Node* node = nullptr;
  const Schema* schema = nullptr;

  explicit operator bool() const { return node != nullptr; }
  [[nodiscard]] NodeKind kind() const { return node ? schema->kind : NodeKind::other; }
  /// Returns the value of a field of type T. Returns null if the node type has no such field.
  template <class T>
  [[nodiscard]] const T* find(int field) const {
    const int slot = schema->slots[static_cast<std::size_t>(field)];
    return slot < 0 ? nullptr : std::get_if<T>(&node->values[slot]);
  }
  template <class T>
  [[nodiscard]] T get(int field, T otherwise) const {
    const T* value = find<T>(field);
    return value ? *value : otherwise;
  }
  /// Returns the value of an SFBool. Returns `otherwise` if the slot is -1.
  /// Returns the value in a slot if it has this type; otherwise null.
  template <class T>
  [[nodiscard]] const T* find_at(int slot) const {
    return slot < 0 ? nullptr : std::get_if<T>(&node->values[slot]);
  }
  [[nodiscard]] bool flag(int slot, bool otherwise) const {
    const auto* value = slot < 0 ? nullptr : std::get_if<vrml::SFBool>(&node->values[slot]);
    return value ? *value : otherwise;
  }
};

/// Returns the geometry that a Shape draws. Null means that the Shape draws nothing.
[[nodiscard]] vrml::NodeId geometry_of(const vrml::SceneGraph& scene, const NodeView& shape);

/// Schemas by node type. Looks up the fields of a type by name only once.
class Schemas {
 public:
  [[nodiscard]] const Schema& of(const vrml::NodeType& type);
  /// Returns the node that represents `id`: PROTO instances are replaced by their first node. Returns an empty view for
  /// NULL and for instances without nodes.
  [[nodiscard]] NodeView view(const vrml::SceneGraph& scene, vrml::NodeId id);

 private:
  std::unordered_map<const vrml::NodeType*, Schema> schemas_;
};

}  // namespace gs::render
