#include "render/volume/volume_store.h"

#include "base/finite.h"
#include "base/parallel.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace gs::render {
namespace {


constexpr std::size_t kUploaded = std::size_t{1} << 18;  // vectors that are uploaded at once
constexpr std::size_t kTask = 16384;
constexpr std::uint64_t kKeptPlaceFrames = 16;  // frames for which unused data still counts when the buffer grows

/// Returns two codes of 10 bits: the position on an octahedron unfolded to a square (Meyer et al. 2010).
glm::uvec2 volume_normal_codes(const glm::vec3& n) {
  const float size = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(size > 0) || !std::isfinite(size)) return glm::uvec2(VolumeCoding::kNoNormal);
  float u = n.x / size, v = n.y / size;
  if (n.z < 0) {
    const float folded = (1 - std::abs(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - std::abs(u)) * (v < 0 ? -1.0f : 1.0f);
    u = folded;
  }
  constexpr float half = 0.5f * static_cast<float>(VolumeCoding::kLargestNormal);
  const auto code = [](float c) {
    return static_cast<std::uint32_t>(std::lround(std::clamp(c, -1.0f, 1.0f) * half + half));
  };
  return {code(u), code(v)};
}

std::uint32_t weight_code(float weight, const VolumeCoding& coding) {
  if (!(weight > 0)) return 0;
  constexpr auto last = static_cast<float>(VolumeCoding::kLargestWeight);
  if (!std::isfinite(weight)) return VolumeCoding::kLargestWeight;
  const float code = coding.weight.y > 0 ? (std::log2(weight) - coding.weight.x) / coding.weight.y : 1.0f;
  return static_cast<std::uint32_t>(std::lround(std::clamp(code, 1.0f, last)));
}

}  // namespace

VolumeCoding volume_coding(const qnv::Volume& volume, std::size_t count) {
  VolumeCoding coding;
  Box box;
  float least = std::numeric_limits<float>::infinity(), most = 0;
  count = std::min(count, volume.size());
  for (std::size_t k = 0; k < count; ++k) {
    if (finite(volume.positions[k])) box.add(volume.positions[k]);
    const float weight = volume.weights[k];
    if (!(weight > 0) || !std::isfinite(weight)) continue;
    least = std::min(least, weight);
    most = std::max(most, weight);
  }
  if (!box.empty()) {
    coding.lower = box.lower;
    coding.step = box.size() * (1 / static_cast<float>(VolumeCoding::kLargestPosition));
    if (!finite(coding.step)) coding.step = glm::vec3(0);
  }
  if (most > 0) {
    const float low = std::log2(least);
    const float step = (std::log2(most) - low) / static_cast<float>(VolumeCoding::kLargestWeight - 1);
    coding.weight = {low - step, step};
  }
  return coding;
}

void encode_volume_codes(const qnv::Volume& volume, const VolumeCoding& coding, std::size_t first,
                         std::span<VolumeCode> codes) {
  glm::vec3 per_unit(0);
  for (int axis = 0; axis < 3; ++axis)
    if (coding.step[axis] > 0) per_unit[axis] = 1 / coding.step[axis];
  constexpr auto last = static_cast<float>(VolumeCoding::kLargestPosition);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    VolumeCode& code = codes[i];
    const std::size_t k = first + i;
    for (int axis = 0; axis < 3; ++axis) {
      // If the step is denormal, its reciprocal is infinite, and 0 times infinity is NaN.
      const float at = (volume.positions[k][axis] - coding.lower[axis]) * per_unit[axis];
      code[static_cast<std::size_t>(axis)] =
          static_cast<std::uint32_t>(std::lround(at >= 0 ? std::min(at, last) : 0.0f));
    }
    const glm::uvec2 normal = volume_normal_codes(volume.normals[k]);
    const std::uint32_t weight = weight_code(volume.weights[k], coding);
    code[0] |= normal.x << 20 | (weight & 3) << 30;
    code[1] |= normal.y << 20 | (weight >> 2 & 3) << 30;
    code[2] |= (weight >> 4) << 20;
    const qnv::Rgb8 color = volume.colors.empty() ? qnv::Rgb8{} : volume.colors[k];
    code[3] = std::uint32_t{color.r} | std::uint32_t{color.g} << 8 | std::uint32_t{color.b} << 16 |
              std::uint32_t{volume.classes.empty() ? std::uint8_t{255} : volume.classes[k]} << 24;
  }
}

VolumeStore::VolumeStore(const Gl& gl, std::size_t most_bytes)
    : gl_(gl), most_(most_bytes / kBytes), codes_(make_texture(gl)), spacings_(make_texture(gl)) {
  GLint texels = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  most_ = std::min(most_, static_cast<std::size_t>(std::max(texels, 0)));
}

