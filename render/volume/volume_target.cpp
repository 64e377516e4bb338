#include "render/volume/volume_target.h"

#include "base/parallel.h"
#include "render/gl/shaders.h"
#include "render/volume/volume_shaders.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

constexpr float kNothing[4] = {0, 0, 0, 0};
constexpr std::size_t kLeastRange = 4096;  // splats between two searches for opaque pixels
constexpr int kStep = 64;                  // texture sizes are multiples of this
constexpr float kSmooth = 1 / 256.0f;  // maximum relative difference of depth between samples of one surface in a pixel

Program program_of(const Gl& gl, const char* defines, const char* fragment) {
  auto made = make_program(gl, defines, kScreenVertexShader, fragment);
  auto* program = std::get_if<Program>(&made);
  return program ? std::move(*program) : Program();
}

GLenum target_of(int samples) { return samples > 1 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D; }

}  // namespace

std::vector<BlendedPart> growing_parts(const PreparedSplats& splats) {
  std::vector<BlendedPart> parts;
  for (std::size_t first = 0; first < splats.total;) {
    // 4 parts of 1/16, 2 of 1/8, then 1/4.
    const std::size_t share = parts.size() < 4   ? 16
                              : parts.size() < 6 ? 8
                                                 : 4,
                      count = std::min(splats.total - first, std::max(kLeastRange, (splats.total + share - 1) / share));
    parts.push_back({&splats, {first, count}});
    first += count;
  }
  return parts;
}

std::vector<BlendedPart> parts_in_slabs(const std::array<const PreparedSplats*, 2>& contents,
                                        std::span<const DepthSlab> slabs) {
  std::vector<BlendedPart> parts;
  for (const DepthSlab& slab : slabs) {
    const PreparedSplats& splats = *contents[slab.content];
    SplatRange range;
    range.count = splats.total;
    range.nearest = slab.nearest;
    range.farthest = std::min(slab.farthest, range.farthest);
    parts.push_back({&splats, range});
  }
  return parts;
}

VolumeTarget::VolumeTarget(const Gl& gl) : gl_(gl), no_attributes_(make_vertex_array(gl)) {}

VolumeTarget::Bound VolumeTarget::bound() const {
  Bound framebuffers;
  gl_.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffers.draw);
  gl_.GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &framebuffers.read);
  return framebuffers;
}

void VolumeTarget::bind(const Bound& framebuffers) const {
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(framebuffers.draw));
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(framebuffers.read));
}

bool VolumeTarget::depth_formats(std::array<GLenum, 2>& formats) const {
  const bool window = bound().draw == 0;
  const GLenum depth = window ? GL_DEPTH : GL_DEPTH_ATTACHMENT, stencil = window ? GL_STENCIL : GL_STENCIL_ATTACHMENT;
  const auto get = [&](GLenum attachment, GLenum name) {
    GLint value = 0;
    gl_.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, attachment, name, &value);
    return value;
  };
  formats = {0, 0};
  if (get(depth, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_NONE) return false;
  const GLint bits = get(depth, GL_FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE);
  if (bits == 0) return false;
  const bool real = get(depth, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE) == GL_FLOAT;
  const bool with_stencil = get(stencil, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) != GL_NONE &&
                            get(stencil, GL_FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE) > 0;
  if (real) formats = {GL_DEPTH_COMPONENT32F, GL_DEPTH32F_STENCIL8};
  if (!real && bits == 24) formats = {GL_DEPTH_COMPONENT24, GL_DEPTH24_STENCIL8};
  if (!real && bits == 32) formats = {GL_DEPTH_COMPONENT32, 0};
  if (!real && bits == 16) formats = {GL_DEPTH_COMPONENT16, 0};
  if (with_stencil) std::swap(formats[0], formats[1]);
  return true;
}

void VolumeTarget::attach(const Texture& texture, GLenum attachment, GLenum internal, GLenum format, GLenum type) {
  const GLenum target = target_of(samples_);
  gl_.BindTexture(target, texture.name());
  if (samples_ > 1) {
    gl_.TexImage2DMultisample(target, samples_, internal, width_, height_, GL_TRUE);
  } else {
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      gl_.TexParameteri(target, filter, GL_NEAREST);
    gl_.TexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
    gl_.TexImage2D(target, 0, static_cast<GLint>(internal), width_, height_, 0, format, type, nullptr);
  }
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, target, texture.name(), 0);
}

