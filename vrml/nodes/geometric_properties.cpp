#include "vrml/nodes/families.h"

namespace gs::vrml {
namespace {

// Rows of the geometric property nodes (VRML97 4.6.3.2).
constexpr NodeRow kGeometricPropertiesRows[] = {
    {"Color", "6.9", Role::geometric_property, NodeKind::color, R"(
  exposedField MFColor    color            []               # [0,1]
)"},
    {"Coordinate", "6.12", Role::geometric_property, NodeKind::coordinate, R"(
  exposedField MFVec3f    point            []               # (-inf,inf)
)"},
    {"Normal", "6.30", Role::geometric_property, NodeKind::normal, R"(
  exposedField MFVec3f    vector           []               # (-inf,inf)
)"},
    {"NurbsTextureSurface", kAmendmentClause, Role::geometric_property, NodeKind::nurbs_texture_surface, R"(
  exposedField MFVec2f    controlPoint     []               # (-inf,inf)
  exposedField MFFloat    weight           []               # (0,inf)
  field        SFInt32    uDimension       0                # [0,inf)
  field        MFFloat    uKnot            []               # (-inf,inf)
  field        SFInt32    uOrder           3                # [2,inf)
  field        SFInt32    vDimension       0                # [0,inf)
  field        MFFloat    vKnot            []               # (-inf,inf)
  field        SFInt32    vOrder           3                # [2,inf)
)"},
    {"TextureCoordinate", "6.48", Role::geometric_property, NodeKind::texture_coordinate, R"(
  exposedField MFVec2f    point            []               # (-inf,inf)
)"},
};

}  // namespace

std::span<const NodeRow> geometric_properties_rows() { return kGeometricPropertiesRows; }

}  // namespace gs::vrml
