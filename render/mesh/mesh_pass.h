#pragma once

#include "render/gl/fog_uniforms.h"
#include "render/gl/gpu.h"
#include "render/gl/layer_textures.h"
#include "render/gl/light_sets.h"
#include "render/gl/texture_store.h"
#include "render/mesh/draw_pacer.h"
#include "render/mesh/filled_spheres.h"
#include "render/mesh/item_styles.h"
#include "render/mesh/mesh_store.h"
#include "render/mesh/visible_items.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/fog.h"
#include "render/scene/render_list.h"
#include "render/surface/surface_pass.h"
#include "render/volume_rendering/volume_caster.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

namespace gs::render {

/// Draws the items of a RenderList. Opaque items are grouped: items with equal mesh, texture, lights and shader are one
/// instanced draw, and small texts of one colour are one draw. Transparent items follow, from back to front.
class MeshPass {
 public:
  static std::variant<std::unique_ptr<MeshPass>, ContextError> create(const Gl& gl);

  /// Draws the items. `camera` must have near and far planes. Calls `between` after opaque and before transparent
  /// items; it may change any state. `surfaces` has the cuts of the view, or is null. `overlays` draws only overlay
  /// items, otherwise only the others.
  ///
  /// If `options.go_on` cancels the frame earlier, `between` is not called. Leaves depth writes on, blending and
  /// culling off.
  void draw(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options,
            FrameStatistics& statistics, const std::function<void()>& between, const SurfacePass* surfaces,
            bool overlays = false);

  /// Pictures of the scene that items of the list need, with their positions in world space. At most kMaxCubes.
  struct CubeRequest {
    std::shared_ptr<const SceneCube> cube;
    glm::dvec3 center;
  };
  static constexpr std::size_t kMaxCubes = 4;
  [[nodiscard]] std::vector<CubeRequest> cubes_to_draw(const RenderList& list);
  /// Returns the texture for a request of cubes_to_draw(); the caller draws its faces. Items with this cube are not
  /// drawn until end_cube().
  LayerTextures::SceneTexture& begin_cube(const CubeRequest& request, const RenderList& list);
  void end_cube() { hidden_cube_ = nullptr; }

 private:
  /// Bits that select a shader variant; each bit is one #define. A feature that costs little when unused is no variant,
  /// because a software driver compiles each variant in 0.1 to 0.3 s.
  enum Variant : unsigned {
    kLit = 1,
    kNormals = 2,
    kTexture = 4,
    kCutOut = 8,
    kLocalLights = 16,
    kSpecular = 32,
    kEmissive = 64,
    kFog = 128,
    kSmoothEdges = 256,
    kMask = 512,
    kStyle = 1024,
    kFirstLightBit = 2048,  // from this bit on: LightSets::variant, 3 bits
    kLayered = 16384,       // program of a LayeredMaterial
  };
  /// Uniforms of the program of a LayeredMaterial.
  struct LayeredUniforms {
    struct OfLayer {
      GLint transform = -1, generator = -1;
    };
    std::vector<OfLayer> layers;
    GLint world_from_camera = -1, factor = -1, amounts = -1, metal_roughness = -1, mesh_origin = -1;
    GLint back_main = -1, back_emissive = -1, back_specular = -1, back_metal_roughness = -1;
    /// Finds the uniforms of a program with this number of layers. Makes it the current program.
    void find(const Gl& gl, GLuint program, std::size_t layer_count);
  };
  struct VariantProgram {
    Program program;
    bool drawn = false;       // was used for a draw, so drivers have compiled it
    std::uint64_t frame = 0;  // frame in which the projection was last set
    GLint clip_from_camera = -1, texture_transform = -1, replaces = -1, eye_back = -1;
    FogUniforms fog;
    LightUniforms lights;
    LayeredUniforms layered;
    StyleUniforms style;
    /// Finds the uniforms that all programs have, and those of the style shaders if `styled`.
    void find_uniforms(const Gl& gl, bool styled);
  };
  /// Variant bits that the lit items of a list need. Computed again only after changes of the items.
  class ItemsVariant {
   public:
    /// Returns the bits of all lit items, including invisible items, so that no program must be built when the viewer
    /// turns.
    [[nodiscard]] unsigned of(const RenderList& list);

