#include "render/splat_gl.h"

#include "render/shaders.h"
#include "render/splat_constants.h"
#include "render/splat_shaders.h"

#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

constexpr std::size_t kMostTargetBytes = std::size_t{1} << 30;
constexpr std::size_t kSurveyed = 8192;  // discs
// Clouds that would cover more samples than this, counted once a disc, are thinned out: a driver that is busy for
// seconds is taken to hang. Clouds that are drawn as they were meant cover a thousandth.
constexpr double kMostCovered = 2e10;
// What is left out beyond that comes last in its piece: OpenGL 4.4 refuses longer strides than 2048 bytes.
constexpr std::size_t kMostStep = 2048 / sizeof(SplatCode);
constexpr float kMargin = 0.05f;  // samples: of the rectangles, for the rounding of their corners

const void* offset_pointer(std::size_t offset) { return reinterpret_cast<const void*>(offset); }

std::string constants() {
  std::string text;
  for (const auto& [name, value] : {std::pair{"BACK_MARGIN", splat::kBackMargin},
                                    {"CUBE_MARGIN", splat::kCubeMargin},
                                    {"SAMPLE_MARGIN", splat::kSampleMargin},
                                    {"CUBE_BELL", splat::kCubeBell},
                                    {"DISC_COVER", splat::kDiscCover},
                                    {"DISC_BELL", splat::kDiscBell},
                                    {"LEAST_REACH", splat::kLeastReach},
                                    {"GRAZING", splat::kGrazing},
                                    {"SMOOTHING", splat::kSmoothing},
                                    {"OFFSET_RANGE", SplatCoding::kOffsetRange},
                                    {"PI", splat::kPi}}) {
    // Not std::to_string, which asks the locale; and in parentheses for the sign.
    const auto billionths = std::llround(std::abs(double{value}) * 1e9);
    const std::string digits = std::to_string(billionths % 1'000'000'000 + 1'000'000'000).substr(1);
    text += std::string("#define ") + name + (value < 0 ? " (-" : " (") + std::to_string(billionths / 1'000'000'000) +
            "." + digits + ")\n";
  }
  return text;
}

/// The pixels that a box with `around` on all sides can cover; empty when it is out of view.
template <class Rectangle>
std::optional<Rectangle> covered(const qnv::Box& box, double around, const SplatView& view, const SplatCamera& camera) {
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
  // Two pixels more: discs smaller than a sample are drawn larger.
  const auto range = [&](int axis, double tangent, int pixels) {
    const double low = center[axis] - extent[axis], high = center[axis] + extent[axis];
    const auto pixel = [&](double slope) {
      const double at = (slope / tangent + 1) * 0.5 * pixels;
      return at > 0 ? std::min(at, double{static_cast<double>(pixels)}) : 0.0;
    };
    return std::pair{static_cast<int>(std::max(pixel(std::min(low / nearest, low / farthest)) - 2, 0.0)),
                     std::min(static_cast<int>(pixel(std::max(high / nearest, high / farthest))) + 3, pixels)};
  };
  const auto [x0, x1] = range(0, double{camera.tangents.x}, view.width);
  const auto [y0, y1] = range(1, double{camera.tangents.y}, view.height);
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

float largest_radius(float weight) { return std::sqrt(weight * (1 / splat::kPi)); }

glm::vec3 row_of(const glm::mat4& matrix, int row) { return {matrix[0][row], matrix[1][row], matrix[2][row]}; }

}  // namespace

SplatGl::SplatGl(const Gl& gl)
    : gl_(gl),
      store_(gl),
      no_attributes_(make_vertex_array(gl)),
      record_attributes_(make_vertex_array(gl)),
      disc_attributes_(make_vertex_array(gl)),
      cell_attributes_(make_vertex_array(gl)) {
  for (const VertexArray* attributes : {&record_attributes_, &disc_attributes_, &cell_attributes_}) {
    gl.BindVertexArray(attributes->name());
    for (GLuint location = 0; location < (attributes == &cell_attributes_ ? 2u : 1u); ++location) {
      gl.EnableVertexAttribArray(location);
      gl.VertexAttribDivisor(location, 1);
    }
  }
  gl.BindVertexArray(0);
}

const SplatGl::Shader* SplatGl::shader(Stage stage, const Kind& kind) {
  // Only what the stage depends on, so that no program is made twice.
  const bool discs = stage != Stage::resolve, blended = stage != Stage::depth;
  const std::array<std::pair<bool, const char*>, 6> flags{{{discs && kind.records, "RECORDS"},
                                                           {discs && kind.cells, "CELLS"},
                                                           {discs && kind.sides, "SIDES"},
                                                           {stage == Stage::resolve && kind.colored, "COLORS"},
                                                           {blended && kind.smooth, "SMOOTH"},
                                                           {stage == Stage::blend, "BLEND"}}};
  unsigned key = static_cast<unsigned>(stage);
  for (const auto& [set, name] : flags) key = key * 2 + (set ? 1 : 0);
  const auto [found, fresh] = shaders_.try_emplace(key);
  Shader& entry = found->second;
  if (fresh) {
    std::string defines = constants();
    for (const auto& [set, name] : flags)
      if (set) defines += std::string("#define ") + name + "\n";
    const char* fragment = stage == Stage::depth   ? kSplatDepthFragmentShader
                           : stage == Stage::blend ? kSplatBlendFragmentShader
                                                   : kSplatResolveFragmentShader;
    const std::string vertex =
        discs ? std::string(kSplatVectorShader) + kSplatDiscVertexShader : std::string(kSplatVertexShader);
    auto made = make_program(gl_, defines, vertex, fragment);
    if (auto* program = std::get_if<Program>(&made)) {
      entry.program = std::move(*program);
      static constexpr std::array<const char*, uniform_count> kNames{
          "frame_lower", "frame_step",  "weight_step", "normal_table",  "palette",    "radius_code", "radius_scale",
          "edge_code",   "eye",         "row_x",       "row_y",         "row_z",      "tangents",    "margin",
          "near_plane",  "sample_size", "ray_origin",  "ray_right",     "ray_up",     "nearest",     "sums",
          "color_sums",  "slopes",      "tilts",       "normal_matrix", "supersample"};
      for (std::size_t i = 0; i < uniform_count; ++i)
        entry.at[i] = gl_.GetUniformLocation(entry.program.name(), kNames[i]);
    }
  }
  return entry.program ? &entry : nullptr;
}

bool SplatGl::fits(const SplatView& view, const Kind& kind) const {
  const int most = std::min(gl_.max_texture_size, gl_.max_renderbuffer_size);
  if (view.width > most / view.supersample || view.height > most / view.supersample) return false;
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  const auto samples = pixels * static_cast<std::size_t>(view.supersample * view.supersample);
  const std::size_t a_sample = 8 + 16 + (kind.colored ? 16 : 0) + (kind.smooth ? 32 : 0);
  return samples * a_sample + pixels * 16 <= kMostTargetBytes;
}

bool SplatGl::make_targets(const SplatView& view, const Kind& kind) {
  Targets& t = targets_;
  const bool same = t.width == view.width && t.height == view.height && t.samples == view.supersample;
  if (same && (t.colored || !kind.colored) && (t.smooth || !kind.smooth)) return t.resolve_pass.name() != 0;
  Targets made;
  made.width = view.width;
  made.height = view.height;
  made.samples = view.supersample;
  // What one cloud needed, others of the same picture will need as well.
  made.colored = kind.colored || (same && t.colored);
  made.smooth = kind.smooth || (same && t.smooth);
  t = {};
  take_errors(gl_);
  gl_.ActiveTexture(GL_TEXTURE0);
  const auto attach = [&](Texture& texture, GLenum attachment, GLenum internal, GLenum format, GLenum type, int scale) {
    texture = make_texture(gl_);
    gl_.BindTexture(GL_TEXTURE_2D, texture.name());
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      gl_.TexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), view.width * scale, view.height * scale, 0, format,
                   type, nullptr);
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture.name(), 0);
  };
  const auto open = [&](Framebuffer& framebuffer) {
    framebuffer = make_framebuffer(gl_);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  };
  const auto complete = [&] { return gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE; };
  const int s = view.supersample;
  open(made.depth_pass);
  attach(made.nearest, GL_COLOR_ATTACHMENT0, GL_R32F, GL_RED, GL_FLOAT, s);
  made.depth = make_renderbuffer(gl_);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, made.depth.name());
  gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, 0, GL_DEPTH_COMPONENT32F, view.width * s, view.height * s);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, made.depth.name());
  bool good = complete();
  // Not half floats: where thousands of discs meet in one sample they would stop to add up.
  open(made.blend_pass);
  attach(made.sums, GL_COLOR_ATTACHMENT0, GL_RGBA32F, GL_RGBA, GL_FLOAT, s);
  if (made.colored) attach(made.color_sums, GL_COLOR_ATTACHMENT1, GL_RGBA32F, GL_RGBA, GL_FLOAT, s);
  if (made.smooth) {
    attach(made.slopes, GL_COLOR_ATTACHMENT2, GL_RGBA32F, GL_RGBA, GL_FLOAT, s);
    attach(made.tilts, GL_COLOR_ATTACHMENT3, GL_RGBA32F, GL_RGBA, GL_FLOAT, s);
  }
  good = complete() && good;
  open(made.resolve_pass);
  attach(made.normals, GL_COLOR_ATTACHMENT0, GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT, 1);
  attach(made.depths, GL_COLOR_ATTACHMENT1, GL_R32F, GL_RED, GL_FLOAT, 1);
  if (made.colored) attach(made.colors, GL_COLOR_ATTACHMENT2, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 1);
  good = complete() && good;
  good = !take_errors(gl_) && good;
  if (good) {
    t = std::move(made);
  } else {
    // So that it is not tried again for every frame of this size.
    t.width = made.width;
    t.height = made.height;
    t.samples = made.samples;
    t.colored = t.smooth = true;
  }
  return good;
}

