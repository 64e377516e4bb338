// Part of Collector for VolumeData, SegmentedVolumeData and IsoSurfaceVolumeData (X3D clause 41).
#include "render/collection/collector.h"
#include "render/collection/nodes/node_fields.h"
#include "render/collection/nodes/texture_sampling.h"
#include "render/collection/render_scene.h"
#include "render/volume_rendering/volume_box.h"
#include "vrml/behaviours/animation/interpolation.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace gs::render {
namespace {

using vrml::NodeId;
using StepKind = VolumeStep::Kind;
using Weight = VolumeStep::Weight;

constexpr std::size_t kMaxVisits = 256;     // nodes of one look; styles may be USEd in styles
constexpr std::size_t kMaxStyleDepth = 16;  // nesting of styles
constexpr std::size_t kGradientBytes = 4;   // of a voxel, for the renderer
constexpr float kMost = 1e6f;

/// Names of weight functions (X3D Table 41.3). Some browsers count from 0.
constexpr std::array<Named<Weight>, 7> kWeightNames = {{
    {"ALPHA0", Weight::alpha_1},
    {"ALPHA1", Weight::alpha_1},
    {"ALPHA2", Weight::alpha_2},
    {"ONE_MINUS_ALPHA0", Weight::one_minus_alpha_1},
    {"ONE_MINUS_ALPHA1", Weight::one_minus_alpha_1},
    {"ONE_MINUS_ALPHA2", Weight::one_minus_alpha_2},
    {"TABLE", Weight::table},
}};
constexpr std::array<Named<VolumeLook::Projection>, 2> kProjectionNames = {{
    {"MIN", VolumeLook::Projection::minimum},
    {"AVERAGE", VolumeLook::Projection::average},
}};

glm::vec4 color_in(const vrml::Node& node, std::string_view name) {
  const auto* value = field<vrml::SFColorRGBA>(node, name);
  if (!value || !std::isfinite(value->r + value->g + value->b + value->a)) return glm::vec4(0);
  return glm::clamp(glm::vec4(value->r, value->g, value->b, value->a), glm::vec4(0), glm::vec4(1));
}

bool flag_in(const vrml::Node& node, std::string_view name, bool otherwise) {
  const auto* value = field<vrml::SFBool>(node, name);
  return value ? static_cast<bool>(*value) : otherwise;
}

std::string_view text_in(const vrml::Node& node, std::string_view name) {
  const auto* value = field<vrml::SFString>(node, name);
  return value ? value->view() : std::string_view();
}

/// Returns the colours of a CartoonVolumeStyle by the angle of the normal (X3D 41.4.3): the ends are the given colours,
/// the others those of the middle of their angles, in HSV.
std::vector<glm::vec4> cartoon_colors(const vrml::Node& node) {
  constexpr int kMostSteps = 64;
  const auto* given = field<vrml::SFInt32>(node, "colorSteps");
  const int steps = std::clamp<int>(given ? *given : 4, 1, kMostSteps);
  const glm::vec4 first = color_in(node, "orthogonalColor"), last = color_in(node, "parallelColor");
  const vrml::SFColor from{first.r, first.g, first.b}, to{last.r, last.g, last.b};
  std::vector<glm::vec4> colors(static_cast<std::size_t>(steps), first);
  for (int i = 1; i < steps; ++i) {
    const float part = (static_cast<float>(i) + 0.5f) / static_cast<float>(steps);
    const vrml::SFColor mixed = vrml::between_colors(from, to, part);
    colors[static_cast<std::size_t>(i)] = glm::vec4(mixed.r, mixed.g, mixed.b, glm::mix(first.a, last.a, part));
  }
  if (steps > 1) colors.back() = last;
  return colors;
}

}  // namespace

