#pragma once

#include "vrml/scene/scene_graph.h"

namespace gs::vrml {

/// Reports whether a field holds angles: rotations, and numbers of built-in nodes such as Viewpoint.fieldOfView. Values
/// of X3D texts with a UNIT for angles are converted (ISO/IEC 19775-1 4.3.6).
[[nodiscard]] bool is_angle(const NodeType& type, const InterfaceDeclaration& field);

/// Multiplies the angles of a value.
void scale_angles(FieldValue& value, double factor);

/// Scales the content of an Inline, if its text has another unit of length than the outer text. A Transform becomes
/// the only top-level node, with all others as children. Statements of the text do not change. Call it once, when the
/// content is complete.
void scale_content(SceneGraph& content, double factor);

}  // namespace gs::vrml
