#include "render/gaussians/gaussian_store.h"

#include "base/finite.h"
#include "base/parallel.h"

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

namespace gs::render {
namespace {

constexpr std::size_t kUploadedTexels = std::size_t{1} << 20;  // texels that are uploaded at once
constexpr std::size_t kEncodedRange = 8192;                    // splats per task
constexpr std::uint64_t kKeptSceneFrames = 16;  // frames for which unused data still counts when the buffer grows
// Maximum of colours and coefficients. Larger ones are not colours; they would only make all others less precise.
constexpr float kMostColor = 64;

float largest_color(const std::vector<glm::vec3>& colors) {
  float most = 0;
  for (const glm::vec3& color : colors)
    for (int c = 0; c < 3; ++c)
      if (const float size = std::abs(color[c]); size <= kMostColor) most = std::max(most, size);
  return most > 0 ? most : 1;
}

std::uint32_t signed_code(float value, float per_limit) {
  constexpr float last = 32767;
  const float code = std::clamp(value * per_limit, -1.0f, 1.0f) * last;
  return static_cast<std::uint32_t>(static_cast<int>(code + (code < 0 ? -0.5f : 0.5f))) & 0xFFFF;
}

std::uint32_t scale_code(float scale, const GaussianCoding& coding) {
  if (!(scale > 0)) return 0;
  constexpr float last = 65535;
  const float code = coding.scale.y > 0 ? (std::log2(scale) - coding.scale.x) / coding.scale.y : 1.0f;
  return static_cast<std::uint32_t>(std::clamp(code, 1.0f, last) + 0.5f);
}

/// Returns three components of a rotation, 16 bits each, and the index of the largest, which is missing.
std::array<std::uint32_t, 3> rotation_codes(glm::vec4 q) {
  const float size = std::sqrt(glm::dot(q, q));
  q = size > 0 ? q / size : glm::vec4(0, 0, 0, 1);
  int largest = 0;
  for (int i = 1; i < 4; ++i)
    if (std::abs(q[i]) > std::abs(q[largest])) largest = i;
  if (q[largest] < 0) q = -q;
  std::array<std::uint32_t, 3> codes{};
  std::size_t next = 0;
  for (int i = 0; i < 4; ++i) {
    if (i == largest) continue;
    // The other components are at most sqrt(1/2).
    const float part = std::clamp(q[i] * 1.41421356f, -1.0f, 1.0f) * 0.5f + 0.5f;
    codes[next++] = static_cast<std::uint32_t>(part * 32766 + 0.5f);
  }
  codes[0] |= (static_cast<std::uint32_t>(largest) & 1) << 15;
  codes[1] |= (static_cast<std::uint32_t>(largest) >> 1) << 15;
  return codes;
}

bool is_whole(const qnv::Gaussians& g) {
  const std::size_t count = g.size();
  return g.scales.size() == count && g.rotations.size() == count && g.opacities.size() == count &&
         g.bases.size() == count && g.degree >= 0 && g.degree <= qnv::Gaussians::kMaxDegree &&
         g.harmonics.size() == count * qnv::harmonic_count(g.degree);
}

}  // namespace

GaussianCoding gaussian_coding(const qnv::Gaussians& gaussians) {
  GaussianCoding coding;
  coding.degree = gaussians.degree;
  coding.texels = 2 + (qnv::harmonic_count(coding.degree) + 1) / 2;
  float least = std::numeric_limits<float>::max(), most = 0;
  for (const glm::vec3& scale : gaussians.scales) {
    coding.surfels = coding.surfels || !(scale.z > 0);
    for (int i = 0; i < 3; ++i)
      if (scale[i] > 0 && std::isfinite(scale[i])) {
        least = std::min(least, scale[i]);
        most = std::max(most, scale[i]);
      }
  }
  if (most > 0) {
    const float low = std::log2(least), step = (std::log2(most) - low) / 65534;
    coding.scale = {low - step, step};
  }
  coding.base_limit = largest_color(gaussians.bases);
  coding.harmonic_limit = largest_color(gaussians.harmonics);
  return coding;
}

void encode_gaussians(const qnv::Gaussians& g, const GaussianCoding& coding, std::size_t first,
                      std::span<GaussianTexel> texels) {
  const std::size_t per = qnv::harmonic_count(coding.degree);
  const float per_base = 1 / coding.base_limit, per_harmonic = 1 / coding.harmonic_limit;
  for (std::size_t at = 0, i = first; at + coding.texels <= texels.size(); at += coding.texels, ++i) {
    const glm::vec3 &p = g.positions[i], &s = g.scales[i], &base = g.bases[i];
    const glm::vec4& q = g.rotations[i];
    bool visible = finite(p) && finite(s) && finite(base) && std::isfinite(glm::dot(q, q));
    for (std::size_t k = 0; k < per && visible; ++k) visible = finite(g.harmonics[i * per + k]);
    if (!visible) {
      std::fill_n(texels.begin() + static_cast<std::ptrdiff_t>(at), coding.texels, GaussianTexel{});
      continue;
    }
    const float opacity = g.opacities[i] > 0 ? std::min(g.opacities[i], 1.0f) : 0.0f;
    const auto rotation = rotation_codes(q);
    texels[at] = {std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                  std::bit_cast<std::uint32_t>(p.z),
                  static_cast<std::uint32_t>(opacity * 65535 + 0.5f) | signed_code(base.x, per_base) << 16};
    texels[at + 1] = {scale_code(s.x, coding) | scale_code(s.y, coding) << 16,
                      scale_code(s.z, coding) | signed_code(base.y, per_base) << 16,
                      signed_code(base.z, per_base) | rotation[0] << 16, rotation[1] | rotation[2] << 16};
    for (std::size_t k = 0; k < per; ++k) {
      const glm::vec3& c = g.harmonics[i * per + k];
      GaussianTexel& texel = texels[at + 2 + k / 2];
      if (k % 2 == 0) texel = {};
      texel[k % 2 * 2] = signed_code(c.x, per_harmonic) | signed_code(c.y, per_harmonic) << 16;
      texel[k % 2 * 2 + 1] = signed_code(c.z, per_harmonic);
    }
  }
}

GaussianStore::GaussianStore(const Gl& gl, std::size_t most_bytes)
    : gl_(gl), most_(most_bytes / sizeof(GaussianTexel)), codes_(make_texture(gl)) {
  GLint texels = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  most_ = std::min(most_, static_cast<std::size_t>(std::max(texels, 0)));
}

void GaussianStore::forget_unused() {
  ++frame_;
  std::erase_if(entries_, [&](const auto& held) {
    if (!held.first.expired()) return false;
    release(held.second);
    return true;
  });
}

void GaussianStore::release(const Entry& entry) {
  if (entry.present) free_.give_back(entry.place.first, entry.count);
}

bool GaussianStore::resize(std::size_t capacity) {
  for (auto& [gaussians, entry] : entries_) entry.present = false;
  free_ = RangeAllocator(0);
  capacity_ = 0;
  take_errors(gl_);
  buffer_ = {};
  buffer_ = make_buffer(gl_);
  gl_.BindBuffer(GL_TEXTURE_BUFFER, buffer_.name());
  gl_.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(capacity * sizeof(GaussianTexel)), nullptr, GL_STATIC_DRAW);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_BUFFER, codes_.name());
  gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32UI, buffer_.name());
  if (take_errors(gl_)) {
    buffer_ = {};
    return false;
  }
  capacity_ = capacity;
  free_ = RangeAllocator(capacity);
  return true;
}

