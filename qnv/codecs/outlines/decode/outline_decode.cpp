#include "qnv/codecs/outlines/outline_stream.h"

#include "qnv/codecs/outlines/outline_chunk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace gs::qnv::outline {
namespace {

constexpr std::size_t kCornersAPolygon = 8;

/// Decoded record, with corners on the lattice.
struct ReadPolygon {
  std::uint32_t group = 0, count = 0;
  bool textured = false;
  std::vector<Corner> corners;
  std::vector<std::uint32_t> ring_ends;
};

class RecordReader {
 public:
  RecordReader(std::span<const std::byte> bytes, const ChunkHead& head, const OutlineHeader& header, ReadPolygon& to)
      : bits_(bytes), head_(head), header_(header), to_(to) {}

  /// Reads one record. Returns false if it is invalid.
  bool read() {
    const std::uint64_t number = bits_.bits(head_.frame_bits());
    if (number >= head_.frames.size()) return false;
    const Frame& frame = head_.frames[number];
    const std::uint64_t group = frame.first_group + bits_.bits(frame.group_bits);
    if (group >= header_.groups) return false;
    to_.group = static_cast<std::uint32_t>(group);
    const std::uint64_t count = head_.inner ? 0 : bits_.golomb(frame.count_order);
    if (count > std::numeric_limits<std::uint32_t>::max()) return false;
    to_.count = static_cast<std::uint32_t>(count);
    to_.textured = head_.textured && bits_.flag();
    axes_ = to_.textured ? kAxes : kPlaneAxes;
    plane_ = bits_.flag() ? Plane::read(bits_) : frame.plane;
    code_ = bits_.flag() ? Code::read(bits_, axes_) : frame.code;
    if (!plane_.good()) return false;
    Place first{};
    for (std::size_t axis = 0; axis < axes_; ++axis)
      first[axis] = static_cast<std::int64_t>(bits_.bits(frame.bits[axis]));
    to_.corners.clear();
    to_.ring_ends.clear();
    if (!bits_.good() || !add(frame.lattice(first))) return false;
    return read_rings() && bits_.at_end();
  }

 private:
  bool read_rings() {
    const auto& p = to_.corners[0].p;
    const PlaneView view(plane_, {p[0], p[1], p[2]});
    Place last{0, 0, 0, to_.corners[0].t[0], to_.corners[0].t[1]};
    for (bool first = true, more = true; more; first = false) {
      const std::uint64_t size = bits_.golomb(0) + 3;
      // Rejects impossible sizes: every corner takes at least one bit.
      if (!bits_.good() || size > bits_.left() + 4) return false;
      const bool parallelogram = size == 4 && bits_.flag();
      const std::uint64_t written = size - (parallelogram ? 1 : 0);
      std::array<Place, 3> seen{last, last, last};  // first three corners
      for (std::uint64_t i = first ? 1 : 0; i < written; ++i) {
        if (!next(view, last)) return false;
        if (i < seen.size()) seen[i] = last;
      }
      if (parallelogram) {
        for (std::size_t axis = 0; axis < axes_; ++axis)
          last[axis] = seen[0][axis] + seen[2][axis] - seen[1][axis] + unzigzag(bits_.golomb(0));
        if (!bits_.good() || !add(view.lattice(last))) return false;
      }
      to_.ring_ends.push_back(static_cast<std::uint32_t>(to_.corners.size()));
      more = bits_.flag();
    }
    return bits_.good();
  }

  bool next(const PlaneView& view, Place& last) {
    for (std::size_t axis = 0; axis < axes_; ++axis) last[axis] += unzigzag(bits_.golomb(code_.orders[axis]));
    return bits_.good() && add(view.lattice(last));
  }

  /// Adds a corner. Returns false if the corner is outside the lattices. Because every corner is checked, sums cannot
  /// overflow.
  bool add(const Place& place) {
    Corner corner;
    for (std::size_t axis = 0; axis < axes_; ++axis) {
      const std::uint32_t most = axis < 3 ? header_.positions.size[axis] : header_.texture_coordinates.size[axis - 3];
      if (place[axis] < 0 || place[axis] > most) return false;
      (axis < 3 ? corner.p[axis] : corner.t[axis - 3]) = static_cast<std::uint32_t>(place[axis]);
    }
    to_.corners.push_back(corner);
    return true;
  }

  BitReader bits_;
  const ChunkHead& head_;
  const OutlineHeader& header_;
  ReadPolygon& to_;
  std::size_t axes_ = kPlaneAxes;
  Plane plane_;
  Code code_;
};

/// Returns half the length of the sum of the rings' vector areas, in units^2. Holes have the opposite orientation, so
/// they are subtracted.
double polygon_area(std::span<const glm::vec3> positions, std::span<const std::uint32_t> ring_ends, std::size_t first) {
  const glm::dvec3 origin(positions[0]);
  glm::dvec3 sum(0);
  std::size_t begin = 0;
  for (const std::uint32_t ring_end : ring_ends) {
    const std::size_t end = ring_end - first;
    glm::dvec3 before = glm::dvec3(positions[end - 1]) - origin;
    for (std::size_t i = begin; i < end; ++i) {
      const glm::dvec3 at = glm::dvec3(positions[i]) - origin;
      sum += glm::dvec3(before.y * at.z - before.z * at.y, before.z * at.x - before.x * at.z,
                        before.x * at.y - before.y * at.x);
      before = at;
    }
    begin = end;
  }
  return std::sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z) / 2;
}

