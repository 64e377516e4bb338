#pragma once

#include "vrml/mesh/vertices.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// Iterator over the faces of a coordIndex. Any negative number ends a face; the last face needs no end marker (VRML97
/// 6.23). Skips faces with fewer than three different vertices, and faces with a vertex that does not exist or is not
/// finite. Drops corners that repeat the previous corner, and last corners that repeat the first corner.
class FaceReader {
 public:
  /// Keeps references to `coord_index` and `vertices`. If `ccw` is false, reverses the corners of each face.
  FaceReader(std::span<const std::int32_t> coord_index, const UsableVertices& vertices, bool ccw)
      : index_(coord_index), vertices_(vertices), ccw_(ccw) {}

  /// Moves to the next drawable face. Returns false at the end.
  bool next() {
    while (next_ < index_.size())
      if (read()) return true;
    return false;
  }
  /// Reads one face. Call it only while position() is inside coordIndex. Returns false if it skips the face.
  bool read();
  /// Returns the position in coordIndex after the face.
  [[nodiscard]] std::size_t position() const { return next_; }
  /// Skips `faces` faces that the caller has read. They end before `position`.
  void skip_to(std::size_t position, std::size_t faces) {
    next_ = position;
    next_face_ += faces;
  }

  /// Returns the index of the face. Skipped faces count, too.
  [[nodiscard]] std::size_t face() const { return next_face_ - 1; }
  /// Returns the corners of the face: at least three positions in coordIndex, counter-clockwise.
  [[nodiscard]] std::span<const std::uint32_t> corners() const { return {corners_.data(), count_}; }
  [[nodiscard]] std::uint32_t vertex(std::uint32_t corner) const { return static_cast<std::uint32_t>(index_[corner]); }

 private:
  std::span<const std::int32_t> index_;
  const UsableVertices& vertices_;
  bool ccw_;
  std::size_t next_ = 0;
  std::size_t next_face_ = 0;
  std::size_t count_ = 0;
  std::vector<std::uint32_t> corners_;
};

inline bool FaceReader::read() {
  const std::size_t begin = next_;
  std::size_t end = begin;
  while (end < index_.size() && index_[end] >= 0) ++end;
  next_ = end + 1;
  ++next_face_;
  count_ = 0;
  if (end - begin < 3) return false;
  if (corners_.size() < end - begin) corners_.resize(std::max(end - begin, 2 * corners_.size()));
  for (std::size_t i = begin; i < end; ++i) {
    if (!vertices_.contains(static_cast<std::uint32_t>(index_[i]))) return false;
    if (count_ > 0 && index_[corners_[count_ - 1]] == index_[i]) continue;
    corners_[count_++] = static_cast<std::uint32_t>(i);
  }
  while (count_ > 1 && index_[corners_[0]] == index_[corners_[count_ - 1]]) --count_;
  if (count_ < 3) return false;
  if (count_ > 3) {
    const std::int32_t a = index_[corners_[0]], b = index_[corners_[1]];
    const auto third = [&](std::uint32_t corner) { return index_[corner] != a && index_[corner] != b; };
    if (std::none_of(corners_.begin() + 2, corners_.begin() + static_cast<std::ptrdiff_t>(count_), third)) return false;
  }
  if (!ccw_) std::reverse(corners_.begin() + 1, corners_.begin() + static_cast<std::ptrdiff_t>(count_));
  return true;
}

}  // namespace gs::vrml
