#pragma once

#include "render/gl/gpu.h"
#include "render/splat/software/splat_camera.h"
#include "render/splat/software/splat_raster.h"
#include "render/splat/splat_store.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// Range of splats. Like SplatPiece, but owns the splats.
struct SharedSplatPiece {
  std::shared_ptr<const qnv::Splats> splats;
  std::size_t first = 0, count = 0;
  float growth = 1;                              // factor of the splats' areas
  std::optional<qnv::Rgb8> tint = std::nullopt;  // replaces the colours of the splats
};

/// Result of SplatGl: the arrays of a SplatLayer as textures. Valid until the next draw. Only the pixels of the
/// rectangle are defined.
struct SplatTextures {
  GLuint normals = 0, depths = 0, colors = 0;  // names of textures; `colors` is 0 if there is a single colour
  int x = 0, y = 0, width = 0, height = 0;     // rectangle in pixels of the viewport
  int left = 0, bottom = 0;                    // pixel of the viewport at the first texel
  std::size_t discs = 0;                       // splats in view; estimated if there are many
  std::size_t draw_calls = 0;
};

/// Draws the splats of surfaces with OpenGL. The image equals that of rasterize_surface(), except for rounding.
/// Instanced rectangles find the nearest surface at each sample, then sum normals and colours around it. A last pass
/// averages the samples of each pixel. Runs on the thread of the context.
///
/// Draws into its own framebuffers and leaves them bound. Changes viewport, scissor, depth test and function, blending,
/// vertex array and active texture unit (0).
class SplatGl {
 public:
  explicit SplatGl(const Gl& gl);

  /// Draws pieces of one surface. Either all or none may have cells; either all or none may be two-sided. If an image
  /// is too large for the memory, draws it without supersampling. Returns nullopt if the context has no float targets,
  /// too little memory or no program.
  std::optional<SplatTextures> draw(std::span<const SharedSplatPiece> pieces, const SplatView& view);

  /// Reads the result into a layer of the viewport's size.
  [[nodiscard]] SplatLayer read(const SplatTextures& textures, const SplatView& view);

  /// Frees splats that have no other owners. Call it once per frame.
  void forget_unused() { store_.forget_unused(); }
  [[nodiscard]] const SplatStore& store() const { return store_; }

 private:
  /// Properties that select a variant of a program.
  struct Kind {
    bool cells = false, sides = false, colored = false, smooth = false;
  };
  enum class Stage : std::uint8_t { depth, blend, resolve };
  enum Uniform : std::size_t {
    vector_buffer,
    cell_buffer,
    piece_table,
    stride,
    by_normal,
    row_x,
    row_y,
    row_z,
    tangents,
    middle,
    margin,
    near_plane,
    sample_size,
    ray_origin,
    ray_right,
    ray_up,
    nearest,
    sums,
    color_sums,
    slopes,
    tilts,
    normal_matrix,
    supersample,
    clip_planes,
    clip_count,
    uniform_count
  };
  struct Shader {
    Program program;
    std::array<GLint, uniform_count> at{};
  };
  /// Instance of up to kAnInstance vectors, in the layout of the vertex shader (splat_shaders.h).
  struct Instance {
    std::uint32_t first = 0, piece_count = 0;
  };
  using PieceTexels = std::array<glm::vec4, 3>;
  // Vectors per instance. More reduce the driver's work per instance; fewer waste less on incomplete instances.
  static constexpr std::size_t kAnInstance = 64;
  static_assert(kAnInstance <= 255);
  static constexpr std::size_t kPiecesARow = 256;  // pieces per row of the texture `pieces`
  /// Instances of one draw call.
  struct Batch {
    GLuint vectors = 0, cells = 0;     // buffer textures
    std::size_t first = 0, count = 0;  // range of Surface::instances
  };
  struct Rectangle {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // rectangle in pixels; x1 and y1 are exclusive
  };
  struct Surface {
    Kind kind;
    std::vector<PieceTexels> pieces;
    std::vector<Instance> instances;
    std::vector<Batch> batches;
    std::size_t step = 1;  // draws one of `step` splats
    Rectangle rectangle;
    bool color_by_normal = false;
  };
  struct Targets {
    int width = 0, height = 0, samples = 0;  // size in pixels, and samples along the side of a pixel
    bool colored = false, smooth = false;
    Texture nearest, sums, color_sums, slopes, tilts;  // one texel per sample
    Texture normals, depths, colors;                   // one texel per pixel
    Renderbuffer depth;
    Framebuffer depth_pass, blend_pass, resolve_pass;
  };

  const Shader* shader(Stage stage, const Kind& kind);
  bool make_targets(const SplatView& view, const Kind& kind);
  bool fits(const SplatView& view, const Kind& kind) const;
  static void add_instances(std::vector<Instance>& to, std::size_t piece, std::size_t first, std::size_t count,
                            std::size_t step);
  std::optional<SplatTextures> draw(Surface& surface, const SurfaceMeasure& survey, SplatView view);
  bool upload(const Surface& surface);
  void depth_pass(const Shader& shader, const Surface& surface, const SplatCamera& camera);
  void blend_pass(const Shader& shader, const Surface& surface, const SplatCamera& camera);
  void resolve_pass(const Shader& shader, const Surface& surface, const SplatCamera& camera);
  void draw_batches(const Shader& shader, const Surface& surface, const SplatCamera& camera);
  void texture(const Shader& shader, Uniform uniform, int unit, GLuint name, GLenum target = GL_TEXTURE_2D);

  const Gl& gl_;
  SplatStore store_;
  Targets targets_;
  VertexArray no_attributes_, attributes_;
  Buffer corners_, instances_;
  Texture pieces_;
  std::unordered_map<unsigned, Shader> shaders_;
};

}  // namespace gs::render
