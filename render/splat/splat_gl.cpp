#include "render/splat/splat_gl.h"

#include "render/splat/software/splat_constants.h"

#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kSurveyedDiscs = 8192;  // splats that are sampled
// Maximum covered samples, summed over the splats. Larger geometries are thinned, because the system resets a driver
// that is busy for seconds. Typical geometries cover a thousandth.
constexpr double kMaxCoveredSamples = 2e10;
constexpr float kMargin = 0.05f;  // margin of the rectangles in samples, for the rounding of their corners

/// Returns the rectangle of pixels that a box, enlarged by `around`, can cover. Returns nullopt if the box is out of
/// view.
template <class Rectangle>
std::optional<Rectangle> covered(const Box& box, double around, const SplatView& view, const SplatCamera& camera) {
  const glm::dmat4 matrix(camera.camera_from_node);
  const glm::dvec3 half = (glm::dvec3(box.upper) - glm::dvec3(box.lower)) * 0.5;
  const glm::dvec3 center(matrix * glm::dvec4(glm::dvec3(box.lower) + half, 1.0));
  glm::dvec3 extent(0);
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 row(matrix[0][axis], matrix[1][axis], matrix[2][axis]);
    extent[axis] = glm::dot(glm::abs(row), half) + glm::length(row) * around;
  }
  const double nearest = std::max(-center.z - extent.z, double{camera.rays.near_plane}),
               farthest = -center.z + extent.z;
  if (!(farthest > nearest)) return std::nullopt;
  // Add two pixels, because splats smaller than a sample are enlarged.
  const auto range = [&](int axis, double tangent, double middle, int pixels) {
    const double low = center[axis] - extent[axis], high = center[axis] + extent[axis];
    const auto pixel = [&](double slope) {
      const double at = ((slope - middle) / tangent + 1) * 0.5 * pixels;
      return at > 0 ? std::min(at, double{static_cast<double>(pixels)}) : 0.0;
    };
    return std::pair{static_cast<int>(std::max(pixel(std::min(low / nearest, low / farthest)) - 2, 0.0)),
                     std::min(static_cast<int>(pixel(std::max(high / nearest, high / farthest))) + 3, pixels)};
  };
  const auto [x0, x1] = range(0, double{camera.tangents.x}, double{camera.center.x}, view.width);
  const auto [y0, y1] = range(1, double{camera.tangents.y}, double{camera.center.y}, view.height);
  return Rectangle{x0, y0, x1, y1};
}

template <class Rectangle>
void unite(Rectangle& all, const Rectangle& other) {
  if (all.x1 <= all.x0) {
    all = other;
    return;
  }
  all = {std::min(all.x0, other.x0), std::min(all.y0, other.y0), std::max(all.x1, other.x1),
         std::max(all.y1, other.y1)};
}

std::size_t step_for(const SurfaceMeasure& survey) {
  return static_cast<std::size_t>(std::clamp(survey.samples / kMaxCoveredSamples, 0.0, 1e6)) + 1;
}

glm::vec3 linear_row_of(const glm::mat4& matrix, int row) { return {matrix[0][row], matrix[1][row], matrix[2][row]}; }

}  // namespace

SplatGl::SplatGl(const Gl& gl)
    : gl_(gl),
      store_(gl),
      no_attributes_(make_vertex_array(gl)),
      attributes_(make_vertex_array(gl)),
      corners_(make_buffer(gl)),
      instances_(make_buffer(gl)),
      pieces_(make_texture(gl)) {
  gl.BindVertexArray(attributes_.name());
  set_quad_elements(gl, corners_, kAnInstance);
  gl.EnableVertexAttribArray(0);
  gl.VertexAttribDivisor(0, 1);
  gl.BindVertexArray(0);
  gl.BindTexture(GL_TEXTURE_2D, pieces_.name());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
}

void SplatGl::add_instances(std::vector<Instance>& to, std::size_t piece, std::size_t first, std::size_t count,
                            std::size_t step) {
  for (std::size_t i = 0; i < count; i += kAnInstance * step) {
    const std::size_t here = std::min((count - i + step - 1) / step, kAnInstance);
    to.push_back({static_cast<std::uint32_t>(first + i), static_cast<std::uint32_t>(piece << 8 | here)});
  }
}

