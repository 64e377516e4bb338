#include "render/splat/splat_store.h"

#include "base/finite.h"
#include "base/parallel.h"
#include "render/splat/software/splat_constants.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace gs::render {
namespace {

constexpr float kLargestPosition = 1048575, kLargestLength = 65535, kLargestNormal = 8191;  // largest codes
constexpr std::size_t kUploadDiscs = std::size_t{1} << 20;                                  // splats per upload
constexpr std::uint32_t kTaskDiscs = 16384;
constexpr std::size_t kMinRange = 1024;  // minimum splats of a range

bool can_be_drawn(const glm::vec3& position, const glm::vec3& normal, float weight) {
  const float size = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  return finite(position) && size > 0 && std::isfinite(size) && weight >= 0 && std::isfinite(weight);
}

float radius_of(float weight) {
  return std::sqrt(std::max(weight, std::numeric_limits<float>::min()) * (1 / splat::kPi));
}

/// Returns a logarithmic coding. Code 1 is `smallest`, the last code is `largest`.
glm::vec2 logarithms(float smallest, float largest) {
  const float low = std::log2(smallest), step = (std::log2(largest) - low) / (kLargestLength - 1);
  return {low - step, step};
}

std::uint32_t length_code(float length, const glm::vec2& coding) {
  const float code = coding.y > 0 ? (std::log2(length) - coding.x) / coding.y : 1;
  return static_cast<std::uint32_t>(std::lround(std::clamp(code, 1.0f, kLargestLength)));
}

/// Returns two codes of 14 bits: the position on an octahedron unfolded to a square (Meyer et al. 2010).
std::array<std::uint32_t, 2> splat_normal_codes(const glm::vec3& n) {
  const float size = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  float u = n.x / size, v = n.y / size;
  if (n.z < 0) {
    const float folded = (1 - std::abs(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - std::abs(u)) * (v < 0 ? -1.0f : 1.0f);
    u = folded;
  }
  const auto code = [](float c) {
    return static_cast<std::uint32_t>(std::lround(std::clamp(c, -1.0f, 1.0f) * kLargestNormal + kLargestNormal));
  };
  return {code(u), code(v)};
}

std::size_t bytes_of(bool cells) { return sizeof(SplatCode) + (cells ? sizeof(CellCode) : 0); }

bool has_cube(const qnv::Cell& cell) { return cell.edge > 0 && std::isfinite(cell.edge); }

}  // namespace

std::optional<SplatCoding> splat_coding(const qnv::Splats& splats) {
  const std::size_t count = splats.size();
  if (splats.normals.size() != count || splats.weights.size() != count) return std::nullopt;
  if (!splats.colors.empty() && splats.colors.size() != count) return std::nullopt;
  if (!splats.cells.empty() && splats.cells.size() != count) return std::nullopt;
  Box box;
  float smallest = std::numeric_limits<float>::max(), largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!can_be_drawn(splats.positions[i], splats.normals[i], splats.weights[i])) continue;
    box.add(splats.positions[i]);
    smallest = std::min(smallest, splats.weights[i]);
    largest = std::max(largest, splats.weights[i]);
  }
  if (box.empty() || !finite(box.size())) return std::nullopt;
  SplatCoding coding;
  coding.lower = box.lower;
  coding.step = box.size() / kLargestPosition;
  coding.radius = logarithms(radius_of(smallest), radius_of(largest));
  coding.largest_radius = radius_of(largest);
  float shortest = std::numeric_limits<float>::max(), longest = 0;
  for (const qnv::Cell& cell : splats.cells) {
    if (!has_cube(cell)) continue;
    shortest = std::min(shortest, cell.edge);
    longest = std::max(longest, cell.edge);
  }
  if (longest > 0) {
    coding.edge = logarithms(shortest, longest);
    for (const qnv::Cell& cell : splats.cells)
      if (has_cube(cell) && std::isfinite(cell.offset))
        coding.reach = std::max(coding.reach, std::min(std::abs(cell.offset), cell.edge * SplatCoding::kOffsetRange));
    coding.reach += longest * 1.1f;
  }
  return coding;
}

void encode_splats(const qnv::Splats& splats, const SplatCoding& coding, std::size_t first,
                   std::span<SplatCode> codes) {
  glm::vec3 per_unit(0);
  for (int axis = 0; axis < 3; ++axis)
    if (coding.step[axis] > 0) per_unit[axis] = 1 / coding.step[axis];
  for (std::size_t i = 0; i < codes.size(); ++i) {
    SplatCode& code = codes[i];
    code = {};
    const glm::vec3& position = splats.positions[first + i];
    const glm::vec3& normal = splats.normals[first + i];
    const float weight = splats.weights[first + i];
    if (!can_be_drawn(position, normal, weight)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      // If the step is denormal, its reciprocal is infinite, and 0 times infinity is NaN.
      const float at = (position[axis] - coding.lower[axis]) * per_unit[axis];
      code[static_cast<std::size_t>(axis)] =
          static_cast<std::uint32_t>(std::lround(at >= 0 ? std::min(at, kLargestPosition) : 0.0f));
    }
    const auto [u, v] = splat_normal_codes(normal);
    const std::uint32_t radius = length_code(radius_of(weight), coding.radius);
    const qnv::Rgb8& color = splats.colors.empty() ? splats.color : splats.colors[first + i];
    code[0] |= u << 20;
    code[1] |= v << 20;
    code[2] |= radius << 20;
    code[3] = std::uint32_t{color.r} | std::uint32_t{color.g} << 8 | std::uint32_t{color.b} << 16 | (u >> 12) << 24 |
              (v >> 12) << 26 | (radius >> 12) << 28;
  }
}