   private:
    std::uint64_t generation_ = 0, dressed_ = 0;  // state of the list when bits_ was computed
    unsigned bits_ = 0;
  };
  using PackedState = FilledSpheres::State;
  /// Texture with its parameters in this frame. Index 0 means no texture.
  struct TextureBinding {
    const TextureStore::Entry* entry = nullptr;
    bool repeat_s = true, repeat_t = true;
    glm::mat3 transform{1.0f};
    bool modulates = false;
    std::optional<Sampling> sampling;
    const LayeredMaterial* layered = nullptr;  // null for a plain texture
    std::string program;                       // key of the programs of `layered`
    std::size_t sets = 0;                      // coordinate sets of the meshes with this binding
    unsigned known_variant = 0;                // variant of known_program, the last one of this binding
    VariantProgram* known_program = nullptr;
    TextureStore::Alpha alpha = TextureStore::Alpha::none;  // of the layers that change alpha
  };
  static constexpr std::size_t kUnsorted = SIZE_MAX;
  /// State of a draw, except its mesh. All items of the draw share it.
  struct DrawState {
    unsigned variant = 0;
    bool mirrored = false, cull = false;
    std::uint32_t lights = 0, texture = 0, style = 0;
    [[nodiscard]] PackedState packed() const;
  };
  /// Item with the data that its draw needs.
  struct Prepared {
    Instance instance;
    DrawState state;
    const MeshStore::Slice* slice;
    const vrml::Mesh* mesh;
    glm::vec3 origin{0};             // for merged text: origin of its positions
    std::size_t sorted = kUnsorted;  // start of the item's triangles in sorted_indices_, where they are sorted
  };
  struct SortKey {
    std::uint32_t layer;  // items with a lower layer are drawn first
    PackedState state;
    std::uint64_t mesh;
    float depth;  // depth of the item's centre: metres in front of the camera
    std::uint32_t prepared;
  };
  /// Items that one call draws.
  struct Batch {
    std::uint32_t layer;
    PackedState state;
    std::uint32_t page;
    float depth;               // depth of the nearest item
    std::size_t first, count;  // index of the first instance, and number of instances
    std::uint32_t prepared;    // index of one of its items in prepared_
    std::size_t merged = 0;    // items merged into one slice and one instance; 0 means not merged
  };
  /// Value of SortKey::mesh for items that are merged, although their meshes differ.
  static constexpr std::uint64_t kMergedMesh = UINT64_MAX;
  struct View {
    glm::dmat4 camera_from_world;  // from world space to the viewer, `back` metres in front of the camera
    float back;
    bool open;                   // faces are drawn as lines or points, so back faces are visible
    glm::vec2 tangents, center;  // tangents of half the angles of view, and of the image centre
    glm::vec2 low, high;         // 1 / lengths of the normals of the side planes: left and bottom; right and top
    float near_plane, far_plane;
    float pixels;  // pixels per metre at distance 1
    const SurfacePass* surfaces;
    bool cancellable;  // the picture belongs to a window, which can cancel it
    /// Returns false if a sphere in camera space is outside of the view. A sphere with negative radius always counts as
    /// inside.
    [[nodiscard]] bool contains(const glm::vec3& sphere, float radius) const;
    /// Returns the line widths per unit of node space at a depth, for patterns of lines.
    [[nodiscard]] float pattern_scale(const DrawItem& item, const Instance& instance, float depth) const;
  };