std::optional<SplatTextures> SplatGl::draw(std::span<const SharedSplatPiece> pieces, const SplatView& view) {
  const auto camera = splat_camera(view);
  if (!camera || pieces.empty() || view.width < 1 || view.height < 1) return SplatTextures{};
  Surface surface;
  std::vector<SplatPiece> in_view;
  for (const SharedSplatPiece& piece : pieces) {
    const SplatStore::Entry* entry = store_.find(piece.cloud);
    if (!entry) return std::nullopt;
    if (!entry->coding || piece.first > entry->discs || piece.count > entry->discs - piece.first) continue;
    const SplatCoding& coding = *entry->coding;
    const float growth = std::max(piece.growth, 1.0f);
    const double radius = double{coding.largest_radius} * std::sqrt(double{growth});
    const qnv::Box box{coding.lower, coding.lower + coding.step * 1048575.0f};
    const auto rectangle = covered<Rectangle>(box, 3 * radius + double{coding.reach}, view, *camera);
    if (!rectangle || piece.count == 0) continue;
    if (surface.batches.empty()) surface.kind.cells = entry->cells;
    if (surface.kind.cells != entry->cells) continue;
    unite(surface.rectangle, *rectangle);
    surface.batches.push_back({entry->buffer.name(), piece.first * sizeof(SplatCode),
                               entry->discs * sizeof(SplatCode) + piece.first * sizeof(CellCode), piece.count, &coding,
                               nullptr, growth});
    surface.kind.colored = surface.kind.colored || !piece.cloud->colors.empty();
    surface.kind.sides = surface.kind.sides || piece.cloud->description.two_sided;
    in_view.push_back({piece.cloud.get(), piece.first, piece.count, growth});
  }
  return draw(surface, survey_surface(in_view, view, kSurveyed), view);
}