// Finds room for an entry. If necessary, frees data that recent frames did not use.
bool GaussianStore::allocate(Entry& entry) {
  std::optional<std::size_t> first = free_.take(entry.count);
  if (!first) {
    for (auto& [gaussians, other] : entries_)
      if (other.present && other.used + kKeptSceneFrames < frame_) {
        release(other);
        other.present = false;
      }
    first = free_.take(entry.count);
  }
  if (!first) return false;
  entry.place.first = *first;
  entry.present = true;
  return true;
}

std::vector<GaussianStore::Place> GaussianStore::place(std::span<const std::shared_ptr<const qnv::Gaussians>> scenes) {
  std::vector<Held*> all;
  std::size_t needed = 0;
  ++placing_;
  for (const auto& scene : scenes) {
    if (!is_whole(*scene) || scene->empty()) return {};
    auto found = entries_.find(scene);
    if (found == entries_.end()) {
      Entry fresh;
      fresh.place.coding = gaussian_coding(*scene);
      fresh.count = scene->size() * fresh.place.coding.texels;
      found = entries_.emplace(scene, fresh).first;
    }
    Entry& entry = found->second;
    // Counts Gaussians once, because all of their parts share the data.
    if (entry.placed != placing_) needed += entry.count;
    entry.placed = placing_;
    entry.used = frame_;
    all.push_back(&*found);
  }
  if (needed == 0 || needed > most_) return {};
  for (int attempt = 0; attempt < 2; ++attempt) {
    std::vector<Held*> fresh;
    bool fits = true;
    for (Held* const held : all) {
      if (held->second.present) continue;
      fits = allocate(held->second);
      if (!fits) break;
      fresh.push_back(held);
    }
    upload(std::move(fresh));
    if (fits) {
      std::vector<Place> places;
      for (const Held* const held : all) places.push_back(held->second.place);
      return places;
    }
    // Enlarges the buffer. Leaves room for later cuts and for other viewports, which must upload their data again.
    std::size_t others = needed / 2;
    for (const auto& [gaussians, entry] : entries_)
      if (entry.used != frame_ && entry.used + kKeptSceneFrames >= frame_) others += entry.count;
    if (attempt > 0 || !resize(std::min(most_, needed + others))) return {};
  }
  return {};
}