  explicit MeshPass(const Gl& gl);
  /// Returns the program of a variant and builds it at first use. Returns null if the driver rejected it.
  VariantProgram* program(unsigned variant);
  /// Returns the program of a state, as program(); that of a LayeredMaterial also depends on the texture binding.
  VariantProgram* program_of(const DrawState& state);
  VariantProgram* layered_program(unsigned variant, TextureBinding& binding);
  [[nodiscard]] std::uint32_t layered_number(const DrawItem& item, std::size_t sets);
  void prepare_layers(const DrawItem& item, Prepared& prepared, bool& transparent);
  void apply_layers(const TextureBinding& binding, const VariantProgram& program);
  void unbind_layers();
  [[nodiscard]] bool is_hidden(const DrawItem& item) const;
  /// Prepares the items and uploads their meshes. Returns false if `go_on` cancelled this. Uploaded meshes remain.
  [[nodiscard]] bool prepare(const RenderList& list, const View& view, bool overlays,
                             const std::function<bool()>& go_on);
  void prepare_item(const DrawItem& item, const View& view);
  [[nodiscard]] bool prepare_text(const DrawItem& item, const glm::vec3& center, float radius, const glm::vec3& origin,
                                  Prepared& prepared);
  [[nodiscard]] bool find_glyphs();
  void merge_texts();
  /// Merged text, and where its vertices and indices begin.
  struct TextPlace {
    std::uint32_t prepared;
    std::size_t vertex, index;
  };
  void add_text(const TextPlace& place);
  [[nodiscard]] bool worth_own_program(unsigned variant, float radius, float depth, const View& view) const;
  [[nodiscard]] std::uint32_t texture_number(const TextureUse& use, const TextureStore::Entry& entry);
  void sort_triangles();
  void draw_edges(const Projection& projection, DrawPacer& pacer);
  void batch(std::span<const SortKey> order, std::size_t first_instance);
  void draw_batches(const Projection& projection, FrameStatistics& statistics, DrawPacer& pacer);
  [[nodiscard]] std::size_t run_end(std::size_t first) const;
  void draw_run(std::span<const Batch> run, FrameStatistics& statistics, DrawPacer& pacer);
  void draw_transparent(const Projection& projection, GLenum polygon_mode, FrameStatistics& statistics,
                        DrawPacer& pacer, bool marked);
  void draw_first(const MeshStore::Slice& mesh, std::size_t& first, std::size_t& count, std::size_t primitives,
                  DrawPacer& pacer);
  void draw_slices(const MeshStore::Slice& mesh, std::size_t primitives, std::size_t first, std::size_t count,
                   DrawPacer& pacer);
  void apply(const DrawState& state, const Projection& projection);

  const Gl& gl_;
  MeshStore meshes_;
  TextureStore textures_;
  LightSets lights_;
  LayerTextures layer_textures_{gl_, textures_};
  ItemStyles styles_{gl_};
  std::optional<VolumeCaster> volumes_;  // made at first use
  std::unordered_map<unsigned, VariantProgram> programs_;
  std::unordered_map<std::string, VariantProgram> layered_programs_;
  std::string last_error_;
  std::uint64_t frame_ = 0;

  // State of the current frame. The members keep their memory for the next frame.
  std::vector<Prepared> prepared_;
  std::vector<SortKey> opaque_, transparent_;
  std::vector<Batch> batches_;
  std::vector<MeshStore::Command> commands_;
  std::vector<Instance> instances_;
  std::vector<std::uint32_t> sorted_indices_;
  // Vertices and indices of merged texts. Only the counted elements belong to this frame. The vectors are never
  // cleared, because resizing them would fill them with zeros.
  std::vector<MeshStore::StreamedVertex> text_vertices_;
  std::vector<std::uint32_t> text_indices_;
  std::vector<TextPlace> text_places_;
  std::size_t text_vertex_count_ = 0, text_index_count_ = 0;
  std::vector<MeshStore::Slice> text_slices_;  // one slice per run of merged texts in opaque_
  std::vector<std::pair<float, std::uint32_t>> triangle_depths_;
  std::vector<TextureBinding> texture_bindings_;
  std::map<std::pair<const LayeredMaterial*, std::size_t>, std::uint32_t> layered_numbers_;  // in texture_bindings_
  std::vector<VolumeCaster::Cast> casts_;                                                    // volumes of the frame
  std::unordered_multimap<std::uint32_t, std::uint32_t> binding_numbers_;  // by TextureStore::Entry::order
  FilledSpheres filled_;                                                   // of the opaque items
  std::shared_ptr<const Image> glyph_picture_;
  const TextureStore::Entry* glyphs_ = nullptr;  // texture of the glyphs; null before its first use
  bool several_samples_ = false;
  const vrml::Mesh* last_mesh_ = nullptr;
  const MeshStore::Slice* last_slice_ = nullptr;
  unsigned frame_variant_ = 0;  // bits of all lit items of the frame; makes items share programs
  ItemsVariant items_variant_;
  VisibleItems visible_;
  CameraFog fog_;
  glm::mat3 world_from_camera_{1.0f};
  std::size_t bound_layers_ = 0;  // number of texture units that layers of this frame have used
  const SceneCube* hidden_cube_ = nullptr;
  unsigned last_variant_ = 0;
  VariantProgram* last_program_ = nullptr;
  DrawState applied_;
  bool anything_applied_ = false;
  std::size_t primitives_ = 0;  // primitives drawn in this frame
};

}  // namespace gs::render