void encode_cells(const qnv::Splats& splats, const SplatCoding& coding, std::size_t first, std::span<CellCode> codes) {
  for (std::size_t i = 0; i < codes.size(); ++i) {
    codes[i] = 0;
    const qnv::Cell& cell = splats.cells[first + i];
    if (!has_cube(cell)) continue;
    float offset = cell.offset / (cell.edge * SplatCoding::kOffsetRange);
    offset = std::isfinite(offset) ? std::clamp(offset, -1.0f, 1.0f) : 0.0f;
    codes[i] = length_code(cell.edge, coding.edge) | static_cast<std::uint32_t>(std::lround(offset * 32767 + 32767))
                                                         << 16;
  }
}

std::size_t most_buffer_texels(const Gl& gl) {
  GLint most = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  return static_cast<std::size_t>(std::max(most, 65536));  // minimum that OpenGL 3.3 guarantees (table 6.41)
}

Texture make_buffer_texture(const Gl& gl, const Buffer& buffer, GLenum format) {
  Texture texture = make_texture(gl);
  gl.BindTexture(GL_TEXTURE_BUFFER, texture.name());
  gl.TexBuffer(GL_TEXTURE_BUFFER, format, buffer.name());
  return texture;
}

SplatStore::SplatStore(const Gl& gl, std::size_t most_bytes, std::size_t slab_discs)
    : gl_(gl), most_bytes_(most_bytes), slab_discs_(std::clamp<std::size_t>(slab_discs, 1, most_buffer_texels(gl))) {}

const SplatStore::Entry* SplatStore::find(const qnv::Splats* splats) const {
  const auto found = entries_.find(splats);
  return found == entries_.end() ? nullptr : &found->second;
}

bool SplatStore::add(std::span<const std::shared_ptr<const qnv::Splats>> sets) {
  std::vector<Upload> uploads;
  for (const auto& splats : sets) {
    Entry& entry = entries_[splats.get()];
    // If the splats have expired, the entry belonged to other splats at this address.
    if (entry.splats.expired()) {
      give_back(entry);
      entry = {};
      entry.splats = splats;
      uploads.push_back({splats.get(), &entry});  // entries of a std::map do not move
    }
    entry.used = frame_;
  }
  if (uploads.empty()) return true;
  parallel_for(
      uploads.size(), [&](std::size_t i) { uploads[i].entry->coding = splat_coding(*uploads[i].splats); }, 0);
  bool good = true;
  take_errors(gl_);
  std::erase_if(uploads, [&](const Upload& upload) {
    if (!upload.entry->coding) return true;
    upload.entry->discs = upload.splats->size();
    upload.entry->cells = !upload.splats->cells.empty();
    if (place(*upload.entry)) return false;
    entries_.erase(upload.splats);
    good = false;
    return true;
  });
  upload(uploads);
  return !take_errors(gl_) && good;
}

// Allocates memory for all splats of a geometry. Allocates nothing and returns false if it does not suffice.
bool SplatStore::place(Entry& entry) {
  std::size_t left = entry.discs, want = std::min(left, slab_discs_);
  while (left > 0) {
    want = std::min(want, left);
    if (const auto range = take(want, entry.cells)) {
      entry.ranges.push_back(*range);
      left -= range->count;
    } else if (want > kMinRange) {
      want /= 2;  // smaller ranges may still fit
    } else {
      give_back(entry);
      return false;
    }
  }
  return true;
}

std::optional<SplatStore::Range> SplatStore::take(std::size_t discs, bool cells) {
  do {
    for (std::size_t i = 0; i < slabs_.size(); ++i) {
      Slab* slab = slabs_[i].get();
      if (!slab || static_cast<bool>(slab->cells) != cells) continue;
      const auto first = slab->free.take(discs);
      if (!first) continue;
      slab->discs += discs;
      bytes_ += discs * bytes_of(cells);
      return Range{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(*first),
                   static_cast<std::uint32_t>(discs)};
    }
  } while (make_slab(cells) || make_room());
  return std::nullopt;
}