// Uploads the data of new entries. Uploads entries that are adjacent in the buffer together.
void GaussianStore::upload(std::vector<Held*> fresh) {
  if (fresh.empty()) return;
  const PhaseScope phase(gl_.phases, Phase::upload);
  std::ranges::sort(fresh, {}, [](const Held* held) { return held->second.place.first; });
  /// Range of splats of one entry in an upload.
  struct Part {
    std::shared_ptr<const qnv::Gaussians> gaussians;
    const Entry* entry;
    std::size_t first, count, to;  // `to` is the texel in the upload
  };
  std::vector<Part> parts;
  std::vector<GaussianTexel> texels;
  std::size_t begin = 0, size = 0;  // first texel and number of texels of the upload
  gl_.BindBuffer(GL_TEXTURE_BUFFER, buffer_.name());
  const auto flush = [&] {
    texels.resize(size);
    parallel_for(parts.size(), [&](std::size_t i) {
      const Part& part = parts[i];
      const GaussianCoding& coding = part.entry->place.coding;
      encode_gaussians(*part.gaussians, coding, part.first,
                       std::span(texels).subspan(part.to, part.count * coding.texels));
    });
    if (size > 0)
      gl_.BufferSubData(GL_TEXTURE_BUFFER, static_cast<GLintptr>(begin * sizeof(GaussianTexel)),
                        static_cast<GLsizeiptr>(size * sizeof(GaussianTexel)), texels.data());
    parts.clear();
    size = 0;
  };
  for (const Held* const held : fresh) {
    const Entry& entry = held->second;
    const auto gaussians = held->first.lock();
    const std::size_t per = entry.place.coding.texels;
    for (std::size_t first = 0; gaussians && first < gaussians->size(); first += kEncodedRange) {
      const std::size_t count = std::min(kEncodedRange, gaussians->size() - first),
                        at = entry.place.first + first * per;
      if (size >= kUploadedTexels || (size > 0 && begin + size != at)) flush();
      if (size == 0) begin = at;
      parts.push_back({gaussians, &entry, first, count, size});
      size += count * per;
    }
  }
  flush();
}

}  // namespace gs::render