std::optional<SplatTextures> SplatGl::draw(const SplatRecords& records, const SplatView& view) {
  const auto camera = splat_camera(view);
  if (!camera || view.width < 1 || view.height < 1) return SplatTextures{};
  Surface surface;
  surface.kind.records = true;
  surface.kind.sides = records.two_sided();
  surface.kind.colored = records.colored();
  surface.palette = records.palette().name();
  std::vector<SplatPiece> samples;
  std::size_t sampled = 0, all = 0;
  for (const SplatRecords::Chunk& chunk : records.chunks()) {
    const float radius = largest_radius(chunk.frame.weight_step * static_cast<float>(qnv::kRecordLargestWeight));
    const auto rectangle = covered<Rectangle>(chunk.frame.box(), 3 * double{radius}, view, *camera);
    if (!rectangle) continue;
    unite(surface.rectangle, *rectangle);
    surface.batches.push_back({chunk.buffer.name(), 0, 0, chunk.records, nullptr, &chunk.frame, 1});
    samples.push_back({chunk.sample.get(), 0, chunk.sample->size(), 1});
    sampled += chunk.sample->size();
    all += chunk.records;
  }
  SplatSurvey survey = survey_surface(samples, view, kSurveyed);
  const double share = static_cast<double>(all) / static_cast<double>(std::max<std::size_t>(sampled, 1));
  survey.discs = static_cast<std::size_t>(static_cast<double>(survey.discs) * share);
  survey.samples *= share;
  return draw(surface, survey, view);
}

