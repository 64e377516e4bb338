#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/x3d/components.h"

// Rows of the X3D component ParticleSystems (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kParticleSystemsX3DRows[] = {
    {"BoundedPhysicsModel",
     "ParticleSystems",
     2,
     "physics",
     "X3DParticlePhysicsModelNode",
     Role::none,
     NodeKind::bounded_physics,
     R"(
  exposedField SFBool     enabled TRUE
  exposedField SFNode     geometry NULL  # X3DGeometryNode
)"},
    {"ConeEmitter",
     "ParticleSystems",
     1,
     "emitter",
     "X3DParticleEmitterNode",
     Role::none,
     NodeKind::cone_emitter,
     R"(
  exposedField SFFloat    angle 0.7854  # [0,3.1416]
  exposedField SFVec3f    direction 0 1 0  # [-1,1]
  exposedField SFFloat    mass 0  # [0,inf)
  exposedField SFBool     on TRUE
  exposedField SFVec3f    position 0 0 0
  exposedField SFFloat    speed 0  # [0,inf)
  exposedField SFFloat    surfaceArea 0  # [0,inf)
  exposedField SFFloat    variation 0.25  # [0,inf)
)"},
    {"ExplosionEmitter",
     "ParticleSystems",
     1,
     "emitter",
     "X3DParticleEmitterNode",
     Role::none,
     NodeKind::explosion_emitter,
     R"(
  exposedField SFFloat    mass 0  # [0,inf)
  exposedField SFBool     on TRUE
  exposedField SFVec3f    position 0 0 0
  exposedField SFFloat    speed 0  # [0,inf)
  exposedField SFFloat    surfaceArea 0  # [0,inf)
  exposedField SFFloat    variation 0.25  # [0,inf)
)"},
    {"ForcePhysicsModel",
     "ParticleSystems",
     1,
     "physics",
     "X3DParticlePhysicsModelNode",
     Role::none,
     NodeKind::force_physics,
     R"(
  exposedField SFBool     enabled TRUE
  exposedField SFVec3f    force 0 -9.8 0
)"},
    {"ParticleSystem",
     "ParticleSystems",
     2,
     "children",
     "X3DShapeNode",
     Role::child,
     NodeKind::particle_system,
     R"(
  exposedField SFNode     appearance NULL  # X3DAppearanceNode
  exposedField SFBool     bboxDisplay FALSE
  exposedField SFBool     castShadow TRUE
  exposedField SFBool     createParticles TRUE
  exposedField SFBool     enabled TRUE
  exposedField SFNode     geometry NULL  # X3DGeometryNode
  exposedField SFFloat    lifetimeVariation 0.25  # [0,1]
  exposedField SFInt32    maxParticles 200  # [0,inf)
  exposedField SFFloat    particleLifetime 5  # [0,inf)
  exposedField SFVec2f    particleSize 0.02 0.02  # [0,inf)
  exposedField SFBool     visible TRUE
  field        SFVec3f    bboxCenter 0 0 0
  field        SFVec3f    bboxSize -1 -1 -1
  field        SFNode     colorRamp NULL  # X3DColorNode
  field        MFFloat    colorKey []  # [0,inf)
  field        SFNode     emitter NULL  # X3DParticleEmitterNode
  field        SFString   geometryType "QUAD"
  field        MFNode     physics []  # X3DParticlePhysicsModelNode
  field        SFNode     texCoordRamp NULL  # TextureCoordinate,TextureCoordinateGenerator
  field        MFFloat    texCoordKey []  # [0,inf)
  eventOut     SFBool     isActive
)",
     {},
     &kParticleSystemBehaviour},
    {"PointEmitter",
     "ParticleSystems",
     1,
     "emitter",
     "X3DParticleEmitterNode",
     Role::none,
     NodeKind::point_emitter,
     R"(
  exposedField SFVec3f    direction 0 1 0
  exposedField SFFloat    mass 0  # [0,inf)
  exposedField SFBool     on TRUE
  exposedField SFVec3f    position 0 0 0
  exposedField SFFloat    speed 0  # [0,inf)
  exposedField SFFloat    surfaceArea 0  # [0,inf)
  exposedField SFFloat    variation 0.25  # [0,inf)
)"},
    {"PolylineEmitter",
     "ParticleSystems",
     1,
     "emitter",
     "X3DParticleEmitterNode",
     Role::none,
     NodeKind::polyline_emitter,
     R"(
  eventIn      MFInt32    set_coordIndex  # [-1,inf)
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFVec3f    direction 0 1 0  # [-1,1]
  exposedField SFFloat    mass 0  # [0,inf)
  exposedField SFBool     on TRUE
  exposedField SFFloat    speed 0  # [0,inf)
  exposedField SFFloat    surfaceArea 0  # [0,inf)
  exposedField SFFloat    variation 0.25  # [0,inf)
  field        MFInt32    coordIndex [-1]  # [-1,inf)
)"},
    {"SurfaceEmitter",
     "ParticleSystems",
     2,
     "emitter",
     "X3DParticleEmitterNode",
     Role::none,
     NodeKind::surface_emitter,
     R"(
  exposedField SFFloat    mass 0  # [0,inf)
  exposedField SFBool     on TRUE
  exposedField SFFloat    speed 0  # [0,inf)
  exposedField SFFloat    surfaceArea 0  # [0,inf)
  exposedField SFFloat    variation 0.25  # [0,inf)
  field        SFNode     surface NULL  # X3DGeometryNode
)"},
    {"VolumeEmitter",
     "ParticleSystems",
     2,
     "emitter",
     "X3DParticleEmitterNode",
     Role::none,
     NodeKind::volume_emitter,
     R"(
  eventIn      MFInt32    set_coordIndex  # [-1,inf)
  exposedField SFNode     coord NULL  # X3DCoordinateNode
  exposedField SFVec3f    direction 0 1 0  # [-1,1]
  exposedField SFFloat    mass 0  # [0,inf)
  exposedField SFBool     on TRUE
  exposedField SFFloat    speed 0  # [0,inf)
  exposedField SFFloat    surfaceArea 0  # [0,inf)
  exposedField SFFloat    variation 0.25  # [0,inf)
  field        MFInt32    coordIndex [-1]  # [-1,inf)
  field        SFBool     internal TRUE
)"},
    {"WindPhysicsModel",
     "ParticleSystems",
     1,
     "physics",
     "X3DParticlePhysicsModelNode",
     Role::none,
     NodeKind::wind_physics,
     R"(
  exposedField SFVec3f    direction 1 0 0
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gustiness 0.1  # [0,inf)
  exposedField SFFloat    speed 0.1  # [0,inf)
  exposedField SFFloat    turbulence 0  # [0,1]
)"},
};

}  // namespace

std::span<const X3DRow> x3d_particle_systems_rows() { return kParticleSystemsX3DRows; }

}  // namespace gs::vrml