std::optional<SplatTextures> SplatGl::draw(std::span<const SharedSplatPiece> pieces, const SplatView& view) {
  const auto camera = splat_camera(view);
  if (!camera || pieces.empty() || view.width < 1 || view.height < 1) return SplatTextures{};
  std::vector<std::shared_ptr<const qnv::Splats>> sets;
  for (const SharedSplatPiece& piece : pieces)
    if (sets.empty() || sets.back() != piece.splats) sets.push_back(piece.splats);
  if (!store_.add(sets)) return std::nullopt;
  Surface surface;
  surface.color_by_normal = view.color_by_normal;
  surface.kind.colored = view.color_by_normal;
  std::vector<SplatPiece> in_view;
  std::vector<const SplatStore::Entry*> entries;
  for (const SharedSplatPiece& piece : pieces) {
    const SplatStore::Entry& entry = *store_.find(piece.splats.get());
    if (!entry.coding || piece.first > entry.discs || piece.count > entry.discs - piece.first) continue;
    const SplatCoding& coding = *entry.coding;
    const float growth = std::max(piece.growth, 1.0f);
    const double radius = double{coding.largest_radius} * std::sqrt(double{growth});
    const Box box{coding.lower, coding.lower + coding.step * 1048575.0f};
    const auto rectangle = covered<Rectangle>(box, 3 * radius + double{coding.reach}, view, *camera);
    if (!rectangle || piece.count == 0) continue;
    if (entries.empty()) surface.kind.cells = entry.cells;
    if (surface.kind.cells != entry.cells) continue;
    unite(surface.rectangle, *rectangle);
    entries.push_back(&entry);
    in_view.push_back({piece.splats.get(), piece.first, piece.count, growth, piece.tint});
    const float tint =
        piece.tint ? static_cast<float>(piece.tint->r | piece.tint->g << 8 | piece.tint->b << 16) : -1.0f;
    surface.pieces.push_back({glm::vec4(coding.lower - camera->eye, coding.radius.x),
                              glm::vec4(coding.step, coding.radius.y),
                              glm::vec4(coding.edge, std::sqrt(growth), tint)});
    surface.kind.colored = surface.kind.colored || piece.tint || !piece.splats->colors.empty();
    surface.kind.sides = surface.kind.sides || piece.splats->description.two_sided;
  }
  const SurfaceMeasure survey = measure_surface(in_view, view, kSurveyedDiscs);
  surface.step = step_for(survey);
  std::vector<std::vector<Instance>> by_slab(store_.slabs());
  for (std::size_t i = 0; i < in_view.size(); ++i) {
    std::size_t skip = in_view[i].first, left = in_view[i].count;
    for (const SplatStore::Range& range : entries[i]->ranges) {
      const std::size_t from = std::min<std::size_t>(skip, range.count), count = std::min(left, range.count - from);
      add_instances(by_slab[range.slab], i, range.first + from, count, surface.step);
      skip -= from;
      left -= count;
    }
  }
  for (std::uint32_t i = 0; i < by_slab.size(); ++i) {
    if (by_slab[i].empty()) continue;
    const SplatStore::Slab& slab = store_.slab(i);
    surface.batches.push_back(
        {slab.codes_texture.name(), slab.cells_texture.name(), surface.instances.size(), by_slab[i].size()});
    surface.instances.insert(surface.instances.end(), by_slab[i].begin(), by_slab[i].end());
  }
  return draw(surface, survey, view);
}

// Uploads the splats of a surface. Returns false if the GPU has too little memory.
bool SplatGl::upload(const Surface& surface) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  const std::size_t rows = (surface.pieces.size() + kPiecesARow - 1) / kPiecesARow;
  if (rows > static_cast<std::size_t>(gl_.max_texture_size)) return false;
  take_errors(gl_);
  std::vector<PieceTexels> table(surface.pieces);
  table.resize(rows * kPiecesARow);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, pieces_.name());
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, static_cast<GLsizei>(kPiecesARow * 3), static_cast<GLsizei>(rows), 0,
                 GL_RGBA, GL_FLOAT, table.data());
  gl_.BindBuffer(GL_ARRAY_BUFFER, instances_.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(surface.instances.size() * sizeof(Instance)),
                 surface.instances.data(), GL_STREAM_DRAW);
  return !take_errors(gl_);
}

