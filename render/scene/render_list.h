#pragma once

#include "qnv/base/cloud.h"
#include "render/image/image.h"
#include "render/scene/fog.h"
#include "render/scene/mesh_cache.h"
#include "render/scene/world_bounds.h"
#include "vrml/mesh/mesh.h"
#include "vrml/scene/array.h"
#include "vrml/scene/scene_graph.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// VRML97 6.27 and Table 4.5.
struct Material {
  glm::vec3 diffuse{0.8f}, emissive{0.0f}, specular{0.0f};
  float ambient_intensity = 0.2f, shininess = 0.2f, transparency = 0.0f;
  bool lit = true;  // false without an Appearance or Material: colour is 1 1 1, unlit
};
/// The specular exponent of a material whose shininess is 1 (VRML97 4.14.4).
inline constexpr float kShininessScale = 128;

struct Light {
  enum class Kind : std::uint8_t { directional, point, spot };
  Kind kind = Kind::directional;
  glm::dvec3 location{0.0};  // world space, as the direction
  glm::vec3 color{1.0f}, direction{0, 0, -1}, attenuation{1, 0, 0};
  float intensity = 1, ambient_intensity = 0, radius = 100, beam_width = 1.570796f, cut_off_angle = 0.785398f;
};

/// An item is lit by no more than this, so that no world keeps a frame busy for minutes; of more, the strongest ones
/// count.
inline constexpr std::size_t kMaxLightsOfAnItem = 1024;
/// Indices into RenderList::lights. Items of one group share them.
using LightList = vrml::Array<std::uint16_t>;

/// A texture as a Shape uses it.
struct TextureUse {
  std::shared_ptr<const Image> image;
  bool repeat_s = true, repeat_t = true;
  glm::mat3 transform{1.0f};  // texture space from mesh texture coordinates (VRML97 6.49)
};

inline constexpr std::uint32_t kNoPlace = UINT32_MAX;
/// A grouping node or Shape as one path from the root leads to it: the end of that path, the rest of which its parents
/// are. What an Inline holds stands below the Inline. PROTO instances are the nodes that they stand for.
struct Place {
  const vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;                // of `scene`
  std::uint32_t parent = kNoPlace;  // of RenderList::places; kNoPlace: a root of the world
  std::uint32_t frame = 0;          // of RenderList::world_from_frame: the coordinate system of the node's children
};

/// One Shape under one transformation.
struct DrawItem {
  std::shared_ptr<const vrml::Mesh> mesh;
  glm::dmat4 world_from_node{1.0};
  Material material;
  TextureUse texture;
  LightList directional_lights;               // those of the enclosing groups (6.16)
  std::uint32_t place = kNoPlace;             // of the Shape
  bool seen = true;                           // false: the proxy of a Collision (6.8)
  bool met = true;                            // false: the viewer goes through it
  bool overlay = false;                       // fixed to the viewer: drawn over everything that is not
  std::shared_ptr<const qnv::Cloud> surface;  // whose vectors are the mesh's vertices: a QNV node; else null
  float detail = 1;                           // > 0: of the QNV node; multiplies how finely a surface is shown
};

/// The vectors of the QNV nodes of a world that have arrived, by node.
using Clouds = std::unordered_map<const vrml::Node*, std::shared_ptr<const qnv::Cloud>>;

/// One Shape whose geometry is a QNV node, under one transformation.
struct SplatItem {
  std::shared_ptr<const qnv::Cloud> cloud;
  glm::dmat4 world_from_node{1.0};
  Material material;
  bool own_color = false;  // the cloud's colour, not the material's
  float detail = 1;        // > 0: of the QNV node; multiplies its part of the budget and how finely it is shown
  LightList directional_lights;
  std::uint32_t place = kNoPlace;  // of the Shape
};

/// VRML97 6.5. Colours from the zenith (sky) and the nadir (ground); angles in radians.
struct Background {
  std::vector<glm::vec3> sky_colors{glm::vec3(0.0f)}, ground_colors;
  std::vector<float> sky_angles, ground_angles;
  /// The panorama, in the order of the node's url fields; null where a face has no picture.
  enum Face : std::size_t { back, bottom, front, left, right, top };
  static constexpr std::size_t kFaces = 6;
  std::array<std::shared_ptr<const Image>, kFaces> panorama;
  glm::mat3 world_from_background{1.0f};  // rotation only
};

