#pragma once

#include "app/formats/common/color_key.h"
#include "app/formats/common/import_context.h"
#include "app/formats/common/time_steps.h"
#include "app/formats/common/voxel_component.h"
#include "vrml/scene/values/field_value.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {

/// Content of one IndexedFaceSet, IndexedLineSet or PointSet from an importer, in the arrays of these nodes (VRML97
/// 6.23, 6.24, 6.36). coord_index replaces an empty normal_index or texture_index.
struct Geometry {
  enum class Kind : std::uint8_t { faces, lines, points };

  Kind kind = Kind::faces;
  vrml::MFVec3f positions;
  vrml::MFVec3f normals;
  vrml::MFColor colors;  // one per position; if color_per_vertex is false, one per face
  vrml::MFVec2f texture_coordinates;
  vrml::MFInt32 coord_index, normal_index, texture_index;
  bool color_per_vertex = true;
  bool solid = false;
  bool convex = true;
  float crease_angle = 0;
};

/// Material with colours in display colour space (VRML97 6.27). Textured if `texture_url` is not empty.
struct Look {
  vrml::Color diffuse{0.8f, 0.8f, 0.8f}, specular{}, emissive{};
  float ambient_intensity = 0.2f, shininess = 0.2f, transparency = 0.0f;
  bool lit = true;  // false means that the Shape has no Material (VRML97 Table 4.5)
  vrml::String texture_url;
  bool repeat_s = true, repeat_t = true;
};

/// Converts a look for lines and points, which show only the emissive colour (VRML97 4.14.2).
[[nodiscard]] Look glowing(Look look);

/// Faces, lines or points with their appearance: one Shape.
struct MeshPart {
  Geometry geometry;
  std::size_t look = 0;  // index in MeshAsset::looks
  std::string name;      // name of the object or group; may be empty
};

/// Content of a mesh file as plain values, without nodes.
struct MeshAsset {
  struct NamedLook {
    Look look;
    std::string name;  // name of the material; may be empty
  };

  std::vector<MeshPart> parts;
  std::vector<NamedLook> looks;
  std::optional<ColorKey> color_key;  // values that the colours represent
  std::optional<TimeSteps> steps;     // of a file that has several; valid
  Share memory;                       // of the arrays
  bool cut_short = false;             // the budget removed some or all of it, which was reported

  [[nodiscard]] bool empty() const { return parts.empty() && !color_key; }
  [[nodiscard]] bool has_textures() const;
};

/// Builder of a MeshAsset, with diagnostics, for the importers of mesh formats.
class MeshBuilder : public ImportContext {
 public:
  using ImportContext::ImportContext;

  /// Sets the user's choice of values and colours.
  void choose(VoxelComponent choice) { choice_ = std::move(choice); }
  [[nodiscard]] const VoxelComponent& choice() const { return choice_; }
  /// Adds a part with its own appearance. Drops faces, lines and points with missing or non-finite coordinates, with
  /// one message per kind. Returns false if nothing is left.
  bool add(Geometry geometry, Look look = {}, std::string_view name = {});
  /// Adds an appearance that several parts can share. Returns its index.
  [[nodiscard]] std::size_t add_look(Look look, std::string_view name);
  /// Adds a part that `keep_drawable` has accepted.
  void add_part(Geometry geometry, std::size_t look, std::string_view name);
  void set_color_key(ColorKey key) { asset_.color_key = std::move(key); }
  /// Sets the steps of a file with a surface that changes with time. Ignores invalid ones, such as a single one.
  void set_steps(TimeSteps steps) {
    if (is_valid(steps)) asset_.steps = std::move(steps);
  }

  /// Reports that the budget stopped the import, unless it was cancelled. The parts so far remain.
  void cut_short();
  [[nodiscard]] MeshAsset take();

 private:
  MeshAsset asset_;
  VoxelComponent choice_;
};

}  // namespace gs::app
