#include "render/splat/splat_gl.h"

#include "render/gl/shaders.h"
#include "render/splat/software/splat_constants.h"
#include "render/splat/splat_shaders.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

// Part of SplatGl that makes programs and framebuffers.
namespace gs::render {
namespace {

constexpr std::size_t kMaxTargetBytes = std::size_t{1} << 30;

std::string constants(std::size_t pieces_a_row) {
  std::string text;
  for (const auto& [name, value] : {std::pair{"BACK_MARGIN", splat::kBackMargin},
                                    {"CUBE_MARGIN", splat::kCubeMargin},
                                    {"SAMPLE_MARGIN", splat::kSampleMargin},
                                    {"CUBE_BELL", splat::kCubeBell},
                                    {"DISC_COVER", splat::kDiscCover},
                                    {"DISC_BELL", splat::kDiscBell},
                                    {"LEAST_REACH", splat::kMinReach},
                                    {"GRAZING", splat::kGrazing},
                                    {"SMOOTHING", splat::kSmoothing},
                                    {"OFFSET_RANGE", SplatCoding::kOffsetRange},
                                    {"PI", splat::kPi}}) {
    // std::to_string would depend on the locale. The parentheses protect the sign.
    const auto billionths = std::llround(std::abs(double{value}) * 1e9);
    const std::string digits = std::to_string(billionths % 1'000'000'000 + 1'000'000'000).substr(1);
    text += std::string("#define ") + name + (value < 0 ? " (-" : " (") + std::to_string(billionths / 1'000'000'000) +
            "." + digits + ")\n";
  }
  return text + "#define PIECES_A_ROW " + std::to_string(pieces_a_row) + "\n";
}

}  // namespace

const SplatGl::Shader* SplatGl::shader(Stage stage, const Kind& kind) {
  // Keep only the flags that affect this stage, so that no program is made twice.
  const bool discs = stage != Stage::resolve, blended = stage != Stage::depth;
  const std::array<std::pair<bool, const char*>, 5> flags{{{discs && kind.cells, "CELLS"},
                                                           {discs && kind.sides, "SIDES"},
                                                           {stage == Stage::resolve && kind.colored, "COLORS"},
                                                           {blended && kind.smooth, "SMOOTH"},
                                                           {stage == Stage::blend, "BLEND"}}};
  unsigned key = static_cast<unsigned>(stage);
  for (const auto& [set, name] : flags) key = key * 2 + (set ? 1 : 0);
  const auto [found, fresh] = shaders_.try_emplace(key);
  Shader& entry = found->second;
  if (fresh) {
    std::string defines = constants(kPiecesARow);
    for (const auto& [set, name] : flags)
      if (set) defines += std::string("#define ") + name + "\n";
    const char* fragment = stage == Stage::depth   ? kSplatDepthFragmentShader
                           : stage == Stage::blend ? kSplatBlendFragmentShader
                                                   : kSplatResolveFragmentShader;
    const std::string vertex =
        discs ? std::string(kSplatVectorShader) + kSplatDiscVertexShader : std::string(kScreenVertexShader);
    auto made = make_program(gl_, defines, vertex, fragment);
    if (auto* program = std::get_if<Program>(&made)) {
      entry.program = std::move(*program);
      static constexpr std::array<const char*, uniform_count> kNames{
          "vectors",       "cells",       "pieces",      "stride",    "color_by_normal", "row_x",       "row_y",
          "row_z",         "tangents",    "middle",      "margin",    "near_plane",      "sample_size", "ray_origin",
          "ray_right",     "ray_up",      "nearest",     "sums",      "color_sums",      "slopes",      "tilts",
          "normal_matrix", "supersample", "clip_planes", "clip_count"};
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
  return samples * a_sample + pixels * 16 <= kMaxTargetBytes;
}

bool SplatGl::make_targets(const SplatView& view, const Kind& kind) {
  Targets& t = targets_;
  const bool same = t.width == view.width && t.height == view.height && t.samples == view.supersample;
  if (same && (t.colored || !kind.colored) && (t.smooth || !kind.smooth)) return t.resolve_pass.name() != 0;
  Targets made;
  made.width = view.width;
  made.height = view.height;
  made.samples = view.supersample;
  // Keep attachments that only earlier splat items needed: later items of the image will need them again.
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
  // Half floats would overflow if thousands of splats overlap in a sample.
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
    // Record the size even after a failure, so that later frames do not try again.
    t.width = made.width;
    t.height = made.height;
    t.samples = made.samples;
    t.colored = t.smooth = true;
  }
  return good;
}

}  // namespace gs::render
