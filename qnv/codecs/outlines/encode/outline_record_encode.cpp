#include "qnv/codecs/outlines/encode/outline_record_encode.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gs::qnv::outline {
namespace {

Place minus(const Place& a, const Place& b) {
  Place difference;
  for (std::size_t axis = 0; axis < kAxes; ++axis) difference[axis] = a[axis] - b[axis];
  return difference;
}

Numbers zigzags(const Place& place) {
  Numbers numbers;
  for (std::size_t axis = 0; axis < kAxes; ++axis) numbers[axis] = zigzag(place[axis]);
  return numbers;
}

}  // namespace

std::array<double, 3> Polygon::normal() const {
  std::array<double, 3> sum{};
  for (std::size_t ring = 0; ring < ring_ends.size(); ++ring) {
    const std::span<const Corner> all = corners.subspan(ring_begin(ring), ring_end(ring) - ring_begin(ring));
    const auto distance = [&](std::size_t i, std::size_t axis) {
      return static_cast<double>(std::int64_t{all[i].p[axis]} - corners[0].p[axis]);
    };
    for (std::size_t i = 0, before = all.size() - 1; i < all.size(); before = i++)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
        sum[axis] += distance(before, a) * distance(i, b) - distance(before, b) * distance(i, a);
      }
  }
  return sum;
}

Plane plane_across(const std::array<double, 3>& normal, int precision) {
  Plane plane;
  for (std::uint8_t axis = 0; axis < 3; ++axis)
    if (std::abs(normal[axis]) > std::abs(normal[plane.axis])) plane.axis = axis;
  const double along = normal[plane.axis];
  if (precision == 0 || along == 0) return plane;
  plane.precision = static_cast<std::uint8_t>(precision);
  const double scale = std::ldexp(1.0, Plane::kSlopeBits[plane.precision] - 2);
  plane.slopes[0] = static_cast<std::int32_t>(std::lround(-normal[plane.u()] / along * scale));
  plane.slopes[1] = static_cast<std::int32_t>(std::lround(-normal[plane.v()] / along * scale));
  return plane;
}

Differences::Differences(const Polygon& polygon, const Plane& plane) : axes_(polygon.axes()) {
  const auto& p = polygon.corners[0].p;
  const PlaneView view(plane, {p[0], p[1], p[2]});
  std::vector<Place> places;
  places.reserve(polygon.corners.size() + 1);
  for (const Corner& corner : polygon.corners) places.push_back(view.place(corner));
  numbers_.reserve(places.size());
  for (std::size_t ring = 0; ring < polygon.ring_ends.size(); ++ring) {
    const std::size_t begin = polygon.ring_begin(ring), end = polygon.ring_end(ring);
    // Writes the first corner of a ring relative to the last corner of the previous ring.
    if (ring > 0) numbers_.push_back(zigzags(minus(places[begin], places[begin - 1])));
    add_ring(std::span(places).subspan(begin, end - begin));
  }
}

void Differences::add_ring(std::span<const Place> places) {
  fixed_cost_ += static_cast<std::uint64_t>(golomb_bits(places.size() - 3, 0)) + 1;
  std::size_t written = places.size();
  bool parallelogram = false;
  if (places.size() == 4) {
    fixed_cost_ += 1;
    Place expected;
    for (std::size_t axis = 0; axis < kAxes; ++axis)
      expected[axis] = places[0][axis] + places[2][axis] - places[1][axis];
    const Numbers off = zigzags(minus(places[3], expected));
    parallelogram = std::all_of(off.begin(), off.begin() + static_cast<std::ptrdiff_t>(axes_),
                                [](std::uint64_t number) { return number <= 4; });
    if (parallelogram) {
      written = 3;
      corrections_.push_back(off);
      for (std::size_t axis = 0; axis < axes_; ++axis)
        fixed_cost_ += static_cast<std::uint64_t>(golomb_bits(off[axis], 0));
    }
  }
  parallelograms_.push_back(parallelogram ? 1 : 0);
  for (std::size_t i = 1; i < written; ++i) numbers_.push_back(zigzags(minus(places[i], places[i - 1])));
}

std::uint64_t Differences::cost(const Code& code) const {
  std::uint64_t bits = fixed_cost_;
  for (const Numbers& n : numbers_)
    for (std::size_t axis = 0; axis < axes_; ++axis)
      bits += static_cast<std::uint64_t>(golomb_bits(n[axis], code.orders[axis]));
  return bits;
}

Code best_code(std::span<const Numbers> numbers, std::size_t axes) {
  Code code;
  if (numbers.empty()) return code;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    std::uint64_t sum = 0, best = std::numeric_limits<std::uint64_t>::max();
    for (const Numbers& n : numbers) sum += n[axis];
    const int about = static_cast<int>(std::bit_width(sum / numbers.size()));
    for (int order = std::max(0, about - 4); order <= std::min(about, kMaxOrder); ++order) {
      std::uint64_t bits = 0;
      for (const Numbers& n : numbers) bits += static_cast<std::uint64_t>(golomb_bits(n[axis], order));
      if (bits < best) best = bits, code.orders[axis] = static_cast<std::uint8_t>(order);
    }
  }
  return code;
}

void Differences::write(const Polygon& polygon, const Code& code, BitWriter& to) const {
  std::size_t next = 0, correction = 0;
  const auto write_next = [&] {
    for (std::size_t axis = 0; axis < axes_; ++axis) to.golomb(numbers_[next][axis], code.orders[axis]);
    ++next;
  };
  for (std::size_t ring = 0; ring < polygon.ring_ends.size(); ++ring) {
    const std::size_t size = polygon.ring_end(ring) - polygon.ring_begin(ring);
    to.golomb(size - 3, 0);
    if (size == 4) to.flag(parallelograms_[ring] != 0);
    const std::size_t written = size - parallelograms_[ring];
    for (std::size_t i = ring == 0 ? 1 : 0; i < written; ++i) write_next();
    if (parallelograms_[ring] != 0) {
      for (std::size_t axis = 0; axis < axes_; ++axis) to.golomb(corrections_[correction][axis], 0);
      ++correction;
    }
    to.flag(ring + 1 < polygon.ring_ends.size());
  }
}

}  // namespace gs::qnv::outline
