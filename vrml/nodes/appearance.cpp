#include "vrml/event_model/behaviour.h"
#include "vrml/nodes/families.h"

namespace gs::vrml {
namespace {

// Rows of the Shape and appearance nodes (VRML97 4.6.3, 4.6.11).
constexpr NodeRow kAppearanceRows[] = {
    {"Appearance", "6.3", Role::appearance, NodeKind::appearance, R"(
  exposedField SFNode     material         NULL
  exposedField SFNode     texture          NULL
  exposedField SFNode     textureTransform NULL
)"},
    {"FontStyle", "6.20", Role::font_style, NodeKind::font_style, R"(
  field        MFString   family           "SERIF"
  field        SFBool     horizontal       TRUE
  field        MFString   justify          "BEGIN"
  field        SFString   language         ""
  field        SFBool     leftToRight      TRUE
  field        SFFloat    size             1.0              # (0,inf)
  field        SFFloat    spacing          1.0              # [0,inf)
  field        SFString   style            "PLAIN"
  field        SFBool     topToBottom      TRUE
)"},
    {"ImageTexture", "6.22", Role::texture, NodeKind::image_texture, R"(
  exposedField MFString   url              []
  field        SFBool     repeatS          TRUE
  field        SFBool     repeatT          TRUE
)",
     nullptr, nullptr, UrlContent::image},
    {"Material", "6.27", Role::material, NodeKind::material, R"(
  exposedField SFFloat    ambientIntensity 0.2              # [0,1]
  exposedField SFColor    diffuseColor     0.8 0.8 0.8      # [0,1]
  exposedField SFColor    emissiveColor    0 0 0            # [0,1]
  exposedField SFFloat    shininess        0.2              # [0,1]
  exposedField SFColor    specularColor    0 0 0            # [0,1]
  exposedField SFFloat    transparency     0                # [0,1]
)"},
    {"MovieTexture", "6.28", Role::texture | Role::sound_source | Role::time_dependent, NodeKind::movie_texture, R"(
  exposedField SFBool     loop             FALSE
  exposedField SFFloat    speed            1.0              # (-inf,inf)
  exposedField SFTime     startTime        0                # (-inf,inf)
  exposedField SFTime     stopTime         0                # (-inf,inf)
  exposedField MFString   url              []
  field        SFBool     repeatS          TRUE
  field        SFBool     repeatT          TRUE
  eventOut     SFTime     duration_changed
  eventOut     SFBool     isActive
)",
     nullptr, &kMovieTextureBehaviour, UrlContent::movie, "eventOut SFTime mediaTime"},
    {"PixelTexture", "6.33", Role::texture, NodeKind::pixel_texture, R"(
  exposedField SFImage    image            0 0 0
  field        SFBool     repeatS          TRUE
  field        SFBool     repeatT          TRUE
)"},
    {"Shape", "6.41", Role::child, NodeKind::shape, R"(
  exposedField SFNode     appearance       NULL
  exposedField SFNode     geometry         NULL
)"},
    {"TextureTransform", "6.49", Role::texture_transform, NodeKind::texture_transform, R"(
  exposedField SFVec2f    center           0 0              # (-inf,inf)
  exposedField SFFloat    rotation         0                # (-inf,inf)
  exposedField SFVec2f    scale            1 1              # (-inf,inf)
  exposedField SFVec2f    translation      0 0              # (-inf,inf)
)"},
};

}  // namespace

std::span<const NodeRow> appearance_rows() { return kAppearanceRows; }

}  // namespace gs::vrml