std::optional<SplatTextures> SplatGl::draw(Surface& surface, const SplatSurvey& survey, SplatView view) {
  SplatTextures result;
  if (surface.batches.empty() || surface.rectangle.x1 <= surface.rectangle.x0 ||
      surface.rectangle.y1 <= surface.rectangle.y0)
    return result;
  surface.kind.smooth = survey.smooth;
  surface.step = static_cast<std::size_t>(std::clamp(survey.samples / kMostCovered, 0.0, 1e6)) + 1;
  if (view.supersample > 1 && !fits(view, surface.kind)) view.supersample = 1;
  if (!fits(view, surface.kind)) return std::nullopt;
  if (!(view.near_plane > 0)) view.near_plane = 1e-20f;  // it scales the depth buffer
  const Shader* depth = shader(Stage::depth, surface.kind);
  const Shader* blend = shader(Stage::blend, surface.kind);
  const Shader* resolve = shader(Stage::resolve, surface.kind);
  if (!depth || !blend || !resolve || !make_targets(view, surface.kind)) return std::nullopt;
  const auto camera = splat_camera(view);
  if (!camera) return result;
  if (surface.kind.records && !normal_table_) normal_table_ = make_normal_table(gl_);

  gl_.Enable(GL_SCISSOR_TEST);
  gl_.Disable(GL_CULL_FACE);
  depth_pass(*depth, surface, *camera);
  blend_pass(*blend, surface, *camera);
  resolve_pass(*resolve, surface, *camera);
  gl_.BindVertexArray(0);
  gl_.ActiveTexture(GL_TEXTURE0);
  const Rectangle& r = surface.rectangle;
  result = {targets_.normals.name(),
            targets_.depths.name(),
            surface.kind.colored ? targets_.colors.name() : 0,
            r.x0,
            r.y0,
            r.x1 - r.x0,
            r.y1 - r.y0,
            survey.discs};
  return result;
}

void SplatGl::texture(const Shader& shader, Uniform uniform, int unit, GLuint name) {
  gl_.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  gl_.BindSampler(static_cast<GLuint>(unit), 0);
  gl_.BindTexture(GL_TEXTURE_2D, name);
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
  // The nearest first in value, so that the depth buffer is as precise far away as float32 is.
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

void SplatGl::point_at(const Batch& batch, const Kind& kind, std::size_t step) {
  gl_.BindBuffer(GL_ARRAY_BUFFER, batch.buffer);
  const auto stride = [&](std::size_t bytes) { return static_cast<GLsizei>(bytes * std::min(step, kMostStep)); };
  if (kind.records) {
    gl_.VertexAttribIPointer(0, 2, GL_UNSIGNED_INT, stride(qnv::kRecordBytes), offset_pointer(batch.offset));
    return;
  }
  gl_.VertexAttribIPointer(0, 4, GL_UNSIGNED_INT, stride(sizeof(SplatCode)), offset_pointer(batch.offset));
  if (kind.cells)
    gl_.VertexAttribIPointer(1, 1, GL_UNSIGNED_INT, stride(sizeof(CellCode)), offset_pointer(batch.cells_offset));
}

void SplatGl::draw_batches(const Shader& shader, const Surface& surface, const SplatCamera& camera) {
  const auto& at = shader.at;
  const auto vector = [&](Uniform uniform, const glm::vec3& v) { gl_.Uniform3fv(at[uniform], 1, glm::value_ptr(v)); };
  const Kind& kind = surface.kind;
  vector(row_x, row_of(camera.camera_from_node, 0));
  vector(row_y, row_of(camera.camera_from_node, 1));
  vector(row_z, row_of(camera.camera_from_node, 2));
  vector(ray_origin, camera.rays.origin);
  vector(ray_right, camera.rays.right);
  vector(ray_up, camera.rays.up);
  gl_.Uniform1f(at[near_plane], camera.rays.near_plane);
  gl_.Uniform1f(at[sample_size], 1 / (camera.pixels * camera.scale));
  gl_.Uniform2f(at[tangents], camera.tangents.x, camera.tangents.y);
  gl_.Uniform2f(at[margin], 2 * kMargin / static_cast<float>(camera.width),
                2 * kMargin / static_cast<float>(camera.height));
  vector(eye, kind.records ? camera.eye : glm::vec3(0));
  if (kind.records) {
    texture(shader, normal_table, 1, normal_table_.name());
    texture(shader, palette, 2, surface.palette);
  }
  gl_.BindVertexArray(kind.records ? record_attributes_.name()
                      : kind.cells ? cell_attributes_.name()
                                   : disc_attributes_.name());
  for (const Batch& batch : surface.batches) {
    if (batch.frame) {
      vector(frame_lower, batch.frame->lower);
      vector(frame_step, batch.frame->cell * 0.5f);
      gl_.Uniform1f(at[weight_step], batch.frame->weight_step);
    } else {
      const SplatCoding& coding = *batch.coding;
      vector(frame_lower, glm::vec3(glm::dvec3(coding.lower) - glm::dvec3(camera.eye)));
      vector(frame_step, coding.step);
      gl_.Uniform2f(at[radius_code], coding.radius.x, coding.radius.y);
      gl_.Uniform1f(at[radius_scale], std::sqrt(batch.growth));
      if (kind.cells) gl_.Uniform2f(at[edge_code], coding.edge.x, coding.edge.y);
    }
    point_at(batch, kind, surface.step);
    const std::size_t count = (batch.count + surface.step - 1) / surface.step;
    gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(count));
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
