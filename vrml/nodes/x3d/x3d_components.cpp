#include "vrml/scene/x3d/x3d_components.h"

#include <algorithm>
#include <iterator>

namespace gs::vrml {
namespace {

// Components by name, with the levels of X3D 4.0.
constexpr X3DComponent kComponents[] = {
    {"Annotation", 2, 0},
    {"CADGeometry", 2, 2},
    {"Core", 2, 2},
    {"CubeMapTexturing", 3, 3},
    {"DIS", 2, 0},
    {"EnvironmentalEffects", 4, 4},
    {"EnvironmentalSensor", 3, 3},
    {"EventUtilities", 1, 1},
    {"Followers", 1, 1},
    {"Geometry2D", 2, 2},
    {"Geometry3D", 4, 4},
    {"Geospatial", 2, 2},
    {"Grouping", 3, 3},
    {"H-Anim", 3, 3},
    {"HAnim", 3, 3},
    {"Interpolation", 5, 5},
    {"KeyDeviceSensor", 2, 2},
    {"Layering", 2, 2},
    {"Layout", 2, 2},
    {"Lighting", 3, 3},
    {"NURBS", 4, 4},
    {"Navigation", 3, 3},
    {"Networking", 4, 4},
    {"ParticleSystems", 3, 3},
    {"Picking", 3, 3},
    {"PointingDeviceSensor", 1, 1},
    {"Rendering", 5, 5},
    {"RigidBodyPhysics", 2, 0},
    {"Scripting", 1, 1},
    {"Shaders", 1, 0},
    {"Shape", 5, 5},
    {"Sound", 2, 1},
    {"Text", 2, 2},
    {"TextureProjection", 2, 0},
    {"TextureProjector", 2, 0},
    {"Texturing", 4, 4},
    {"Texturing3D", 2, 2},
    {"Time", 2, 2},
    {"VolumeRendering", 4, 4},
};

constexpr X3DProfile kProfiles[] = {
    {"CADInterchange", ""},
    {"Core", ""},
    {"Full", "DIS, RigidBodyPhysics, Shaders, TextureProjection"},
    {"Immersive", ""},
    {"Interactive", ""},
    {"Interchange", ""},
    {"MPEG-4", ""},
    {"MPEG-4 interactive", ""},
    {"MPEG4Interactive", ""},
    {"MedicalInterchange", ""},
};

template <class Row, std::size_t kRows>
const Row* row_named(const Row (&rows)[kRows], std::string_view name) {
  const Row* const found = std::find_if(std::begin(rows), std::end(rows), [&](const Row& r) { return r.name == name; });
  return found == std::end(rows) ? nullptr : found;
}

}  // namespace

const X3DComponent* x3d_component_named(std::string_view name) { return row_named(kComponents, name); }

const X3DProfile* x3d_profile_named(std::string_view name) { return row_named(kProfiles, name); }

}  // namespace gs::vrml
