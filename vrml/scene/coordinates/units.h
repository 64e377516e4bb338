#pragma once

#include "vrml/scene/scene_graph.h"

namespace gs::vrml {

/// Measure of a field. Values in another unit of a text are converted while it is read (ISO/IEC 19775-1 4.3.6). Lengths
/// are not converted; see scale_content().
enum class Measure : std::uint8_t { none, angle, mass, force };

/// Base units per unit of a text: radians, kilograms and newtons.
struct Units {
  double angle = 1, mass = 1, force = 1;

  [[nodiscard]] bool are_standard() const { return angle == 1 && mass == 1 && force == 1; }
  [[nodiscard]] double of(Measure measure) const {
    return measure == Measure::angle ? angle : measure == Measure::mass ? mass : measure == Measure::force ? force : 1;
  }
};

/// Returns the measure of a field: of rotations, and of fields of built-in nodes such as Viewpoint.fieldOfView.
[[nodiscard]] Measure measure_of(const NodeType& type, const InterfaceDeclaration& field);

/// Multiplies the numbers of a value; of rotations, only the angles.
void scale_measures(FieldValue& value, double factor);

/// Scales the content of an Inline, if its text has another unit of length than the outer text. A Transform becomes
/// the only top-level node, with all others as children. Statements of the text do not change. Call it once, when the
/// content is complete.
void scale_content(SceneGraph& content, double factor);

}  // namespace gs::vrml
