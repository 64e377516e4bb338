#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/families.h"

namespace gs::vrml {
namespace {

// Rows of the interpolators (VRML97 4.6.8).
constexpr NodeRow kInterpolatorsRows[] = {
    {"ColorInterpolator", "6.10", Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction                      # (-inf,inf)
  exposedField MFFloat    key              []               # (-inf,inf)
  exposedField MFColor    keyValue         []               # [0,1]
  eventOut     SFColor    value_changed
)",
     nullptr, &kColorInterpolatorBehaviour},
    {"CoordinateInterpolator", "6.13", Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction                      # (-inf,inf)
  exposedField MFFloat    key              []               # (-inf,inf)
  exposedField MFVec3f    keyValue         []               # (-inf,inf)
  eventOut     MFVec3f    value_changed
)",
     nullptr, &kCoordinateInterpolatorBehaviour},
    {"NormalInterpolator", "6.31", Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction                      # (-inf,inf)
  exposedField MFFloat    key              []               # (-inf,inf)
  exposedField MFVec3f    keyValue         []               # (-inf,inf)
  eventOut     MFVec3f    value_changed
)",
     nullptr, &kNormalInterpolatorBehaviour},
    {"NurbsPositionInterpolator", kAmendmentClause, Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction                      # (-inf,inf)
  exposedField SFInt32    dimension        0                # [0,inf)
  exposedField MFVec3f    keyValue         []               # (-inf,inf)
  exposedField MFFloat    keyWeight        []               # (0,inf)
  exposedField MFFloat    knot             []               # (-inf,inf)
  exposedField SFInt32    order            4                # [2,inf)
  eventOut     SFVec3f    value_changed
)",
     nullptr, &kNurbsPositionInterpolatorBehaviour},
    {"OrientationInterpolator", "6.32", Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction                      # (-inf,inf)
  exposedField MFFloat    key              []               # (-inf,inf)
  exposedField MFRotation keyValue         []               # [-1,1],(-inf,inf)
  eventOut     SFRotation value_changed
)",
     nullptr, &kOrientationInterpolatorBehaviour},
    {"PositionInterpolator", "6.37", Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction                      # (-inf,inf)
  exposedField MFFloat    key              []               # (-inf,inf)
  exposedField MFVec3f    keyValue         []               # (-inf,inf)
  eventOut     SFVec3f    value_changed
)",
     nullptr, &kPositionInterpolatorBehaviour},
    {"ScalarInterpolator", "6.39", Role::child | Role::interpolator, NodeKind::other, R"(
  eventIn      SFFloat    set_fraction                      # (-inf,inf)
  exposedField MFFloat    key              []               # (-inf,inf)
  exposedField MFFloat    keyValue         []               # (-inf,inf)
  eventOut     SFFloat    value_changed
)",
     nullptr, &kScalarInterpolatorBehaviour},
};

}  // namespace

std::span<const NodeRow> interpolators_rows() { return kInterpolatorsRows; }

}  // namespace gs::vrml