std::optional<SplatTextures> SplatGl::draw(Surface& surface, const SurfaceMeasure& survey, SplatView view) {
  SplatTextures result;
  if (surface.batches.empty() || surface.rectangle.x1 <= surface.rectangle.x0 ||
      surface.rectangle.y1 <= surface.rectangle.y0)
    return result;
  surface.kind.smooth = survey.smooth;
  if (view.supersample > 1 && !fits(view, surface.kind)) view.supersample = 1;
  if (!fits(view, surface.kind)) return std::nullopt;
  if (!(view.near_plane > 0)) view.near_plane = 1e-20f;  // the near plane is a divisor of depth
  const Shader* depth = shader(Stage::depth, surface.kind);
  const Shader* blend = shader(Stage::blend, surface.kind);
  const Shader* resolve = shader(Stage::resolve, surface.kind);
  if (!depth || !blend || !resolve || !make_targets(view, surface.kind)) return std::nullopt;
  if (!upload(surface)) return std::nullopt;
  const auto camera = splat_camera(view);
  if (!camera) return result;

  gl_.Enable(GL_SCISSOR_TEST);
  gl_.Disable(GL_CULL_FACE);
  depth_pass(*depth, surface, *camera);
  blend_pass(*blend, surface, *camera);
  resolve_pass(*resolve, surface, *camera);
  gl_.BindVertexArray(0);
  gl_.ActiveTexture(GL_TEXTURE0);
  const Rectangle& r = surface.rectangle;
  result.normals = targets_.normals.name();
  result.depths = targets_.depths.name();
  result.colors = surface.kind.colored ? targets_.colors.name() : 0;
  result.x = r.x0;
  result.y = r.y0;
  result.width = r.x1 - r.x0;
  result.height = r.y1 - r.y0;
  result.discs = survey.discs;
  result.draw_calls = 2 * surface.batches.size() + 1;
  return result;
}

void SplatGl::texture(const Shader& shader, Uniform uniform, int unit, GLuint name, GLenum target) {
  gl_.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  gl_.BindSampler(static_cast<GLuint>(unit), 0);
  gl_.BindTexture(target, name);
  gl_.Uniform1i(shader.at[uniform], unit);
}

void SplatGl::depth_pass(const Shader& shader, const Surface& surface, const SplatCamera& camera) {
  const int s = targets_.samples;
  const Rectangle& r = surface.rectangle;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, targets_.depth_pass.name());
  gl_.Viewport(0, 0, camera.width, camera.height);
  gl_.Scissor(r.x0 * s, r.y0 * s, (r.x1 - r.x0) * s, (r.y1 - r.y0) * s);
  gl_.Disable(GL_BLEND);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthMask(GL_TRUE);
  // The nearest depth has the largest value, so that far depths have the precision of float32.
  gl_.DepthFunc(GL_GREATER);
  constexpr std::array<GLfloat, 4> kZeros{};
  gl_.ClearBufferfv(GL_COLOR, 0, kZeros.data());
  gl_.ClearBufferfv(GL_DEPTH, 0, kZeros.data());
  gl_.UseProgram(shader.program.name());
  draw_batches(shader, surface, camera);
  gl_.Disable(GL_DEPTH_TEST);
}

void SplatGl::blend_pass(const Shader& shader, const Surface& surface, const SplatCamera& camera) {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, targets_.blend_pass.name());
  const std::array<GLenum, 4> buffers{GL_COLOR_ATTACHMENT0,
                                      static_cast<GLenum>(surface.kind.colored ? GL_COLOR_ATTACHMENT1 : GL_NONE),
                                      static_cast<GLenum>(surface.kind.smooth ? GL_COLOR_ATTACHMENT2 : GL_NONE),
                                      static_cast<GLenum>(surface.kind.smooth ? GL_COLOR_ATTACHMENT3 : GL_NONE)};
  gl_.DrawBuffers(4, buffers.data());
  constexpr std::array<GLfloat, 4> kZeros{};
  for (int i = 0; i < 4; ++i)
    if (buffers[static_cast<std::size_t>(i)] != GL_NONE) gl_.ClearBufferfv(GL_COLOR, i, kZeros.data());
  gl_.Enable(GL_BLEND);
  gl_.BlendFuncSeparate(GL_ONE, GL_ONE, GL_ONE, GL_ONE);
  gl_.UseProgram(shader.program.name());
  texture(shader, nearest, 0, targets_.nearest.name());
  draw_batches(shader, surface, camera);
  gl_.Disable(GL_BLEND);
}

