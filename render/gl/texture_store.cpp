#include "render/gl/texture_store.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace gs::render {
namespace {

constexpr GLenum kTextureMaxAnisotropy = 0x84FE;  // EXT_texture_filter_anisotropic
constexpr float kAnisotropy = 8;

bool can_be_uploaded(const Image& image) {
  return image.width > 0 && image.height > 0 && image.components >= 1 && image.components <= 4 &&
         image.pixels.size() / image.width / image.height == image.components &&
         image.pixels.size() % (std::size_t{image.width} * image.height) == 0;
}

TextureStore::Alpha alpha_of(const Image& image) {
  if (!image.has_alpha()) return TextureStore::Alpha::none;
  auto result = TextureStore::Alpha::none;
  for (std::size_t i = image.components - 1; i < image.pixels.size(); i += image.components) {
    const std::uint8_t alpha = image.pixels[i];
    if (alpha == 255) continue;
    if (alpha != 0) return TextureStore::Alpha::blended;
    result = TextureStore::Alpha::cut_out;
  }
  return result;
}

/// Half as large in each direction in which it has more than one pixel; 2 x 2 means.
Image halved(const Image& image) {
  Image half{std::max(image.width / 2, 1u), std::max(image.height / 2, 1u), image.components, {}};
  half.pixels.resize(std::size_t{half.width} * half.height * half.components);
  const std::size_t components = image.components;
  const std::size_t step_x = image.width > 1 ? components : 0, step_y = image.height > 1 ? components * image.width : 0;
  std::uint8_t* to = half.pixels.data();
  for (std::size_t y = 0; y < half.height; ++y) {
    const std::uint8_t* row = image.pixels.data() + 2 * y * step_y;
    for (std::size_t x = 0; x < half.width; ++x)
      for (std::size_t c = 0; c < components; ++c) {
        const std::uint8_t* from = row + 2 * x * step_x + c;
        *to++ = static_cast<std::uint8_t>((from[0] + from[step_x] + from[step_y] + from[step_x + step_y] + 2) / 4);
      }
  }
  return half;
}

}  // namespace

TextureStore::TextureStore(const Gl& gl) : gl_(gl) {
  for (std::size_t i = 0; i < samplers_.size(); ++i) {
    samplers_[i] = make_sampler(gl);
    const GLuint name = samplers_[i].name();
    gl.SamplerParameteri(name, GL_TEXTURE_WRAP_S, i & 1 ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    gl.SamplerParameteri(name, GL_TEXTURE_WRAP_T, i & 2 ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    gl.SamplerParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl.SamplerParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    if (gl.max_anisotropy > 1)
      gl.SamplerParameterf(name, kTextureMaxAnisotropy, std::min(gl.max_anisotropy, kAnisotropy));
  }
}

const TextureStore::Entry* TextureStore::find(const std::shared_ptr<const Image>& image) {
  Entry& entry = entries_[image.get()];
  if (entry.image.expired()) {  // new, or another image lay at the same address
    entry = {};
    entry.image = image;
    if (can_be_uploaded(*image)) upload(*image, entry);
  }
  return entry.texture ? &entry : nullptr;
}

void TextureStore::forget_unused() {
  std::erase_if(entries_, [](const auto& entry) { return entry.second.image.expired(); });
}

void TextureStore::bind(const Entry& entry, bool repeat_s, bool repeat_t) {
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, entry.texture.name());
  gl_.BindSampler(0, samplers_[(repeat_s ? 1 : 0) | (repeat_t ? 2 : 0)].name());
}

void TextureStore::upload(const Image& given, Entry& entry) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  const Image* image = &given;
  Image smaller;
  const auto most = static_cast<std::uint32_t>(gl_.max_texture_size);
  while (image->width > most || image->height > most) {
    Image half = halved(*image);
    smaller = std::move(half);
    image = &smaller;
  }
  entry.alpha = alpha_of(given);
  entry.intensity = given.components <= 2;
  entry.order = next_order_++;
  entry.texture = make_texture(gl_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, entry.texture.name());
  static constexpr GLenum kFormats[] = {GL_RED, GL_RG, GL_RGB, GL_RGBA};
  static constexpr GLint kInternal[] = {GL_R8, GL_RG8, GL_RGB8, GL_RGBA8};
  static constexpr GLint kSwizzles[][4] = {{GL_RED, GL_RED, GL_RED, GL_ONE},
                                           {GL_RED, GL_RED, GL_RED, GL_GREEN},
                                           {GL_RED, GL_GREEN, GL_BLUE, GL_ONE},
                                           {GL_RED, GL_GREEN, GL_BLUE, GL_ALPHA}};
  const std::size_t kind = image->components - 1;
  gl_.TexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, kSwizzles[kind]);
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, kInternal[kind], static_cast<GLsizei>(image->width),
                 static_cast<GLsizei>(image->height), 0, kFormats[kind], GL_UNSIGNED_BYTE, image->pixels.data());
  if (gl_.software) {
    // Drivers on the processor compile a shader for that and draw with it: ten times as long.
    GLint level = 0;
    while (image->width > 1 || image->height > 1) {
      Image half = halved(*image);
      smaller = std::move(half);
      image = &smaller;
      gl_.TexImage2D(GL_TEXTURE_2D, ++level, kInternal[kind], static_cast<GLsizei>(image->width),
                     static_cast<GLsizei>(image->height), 0, kFormats[kind], GL_UNSIGNED_BYTE, image->pixels.data());
    }
  } else {
    gl_.GenerateMipmap(GL_TEXTURE_2D);
  }
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

}  // namespace gs::render