/// A Viewpoint in world space (6.53).
struct ViewpointState {
  std::string description, name;  // `description` field, DEF name
  const vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;  // of `scene`
  glm::dmat4 world_from_camera{1.0};
  float field_of_view = 0.785398f;
  // Of its coordinates, without its own orientation: what is up for who is bound to it, and how long a metre (6.29).
  glm::dvec3 up{0, 1, 0};
  double scale = 1;
  bool jump = true;  // whether the viewer goes there when it is bound
};

/// A Sound node that is traversed (6.42), once for each path to it.
struct SoundPlace {
  const vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;        // of `scene`
  std::uint32_t frame = 0;  // of RenderList::world_from_frame: its coordinate system
};

/// The bound NavigationInfo (6.29).
struct NavigationState {
  std::vector<std::string> types{"WALK", "ANY"};
  std::array<float, 3> avatar_size{0.25f, 1.6f, 0.75f};
  float speed = 1, visibility_limit = 0;
  bool headlight = true;
  friend bool operator==(const NavigationState&, const NavigationState&) = default;
};

/// The bindable nodes that are bound (4.6.10), of the root or of Inlines. Null: none of the type is.
struct BoundNodes {
  const vrml::Node *viewpoint = nullptr, *navigation_info = nullptr, *background = nullptr, *fog = nullptr;
};

/// How many pixels an angle has in the middle of pictures of a usual size, 768 lines at 45 degrees.
inline constexpr float kUsualPixelsPerRadian = 930;

/// What limits kept out of a picture, for one reason.
struct LeftOut {
  std::string why;    // names the limit
  std::size_t count;  // shapes, pictures or steps of the walk
  std::string file;   // the first one
  vrml::SourceLocation location;
};

/// Everything that one frame needs, as plain data in world space. Places are in double precision, so that a thing keeps
/// its centimetres ten thousand kilometres from the origin; boxes are not.
struct RenderList {
  // Not in each file that has a list: they are long.
  RenderList();
  RenderList(const RenderList& other);
  RenderList(RenderList&& other) noexcept;
  RenderList& operator=(const RenderList& other);
  RenderList& operator=(RenderList&& other) noexcept;
  ~RenderList();

  std::vector<DrawItem> items;
  /// What the list was gathered as, unlike any other list of the process; then `moved` has the items whose places or
  /// meshes have changed since, some more than once, and `dressed` counts changes of materials. 0: nobody keeps
  /// account.
  std::uint64_t generation = 0, dressed = 0;
  std::vector<std::uint32_t> moved;
  /// Another number, unlike that of any list of the process, whenever something in it is another: `next_change`. Who
  /// has drawn it has nothing to draw anew while it stays. 0: nobody keeps account. What grows in the clouds and images
  /// that it holds is not counted.
  std::uint64_t changes = 0;
  std::vector<SplatItem> splats;
  std::vector<Light> lights;               // directional ones act through DrawItem::directional_lights
  std::vector<ViewpointState> viewpoints;  // in the order of the file; the first one is bound at start
  std::vector<SoundPlace> sounds;
  Background background;
  NavigationState navigation;
  bool has_navigation = false;  // of a node, and not what the standard says where there is none
  Fog fog;
  WorldBounds bounds;                                           // world space, of all items that are no overlays
  bool overlays = false;                                        // some items are
  std::vector<LeftOut> left_out;                                // one for each reason
  std::vector<Place> places;                                    // of everything above, parents before children
  std::vector<glm::dmat4> world_from_frame;                     // coordinate systems of places
  std::vector<std::shared_ptr<const vrml::SceneGraph>> scenes;  // of Inlines that `places` name, kept for as long
};

/// A number for RenderList::changes. Any thread.
[[nodiscard]] std::uint64_t next_change();

/// Walks the live scene (PROTO instances and attached Inlines included) and gathers what is visible.
/// Safe for any graph a file can describe: cycles are cut; depth, items, triangles and the memory of meshes are bounded
/// by the scene's budget, and `left_out` tells what did not fit. Many primitives are cut more coarsely. Ends early
/// where the budget says so. `viewer` is the camera's place in world space, for LOD. Geometry nodes that are in
/// `clouds` become splats. `bound` says which NavigationInfo, Background and Fog count; null: the first ones that are
/// not in an Inline. `pixels_per_radian`: for how large pictures Text is cut.
[[nodiscard]] RenderList collect(const vrml::SceneGraph& scene, const Images& images, MeshCache& meshes,
                                 const glm::dvec3& viewer = glm::dvec3(0, 0, 10), const Clouds& clouds = {},
                                 const BoundNodes* bound = nullptr, float pixels_per_radian = kUsualPixelsPerRadian);

}  // namespace gs::render
