#pragma once

#include "render/gl/fog_uniforms.h"
#include "render/gl/gpu.h"
#include "render/gl/light_sets.h"
#include "render/gl/texture_store.h"
#include "render/mesh/draw_pacer.h"
#include "render/mesh/mesh_store.h"
#include "render/mesh/visible_items.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/fog.h"
#include "render/scene/render_list.h"
#include "render/surface/surface_pass.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>
#include <variant>
#include <vector>

namespace gs::render {

/// Draws the items of a RenderList: opaque ones grouped so that items of the same mesh, texture,
/// lights and shader are one instanced draw, and small texts of one colour one draw, then transparent ones from back to
/// front.
class MeshPass {
 public:
  static std::variant<std::unique_ptr<MeshPass>, ContextError> create(const Gl& gl);

  /// `camera` must have its near and far planes set. Leaves depth writes on, blending and culling off.
  /// `between` is called when the opaque items are drawn and the transparent ones are not; it may change any state.
  /// `surfaces`: has the cuts of the view; null: there are none.
  /// `overlays`: the items that are such, and no others.
  /// When `options.go_on` ends the frame before that, it is not called.
  void draw(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options,
            FrameStatistics& statistics, const std::function<void()>& between, const SurfacePass* surfaces,
            bool overlays = false);

 private:
  /// Bits that select a shader variant; each is one #define. What costs little where it is not needed is no variant:
  /// a software driver takes 0.1 to 0.3 s to compile each.
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
    kFirstLightBit = 1024,  // from here on: LightSets::variant
  };
  struct VariantProgram {
    Program program;
    bool drawn = false;       // so that the driver has compiled the rest of it
    std::uint64_t frame = 0;  // for which the projection was set last
    GLint clip_from_camera = -1, texture_transform = -1, replaces = -1, eye_back = -1;
    FogUniforms fog;
    LightUniforms lights;
  };
  /// A texture as some items of this frame use it. Number 0 stands for none.
  struct TextureBinding {
    const TextureStore::Entry* entry = nullptr;
    bool repeat_s = true, repeat_t = true;
    glm::mat3 transform{1.0f};
  };
  static constexpr std::size_t kUnsorted = SIZE_MAX;
  /// What all items of one draw have in common, besides the mesh.
  struct DrawState {
    unsigned variant = 0;
    bool mirrored = false, cull = false;
    std::uint32_t lights = 0, texture = 0;
    [[nodiscard]] std::uint64_t packed() const;
  };
  /// An item that will be drawn.
  struct Prepared {
    Instance instance;
    DrawState state;
    const MeshStore::Slice* slice;
    const vrml::Mesh* mesh;
    glm::vec3 origin{0};             // of a text that is merged: from which its positions count
    std::size_t sorted = kUnsorted;  // where its triangles begin in sorted_indices_, the farthest first
  };
  struct SortKey {
    std::uint32_t layer;  // so many opaque items before it fill the same place: they are drawn before
    std::uint64_t state;
    std::uint64_t mesh;
    float depth;  // metres in front of the camera, of the item's centre
    std::uint32_t prepared;
  };
  /// Items that are drawn by one call.
  struct Batch {
    std::uint32_t layer;
    std::uint64_t state;
    std::uint32_t page;
    float depth;               // of the nearest
    std::size_t first, count;  // instances
    std::uint32_t prepared;    // one of them
    std::size_t merged = 0;    // items whose triangles are one slice, drawn as one instance; 0: they are not
  };
  /// As SortKey::mesh: of items that are drawn together whatever their meshes are.
  static constexpr std::uint64_t kMergedMesh = UINT64_MAX;
  struct View {
    glm::dmat4 camera_from_world;  // of the viewer, who is `back` before the camera
    float back;
    bool open;                   // faces are not filled, and those of the far side are seen
    glm::vec2 tangents, center;  // of half the angles of view; of what is in the middle
    glm::vec2 low, high;         // 1 / lengths of the normals of the planes at the left and below, right and above
    float near_plane, far_plane;
    float pixels;  // of a metre at a distance of one
    const SurfacePass* surfaces;
  };

