#include "render/gl/texture_store.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace gs::render {
namespace {

constexpr GLenum kTextureMaxAnisotropy = 0x84FE;  // EXT_texture_filter_anisotropic
constexpr float kAnisotropy = 8;
constexpr std::size_t kOfMasks = 4;  // index of the first sampler for masks

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

}  // namespace

Image halved(const Image& image) {
  // Source of an output pixel along one axis: index of the first of up to three source pixels, and their weights.
  // `whole` is the sum of the weights.
  struct Cover {
    std::size_t first;
    std::array<std::uint32_t, 3> weights;
  };
  const auto cover = [](std::uint32_t from, std::uint32_t to) {
    std::vector<Cover> covers(to);
    for (std::uint32_t i = 0; i < to; ++i)
      covers[i] = from == 1       ? Cover{0, {1, 0, 0}}
                  : from % 2 == 0 ? Cover{std::size_t{2} * i, {1, 1, 0}}
                                  : Cover{std::size_t{2} * i, {to - i, to, i + 1}};
    return covers;
  };
  Image half{std::max(image.width / 2, 1u), std::max(image.height / 2, 1u), image.components, {}};
  half.pixels.resize(std::size_t{half.width} * half.height * half.components);
  const std::size_t components = image.components, stride = components * image.width;
  std::uint8_t* to = half.pixels.data();
  if (image.width % 2 == 0 && image.height % 2 == 0) {
    for (std::size_t y = 0; y < half.height; ++y) {
      const std::uint8_t* row = image.pixels.data() + 2 * y * stride;
      for (std::size_t x = 0; x < half.width; ++x, row += 2 * components)
        for (std::size_t c = 0; c < components; ++c)
          *to++ = static_cast<std::uint8_t>(
              (row[c] + row[c + components] + row[c + stride] + row[c + stride + components] + 2) / 4);
    }
    return half;
  }
  const std::vector<Cover> columns = cover(image.width, half.width), rows = cover(image.height, half.height);
  const auto whole = [](const Cover& part) {
    return std::uint64_t{part.weights[0]} + part.weights[1] + part.weights[2];
  };
  const std::uint64_t area = whole(rows[0]) * whole(columns[0]);
  for (const Cover& row : rows)
    for (const Cover& column : columns)
      for (std::size_t c = 0; c < components; ++c) {
        std::uint64_t sum = area / 2;
        for (std::size_t y = 0; y < 3 && row.weights[y] > 0; ++y)
          for (std::size_t x = 0; x < 3 && column.weights[x] > 0; ++x)
            sum += std::uint64_t{row.weights[y]} * column.weights[x] *
                   image.pixels[(row.first + y) * stride + (column.first + x) * components + c];
        *to++ = static_cast<std::uint8_t>(sum / area);
      }
  return half;
}

TextureStore::TextureStore(const Gl& gl) : gl_(gl) {
  for (std::size_t i = 0; i < samplers_.size(); ++i) {
    samplers_[i] = make_sampler(gl);
    const GLuint name = samplers_[i].name();
    gl.SamplerParameteri(name, GL_TEXTURE_WRAP_S, i & 1 ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    gl.SamplerParameteri(name, GL_TEXTURE_WRAP_T, i & 2 ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    gl.SamplerParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl.SamplerParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    if (i >= kOfMasks) {
      gl.SamplerParameteri(name, GL_TEXTURE_MIN_FILTER, i == kOfMasks ? GL_NEAREST : GL_LINEAR);
      gl.SamplerParameteri(name, GL_TEXTURE_MAG_FILTER, i == kOfMasks ? GL_NEAREST : GL_LINEAR);
    } else if (gl.max_anisotropy > 1) {
      gl.SamplerParameterf(name, kTextureMaxAnisotropy, std::min(gl.max_anisotropy, kAnisotropy));
    }
  }
}

const TextureStore::Entry* TextureStore::find(const std::shared_ptr<const Image>& image) {
  Entry& entry = entries_[image.get()];
  if (entry.image.expired()) {  // new entry, or the address of a deleted image
    entry = {};
    entry.image = image;
    if (can_be_uploaded(*image)) upload(*image, entry);
  } else if (entry.version != image->version && can_be_uploaded(*image)) {
    upload(*image, entry);
  }
  return entry.texture ? &entry : nullptr;
}

const TextureStore::Entry* TextureStore::find_mask(const std::shared_ptr<const Image>& image) {
  Entry& entry = entries_[image.get()];
  if (entry.image.expired()) {
    entry = {};
    entry.image = image;
    if (can_be_uploaded(*image) && image->components == 1) upload_mask(*image, entry);
  }
  return entry.texture ? &entry : nullptr;
}

void TextureStore::upload_mask(const Image& image, Entry& entry) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  entry.mask = entry.intensity = true;
  entry.alpha = Alpha::cut_out;
  entry.order = next_order_++;
  entry.texture = make_texture(gl_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, entry.texture.name());
  static constexpr GLint kSwizzle[] = {GL_ONE, GL_ONE, GL_ONE, GL_RED};
  gl_.TexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, kSwizzle);
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, static_cast<GLsizei>(image.width), static_cast<GLsizei>(image.height), 0,
                 GL_RED, GL_UNSIGNED_BYTE, image.pixels.data());
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

