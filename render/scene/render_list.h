#pragma once

#include "base/array.h"
#include "qnv/base/geometry.h"
#include "render/image/image.h"
#include "render/scene/camera.h"
#include "render/scene/fog.h"
#include "render/scene/layered_material.h"
#include "render/scene/mesh_cache.h"
#include "render/scene/shape_style.h"
#include "render/scene/sight.h"
#include "render/scene/volume_look.h"
#include "render/scene/world_bounds.h"
#include "vrml/mesh/mesh.h"
#include "vrml/scene/coordinates/geospatial.h"
#include "vrml/scene/layers.h"
#include "vrml/scene/scene_graph.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs {
class Budget;
}

namespace gs::render {

/// Material of a Shape (VRML97 6.27 and Table 4.5).
struct Material {
  glm::vec3 diffuse{0.8f}, emissive{0.0f}, specular{0.0f};
  float ambient_intensity = 0.2f, shininess = 0.2f, transparency = 0.0f;
  bool lit = true;        // false without Appearance or Material, and for an UnlitMaterial
  glm::vec3 unlit{1.0f};  // colour if not lit: that of an UnlitMaterial, or 1 1 1 (VRML97 Table 4.5)
};
/// Specular exponent of a material with shininess 1 (VRML97 4.14.4).
inline constexpr float kShininessScale = 128;

// Light in world space.
struct Light {
  enum class Kind : std::uint8_t { directional, point, spot };
  Kind kind = Kind::directional;
  glm::dvec3 location{0.0};  // in world space, as is `direction`
  glm::vec3 color{1.0f}, direction{0, 0, -1}, attenuation{1, 0, 0};
  float intensity = 1, ambient_intensity = 0, radius = 100, beam_width = 1.570796f, cut_off_angle = 0.785398f;
  /// X3D: true if the light reaches all items, false if it reaches only the items that list it
  /// (DrawItem::directional_lights). Unset means as in VRML97: only directional lights must be listed.
  std::optional<bool> global = {};
  [[nodiscard]] bool listed() const { return !global.value_or(kind != Kind::directional); }
};

/// Maximum lights of an item; the strongest are used. No world can then block a frame for minutes.
inline constexpr std::size_t kMaxLightsOfAnItem = 1024;
/// Indexes in RenderList::lights. The items of a group share one list.
using LightList = Array<std::uint16_t>;

/// Indexes in RenderList::clip_planes, the innermost last. The items of a group share one list.
using ClipList = Array<std::uint16_t>;
inline constexpr std::uint16_t kNoLocalFog = UINT16_MAX;

/// Texture of a Shape, with its parameters.
struct TextureUse {
  std::shared_ptr<const Image> image;
  bool repeat_s = true, repeat_t = true;
  glm::mat3 transform{1.0f};           // from texture coordinates of the mesh to texture space (VRML97 6.49)
  bool modulates = false;              // X3D 4: the texture always modulates the colour and the alpha of the material
  std::optional<Sampling> sampling{};  // X3D TextureProperties; replaces repeat_s and repeat_t
};

inline constexpr std::uint32_t kNoPlace = UINT32_MAX;
/// Instance of a grouping node or Shape: the last node of a path from the root. The parents give the rest of the path.
/// The content of an Inline is below the Inline. A PROTO instance is replaced by the node that represents it.
struct Place {
  const vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;                // id in `scene`
  std::uint32_t parent = kNoPlace;  // index in RenderList::places; kNoPlace for a root node of the world
  std::uint32_t frame = 0;          // coordinate system of the node's children: index in RenderList::world_from_frame
};

/// Instance of a Shape that is drawn as a mesh.
struct DrawItem {
  std::shared_ptr<const vrml::Mesh> mesh;
  glm::dmat4 world_from_node{1.0};
  Material material;
  TextureUse texture;
  /// Replaces `texture`, if set; `material` has its colours, and their closest equivalents in VRML97.
  std::shared_ptr<const LayeredMaterial> layered;
  LightList directional_lights;                  // lights of the enclosing groups (6.16)
  ClipList clip_planes;                          // ClipPlanes of the enclosing groups
  std::shared_ptr<const ShapeStyle> style;       // null for the default style
  std::uint16_t local_fog = kNoLocalFog;         // LocalFog of the innermost group that has one
  std::uint32_t place = kNoPlace;                // path of the Shape: index in RenderList::places
  bool visible = true;                           // false in the proxy of a Collision (6.8)
  bool collidable = true;                        // an obstacle to the viewer
  bool overlay = false;                          // fixed to the viewer: drawn in front of all other items
  bool touchable = true;                         // rays hit it; false for particles
  std::shared_ptr<const qnv::Geometry> surface;  // QNV node: an indexed mesh or patches; else null
  float detail = 1;                              // field `detail` of the QNV node, more than 0
  /// Volume of X3D that fills the box of `mesh`, which is then not drawn; else null.
  std::shared_ptr<const VolumeLook> volume;