void append_polygon(const ReadPolygon& polygon, const OutlineHeader& header, OutlineBatch& batch) {
  OutlinePolygons& to = batch.polygons;
  const std::size_t first = to.positions.size(), first_ring = to.ring_ends.size();
  batch.groups.push_back(polygon.group);
  if (!batch.inner) batch.counts.push_back(polygon.count);
  for (const Corner& corner : polygon.corners) {
    to.positions.emplace_back(header.positions.at(0, corner.p[0]), header.positions.at(1, corner.p[1]),
                              header.positions.at(2, corner.p[2]));
    if (polygon.textured)
      to.texture_coordinates.emplace_back(header.texture_coordinates.at(0, corner.t[0]),
                                          header.texture_coordinates.at(1, corner.t[1]));
  }
  for (const std::uint32_t end : polygon.ring_ends) to.ring_ends.push_back(static_cast<std::uint32_t>(first + end));
  to.polygon_ends.push_back(static_cast<std::uint32_t>(to.ring_ends.size()));
  to.areas.push_back(polygon_area(std::span<const glm::vec3>(to.positions).subspan(first),
                                  std::span<const std::uint32_t>(to.ring_ends).subspan(first_ring), first));
}

bool overlaps(std::span<const ByteRange> missing, std::size_t first, std::size_t last) {
  return std::any_of(missing.begin(), missing.end(),
                     [&](const ByteRange& range) { return range.first < last && range.last > first; });
}

}  // namespace
}  // namespace gs::qnv::outline

namespace gs::qnv {

bool OutlineDecoder::is_outlines() {
  if (refused_) return false;
  if (!header() || header()->payload == Payload::outlines) return true;
  refused_ = true;
  other_payload_.push_back({11, "not an outlines stream; expected payload 2"});
  return false;
}

const std::vector<StreamProblem>& OutlineDecoder::problems() const {
  return refused_ ? other_payload_ : reader_.problems();
}

bool OutlineDecoder::push(std::span<const std::byte> bytes) {
  if (refused_) return false;
  const bool good = reader_.push(
      bytes, [this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) { add(type, payload); },
      [this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
        return add_polygons(type, payload, {});
      });
  return is_outlines() && good;
}

void OutlineDecoder::finish() {
  if (refused_) return;
  reader_.finish([this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) { add(type, payload); },
                 [this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
                   return add_polygons(type, payload, {});
                 });
}

void OutlineDecoder::add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) {
  if (!header() || !is_outlines()) return;
  if (type == ChunkType::directory && missing.empty()) {
    if (directory_.size() > kMaxDirectoryEntries) return;
    const auto entries = decode_directory(payload, header()->description.box);
    directory_.insert(directory_.end(), entries.begin(), entries.end());
  } else if ((type != ChunkType::outlines && type != ChunkType::inner) || !add_polygons(type, payload, missing)) {
    ++refused_chunks_;
  }
}

bool OutlineDecoder::add_polygons(ChunkType type, std::span<const std::byte> payload,
                                  std::span<const ByteRange> missing) {
  const OutlineHeader& outlines = header()->outlines;
  outline::ChunkHead head;
  std::size_t at = 0;
  if (!outline::decode_head(payload, outline::LatticeBits(outlines), head, at) || outline::overlaps(missing, 0, at))
    return false;
  if (head.inner != (type == ChunkType::inner) || head.appearance >= outlines.appearances.size()) return false;
  const auto known = handed_out_.find(head.number);
  // Rejects another chunk with the same chunk number.
  if (known != handed_out_.end() && known->second.size() != head.lengths.size()) return false;
  std::vector<bool> done = known == handed_out_.end() ? std::vector<bool>(head.lengths.size()) : known->second;
  bool any = false;
  outline::ReadPolygon polygon;
  for (std::size_t i = 0; i < head.lengths.size(); at += head.lengths[i++]) {
    if (done[i] || outline::overlaps(missing, at, at + head.lengths[i])) continue;
    const auto record = payload.subspan(at, head.lengths[i]);
    const bool good = outline::crc8(record) == 0 &&
                      outline::RecordReader(record.first(record.size() - 1), head, outlines, polygon).read();
    if (!good || outline_polygons_ + inner_polygons_ >= most_polygons_ ||
        corners_ + polygon.corners.size() > outline::kCornersAPolygon * most_polygons_) {
      ++refused_records_;
      continue;
    }
    outline::append_polygon(polygon, outlines, batch(head.appearance, head.inner, polygon.textured));
    corners_ += polygon.corners.size();
    ++(head.inner ? inner_polygons_ : outline_polygons_);
    done[i] = any = true;
  }
  if (any) handed_out_[head.number] = std::move(done);
  return true;
}

OutlineBatch& OutlineDecoder::batch(std::uint32_t appearance, bool inner, bool textured) {
  const auto [place, fresh] = batch_of_.try_emplace({appearance, inner, textured}, batches_.size());
  if (fresh) {
    OutlineBatch& made = batches_.emplace_back();
    made.appearance = appearance;
    made.inner = inner;
  }
  return batches_[place->second];
}

std::vector<OutlineBatch> OutlineDecoder::take() {
  batch_of_.clear();
  return std::exchange(batches_, {});
}

}  // namespace gs::qnv
