#pragma once

#include "render/gl/gpu.h"
#include "render/splat/splat_camera.h"
#include "render/splat/splat_raster.h"
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

/// Some discs of a cloud; as SplatPiece, with the cloud held.
struct SharedSplatPiece {
  std::shared_ptr<const qnv::Cloud> cloud;
  std::size_t first = 0, count = 0;
  float growth = 1;                              // by which their areas are multiplied
  std::optional<qnv::Rgb8> tint = std::nullopt;  // in place of all colours of the piece
};

/// What SplatGl leaves: the arrays of a SplatLayer as textures, valid until it draws again. Only the pixels of the
/// rectangle were written.
struct SplatTextures {
  GLuint normals = 0, depths = 0, colors = 0;  // colors 0: one colour
  int x = 0, y = 0, width = 0, height = 0;     // pixels of the viewport
  int left = 0, bottom = 0;                    // the pixel of the viewport that the first texel is
  std::size_t discs = 0;                       // in view, told from some of them when there are many
  std::size_t draw_calls = 0;
};

/// Surface splatting with OpenGL: the picture of rasterize_surface, up to rounding. Instanced rectangles leave the
/// nearest surface of every sample, then add up normals and colours around it; a last pass averages the samples of each
/// pixel. Belongs to the thread of its context.
///
/// Draws into framebuffers of its own and leaves those bound; changes the viewport, the scissor, the depth test and
/// function, blending and the vertex array, and has texture unit 0 active.
class SplatGl {
 public:
  explicit SplatGl(const Gl& gl);

  /// Draws pieces that make up one surface: all of them with cells or none, seen from both sides or none. Pictures too
  /// large for the memory are drawn without supersampling. Empty when this context cannot: no float targets, no
  /// memory, no program.
  std::optional<SplatTextures> draw(std::span<const SharedSplatPiece> pieces, const SplatView& view);
  /// Likewise records, which are unpacked in the vertex shader.
  std::optional<SplatTextures> draw(const SplatRecords& records, const SplatView& view);

  /// Reads back what was drawn, in a layer of the viewport's size.
  [[nodiscard]] SplatLayer read(const SplatTextures& textures, const SplatView& view);

  /// To be called once a frame. Frees the copies of clouds that nobody holds any more.
  void forget_unused() { store_.forget_unused(); }
  [[nodiscard]] const SplatStore& store() const { return store_; }

 private:
  /// Which variant of a program.
  struct Kind {
    bool records = false, cells = false, sides = false, colored = false, smooth = false;
  };
  enum class Stage : std::uint8_t { depth, blend, resolve };
  enum Uniform : std::size_t {
    vector_buffer,
    cell_buffer,
    piece_table,
    stride,
    by_normal,
    normal_table,
    palette,
    eye,
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
    uniform_count
  };
  struct Shader {
    Program program;
    std::array<GLint, uniform_count> at{};
  };
  /// As the vertex shader reads it (splat_shaders.h).
  struct Instance {
    std::uint32_t first = 0, piece_count = 0;
  };
  using PieceTexels = std::array<glm::vec4, 3>;
  // Vectors an instance: many, because a driver begins anew with each, and few, because those that a piece does not
  // fill are drawn for nothing.
  static constexpr std::size_t kAnInstance = 64;
  static_assert(kAnInstance <= 255);
  static constexpr std::size_t kPiecesARow = 256;  // of the table
  /// The instances of one draw call.
  struct Batch {
    GLuint vectors = 0, cells = 0;     // textures
    std::size_t first = 0, count = 0;  // of Surface::instances
  };
  struct Rectangle {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels, x1 and y1 exclusive
  };
  struct Surface {
    Kind kind;
    std::vector<PieceTexels> pieces;
    std::vector<Instance> instances;
    std::vector<Batch> batches;
    std::size_t step = 1;  // every so many discs are drawn
    GLuint palette = 0;
    Rectangle rectangle;
    bool color_by_normal = false;
  };
  struct Targets {
    int width = 0, height = 0, samples = 0;  // pixels; samples along the edge of one
    bool colored = false, smooth = false;
    Texture nearest, sums, color_sums, slopes, tilts;  // one a sample
    Texture normals, depths, colors;                   // one a pixel
    Renderbuffer depth;
    Framebuffer depth_pass, blend_pass, resolve_pass;
  };

  const Shader* shader(Stage stage, const Kind& kind);
  bool make_targets(const SplatView& view, const Kind& kind);
  bool fits(const SplatView& view, const Kind& kind) const;
  static void add_instances(std::vector<Instance>& to, std::size_t piece, std::size_t first, std::size_t count,
                            std::size_t step);
  std::optional<SplatTextures> draw(Surface& surface, const SplatSurvey& survey, SplatView view);
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
  Texture pieces_, normal_table_;
  std::unordered_map<unsigned, Shader> shaders_;
};

}  // namespace gs::render
