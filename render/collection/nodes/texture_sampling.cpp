#include "render/collection/nodes/texture_sampling.h"

#include "render/collection/nodes/node_fields.h"

#include <array>

namespace gs::render {

bool has_properties(const vrml::SceneGraph& scene, const NodeView& texture) {
  const auto* given = texture.find<vrml::SFNode>(TextureFields::properties);
  return given && scene.resolve_as(*given, NodeKind::texture_properties);
}

Sampling sampling_of(Schemas& schemas, const vrml::SceneGraph& scene, const NodeView& texture) {
  using Edge = Sampling::Edge;
  using Filter = Sampling::Filter;
  static constexpr std::array<Named<Edge>, 4> kEdges = {{
      {"CLAMP", Edge::clamp},
      {"CLAMP_TO_EDGE", Edge::clamp},
      {"CLAMP_TO_BOUNDARY", Edge::border},
      {"MIRRORED_REPEAT", Edge::mirror},
  }};
  static constexpr std::array<Named<Filter>, 7> kSmaller = {{
      {"AVG_PIXEL", Filter::linear},
      {"NEAREST_PIXEL", Filter::nearest},
      {"FASTEST", Filter::nearest},
      {"NEAREST_PIXEL_NEAREST_MIPMAP", Filter::nearest_mipmap_nearest},
      {"NEAREST_PIXEL_AVG_MIPMAP", Filter::nearest_mipmap_nearest},
      {"AVG_PIXEL_AVG_MIPMAP", Filter::linear_mipmap_linear},
      {"NICEST", Filter::linear_mipmap_linear},
  }};
  static constexpr std::array<Named<bool>, 2> kLarger = {{{"NEAREST_PIXEL", false}, {"FASTEST", false}}};
  Sampling sampling;
  const auto edge = [&](int repeat) { return texture.get(repeat, true) ? Edge::repeat : Edge::clamp; };
  sampling.s = edge(TextureFields::repeat_s);
  sampling.t = edge(TextureFields::repeat_t);
  sampling.r = edge(TextureFields::repeat_r);
  const auto* given = texture.find<vrml::SFNode>(TextureFields::properties);
  const NodeView view = given ? schemas.view(scene, *given) : NodeView{};
  if (view.kind() != NodeKind::texture_properties) return sampling;
  const vrml::Node& node = *view.node;
  const auto text = [&](std::string_view name) {
    const auto* value = field<vrml::SFString>(node, name);
    return value ? value->view() : std::string_view();
  };
  sampling.s = named(kEdges, text("boundaryModeS"), Edge::repeat);
  sampling.t = named(kEdges, text("boundaryModeT"), Edge::repeat);
  sampling.r = named(kEdges, text("boundaryModeR"), Edge::repeat);
  sampling.smaller = named(kSmaller, text("minificationFilter"), Filter::linear_mipmap_linear);
  sampling.smooth = named(kLarger, text("magnificationFilter"), true);
  if (const auto* border = field<vrml::SFColorRGBA>(node, "borderColor"))
    sampling.border = {border->r, border->g, border->b, border->a};
  sampling.anisotropy = number(node, "anisotropicDegree", 1, 64, 1);
  return sampling;
}

}  // namespace gs::render