/// Translates a volume data node and its styles to a VolumeLook. Nodes are those of one scene. One thread.
class VolumeLookBuilder {
 public:
  /// `nodes` receives the nodes on which the look depends.
  VolumeLookBuilder(ShapeResources& resources, const vrml::SceneGraph& scene, std::vector<const vrml::Node*>& nodes)
      : resources_(resources), scene_(scene), nodes_(nodes) {}

  /// Returns null, after a report, if the node cannot be drawn in its state.
  std::shared_ptr<const VolumeLook> build(NodeId id) {
    id_ = id;
    const vrml::Node& node = scene_.node(id);
    nodes_.push_back(&node);
    const auto* dimensions = field<vrml::SFVec3f>(node, "dimensions");
    look_.dimensions = dimensions ? *dimensions : glm::vec3(1);
    const glm::vec3& d = look_.dimensions;
    constexpr float kLongest = 1e30f, kShortest = 1e-30f;
    if (!(std::min({d.x, d.y, d.z}) > kShortest && std::max({d.x, d.y, d.z}) < kLongest))
      return refuse("the dimensions of a volume: expected numbers above 0");
    const Found voxels = node_in(node, "voxels");
    if (!voxels) return refuse("a volume without voxels: expected a 3D texture");
    look_.voxels = volume_of(voxels);
    if (!look_.voxels && voxels.kind() == NodeKind::pixel_texture_3d)
      return refuse(
          "a volume with an invalid image: expected components, width, height, depth, and a number per voxel");
    look_.smooth = sampling_of(resources_.schemas(), scene_, voxels).smooth;
    const NodeKind kind = resources_.schemas().of(*node.type).kind;
    if (kind == NodeKind::iso_surface_volume) {
      add_surfaces(node);
    } else if (kind == NodeKind::segmented_volume) {
      add_segments(node);
    } else if (const NodeView style = node_in(node, "renderStyle")) {
      add_chain(style);
    }
    return std::make_shared<const VolumeLook>(std::move(look_));
  }

 private:
  std::shared_ptr<const VolumeLook> refuse(const std::string& why) {
    resources_.report_limit(why, scene_, id_);
    return nullptr;
  }

  /// Node in a field.
  struct Found : NodeView {
    NodeId id;
  };
  /// Returns the node that `id` means, and records it.
  Found view_of(NodeId id) {
    const NodeView view = resources_.schemas().view(scene_, id);
    if (!view || ++visits_ > kMaxVisits) return {};
    nodes_.push_back(view.node);
    return {view, scene_.resolve(id)};
  }
  Found node_in(const vrml::Node& node, std::string_view name) {
    const auto* given = field<vrml::SFNode>(node, name);
    return given ? view_of(*given) : Found{};
  }

  /// Returns the volume of a 3D texture. Returns null if it is not loaded, or if the budget does not permit it.
  std::shared_ptr<const Image> volume_of(const Found& texture) {
    for (const vrml::Node* inner : inner_nodes(scene_, *texture.node)) nodes_.push_back(inner);
    std::shared_ptr<const Image> image;
    switch (texture.kind()) {
      case NodeKind::image_texture_3d:
        image = resources_.image_of_texture(scene_, texture.id);
        break;
      case NodeKind::pixel_texture_3d:
        image = resources_.volume_of_pixels(scene_, texture.id);
        break;
      case NodeKind::composed_texture_3d:
        image = resources_.volume_of_textures(scene_, texture.id);
        break;
      default:
        return nullptr;
    }
    return image && is_affordable(image) ? image : nullptr;
  }

  /// Charges the renderer's copies of a volume to the budget.
  bool is_affordable(const std::shared_ptr<const Image>& image) {
    auto& casts = resources_.meshes_.casts;
    MeshCache::CastEntry& entry = casts[image.get()];
    if (!entry.image.expired()) return true;
    std::erase_if(casts, [&](const auto& each) { return each.first != image.get() && each.second.image.expired(); });
    entry = {{}, Share(resources_.budget_, Resource::pixels)};
    const std::uint64_t voxels = std::uint64_t{image->width} * image->height;
    if (!entry.share.grow(voxels * (kGradientBytes + image->components))) {
      resources_.report_limit("a volume: " + resources_.budget_->refusal(Resource::pixels), scene_, id_);
      return false;
    }
    entry.image = image;
    return true;
  }