bool VolumeTarget::make(int width, int height, int samples, GLenum depth_format, bool colored) {
  const bool large_enough = width <= width_ && height <= height_ && samples == samples_;
  if (framebuffer_ && large_enough && depth_format == depth_format_ && (colored_ || !colored)) return true;
  const bool same = samples == samples_;
  // Viewports of different sizes share one texture, which grows as necessary.
  const auto size = [&](int wanted, int had) {
    return std::min(std::max((wanted + kStep - 1) / kStep * kStep, same ? had : 0), gl_.max_texture_size);
  };
  width_ = size(width, width_);
  height_ = size(height, height_);
  samples_ = samples;
  depth_format_ = depth_format;
  colored_ = colored;
  framebuffer_ = {};
  color_ = {};
  depth_ = {};
  take_errors(gl_);
  if (width > width_ || height > height_) return false;
  framebuffer_ = make_framebuffer(gl_);
  color_ = make_texture(gl_);
  depth_ = make_texture(gl_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  gl_.ActiveTexture(GL_TEXTURE0);
  const GLenum drawn = colored ? GL_COLOR_ATTACHMENT0 : GL_NONE;
  gl_.DrawBuffers(1, &drawn);
  gl_.ReadBuffer(drawn);
  if (colored) attach(color_, GL_COLOR_ATTACHMENT0, GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT);
  const bool stencil = depth_format == GL_DEPTH24_STENCIL8 || depth_format == GL_DEPTH32F_STENCIL8;
  attach(depth_, stencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT, depth_format,
         stencil ? GL_DEPTH_STENCIL : GL_DEPTH_COMPONENT,
         depth_format == GL_DEPTH32F_STENCIL8  ? GL_FLOAT_32_UNSIGNED_INT_24_8_REV
         : depth_format == GL_DEPTH24_STENCIL8 ? GL_UNSIGNED_INT_24_8
                                               : GL_FLOAT);
  const bool complete = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  framebuffer_closing_ = {};
  if (colored) framebuffer_closing_ = closing_for(depth_, stencil);
  if (take_errors(gl_) || !complete) framebuffer_ = {};
  return framebuffer_.name() != 0;
}

/// Makes a framebuffer with only a depth texture, for writes that depend on the colours.
Framebuffer VolumeTarget::closing_for(const Texture& depth, bool stencil) const {
  Framebuffer made = make_framebuffer(gl_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, made.name());
  const GLenum none = GL_NONE;
  gl_.DrawBuffers(1, &none);
  gl_.ReadBuffer(GL_NONE);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, stencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D,
                           depth.name(), 0);
  if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) return {};
  return made;
}

bool VolumeTarget::copy_depth(const Bound& from, const TargetRectangle& r, bool colored) {
  GLint samples = 0;
  gl_.GetIntegerv(GL_SAMPLES, &samples);
  std::array<GLenum, 2> formats{};
  if (!depth_formats(formats)) return false;
  // Try the last format that worked first.
  if (formats[1] == depth_format_ && framebuffer_) std::swap(formats[0], formats[1]);
  for (const GLenum format : formats) {
    if (format == 0) continue;
    if (make(r.width, r.height, std::max(samples, 1), format, colored)) {
      gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(from.draw));
      gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
      gl_.Viewport(0, 0, r.width, r.height);
      gl_.Scissor(0, 0, r.width, r.height);
      take_errors(gl_);
      gl_.BlitFramebuffer(r.x, r.y, r.x + r.width, r.y + r.height, 0, 0, r.width, r.height, GL_DEPTH_BUFFER_BIT,
                          GL_NEAREST);
      if (!take_errors(gl_)) return true;
      framebuffer_ = {};
    }
    bind(from);
  }
  return false;
}