bool VolumeStore::resize(std::size_t capacity) {
  entries_.clear();
  free_ = RangeAllocator(0);
  capacity_ = 0;
  take_errors(gl_);
  const auto make = [&](Buffer& buffer, const Texture& texture, std::size_t bytes, GLenum format) {
    buffer = {};
    buffer = make_buffer(gl_);
    gl_.BindBuffer(GL_TEXTURE_BUFFER, buffer.name());
    gl_.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr, GL_STATIC_DRAW);
    gl_.ActiveTexture(GL_TEXTURE0);
    gl_.BindTexture(GL_TEXTURE_BUFFER, texture.name());
    gl_.TexBuffer(GL_TEXTURE_BUFFER, format, buffer.name());
  };
  make(code_buffer_, codes_, capacity * sizeof(VolumeCode), GL_RGBA32UI);
  make(spacing_buffer_, spacings_, capacity * sizeof(float), GL_R32F);
  if (gl_.GetError() != GL_NO_ERROR) {
    take_errors(gl_);
    code_buffer_ = {};
    spacing_buffer_ = {};
    return false;
  }
  capacity_ = capacity;
  free_ = RangeAllocator(capacity);
  return true;
}

void VolumeStore::forget_unused() {
  ++frame_;
  std::erase_if(entries_, [&](const Entry& entry) {
    if (!entry.volume.expired()) return false;
    free_.give_back(entry.first, entry.count);
    return true;
  });
}

VolumeStore::Entry* VolumeStore::find(const SharedVolume& volume) {
  const auto same = [](const auto& a, const auto& b) { return !a.owner_before(b) && !b.owner_before(a); };
  for (Entry& entry : entries_) {
    if (!same(entry.volume, volume.volume)) continue;
    if (same(entry.model, volume.model)) return &entry;
    // The entry is for another prefix. Reuse its codes, unless this frame draws both prefixes.
    if (entry.used == frame_ || entry.count != volume.model->spacing.size()) continue;
    entry.model = volume.model;
    upload_spacings(*volume.volume, *volume.model, entry);
    return &entry;
  }
  return nullptr;
}

VolumeStore::Entry* VolumeStore::add(const SharedVolume& volume) {
  const std::size_t count = volume.model->spacing.size();
  std::optional<std::size_t> first = free_.take(count);
  while (!first) {
    // Free the data that was unused for the longest time, but not that of this frame.
    const auto oldest = std::min_element(entries_.begin(), entries_.end(),
                                         [](const Entry& a, const Entry& b) { return a.used < b.used; });
    if (oldest == entries_.end() || oldest->used + kKeptPlaceFrames >= frame_) return nullptr;
    free_.give_back(oldest->first, oldest->count);
    entries_.erase(oldest);
    first = free_.take(count);
  }
  entries_.push_back({volume.volume, volume.model, *first, count, volume_coding(*volume.volume, count), frame_});
  upload(*volume.volume, entries_.back());
  upload_spacings(*volume.volume, *volume.model, entries_.back());
  return &entries_.back();
}

std::vector<VolumeStore::Place> VolumeStore::place(std::span<const SharedVolume> volumes) {
  std::size_t needed = 0;
  for (const SharedVolume& volume : volumes) needed += volume.model->spacing.size();
  if (needed == 0 || needed > most_) return {};
  std::vector<Place> places;
  for (int attempt = 0; attempt < 2; ++attempt) {
    places.clear();
    for (const SharedVolume& volume : volumes) {
      Entry* entry = find(volume);
      if (!entry) entry = add(volume);
      if (!entry) break;
      entry->used = frame_;
      places.push_back({entry->first, entry->coding});
    }
    if (places.size() == volumes.size()) return places;
    // Enlarge the buffer. Leave room for the data of other viewports, which upload it again.
    std::size_t others = 0;
    for (const Entry& entry : entries_)
      if (entry.used != frame_ && entry.used + kKeptPlaceFrames >= frame_) others += entry.count;
    if (attempt > 0 || !resize(std::min(most_, needed + std::max(others, needed / 4)))) return {};
  }
  return {};
}

void VolumeStore::upload(const qnv::Volume& volume, const Entry& entry) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  std::vector<VolumeCode> codes(std::min(entry.count, kUploaded));
  gl_.BindBuffer(GL_TEXTURE_BUFFER, code_buffer_.name());
  for (std::size_t first = 0; first < entry.count; first += kUploaded) {
    const std::size_t part = std::min(kUploaded, entry.count - first);
    parallel_for((part + kTask - 1) / kTask, [&](std::size_t task) {
      const std::size_t at = task * kTask;
      encode_volume_codes(volume, entry.coding, first + at, std::span(codes).subspan(at, std::min(kTask, part - at)));
    });
    gl_.BufferSubData(GL_TEXTURE_BUFFER, static_cast<GLintptr>((entry.first + first) * sizeof(VolumeCode)),
                      static_cast<GLsizeiptr>(part * sizeof(VolumeCode)), codes.data());
  }
}

void VolumeStore::upload_spacings(const qnv::Volume& volume, const VolumeModel& model, const Entry& entry) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  std::vector<float> spacings = model.spacing;
  // Codes cannot mark a vector as invisible, so its spacing must.
  for (std::size_t k = 0; k < spacings.size(); ++k)
    if (!finite(volume.positions[k]) || !(volume.weights[k] >= 0)) spacings[k] = 0;
  gl_.BindBuffer(GL_TEXTURE_BUFFER, spacing_buffer_.name());
  gl_.BufferSubData(GL_TEXTURE_BUFFER, static_cast<GLintptr>(entry.first * sizeof(float)),
                    static_cast<GLsizeiptr>(spacings.size() * sizeof(float)), spacings.data());
}

}  // namespace gs::render