  /// Takes `count` texture units of the program. Returns false, after a report, if there are no more.
  bool take_units(std::size_t count) {
    if (units_ + count > VolumeLook::kMaxTextures) {
      resources_.report_limit("more textures in the styles of a volume than the " +
                                  std::to_string(VolumeLook::kMaxTextures) + " that it may have",
                              scene_, id_);
      return false;
    }
    units_ += count;
    return true;
  }

  std::shared_ptr<const Image> volume_in(const vrml::Node& node, std::string_view name, std::size_t units = 1) {
    const Found texture = node_in(node, name);
    const auto image = texture ? volume_of(texture) : nullptr;
    return image && take_units(units) ? image : nullptr;
  }

  /// Returns the image of a table: a texture in two or three dimensions.
  std::shared_ptr<const Image> table_in(const vrml::Node& node, std::string_view name) {
    const Found texture = node_in(node, name);
    if (!texture) return nullptr;
    auto image = volume_of(texture);
    const NodeKind kind = texture.kind();
    if (!image &&
        (kind == NodeKind::image_texture || kind == NodeKind::pixel_texture || kind == NodeKind::movie_texture))
      image = resources_.image_of_texture(scene_, texture.id);
    return image && take_units(1) ? image : nullptr;
  }

  void add_chain(const NodeView& style) {
    VolumeChain chain;
    if (style && style.kind() == NodeKind::projection_style) {
      if (flag_in(*style.node, "enabled", true)) {
        chain.projected = true;
        look_.projection = named(kProjectionNames, text_in(*style.node, "type"), VolumeLook::Projection::maximum);
        look_.threshold = number(*style.node, "intensityThreshold", 0, kMost, 0);
      }
    } else if (style) {
      add_steps(style, chain.steps, 0);
    }
    look_.chains.push_back(std::move(chain));
  }

  /// Adds the steps of a style, in order.
  void add_steps(const NodeView& style, std::vector<VolumeStep>& to, std::size_t depth) {
    if (depth > kMaxStyleDepth || !flag_in(*style.node, "enabled", true)) return;
    if (style.kind() == NodeKind::composed_style) {
      const auto* parts = field<vrml::MFNode>(*style.node, "renderStyle");
      for (std::size_t i = 0; parts && i < parts->size(); ++i)
        if (const NodeView part = view_of((*parts)[i])) add_steps(part, to, depth + 1);
      return;
    }
    if (steps_ >= VolumeLook::kMaxSteps) {
      resources_.report_limit(
          "more styles of a volume than the " + std::to_string(VolumeLook::kMaxSteps) + " that it may have", scene_,
          id_);
      return;
    }
    VolumeStep step;
    if (!set_step(style, step, depth)) return;
    ++steps_;
    to.push_back(std::move(step));
  }

