#include "render/splat_store.h"

#include "qnv/parallel.h"
#include "render/splat_constants.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace gs::render {
namespace {

constexpr float kLargestPosition = 1048575, kLargestLength = 65535, kLargestNormal = 8191;  // codes
constexpr std::size_t kUploadDiscs = std::size_t{1} << 20;                                  // encoded at a time
constexpr std::size_t kTaskDiscs = 16384;
constexpr std::size_t kSampledRecords = 1024;  // of a chunk

bool finite(const glm::vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

bool can_be_drawn(const glm::vec3& position, const glm::vec3& normal, float weight) {
  const float size = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  return finite(position) && size > 0 && std::isfinite(size) && weight >= 0 && std::isfinite(weight);
}

float radius_of(float weight) {
  return std::sqrt(std::max(weight, std::numeric_limits<float>::min()) * (1 / splat::kPi));
}

/// The code 1 for `smallest`, the last for `largest`.
glm::vec2 logarithms(float smallest, float largest) {
  const float low = std::log2(smallest), step = (std::log2(largest) - low) / (kLargestLength - 1);
  return {low - step, step};
}

std::uint32_t length_code(float length, const glm::vec2& coding) {
  const float code = coding.y > 0 ? (std::log2(length) - coding.x) / coding.y : 1;
  return static_cast<std::uint32_t>(std::lround(std::clamp(code, 1.0f, kLargestLength)));
}

/// Two codes of 14 bits: the octahedron unfolded to a square (Meyer et al. 2010).
std::array<std::uint32_t, 2> normal_codes(const glm::vec3& n) {
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

bool has_cube(const qnv::Cell& cell) { return cell.edge > 0 && std::isfinite(cell.edge); }

}  // namespace

bool take_errors(const Gl& gl) {
  bool any = false;
  for (int i = 0; i < 100 && gl.GetError() != GL_NO_ERROR; ++i) any = true;
  return any;
}

std::optional<SplatCoding> splat_coding(const qnv::Cloud& cloud) {
  const std::size_t count = cloud.size();
  if (cloud.normals.size() != count || cloud.weights.size() != count) return std::nullopt;
  if (!cloud.colors.empty() && cloud.colors.size() != count) return std::nullopt;
  if (!cloud.cells.empty() && cloud.cells.size() != count) return std::nullopt;
  qnv::Box box;
  float smallest = std::numeric_limits<float>::max(), largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!can_be_drawn(cloud.positions[i], cloud.normals[i], cloud.weights[i])) continue;
    box.add(cloud.positions[i]);
    smallest = std::min(smallest, cloud.weights[i]);
    largest = std::max(largest, cloud.weights[i]);
  }
  if (box.empty() || !finite(box.size())) return std::nullopt;
  SplatCoding coding;
  coding.lower = box.lower;
  coding.step = box.size() / kLargestPosition;
  coding.radius = logarithms(radius_of(smallest), radius_of(largest));
  coding.largest_radius = radius_of(largest);
  float shortest = std::numeric_limits<float>::max(), longest = 0;
  for (const qnv::Cell& cell : cloud.cells) {
    if (!has_cube(cell)) continue;
    shortest = std::min(shortest, cell.edge);
    longest = std::max(longest, cell.edge);
  }
  if (longest > 0) {
    coding.edge = logarithms(shortest, longest);
    for (const qnv::Cell& cell : cloud.cells)
      if (has_cube(cell) && std::isfinite(cell.offset))
        coding.reach = std::max(coding.reach, std::min(std::abs(cell.offset), cell.edge * SplatCoding::kOffsetRange));
    coding.reach += longest * 1.1f;
  }
  return coding;
}