  explicit MeshPass(const Gl& gl);
  /// The program of a variant, built on first use; null when the driver refused it.
  VariantProgram* program(unsigned variant);
  /// False: `go_on` would not wait for all meshes to be uploaded; those that were stay.
  [[nodiscard]] bool prepare(const RenderList& list, const View& view, bool overlays,
                             const std::function<bool()>& go_on);
  [[nodiscard]] unsigned variant_of_all(const RenderList& list);
  [[nodiscard]] static bool in_view(const glm::vec3& center, float radius, const View& view);
  void prepare_item(const DrawItem& item, const View& view);
  [[nodiscard]] bool prepare_text(const DrawItem& item, const glm::vec3& center, float radius, const glm::vec3& origin,
                                  Prepared& prepared);
  [[nodiscard]] bool find_glyphs();
  void merge_texts();
  void add_text(const Prepared& prepared);
  [[nodiscard]] std::uint32_t layer_of(const glm::vec3& center, float radius, std::uint64_t state);
  [[nodiscard]] std::uint32_t texture_number(const TextureUse& use, const TextureStore::Entry& entry);
  void sort_triangles();
  void draw_edges(const Projection& projection, DrawPacer& pacer);
  void batch(const std::vector<SortKey>& order, std::size_t first_instance);
  void draw_batches(const Projection& projection, FrameStatistics& statistics, DrawPacer& pacer);
  void draw_first(const MeshStore::Slice& mesh, std::size_t& first, std::size_t& count, std::size_t primitives,
                  DrawPacer& pacer);
  void draw_slices(const MeshStore::Slice& mesh, std::size_t primitives, std::size_t first, std::size_t count,
                   DrawPacer& pacer);
  void apply(const DrawState& state, const Projection& projection);

  const Gl& gl_;
  MeshStore meshes_;
  TextureStore textures_;
  LightSets lights_;
  std::unordered_map<unsigned, VariantProgram> programs_;
  std::string last_error_;
  std::uint64_t frame_ = 0;

  // Of the frame being drawn; kept for their storage.
  std::vector<Prepared> prepared_;
  std::vector<SortKey> opaque_, transparent_;
  std::vector<Batch> batches_;
  std::vector<Instance> instances_;
  std::vector<std::uint32_t> sorted_indices_;
  // Of texts; so many of them are of this frame: they are not made empty, which would fill them with zeros again.
  std::vector<MeshStore::StreamedVertex> text_vertices_;
  std::vector<std::uint32_t> text_indices_;
  std::size_t text_vertex_count_ = 0, text_index_count_ = 0;
  std::vector<MeshStore::Slice> text_slices_;  // one for each run of texts in opaque_
  std::vector<std::pair<float, std::uint32_t>> triangle_depths_;
  std::vector<TextureBinding> texture_bindings_;
  std::unordered_multimap<std::uint32_t, std::uint32_t> binding_numbers_;  // by TextureStore::Entry::order
  struct Filled {                                                          // by an opaque item
    glm::vec3 center;
    float radius;
    std::uint64_t state;
    std::uint32_t layer;
  };
  std::unordered_multimap<std::uint64_t, Filled> filled_;  // by centre and radius
  std::shared_ptr<const Image> glyph_picture_;
  const TextureStore::Entry* glyphs_ = nullptr;  // its texture; null until it is first asked for
  bool several_samples_ = false;
  const vrml::Mesh* last_mesh_ = nullptr;
  const MeshStore::Slice* last_slice_ = nullptr;
  unsigned frame_variant_ = 0;  // bits of all lit items of the frame, so that they share few programs
  std::uint64_t variant_generation_ = 0, variant_dressed_ = 0;  // of the list that the bits of items are of
  unsigned items_variant_ = 0;
  VisibleItems visible_;
  CameraFog fog_;
  unsigned last_variant_ = 0;
  VariantProgram* last_program_ = nullptr;
  DrawState applied_;
  bool anything_applied_ = false;
  std::size_t primitives_ = 0;  // drawn in this frame
};

}  // namespace gs::render