  bool set_step(const NodeView& style, VolumeStep& step, std::size_t depth) {
    const vrml::Node& node = *style.node;
    const auto float_in = [&](std::string_view name, float otherwise, float most = kMost) {
      return number(node, name, 0, most, otherwise);
    };
    switch (style.kind()) {
      case NodeKind::opacity_map_style:
        step.kind = StepKind::opacity_map;
        step.tables[0] = table_in(node, "transferFunction");
        return true;
      case NodeKind::boundary_style:
        step.kind = StepKind::boundary;
        step.values = {
            {float_in("retainedOpacity", 0.2f), float_in("boundaryOpacity", 0.9f), float_in("opacityFactor", 2), 0}};
        break;
      case NodeKind::edge_style:
        step.kind = StepKind::edge;
        step.values = {color_in(node, "edgeColor"), glm::vec4(std::cos(float_in("gradientThreshold", 0.4f, 3.1416f)))};
        break;
      case NodeKind::tone_mapped_style:
        step.kind = StepKind::tone;
        step.values = {color_in(node, "warmColor"), color_in(node, "coolColor")};
        break;
      case NodeKind::silhouette_style:
        step.kind = StepKind::silhouette;
        step.values = {{float_in("silhouetteRetainedOpacity", 1), float_in("silhouetteBoundaryOpacity", 0),
                        float_in("silhouetteSharpness", 0.5f), 0}};
        break;
      case NodeKind::cartoon_style:
        step.kind = StepKind::cartoon;
        step.values = cartoon_colors(node);
        break;
      case NodeKind::shaded_style:
        step.kind = StepKind::shaded;
        set_shading(node, step);
        break;
      case NodeKind::blended_style:
        return set_blend(node, step, depth);
      default:
        return false;
    }
    step.normals = volume_in(node, "surfaceNormals");
    return true;
  }

  void set_shading(const vrml::Node& node, VolumeStep& step) {
    step.lit = flag_in(node, "lighting", false);
    step.shadows = flag_in(node, "shadows", false);
    step.scatters = text_in(node, "phaseFunction") == "Henyey-Greenstein";
    step.values.assign(3, glm::vec4(0));
    const NodeView given = node_in(node, "material");
    const NodeKind kind = given.kind();
    if (kind != NodeKind::material && kind != NodeKind::physical_material && kind != NodeKind::unlit_material &&
        kind != NodeKind::two_sided_material)
      return;
    const Material material = material_of(given);
    step.has_material = true;
    step.lit = step.lit && material.lit;
    step.values = {glm::vec4(material.lit ? material.diffuse : material.unlit, material.transparency),
                   glm::vec4(material.emissive, material.ambient_intensity),
                   glm::vec4(material.specular, material.shininess * kShininessScale)};
  }

  bool set_blend(const vrml::Node& node, VolumeStep& step, std::size_t depth) {
    step.kind = StepKind::blend;
    step.values = {{number(node, "weightConstant1", 0, 1, 0.5f), number(node, "weightConstant2", 0, 1, 0.5f), 0, 0}};
    step.weights = {named(kWeightNames, text_in(node, "weightFunction1"), Weight::constant),
                    named(kWeightNames, text_in(node, "weightFunction2"), Weight::constant)};
    step.voxels = volume_in(node, "voxels", 2);  // with its gradients
    for (std::size_t i = 0; i < 2; ++i)
      if (step.weights[i] == Weight::table)
        step.tables[i] = table_in(node, i == 0 ? "weightTransferFunction1" : "weightTransferFunction2");
    if (const NodeView style = node_in(node, "renderStyle")) add_steps(style, step.inner, depth + 1);
    return step.voxels != nullptr;
  }

  /// Adds one chain per style of an MFNode.
  void add_chains(const vrml::Node& node) {
    const auto* styles = field<vrml::MFNode>(node, "renderStyle");
    for (std::size_t i = 0; styles && i < styles->size(); ++i) {
      if (i == VolumeLook::kMaxChains) {
        resources_.report_limit(
            "more styles of a volume than the " + std::to_string(VolumeLook::kMaxChains) + " that it may have", scene_,
            id_);
        return;
      }
      add_chain(view_of((*styles)[i]));
    }
  }

  // X3D 41.4.9. Identifiers of another size than the voxels are ignored.
  void add_segments(const vrml::Node& node) {
    const Found texture = node_in(node, "segmentIdentifiers");
    const auto segments = texture ? volume_of(texture) : nullptr;
    add_chains(node);
    if (!segments || !look_.voxels || voxel_counts(*segments) != voxel_counts(*look_.voxels)) {
      if (look_.chains.size() > 1) look_.chains.resize(1);
      return;
    }
    look_.segments = segments;
    const auto* enabled = field<vrml::MFBool>(node, "segmentEnabled");
    for (std::size_t i = 0; enabled && i < std::min(enabled->size(), VolumeLook::kSegments); ++i)
      if (!(*enabled)[i]) look_.hidden_segments[i / 32] |= 1u << i % 32;
  }

