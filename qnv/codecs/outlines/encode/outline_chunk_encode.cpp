#include "qnv/codecs/outlines/encode/outline_record_encode.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

namespace gs::qnv::outline {
namespace {

/// Minimum number of inner polygons that a group must have in a chunk to get a separate frame.
constexpr std::size_t kOwnFrame = 5;
constexpr std::size_t kMaxFrames = 255;
/// Minimum number of corners of a polygon with a separate plane. The plane costs at least 20 bits; a triangle cannot
/// save as many.
constexpr std::size_t kOwnPlane = 4;

int code_bits(std::size_t axes) { return 5 * static_cast<int>(axes); }

/// Polygon with the encoding that was chosen for it.
struct Prepared {
  const Polygon* polygon;
  std::optional<Plane> own_plane;
  Differences differences;
  Code own_code;
  std::uint64_t own_cost;  // bits of the differences with that code, and of the code

  Prepared(const Polygon& of, const Plane& plane) : polygon(&of), differences(of, plane) { choose(); }

  void choose() {
    own_code = best_code(differences.numbers(), differences.axes());
    own_cost = differences.cost(own_code) + static_cast<std::uint64_t>(code_bits(differences.axes()));
  }
  void try_own_plane() {
    if (polygon->corners.size() < kOwnPlane) return;
    const auto normal = polygon->normal();
    std::uint64_t least = own_cost;
    for (int precision = 1; precision <= 3; ++precision) {
      const Plane plane = plane_across(normal, precision);
      Prepared other(*polygon, plane);
      const std::uint64_t cost = other.own_cost + static_cast<std::uint64_t>(plane.cost());
      if (cost >= least) continue;
      least = cost;
      differences = std::move(other.differences);
      own_code = other.own_code;
      own_cost = other.own_cost;
      own_plane = plane;
    }
  }
};

std::uint64_t cost_of(const std::vector<Prepared>& all, const Code& code) {
  std::uint64_t bits = 0;
  for (const Prepared& p : all) bits += std::min(p.differences.cost(code), p.own_cost);
  return bits;
}

/// Returns the code for a frame that makes its records smallest, and the total bits of these records.
std::pair<Code, std::uint64_t> choose_code(const std::vector<Prepared>& all, std::size_t axes) {
  std::vector<Numbers> numbers;
  for (const Prepared& p : all) {
    const auto& more = p.differences.numbers();
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
  const Code code = best_code(numbers, axes);
  return {code, cost_of(all, code)};
}

struct FramedRecords {
  Frame frame;
  std::vector<Prepared> records;
  std::uint64_t cost = 0;
};

/// Returns the lower and upper corners of the bounding box of the polygons' first corners, in the axes of a frame. Both
/// are 0 on an axis that no polygon uses.
std::pair<Place, Place> box_of(std::span<const Polygon* const> polygons, const Frame& frame) {
  Place lower, upper;
  lower.fill(std::numeric_limits<std::int64_t>::max());
  upper.fill(std::numeric_limits<std::int64_t>::min());
  for (const Polygon* polygon : polygons) {
    const Place place = frame.place(polygon->corners[0]);
    for (std::size_t axis = 0; axis < polygon->axes(); ++axis) {
      lower[axis] = std::min(lower[axis], place[axis]);
      upper[axis] = std::max(upper[axis], place[axis]);
    }
  }
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    if (lower[axis] > upper[axis]) lower[axis] = upper[axis] = 0;
  return {lower, upper};
}

/// Sets the frame's box to the bounding box of the polygons' first corners.
void fit_box(std::span<const Polygon* const> polygons, Frame& frame) {
  frame.origin = {};
  const Place corner = box_of(polygons, frame).first;
  std::copy_n(corner.begin(), 2, frame.origin.begin());  // u and v first: w depends on them
  const auto [lower, upper] = box_of(polygons, frame);
  std::copy(lower.begin() + 2, lower.end(), frame.origin.begin() + 2);
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    frame.bits[axis] = static_cast<std::uint8_t>(std::bit_width(static_cast<std::uint64_t>(upper[axis] - lower[axis])));
}

FramedRecords with_plane(std::span<const Polygon* const> polygons, const ChunkKind& kind, const Plane& plane) {
  const std::size_t axes = kind.textured ? kAxes : kPlaneAxes;
  FramedRecords framed;
  framed.frame.plane = plane;
  fit_box(polygons, framed.frame);
  framed.records.reserve(polygons.size());
  std::uint64_t planes = 0;
  for (const Polygon* polygon : polygons) {
    Prepared& p = framed.records.emplace_back(*polygon, plane);
    p.try_own_plane();
    if (p.own_plane) planes += static_cast<std::uint64_t>(p.own_plane->cost());
  }
  std::tie(framed.frame.code, framed.cost) = choose_code(framed.records, axes);
  framed.cost += planes + static_cast<std::uint64_t>(plane.cost());
  for (std::size_t axis = 0; axis < axes; ++axis) framed.cost += framed.frame.bits[axis] * polygons.size();
  return framed;
}

std::uint8_t count_order(std::span<const Polygon* const> polygons) {
  std::uint64_t best = std::numeric_limits<std::uint64_t>::max();
  std::uint8_t chosen = 0;
  for (int order = 0; order < 16; ++order) {
    std::uint64_t bits = 0;
    for (const Polygon* polygon : polygons) bits += static_cast<std::uint64_t>(golomb_bits(polygon->count, order));
    if (bits < best) best = bits, chosen = static_cast<std::uint8_t>(order);
  }
  return chosen;
}

FramedRecords make_frame(std::span<const Polygon* const> polygons, const ChunkKind& kind, bool flat) {
  FramedRecords best = with_plane(polygons, kind, {});
  if (flat) {
    std::array<double, 3> normal{};
    for (const Polygon* polygon : polygons) {
      const auto own = polygon->normal();
      for (std::size_t axis = 0; axis < 3; ++axis) normal[axis] += own[axis];
    }
    for (int precision = 2; precision <= 3; ++precision) {
      FramedRecords other = with_plane(polygons, kind, plane_across(normal, precision));
      if (other.cost < best.cost) best = std::move(other);
    }
  }
  Frame& frame = best.frame;
  std::uint32_t last = 0;
  frame.first_group = std::numeric_limits<std::uint32_t>::max();
  for (const Polygon* polygon : polygons) {
    frame.first_group = std::min(frame.first_group, polygon->group);
    last = std::max(last, polygon->group);
  }
  frame.group_bits = static_cast<int>(std::bit_width(last - frame.first_group));
  if (!kind.inner) frame.count_order = count_order(polygons);
  return best;
}

bool write_record(const Prepared& p, const ChunkHead& head, std::size_t frame_number, std::vector<std::byte>& out) {
  const Frame& frame = head.frames[frame_number];
  const Polygon& polygon = *p.polygon;
  const std::size_t begin = out.size();
  BitWriter to(out);
  to.bits(frame_number, head.frame_bits());
  to.bits(polygon.group - frame.first_group, frame.group_bits);
  if (!head.inner) to.golomb(polygon.count, frame.count_order);
  if (head.textured) to.flag(polygon.textured);
  to.flag(p.own_plane.has_value());
  if (p.own_plane) p.own_plane->write(to);
  const bool own_code = p.differences.cost(frame.code) > p.own_cost;
  to.flag(own_code);
  if (own_code) p.own_code.write(to, polygon.axes());
  const Place first = frame.place(polygon.corners[0]);
  for (std::size_t axis = 0; axis < polygon.axes(); ++axis)
    to.bits(static_cast<std::uint64_t>(first[axis]), frame.bits[axis]);
  p.differences.write(polygon, own_code ? p.own_code : frame.code, to);
  to.align();
  out.push_back(static_cast<std::byte>(crc8(std::span(out).subspan(begin))));
  return out.size() - begin <= 0xffff;
}

/// Assigns polygons to frames: one frame for each large group, and one for all other polygons.
std::vector<std::vector<const Polygon*>> by_frames(std::span<const Polygon> polygons, const ChunkKind& kind) {
  std::vector<std::vector<const Polygon*>> frames(1);
  for (std::size_t i = 0; i < polygons.size();) {
    std::size_t end = i;
    while (end < polygons.size() && polygons[end].group == polygons[i].group) ++end;
    const bool own = kind.inner && end - i >= kOwnFrame && frames.size() < kMaxFrames;
    if (own) frames.emplace_back();
    for (; i < end; ++i) (own ? frames.back() : frames.front()).push_back(&polygons[i]);
  }
  if (frames.front().empty()) frames.erase(frames.begin());
  return frames;
}

}  // namespace

std::vector<std::byte> Chunk::payload(const LatticeBits& bits) const {
  std::vector<std::byte> out = head.encode(bits);
  out.insert(out.end(), records.begin(), records.end());
  return out;
}

Chunk encode_chunk_of(std::span<const Polygon> polygons, const ChunkKind& kind) {
  Chunk chunk;
  chunk.head.appearance = kind.appearance;
  chunk.head.inner = kind.inner;
  chunk.head.textured = kind.textured;
  std::vector<std::vector<Prepared>> records;
  for (const auto& members : by_frames(polygons, kind)) {
    const bool flat = kind.inner && members.front()->group == members.back()->group;
    FramedRecords framed = make_frame(members, kind, flat);
    chunk.head.frames.push_back(framed.frame);
    records.push_back(std::move(framed.records));
  }
  chunk.head.first_group = chunk.head.frames.front().first_group;
  // Restores the original order of the polygons.
  std::vector<std::pair<const Prepared*, std::size_t>> order;
  for (std::size_t frame = 0; frame < records.size(); ++frame)
    for (const Prepared& p : records[frame]) order.emplace_back(&p, frame);
  std::sort(order.begin(), order.end(),
            [](const auto& a, const auto& b) { return a.first->polygon < b.first->polygon; });
  for (const auto& [p, frame] : order) {
    const std::size_t before = chunk.records.size();
    if (!write_record(*p, chunk.head, frame, chunk.records)) return {};
    chunk.head.lengths.push_back(static_cast<std::uint16_t>(chunk.records.size() - before));
  }
  return chunk;
}

}  // namespace gs::qnv::outline