bool VolumeTarget::read_samples(const TargetRectangle& r, std::vector<float>& both) {
  if (!extremes_) extremes_ = program_of(gl_, "", kVolumeExtremesFragmentShader);
  if (!extremes_) return false;
  take_errors(gl_);
  gl_.ActiveTexture(GL_TEXTURE0);
  if (!extremes_framebuffer_ || r.width > extremes_width_ || r.height > extremes_height_) {
    extremes_width_ = std::max(r.width, extremes_width_);
    extremes_height_ = std::max(r.height, extremes_height_);
    extremes_framebuffer_ = make_framebuffer(gl_);
    extreme_depths_ = make_texture(gl_);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, extremes_framebuffer_.name());
    gl_.BindTexture(GL_TEXTURE_2D, extreme_depths_.name());
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RG32F, extremes_width_, extremes_height_, 0, GL_RG, GL_FLOAT, nullptr);
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, extreme_depths_.name(), 0);
    if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) extremes_framebuffer_ = {};
  }
  if (take_errors(gl_) || !extremes_framebuffer_) return false;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, extremes_framebuffer_.name());
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Disable(GL_BLEND);
  gl_.BindSampler(0, 0);
  gl_.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, depth_.name());
  gl_.UseProgram(extremes_.name());
  gl_.Uniform1i(gl_.GetUniformLocation(extremes_.name(), "depths"), 0);
  gl_.Uniform1i(gl_.GetUniformLocation(extremes_.name(), "samples"), samples_);
  gl_.BindVertexArray(no_attributes_.name());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.ReadPixels(0, 0, r.width, r.height, GL_RG, GL_FLOAT, both.data());
  return !take_errors(gl_);
}

bool VolumeTarget::read_depths(const TargetRectangle& r, const Projection& projection, TargetDepths& depths) {
  if (r.width < 1 || r.height < 1) return false;
  const auto pixels = static_cast<std::size_t>(r.width) * static_cast<std::size_t>(r.height);
  const Bound from = bound();
  GLint samples = 0;
  gl_.GetIntegerv(GL_SAMPLES, &samples);
  take_errors(gl_);
  const bool several = samples > 1;
  std::vector<float>& read = read_depths_;
  read.resize(pixels * (several ? 2 : 1));
  bool good = false;
  if (several) {
    good = copy_depth(from, r, false) && read_samples(r, read);
    bind(from);
    gl_.Viewport(r.x, r.y, r.width, r.height);
    gl_.Scissor(r.x, r.y, r.width, r.height);
  } else {
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(from.draw));
    gl_.ReadPixels(r.x, r.y, r.width, r.height, GL_DEPTH_COMPONENT, GL_FLOAT, read.data());
    good = !take_errors(gl_);
    bind(from);
  }
  if (!good) return false;
  const auto distance = [&](float window) {
    return window != projection.farthest_depth() ? projection.depth_scale / (window - projection.depth_offset)
                                                 : std::numeric_limits<float>::infinity();
  };
  // With multisampling, the textures hold minimum and maximum depth.
  const std::size_t nearer = several && projection.reversed ? 1 : 0;
  depths.near.resize(pixels);
  depths.far.clear();
  if (several) depths.far.resize(pixels);
  constexpr std::size_t kPart = std::size_t{1} << 16;  // pixels per task
  parallel_for((pixels + kPart - 1) / kPart, [&](std::size_t part) {
    const std::size_t last = std::min(pixels, (part + 1) * kPart);
    if (!several) {
      for (std::size_t i = part * kPart; i < last; ++i) depths.near[i] = distance(read[i]);
      return;
    }
    for (std::size_t i = part * kPart; i < last; ++i) {
      depths.near[i] = distance(read[2 * i + nearer]);
      const float far = distance(read[2 * i + 1 - nearer]);
      depths.far[i] = depths.near[i] < far * (1 - kSmooth) ? far : depths.near[i];
    }
  });
  return true;
}

bool VolumeTarget::make_layer(int width, int height) {
  if (layer_ && width <= layer_width_ && height <= layer_height_) return true;
  layer_width_ = std::max(width_, width);
  layer_height_ = std::max(height_, height);
  take_errors(gl_);
  layer_ = make_framebuffer(gl_);
  layer_color_ = make_texture(gl_);
  layer_depth_ = make_texture(gl_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, layer_.name());
  gl_.ActiveTexture(GL_TEXTURE0);
  const auto attach_single = [&](const Texture& texture, GLenum attachment, GLenum internal, GLenum format,
                                 GLenum type) {
    gl_.BindTexture(GL_TEXTURE_2D, texture.name());
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      gl_.TexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), layer_width_, layer_height_, 0, format, type,
                   nullptr);
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture.name(), 0);
  };
  attach_single(layer_color_, GL_COLOR_ATTACHMENT0, GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT);
  attach_single(layer_depth_, GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT);
  const bool complete = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  layer_closing_ = closing_for(layer_depth_, false);
  if (take_errors(gl_) || !complete) layer_ = {};
  return layer_.name() != 0;
}