void SplatGl::resolve_pass(const Shader& shader, const Surface& surface, const SplatCamera& camera) {
  const Rectangle& r = surface.rectangle;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, targets_.resolve_pass.name());
  const std::array<GLenum, 3> buffers{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
                                      static_cast<GLenum>(surface.kind.colored ? GL_COLOR_ATTACHMENT2 : GL_NONE)};
  gl_.DrawBuffers(3, buffers.data());
  gl_.Viewport(0, 0, targets_.width, targets_.height);
  gl_.Scissor(r.x0, r.y0, r.x1 - r.x0, r.y1 - r.y0);
  gl_.UseProgram(shader.program.name());
  texture(shader, nearest, 0, targets_.nearest.name());
  texture(shader, sums, 1, targets_.sums.name());
  if (surface.kind.colored) texture(shader, color_sums, 2, targets_.color_sums.name());
  if (surface.kind.smooth) {
    texture(shader, slopes, 3, targets_.slopes.name());
    texture(shader, tilts, 4, targets_.tilts.name());
  }
  gl_.UniformMatrix3fv(shader.at[normal_matrix], 1, GL_FALSE, glm::value_ptr(camera.normal_matrix));
  gl_.Uniform1i(shader.at[supersample], targets_.samples);
  gl_.BindVertexArray(no_attributes_.name());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void SplatGl::draw_batches(const Shader& shader, const Surface& surface, const SplatCamera& camera) {
  const auto& at = shader.at;
  const auto vector = [&](Uniform uniform, const glm::vec3& v) { gl_.Uniform3fv(at[uniform], 1, glm::value_ptr(v)); };
  const Kind& kind = surface.kind;
  vector(row_x, linear_row_of(camera.camera_from_node, 0));
  vector(row_y, linear_row_of(camera.camera_from_node, 1));
  vector(row_z, linear_row_of(camera.camera_from_node, 2));
  gl_.Uniform4fv(at[clip_planes], static_cast<GLsizei>(kMaxClipPlanes), glm::value_ptr(camera.clip.planes[0]));
  gl_.Uniform1i(at[clip_count], static_cast<GLint>(camera.clip.count));
  vector(ray_origin, camera.rays.origin);
  vector(ray_right, camera.rays.right);
  vector(ray_up, camera.rays.up);
  gl_.Uniform1f(at[near_plane], camera.rays.near_plane);
  gl_.Uniform1f(at[sample_size], 1 / (camera.pixels * camera.scale));
  gl_.Uniform2f(at[tangents], camera.tangents.x, camera.tangents.y);
  gl_.Uniform2f(at[middle], camera.center.x, camera.center.y);
  gl_.Uniform2f(at[margin], 2 * kMargin / static_cast<float>(camera.width),
                2 * kMargin / static_cast<float>(camera.height));
  gl_.Uniform1i(at[stride], static_cast<GLint>(surface.step));
  gl_.Uniform1i(at[by_normal], surface.color_by_normal ? 1 : 0);
  texture(shader, piece_table, 3, pieces_.name());
  gl_.BindVertexArray(attributes_.name());
  gl_.BindBuffer(GL_ARRAY_BUFFER, instances_.name());
  for (const Batch& batch : surface.batches) {
    texture(shader, vector_buffer, 4, batch.vectors, GL_TEXTURE_BUFFER);
    if (kind.cells) texture(shader, cell_buffer, 5, batch.cells, GL_TEXTURE_BUFFER);
    gl_.VertexAttribIPointer(0, 2, GL_UNSIGNED_INT, sizeof(Instance), offset_pointer(batch.first * sizeof(Instance)));
    gl_.DrawElementsInstancedBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(6 * kAnInstance), GL_UNSIGNED_SHORT, nullptr,
                                        static_cast<GLsizei>(batch.count), 0);
  }
}

SplatLayer SplatGl::read(const SplatTextures& textures, const SplatView& view) {
  SplatLayer layer;
  if (textures.normals == 0) return layer;
  layer.width = view.width;
  layer.height = view.height;
  layer.discs = textures.discs;
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  layer.depth.assign(pixels, 0);
  layer.normals.assign(4 * pixels, 0);
  if (textures.colors != 0) layer.colors.assign(4 * pixels, 0);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, targets_.resolve_pass.name());
  gl_.PixelStorei(GL_PACK_ROW_LENGTH, view.width);
  const auto first = static_cast<std::size_t>(textures.y) * static_cast<std::size_t>(view.width) +
                     static_cast<std::size_t>(textures.x);
  const auto get = [&](GLenum attachment, GLenum format, GLenum type, void* to) {
    gl_.ReadBuffer(attachment);
    gl_.ReadPixels(textures.x, textures.y, textures.width, textures.height, format, type, to);
  };
  get(GL_COLOR_ATTACHMENT0, GL_RGBA, GL_UNSIGNED_SHORT, layer.normals.data() + 4 * first);
  get(GL_COLOR_ATTACHMENT1, GL_RED, GL_FLOAT, layer.depth.data() + first);
  if (textures.colors != 0) get(GL_COLOR_ATTACHMENT2, GL_RGBA, GL_UNSIGNED_BYTE, layer.colors.data() + 4 * first);
  gl_.PixelStorei(GL_PACK_ROW_LENGTH, 0);
  return layer;
}

}  // namespace gs::render