  /// Returns the patches of which each view draws a cut instead of `mesh`; nullptr if there are none.
  [[nodiscard]] const qnv::SurfacePatches* patches() const {
    return surface ? surface->as<qnv::SurfacePatches>() : nullptr;
  }
};

/// Received vectors of the QNV nodes of a world, by node.
using Geometries = std::unordered_map<const vrml::Node*, std::shared_ptr<const qnv::Geometry>>;

/// Instance of a Shape that is drawn as splats or as a volume.
struct SplatItem {
  std::shared_ptr<const qnv::Geometry> geometry;
  glm::dmat4 world_from_node{1.0};
  Material material;
  bool own_color = false;  // use the splats' colour instead of the material's
  float detail = 1;        // field `detail` of the QNV node, more than 0: factor of its budget and level of detail
  LightList directional_lights;
  ClipList clip_planes;
  std::uint32_t place = kNoPlace;  // path of the Shape: index in RenderList::places
};

inline constexpr vrml::ClipBoundary kWholePicture{0, 1, 0, 1};
/// Rectangle that a LayoutLayer without a Viewpoint shows: that of an OrthoViewpoint with default values.
inline constexpr glm::dvec2 kLayoutExtent{2};

/// Background (VRML97 6.5). Colours of the sky begin at the zenith, those of the ground at the nadir. Angles are in
/// radians.
struct Background {
  std::vector<glm::vec3> sky_colors{glm::vec3(0.0f)}, ground_colors;
  std::vector<float> sky_angles, ground_angles;
  /// Face of the panorama, in the order of the node's url fields. A face without an image is null.
  enum Face : std::size_t { back, bottom, front, left, right, top };
  static constexpr std::size_t kFaces = 6;
  std::array<std::shared_ptr<const Image>, kFaces> panorama;
  glm::mat3 world_from_background{1.0f};  // rotation only
  float transparency = 0;                 // X3D: shows what is behind the picture; without that, black
};

/// Box of a ViewpointGroup (X3D 23.4.7). Its Viewpoints are only in lists while the viewer is inside.
struct ViewpointRegion {
  glm::dmat4 group_from_world{1.0};
  glm::dvec3 center{0}, half{0};
};

/// Viewpoint in world space (6.53).
struct ViewpointState {
  std::string description, name;  // field `description`, and DEF name
  const vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;  // id in `scene`
  glm::dmat4 world_from_camera{1.0};
  float field_of_view = 0.785398f;
  // Up direction and length of a metre in the Viewpoint's coordinate system, without its orientation (6.29).
  glm::dvec3 up{0, 1, 0};
  double scale = 1;
  std::optional<vrml::GeoGround> ground;  // of a GeoViewpoint
  bool jump = true;  // binding moves the viewer to the Viewpoint
  // Fields of X3D (ISO/IEC 19775-1 clause 23).
  glm::dvec2 extent{0};  // OrthoViewpoint: size of the view rectangle in world units; 0 means a perspective view
  std::optional<glm::dvec3> center_of_rotation;  // world space; nullopt for Viewpoints of VRML97
  float near_distance = 0, far_distance = 0;     // world units; 0 means that the program chooses
  bool view_all = false;                         // the initial pose shows the whole world
  bool retains_offset = false;                   // binding keeps the movements that the user made at this Viewpoint
  bool listed = true;                            // false below a ViewpointGroup with displayed FALSE
  bool group_retains_offset = false;             // a ViewpointGroup above has retainUserOffsets TRUE
  std::string group;  // descriptions of the ViewpointGroups above, outermost first, each followed by ": "
  std::vector<ViewpointRegion> regions;  // of the ViewpointGroups above
};

/// Sound node (6.42), once for each path to it.
struct SoundPlace {
  const vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;        // id in `scene`
  std::uint32_t frame = 0;  // coordinate system of the Sound: index in RenderList::world_from_frame
};

/// Bound NavigationInfo (6.29).
struct NavigationState {
  std::vector<std::string> types{"WALK", "ANY"};
  std::array<float, 3> avatar_size{0.25f, 1.6f, 0.75f};
  float speed = 1, visibility_limit = 0;
  bool headlight = true;
  // Fields of X3D. Without them, the program chooses the transitions between Viewpoints.
  std::optional<float> transition_seconds;
  bool teleports = false;  // transitions take no time
  friend bool operator==(const NavigationState&, const NavigationState&) = default;
};

/// Layer that is drawn behind or in front of the active one (X3D 35.2.2), with its bound nodes.
struct BoundLayer {
  const vrml::Node *viewpoint = nullptr, *navigation_info = nullptr, *background = nullptr, *fog = nullptr;
  int layer = 0;                                // its number
  vrml::ClipBoundary boundary = kWholePicture;  // part of the picture that it fills
  bool in_front = false;                        // of the active layer
  bool pickable = true;                         // X3D 35.4.1
  bool parallel = false;                        // LayoutLayer: parallel projection without a Viewpoint (36.4.3)
  friend bool operator==(const BoundLayer&, const BoundLayer&) = default;
};

/// Bound nodes, of the world or of Inlines (4.6.10). Null if no node of the type is bound. In a world with a LayerSet,
/// these are the nodes of the layer to collect.
struct BoundNodes {
  const vrml::Node *viewpoint = nullptr, *navigation_info = nullptr, *background = nullptr, *fog = nullptr;
  vrml::NodeId layer_set{};                     // the null id for a world without a LayerSet
  int layer = 0;                                // number of the layer to collect
  vrml::ClipBoundary boundary = kWholePicture;  // part of the picture that it fills
  bool parallel = false;                        // LayoutLayer: parallel projection without a Viewpoint (36.4.3)
  bool pickable = true;                         // X3D 35.4.1: pointing devices act on it
  bool drawn = true;                            // false if LayerSet.order omits it, or it is not visible
  std::vector<BoundLayer> others{};             // the other drawn layers, from back to front
};

struct RenderList;

/// Layer of a world that is drawn behind or in front of the active layer, with the lens of its own Viewpoint.
struct RenderLayer {
  std::shared_ptr<const RenderList> list;
  bool in_front = false;
  Camera camera;         // its `height` is not set
  glm::dvec2 extent{0};  // OrthoViewpoint: size of the view rectangle in world units; 0 means a perspective view
};

/// Pixels per radian at the centre of a typical image: 768 rows for 45 degrees.
inline constexpr float kUsualPixelsPerRadian = 930;

/// Content that a limit has excluded from an image.
struct LimitReport {
  std::string why;    // text that names the limit
  std::size_t count;  // number of shapes, images or traversal steps
  std::string file;   // location of the first excluded node
  SourceLocation location;
};

/// Data of one frame in world space. Positions have double precision, so that objects are exact to centimetres ten
/// thousand kilometres from the origin. Boxes have single precision.
struct RenderList {
  // Defined in the .cpp file, because they are long.
  RenderList();
  RenderList(const RenderList& other);
  RenderList(RenderList&& other) noexcept;
  RenderList& operator=(const RenderList& other);
  RenderList& operator=(RenderList&& other) noexcept;
  ~RenderList();