void encode_splats(const qnv::Cloud& cloud, const SplatCoding& coding, std::size_t first, std::span<SplatCode> codes) {
  glm::vec3 per_unit(0);
  for (int axis = 0; axis < 3; ++axis)
    if (coding.step[axis] > 0) per_unit[axis] = 1 / coding.step[axis];
  for (std::size_t i = 0; i < codes.size(); ++i) {
    SplatCode& code = codes[i];
    code = {};
    const glm::vec3& position = cloud.positions[first + i];
    const glm::vec3& normal = cloud.normals[first + i];
    const float weight = cloud.weights[first + i];
    if (!can_be_drawn(position, normal, weight)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      // The reciprocal of a step that is hardly a number is infinite, and 0 times that is none.
      const float at = (position[axis] - coding.lower[axis]) * per_unit[axis];
      code[static_cast<std::size_t>(axis)] =
          static_cast<std::uint32_t>(std::lround(at >= 0 ? std::min(at, kLargestPosition) : 0.0f));
    }
    const auto [u, v] = normal_codes(normal);
    const std::uint32_t radius = length_code(radius_of(weight), coding.radius);
    const qnv::Rgb8& color = cloud.colors.empty() ? cloud.color : cloud.colors[first + i];
    code[0] |= u << 20;
    code[1] |= v << 20;
    code[2] |= radius << 20;
    code[3] = std::uint32_t{color.r} | std::uint32_t{color.g} << 8 | std::uint32_t{color.b} << 16 | (u >> 12) << 24 |
              (v >> 12) << 26 | (radius >> 12) << 28;
  }
}

void encode_cells(const qnv::Cloud& cloud, const SplatCoding& coding, std::size_t first, std::span<CellCode> codes) {
  for (std::size_t i = 0; i < codes.size(); ++i) {
    codes[i] = 0;
    const qnv::Cell& cell = cloud.cells[first + i];
    if (!has_cube(cell)) continue;
    float offset = cell.offset / (cell.edge * SplatCoding::kOffsetRange);
    offset = std::isfinite(offset) ? std::clamp(offset, -1.0f, 1.0f) : 0.0f;
    codes[i] = length_code(cell.edge, coding.edge) | static_cast<std::uint32_t>(std::lround(offset * 32767 + 32767))
                                                         << 16;
  }
}

const SplatStore::Entry* SplatStore::find(const std::shared_ptr<const qnv::Cloud>& cloud) {
  Entry& entry = entries_[cloud.get()];
  // An expired entry belonged to another cloud that lay at the same address.
  if (entry.cloud.expired()) {
    bytes_ -= entry.bytes;
    entry = {};
    entry.cloud = cloud;
    entry.used = frame_;
    if (!upload(*cloud, entry)) {
      entries_.erase(cloud.get());
      return nullptr;
    }
  }
  entry.used = frame_;
  return &entry;
}

void SplatStore::forget_unused() {
  ++frame_;
  std::erase_if(entries_, [&](const auto& item) {
    if (!item.second.cloud.expired()) return false;
    bytes_ -= item.second.bytes;
    return true;
  });
}

// What this frame needs stays.
void SplatStore::make_room(std::size_t bytes) {
  while (bytes_ + bytes > most_bytes_) {
    auto oldest = entries_.end();
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry)
      if (entry->second.bytes > 0 && entry->second.used < frame_ &&
          (oldest == entries_.end() || entry->second.used < oldest->second.used))
        oldest = entry;
    if (oldest == entries_.end()) return;
    bytes_ -= oldest->second.bytes;
    entries_.erase(oldest);
  }
}