bool VolumeTarget::make_programs(bool several) {
  if (!closing_) closing_ = program_of(gl_, "", kVolumeClosingFragmentShader);
  if (!several) {
    if (!single_) single_ = program_of(gl_, "", kVolumeLayerFragmentShader);
    return single_.name() != 0;
  }
  const std::string depths = std::string(kVolumeSamplesShader) + kVolumeDepthsFragmentShader,
                    layer = std::string(kVolumeSamplesShader) + kVolumeLayerFragmentShader;
  if (!far_depths_) far_depths_ = program_of(gl_, "", depths.c_str());
  if (!edge_depths_) edge_depths_ = program_of(gl_, "#define EDGES\n", depths.c_str());
  if (!far_layer_) far_layer_ = program_of(gl_, "#define SAMPLES\n", layer.c_str());
  if (!edge_layer_) edge_layer_ = program_of(gl_, "#define SAMPLES\n#define EDGES\n", layer.c_str());
  if (!edges_) edges_ = make_query(gl_);
  return far_depths_ && edge_depths_ && far_layer_ && edge_layer_;
}

/// Draws a triangle that covers the viewport. `program` reads the depths of samples (kVolumeSamplesShader), or no
/// depth.
void VolumeTarget::fill(const Program& program, const Projection& projection) {
  const auto at = [&](const char* name) { return gl_.GetUniformLocation(program.name(), name); };
  gl_.UseProgram(program.name());
  gl_.ActiveTexture(GL_TEXTURE1);
  gl_.BindSampler(1, 0);
  gl_.BindTexture(target_of(samples_), depth_.name());
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.Uniform1i(at("depths"), 1);
  gl_.Uniform1i(at("samples"), samples_);
  gl_.Uniform2f(at("depth_row"), projection.depth_offset, projection.depth_scale);
  gl_.Uniform2f(at("depth_range"), projection.nearest_depth(), projection.farthest_depth());
  gl_.Uniform1f(at("smooth_part"), 1 - kSmooth);
  gl_.BindVertexArray(no_attributes_.name());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

/// Composites a layer over the outer framebuffer. With several samples, `program` writes the depth to test.
void VolumeTarget::composite(const Program& program, const Texture& layer, const TargetRectangle& r,
                             const Projection& projection, float gain) {
  bind(outer_);
  gl_.Viewport(r.x, r.y, r.width, r.height);
  gl_.Scissor(r.x, r.y, r.width, r.height);
  gl_.DepthMask(GL_FALSE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindSampler(0, 0);
  gl_.BindTexture(GL_TEXTURE_2D, layer.name());
  gl_.UseProgram(program.name());
  gl_.Uniform1i(gl_.GetUniformLocation(program.name(), "layer"), 0);
  gl_.Uniform2i(gl_.GetUniformLocation(program.name(), "origin"), r.x, r.y);
  gl_.Uniform1f(gl_.GetUniformLocation(program.name(), "gain"), gain);
  fill(program, projection);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_DEPTH_TEST);
}

void VolumeTarget::begin_blending(const Projection& projection, bool near_first) {
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(projection.reversed ? GL_GEQUAL : GL_LEQUAL);
  gl_.DepthMask(GL_FALSE);
  gl_.Disable(GL_CULL_FACE);
  gl_.Enable(GL_BLEND);
  if (near_first)
    gl_.BlendFuncSeparate(GL_ONE_MINUS_DST_ALPHA, GL_ONE, GL_ONE_MINUS_DST_ALPHA, GL_ONE);
  else
    gl_.BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

/// Gives the opaque pixels of the bound layer the nearest depth, so that the depth test excludes them.
void VolumeTarget::close_opaque(const Projection& projection) {
  const bool several = samples_ > 1;
  const Framebuffer& closing = several ? layer_closing_ : framebuffer_closing_;
  if (!closing || !closing_) return;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, closing.name());
  gl_.Disable(GL_BLEND);
  gl_.DepthMask(GL_TRUE);
  gl_.DepthFunc(GL_ALWAYS);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindSampler(0, 0);
  gl_.BindTexture(GL_TEXTURE_2D, (several ? layer_color_ : color_).name());
  gl_.UseProgram(closing_.name());
  gl_.Uniform1i(gl_.GetUniformLocation(closing_.name(), "layer"), 0);
  gl_.Uniform1f(gl_.GetUniformLocation(closing_.name(), "nearest"), projection.nearest_depth());
  gl_.BindVertexArray(no_attributes_.name());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, (several ? layer_ : framebuffer_).name());
}