bool SplatStore::make_slab(bool cells) {
  const std::size_t bytes = slab_discs_ * bytes_of(cells);
  if (reserved_bytes_ + bytes > most_bytes_) return false;
  auto slab = std::make_unique<Slab>(Slab{{}, {}, {}, {}, RangeAllocator(slab_discs_), 0});
  const auto make = [&](Buffer& buffer, Texture& texture, std::size_t size, GLenum format) {
    buffer = make_buffer(gl_);
    gl_.BindBuffer(GL_TEXTURE_BUFFER, buffer.name());
    gl_.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(size), nullptr, GL_STATIC_DRAW);
    texture = make_buffer_texture(gl_, buffer, format);
  };
  make(slab->codes, slab->codes_texture, slab_discs_ * sizeof(SplatCode), GL_RGBA32UI);
  if (cells) make(slab->cells, slab->cells_texture, slab_discs_ * sizeof(CellCode), GL_R32UI);
  if (take_errors(gl_)) return false;
  reserved_bytes_ += bytes;
  const auto hole = std::find(slabs_.begin(), slabs_.end(), nullptr);
  (hole == slabs_.end() ? slabs_.emplace_back() : *hole) = std::move(slab);
  return true;
}

// Frees the splats that were unused for the longest time, but not those of this frame. Returns false if none can be
// freed.
bool SplatStore::make_room() {
  std::uint64_t oldest = frame_;
  for (const auto& [splats, entry] : entries_)
    if (!entry.ranges.empty()) oldest = std::min(oldest, entry.used);
  if (oldest == frame_) return false;
  std::erase_if(entries_, [&](const auto& item) {
    if (item.second.used != oldest) return false;
    give_back(item.second);
    return true;
  });
  drop_empty_slabs();
  return true;
}

void SplatStore::give_back(const Entry& entry) {
  for (const Range& range : entry.ranges) {
    Slab& slab = *slabs_[range.slab];
    slab.free.give_back(range.first, range.count);
    slab.discs -= range.count;
    bytes_ -= range.count * bytes_of(entry.cells);
  }
}

void SplatStore::drop_empty_slabs() {
  for (auto& slab : slabs_) {
    if (!slab || slab->discs > 0) continue;
    reserved_bytes_ -= slab_discs_ * bytes_of(static_cast<bool>(slab->cells));
    slab.reset();
  }
}

void SplatStore::forget_unused() {
  ++frame_;
  std::erase_if(entries_, [&](const auto& item) {
    if (!item.second.splats.expired()) return false;
    give_back(item.second);
    return true;
  });
  drop_empty_slabs();
}

void SplatStore::upload(std::span<const Upload> uploads) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  // Part of a range that one task encodes.
  struct Task {
    const Upload* upload;
    std::size_t from;  // index of the first splat in the geometry
    Range to;
    std::size_t at;  // index of the first splat in `codes`
  };
  std::vector<Task> tasks;
  std::vector<SplatCode> codes;
  std::vector<CellCode> cells;
  std::size_t discs = 0;
  const auto flush = [&] {
    codes.resize(std::max(codes.size(), discs));
    cells.resize(codes.size());
    parallel_for(
        tasks.size(),
        [&](std::size_t t) {
          const auto& [upload, from, to, at] = tasks[t];
          encode_splats(*upload->splats, *upload->entry->coding, from, std::span(codes).subspan(at, to.count));
          if (upload->entry->cells)
            encode_cells(*upload->splats, *upload->entry->coding, from, std::span(cells).subspan(at, to.count));
        },
        0);
    for (std::size_t t = 0; t < tasks.size();) {
      // Upload consecutive ranges at once.
      const Range& first = tasks[t].to;
      std::size_t end = t, count = 0;
      while (end < tasks.size() && tasks[end].to.slab == first.slab && tasks[end].to.first == first.first + count)
        count += tasks[end++].to.count;
      const auto put = [&](const Buffer& buffer, const auto* values) {
        gl_.BindBuffer(GL_TEXTURE_BUFFER, buffer.name());
        gl_.BufferSubData(GL_TEXTURE_BUFFER, static_cast<GLintptr>(first.first * sizeof *values),
                          static_cast<GLsizeiptr>(count * sizeof *values), values + tasks[t].at);
      };
      const Slab& slab = *slabs_[first.slab];
      put(slab.codes, codes.data());
      if (slab.cells) put(slab.cells, cells.data());
      t = end;
    }
    tasks.clear();
    discs = 0;
  };
  for (const Upload& upload : uploads) {
    std::size_t from = 0;
    for (const Range& range : upload.entry->ranges)
      for (std::uint32_t i = 0; i < range.count; i += kTaskDiscs) {
        const std::uint32_t count = std::min(range.count - i, kTaskDiscs);
        tasks.push_back({&upload, from, {range.slab, range.first + i, count}, discs});
        from += count;
        discs += count;
        if (discs >= kUploadDiscs) flush();
      }
  }
  flush();
}

}  // namespace gs::render
