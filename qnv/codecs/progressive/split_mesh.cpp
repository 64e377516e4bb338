#include "qnv/codecs/progressive/split_mesh.h"

#include <algorithm>
#include <utility>

namespace gs::qnv::progressive {

SplitMesh::SplitMesh(exact::ExactMesh mesh)
    : triangles_(std::move(mesh.triangles)),
      twins_(std::move(mesh.twins)),
      corners_(mesh.vertices.size(), kNone),
      places_(std::move(mesh.vertices)) {
  for (std::uint32_t c = 0; c < 3 * triangles_.size(); ++c) corners_[triangles_[c / 3][c % 3]] = c;
}

void SplitMesh::ring(std::uint32_t vertex, VertexRing& out) const {
  out.corners.clear();
  out.neighbours.clear();
  out.open = false;
  std::uint32_t start = corners_[vertex];
  if (start == kNone) return;
  std::uint32_t least = start, at = start;
  do {
    const std::uint32_t beside = twins_[at];
    out.open = beside == kNone;
    if (out.open) break;
    at = after(beside);
    least = std::min(least, at);
  } while (at != start);
  start = out.open ? at : least;
  at = start;
  std::uint32_t last = kNone;
  do {
    out.corners.push_back(at);
    out.neighbours.push_back(triangles_[at / 3][after(at) % 3]);
    last = before(at);
    at = twins_[last];
  } while (at != start && at != kNone);
  if (out.open) out.neighbours.push_back(triangles_[last / 3][last % 3]);
}

void SplitMesh::join(std::uint32_t side, std::uint32_t other) {
  if (side != kNone) twins_[side] = other;
  if (other != kNone) twins_[other] = side;
}

void SplitMesh::split(std::uint32_t v, const VertexRing& ring, const VertexSplit& how, const glm::ivec3& place) {
  const auto count = static_cast<std::uint32_t>(ring.corners.size());
  const auto made = static_cast<std::uint32_t>(places_.size());
  const auto corner_behind = [&](std::uint32_t neighbour) {
    return neighbour < count || !ring.open ? ring.corners[neighbour % count] : kNone;
  };
  const auto side_before = [&](std::uint32_t neighbour) {
    if (ring.open && neighbour == 0) return kNone;
    return before(ring.corners[(neighbour + count - 1) % count]);
  };
  const std::uint32_t left_before = side_before(how.first), left_behind = corner_behind(how.first);
  const std::uint32_t right_before = side_before(how.last), right_behind = corner_behind(how.last);
  const auto size = static_cast<std::uint32_t>(ring.neighbours.size());
  for (std::uint32_t k = how.first; k < how.last; ++k) {
    const std::uint32_t corner = ring.corners[k % count];
    triangles_[corner / 3][corner % 3] = made;
  }
  places_.push_back(place);
  corners_.resize(places_.size(), kNone);
  const auto add = [&](const std::array<std::uint32_t, 3>& triangle, std::uint32_t side_ahead, std::uint32_t behind) {
    const auto side = static_cast<std::uint32_t>(3 * triangles_.size());
    triangles_.push_back(triangle);
    twins_.resize(side + 3, kNone);
    join(side, side_ahead);
    join(side + 1, behind);
    return side;
  };
  std::uint32_t middle = kNone;  // side from the new vertex to the old one, in the left triangle
  if (how.left) {
    const std::uint32_t side = add({v, ring.neighbours[how.first % size], made}, left_before, left_behind);
    middle = side + 2;
    corners_[v] = side;
    corners_[made] = side + 2;
  }
  if (how.right) {
    const std::uint32_t side = add({made, ring.neighbours[how.last % size], v}, right_before, right_behind);
    if (middle != kNone) join(side + 2, middle);
    corners_[v] = side + 2;
    corners_[made] = side;
  }
}

}  // namespace gs::qnv::progressive