/// Draws parts of splats into the bound layer, from near to far.
void VolumeTarget::blend_parts(const Projection& projection, std::span<const BlendedPart> parts, float gain) {
  bool first = true;
  for (const BlendedPart& part : parts) {
    if (part.range.count == 0) continue;
    if (!first) close_opaque(projection);
    first = false;
    begin_blending(projection, true);
    SplatRange range = part.range;
    range.gain = gain;
    part.splats->draw(range);
  }
}

void VolumeTarget::draw_several(const TargetRectangle& r, const Projection& projection,
                                const std::function<void()>& blend_layer, float gain) {
  for (const bool edges : {false, true}) {
    gl_.BindFramebuffer(GL_FRAMEBUFFER, layer_.name());
    gl_.Viewport(0, 0, r.width, r.height);
    gl_.Scissor(0, 0, r.width, r.height);
    gl_.Disable(GL_BLEND);
    gl_.DepthMask(GL_TRUE);
    const float nearest = projection.nearest_depth();
    gl_.ClearBufferfv(GL_COLOR, 0, kNothing);
    gl_.ClearBufferfv(GL_DEPTH, 0, &nearest);
    gl_.Enable(GL_DEPTH_TEST);
    gl_.DepthFunc(GL_ALWAYS);
    gl_.Disable(GL_CULL_FACE);
    if (edges) gl_.BeginQuery(GL_SAMPLES_PASSED, edges_.name());
    fill(edges ? edge_depths_ : far_depths_, projection);
    if (edges) {
      gl_.EndQuery(GL_SAMPLES_PASSED);
      gl_.BeginConditionalRender(edges_.name(), GL_QUERY_WAIT);
    }
    blend_layer();
    gl_.Enable(GL_DEPTH_TEST);
    if (edges)
      gl_.DepthFunc(projection.reversed ? GL_LESS : GL_GREATER);
    else
      gl_.DepthFunc(projection.reversed ? GL_GEQUAL : GL_LEQUAL);
    composite(edges ? edge_layer_ : far_layer_, layer_color_, r, projection, gain);
    if (edges) gl_.EndConditionalRender();
  }
}

bool VolumeTarget::prepare(const TargetRectangle& r, bool several) {
  return make_programs(several) && copy_depth(outer_, r, !several) && (!several || make_layer(r.width, r.height));
}

void VolumeTarget::blend(const TargetRectangle& r, const Projection& projection, std::span<const BlendedPart> parts,
                         float gain) {
  if (r.width < 1 || r.height < 1) return;
  outer_ = bound();
  GLint samples = 0;
  gl_.GetIntegerv(GL_SAMPLES, &samples);
  const bool several = samples > 1, ready = prepare(r, several);
  const auto blend_layer = [&] { blend_parts(projection, parts, 1 / gain); };
  if (ready && several) {
    draw_several(r, projection, blend_layer, gain);
  } else if (ready) {
    gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    gl_.ClearBufferfv(GL_COLOR, 0, kNothing);
    blend_layer();
    gl_.Disable(GL_DEPTH_TEST);
    composite(single_, color_, r, projection, gain);
  }
  bind(outer_);
  gl_.Viewport(r.x, r.y, r.width, r.height);
  gl_.Scissor(r.x, r.y, r.width, r.height);
  if (!ready) {
    begin_blending(projection, false);
    for (std::size_t i = parts.size(); i-- > 0;) {
      SplatRange range = parts[i].range;
      range.first = parts[i].splats->total - range.first - range.count;
      range.near_first = false;
      if (range.count > 0) parts[i].splats->draw(range);
    }
  }
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Disable(GL_BLEND);
}

}  // namespace gs::render