  // X3D 41.4.6. Of the surfaces at multiples of contourStepSize, the given one has the first style, and the others have
  // the next ones, from the smallest value on.
  void add_surfaces(const vrml::Node& node) {
    look_.iso_surfaces = true;
    look_.least_gradient = number(node, "surfaceTolerance", 0, kMost, 0);
    look_.gradients = volume_in(node, "gradients", 0);
    add_chains(node);
    if (look_.chains.empty()) look_.chains.emplace_back();
    const auto* given = field<vrml::MFFloat>(node, "surfaceValues");
    std::vector<std::pair<float, std::size_t>> surfaces;  // value, and index of its style
    for (std::size_t i = 0; given && i < given->size(); ++i)
      if (std::isfinite((*given)[i])) surfaces.emplace_back((*given)[i], i);
    const float step = std::abs(number(node, "contourStepSize", -kMost, kMost, 0));
    if (given && given->size() == 1 && surfaces.size() == 1 && step > 0) {
      const float first = surfaces[0].first;
      std::vector<float> others;
      const auto add_others = [&](float direction) {
        for (int k = 1; others.size() <= VolumeLook::kMaxSurfaces; ++k) {
          const float value = first + direction * static_cast<float>(k) * step;
          if (!(value > 0 && value < 1)) break;
          others.push_back(value);
        }
      };
      add_others(-1);
      add_others(1);
      std::sort(others.begin(), others.end());
      for (const float value : others) surfaces.emplace_back(value, surfaces.size());
    }
    if (surfaces.size() > VolumeLook::kMaxSurfaces) {
      resources_.report_limit(
          "more isosurfaces than the " + std::to_string(VolumeLook::kMaxSurfaces) + " that a volume may have", scene_,
          id_);
      surfaces.resize(VolumeLook::kMaxSurfaces);
    }
    std::sort(surfaces.begin(), surfaces.end());
    for (const auto& [value, style] : surfaces) {
      look_.surfaces.push_back(value);
      look_.surface_chains.push_back(static_cast<std::uint32_t>(std::min(style, look_.chains.size() - 1)));
    }
  }

  ShapeResources& resources_;
  const vrml::SceneGraph& scene_;
  std::vector<const vrml::Node*>& nodes_;
  NodeId id_;
  VolumeLook look_;
  std::size_t visits_ = 0, steps_ = 0, units_ = 0;
};

bool renew_volume(ShapeResources& resources, DrawItem& item, RenderSources::Item& source, RenderSources::Volume& volume,
                  const vrml::SceneGraph& scene, NodeId id) {
  volume.nodes.clear();
  item.volume = VolumeLookBuilder(resources, scene, volume.nodes).build(id);
  if (!item.volume) return false;
  source.scale = item.volume->dimensions;
  return true;
}

void Collector::add_volume(const Frame& parent, NodeId id) {
  DrawItem item;
  RenderSources::Item source;
  RenderSources::Volume volume;
  item.mesh = volume_box();
  item.material.lit = false;
  const vrml::SceneGraph& scene = *parent.scene;
  const bool drawn = renew_volume(resources_, item, source, volume, scene, id);
  const glm::dmat4 world_from_box = glm::scale(parent.world_from_local, glm::dvec3(source.scale));
  if (!drawn || !fits_float(world_from_box)) {
    if (sources_) sources_->unshown.push_back({&scene.node(id), &scene});
    return;
  }
  if (!room_.take_item(list_, item.mesh->indices.size() / 3, scene, id)) return;
  volume.item = static_cast<std::uint32_t>(list_.items.size());
  add_item(parent, id, {}, std::move(item), source, world_from_box);
  if (sources_) sources_->volumes.push_back(std::move(volume));
}

}  // namespace gs::render