  std::vector<DrawItem> items;
  /// `generation` identifies the collection that made the list; unique in the process. After it, `moved` lists items
  /// with changed positions or meshes, possibly repeatedly. `dressed` counts changes of materials. Generation 0 means
  /// that changes are not tracked.
  std::uint64_t generation = 0, dressed = 0;
  std::vector<std::uint32_t> moved;
  /// Number that changes with any content, unique in the process (next_change()). While it is equal, a drawn image is
  /// valid. 0 means that changes are not tracked. Does not cover the growth of geometries and images in the list.
  std::uint64_t changes = 0;
  std::vector<SplatItem> splats;
  std::shared_ptr<Budget> budget;  // of the world, for data that is derived while drawing; null means unlimited
  std::vector<Light> lights;  // directional lights have effect only through DrawItem::directional_lights
  /// ClipPlanes in world space: a point p is drawn if dot(plane, (p, 1)) is positive.
  std::vector<glm::dvec4> clip_planes;
  std::vector<Fog> local_fogs;
  float near_distance = 0, far_distance = 0;  // of the bound Viewpoint; 0 means that the program chooses
  std::vector<ViewpointState> viewpoints;     // in file order; the first is bound at the start
  std::vector<SoundPlace> sounds;
  Background background;
  bool has_background = false;  // true if a Background is bound
  NavigationState navigation;
  bool has_navigation = false;  // true if a NavigationInfo is bound; false for the defaults of the standard
  Fog fog;
  WideBox bounds;                                               // box of all items except overlays, in world space
  bool overlays = false;                                        // some items are overlays
  vrml::ClipBoundary boundary = kWholePicture;                  // part of the picture that the list fills
  bool pickable = true;                                         // pointing devices act on the list
  bool drawn = true;                                            // false if only `layers` are drawn
  glm::dvec2 default_extent{0};                                 // LayoutLayer without a Viewpoint: kLayoutExtent
  std::vector<RenderLayer> layers;                              // other layers of the world, from back to front
  std::vector<LimitReport> limit_reports;                       // at most one entry per reason
  std::vector<Place> places;                                    // paths of all content, parents before children
  std::vector<glm::dmat4> world_from_frame;                     // coordinate systems of `places`
  std::vector<std::shared_ptr<const vrml::SceneGraph>> scenes;  // scenes of Inlines in `places`
};

/// Returns a new value for RenderList::changes. Thread-safe.
[[nodiscard]] std::uint64_t next_change();

/// Traverses the scene, including PROTO instances and attached Inlines, and collects its visible content. Accepts any
/// graph that a file can describe: the traversal stops at cycles; the scene's budget bounds depth, items, triangles and
/// mesh memory, and `limit_reports` reports omissions. Many primitives get coarser meshes. Stops early if the budget is
/// cancelled. `viewer` is the camera position in world space, for LOD. Geometry nodes in `geometries` become splats or
/// surfaces. `bound` selects NavigationInfo, Background and Fog; null means the first ones outside Inlines.
/// `sight` determines the detail of Text and the place of content in
/// units of the picture.
[[nodiscard]] RenderList collect(const vrml::SceneGraph& scene, const Images& images, MeshCache& meshes,
                                 const glm::dvec3& viewer = glm::dvec3(0, 0, 10), const Geometries& geometries = {},
                                 const BoundNodes* bound = nullptr, const Sight& sight = {});

}  // namespace gs::render