void TextureStore::forget_unused() {
  std::erase_if(entries_, [](const auto& entry) { return entry.second.image.expired(); });
}

void TextureStore::bind(const Entry& entry, bool repeat_s, bool repeat_t) {
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, entry.texture.name());
  gl_.BindSampler(0, samplers_[(repeat_s ? 1 : 0) | (repeat_t ? 2 : 0)].name());
}

void TextureStore::bind(const Entry& entry, const Sampling& sampling, GLuint unit) {
  gl_.ActiveTexture(GL_TEXTURE0 + unit);
  gl_.BindTexture(GL_TEXTURE_2D, entry.texture.name());
  gl_.ActiveTexture(GL_TEXTURE0);
  bind_sampler(sampling, unit);
}

void TextureStore::bind_sampler(const Sampling& sampling, GLuint unit) {
  constexpr std::size_t kMaxSamplers = 256;
  const auto known =
      std::find_if(own_samplers_.begin(), own_samplers_.end(), [&](const auto& one) { return one.first == sampling; });
  if (known != own_samplers_.end()) return gl_.BindSampler(unit, known->second.name());
  if (own_samplers_.size() >= kMaxSamplers) own_samplers_.clear();
  Sampler sampler = make_sampler(gl_);
  const GLuint name = sampler.name();
  static constexpr GLint kEdges[] = {GL_REPEAT, GL_CLAMP_TO_EDGE, GL_CLAMP_TO_BORDER, GL_MIRRORED_REPEAT};
  static constexpr GLint kFilters[] = {GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR, GL_NEAREST, GL_NEAREST_MIPMAP_NEAREST};
  gl_.SamplerParameteri(name, GL_TEXTURE_WRAP_S, kEdges[static_cast<std::size_t>(sampling.s)]);
  gl_.SamplerParameteri(name, GL_TEXTURE_WRAP_T, kEdges[static_cast<std::size_t>(sampling.t)]);
  gl_.SamplerParameteri(name, GL_TEXTURE_WRAP_R, kEdges[static_cast<std::size_t>(sampling.r)]);
  gl_.SamplerParameteri(name, GL_TEXTURE_MIN_FILTER, kFilters[static_cast<std::size_t>(sampling.smaller)]);
  gl_.SamplerParameteri(name, GL_TEXTURE_MAG_FILTER, sampling.smooth ? GL_LINEAR : GL_NEAREST);
  gl_.SamplerParameterfv(name, GL_TEXTURE_BORDER_COLOR, &sampling.border.x);
  const float anisotropy = sampling.anisotropy > 0 ? sampling.anisotropy : kAnisotropy;
  if (gl_.max_anisotropy > 1 && sampling.smaller == Sampling::Filter::linear_mipmap_linear)
    gl_.SamplerParameterf(name, kTextureMaxAnisotropy, std::clamp(anisotropy, 1.0f, gl_.max_anisotropy));
  gl_.BindSampler(unit, name);
  own_samplers_.emplace_back(sampling, std::move(sampler));
}

void TextureStore::bind_mask(const Entry& entry, bool smooth) {
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, entry.texture.name());
  gl_.BindSampler(0, samplers_[smooth ? kOfMasks + 1 : kOfMasks].name());
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
  // Reuse the texture storage for a movie frame of the same size.
  const bool in_place = entry.texture && entry.width == image->width && entry.height == image->height &&
                        entry.components == image->components;
  entry.version = given.version;
  entry.width = image->width;
  entry.height = image->height;
  entry.components = image->components;
  if (!entry.texture) {
    entry.order = next_order_++;
    entry.texture = make_texture(gl_);
  }
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
  const auto fill = [&](GLint level) {
    const auto width = static_cast<GLsizei>(image->width), height = static_cast<GLsizei>(image->height);
    if (in_place)
      gl_.TexSubImage2D(GL_TEXTURE_2D, level, 0, 0, width, height, kFormats[kind], GL_UNSIGNED_BYTE,
                        image->pixels.data());
    else
      gl_.TexImage2D(GL_TEXTURE_2D, level, kInternal[kind], width, height, 0, kFormats[kind], GL_UNSIGNED_BYTE,
                     image->pixels.data());
  };
  fill(0);
  if (gl_.software) {
    // Software drivers compile a shader for mipmaps and draw with it, which takes ten times as long as computing them
    // here.
    GLint level = 0;
    while (image->width > 1 || image->height > 1) {
      Image half = halved(*image);
      smaller = std::move(half);
      image = &smaller;
      fill(++level);
    }
  } else {
    gl_.GenerateMipmap(GL_TEXTURE_2D);
  }
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

}  // namespace gs::render