bool SplatStore::upload(const qnv::Cloud& cloud, Entry& entry) {
  entry.coding = splat_coding(cloud);
  if (!entry.coding) return true;
  const std::size_t count = cloud.size();
  const bool cells = !cloud.cells.empty();
  const std::size_t bytes = count * (sizeof(SplatCode) + (cells ? sizeof(CellCode) : 0));
  make_room(bytes);
  if (bytes_ + bytes > most_bytes_) return false;
  take_errors(gl_);
  Buffer buffer = make_buffer(gl_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, buffer.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr, GL_STATIC_DRAW);
  if (take_errors(gl_)) return false;
  std::vector<SplatCode> codes(std::min(count, kUploadDiscs));
  std::vector<CellCode> cubes(cells ? codes.size() : 0);
  for (std::size_t first = 0; first < count; first += kUploadDiscs) {
    const std::size_t part = std::min(kUploadDiscs, count - first);
    qnv::parallel_for((part + kTaskDiscs - 1) / kTaskDiscs,
                      [&](std::size_t task) {
                        const std::size_t at = task * kTaskDiscs, size = std::min(kTaskDiscs, part - at);
                        encode_splats(cloud, *entry.coding, first + at, std::span(codes).subspan(at, size));
                        if (cells) encode_cells(cloud, *entry.coding, first + at, std::span(cubes).subspan(at, size));
                      },
                      0);
    gl_.BufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(first * sizeof(SplatCode)),
                      static_cast<GLsizeiptr>(part * sizeof(SplatCode)), codes.data());
    if (cells)
      gl_.BufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(count * sizeof(SplatCode) + first * sizeof(CellCode)),
                        static_cast<GLsizeiptr>(part * sizeof(CellCode)), cubes.data());
  }
  entry.buffer = std::move(buffer);
  entry.discs = count;
  entry.cells = cells;
  entry.bytes = bytes;
  bytes_ += bytes;
  return true;
}

SplatRecords::SplatRecords(const Gl& gl, std::span<const qnv::Rgb8> palette, bool two_sided)
    : gl_(gl), palette_(make_texture(gl)), two_sided_(two_sided), colored_(!palette.empty()) {
  std::array<qnv::Rgb8, 256> colors{};
  std::copy_n(palette.begin(), std::min(palette.size(), colors.size()), colors.begin());
  static_assert(sizeof colors == 256 * 3);
  gl.BindTexture(GL_TEXTURE_2D, palette_.name());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, 256, 1, 0, GL_RGB, GL_UNSIGNED_BYTE, colors.data());
}

bool SplatRecords::add(std::span<const std::byte> records, const qnv::RecordFrame& frame) {
  // The shader reads records as two integers in the byte order of the machine.
  static_assert(std::endian::native == std::endian::little);
  const std::size_t count = records.size() / qnv::kRecordBytes;
  if (!qnv::valid(frame)) return false;
  if (count == 0) return true;
  take_errors(gl_);
  Chunk chunk{make_buffer(gl_), count, frame, nullptr};
  gl_.BindBuffer(GL_ARRAY_BUFFER, chunk.buffer.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * qnv::kRecordBytes), records.data(), GL_STATIC_DRAW);
  if (take_errors(gl_)) return false;

  const std::size_t step = (count + kSampledRecords - 1) / kSampledRecords, sampled = (count + step - 1) / step;
  std::vector<std::byte> chosen;
  for (std::size_t i = 0; i < count; i += step) {
    const auto record = records.subspan(i * qnv::kRecordBytes, qnv::kRecordBytes);
    chosen.insert(chosen.end(), record.begin(), record.end());
  }
  auto sample = std::make_shared<qnv::Cloud>();
  sample->description.two_sided = two_sided_;
  sample->positions.resize(sampled);
  sample->normals.resize(sampled);
  sample->weights.resize(sampled);
  sample->classes.resize(sampled);
  qnv::unpack_records(chosen, frame, sample->positions.data(), sample->normals.data(), sample->weights.data(),
                      sample->classes.data());
  sample->classes.clear();
  chunk.sample = std::move(sample);
  chunks_.push_back(std::move(chunk));
  return true;
}

Texture make_normal_table(const Gl& gl) {
  std::vector<glm::vec3> normals(qnv::kNormalCodes);
  for (unsigned code = 0; code < qnv::kNormalCodes; ++code) normals[code] = qnv::normal_of(code);
  Texture texture = make_texture(gl);
  gl.BindTexture(GL_TEXTURE_2D, texture.name());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGB32F, qnv::kRecordThetas, qnv::kRecordPhis, 0, GL_RGB, GL_FLOAT, normals.data());
  return texture;
}

}  // namespace gs::render
