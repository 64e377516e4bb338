#include "qnv/codecs/records/record.h"

#include "qnv/codecs/records/record_paths.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace gs::qnv {
namespace {

// Returns the sine of (2k + 1) pi / 64, the centre of a direction code. Sums the series instead of calling a library,
// so that all machines agree.
constexpr double sine_of_odd(unsigned k) {
  k %= 64;
  const double sign = k < 32 ? 1 : -1;
  k %= 32;
  if (k >= 16) k = 31 - k;
  const double angle = (2 * k + 1) * (std::numbers::pi / 64);
  double term = angle, sum = 0;
  for (int i = 1; i < 30; i += 2) {
    sum += term;
    term *= -angle * angle / ((i + 1) * (i + 2));
  }
  return sign * sum;
}
constexpr double cosine_of_odd(unsigned k) { return sine_of_odd(k + 16); }

constexpr std::array<record_paths::PaddedNormal, kNormalCodes> kNormalTable = [] {
  std::array<record_paths::PaddedNormal, kNormalCodes> table{};
  for (unsigned code = 0; code < kNormalCodes; ++code) {
    const unsigned theta = code % kRecordThetas, phi = code / kRecordThetas;
    const auto z = static_cast<float>(cosine_of_odd(theta));
    table[code] = {static_cast<float>(sine_of_odd(theta) * cosine_of_odd(phi)),
                   static_cast<float>(sine_of_odd(theta) * sine_of_odd(phi)), z, z};
  }
  return table;
}();

struct Direction {
  double cosine, sine;
};

// Directions k pi / 32 at the borders between the codes of a half turn.
constexpr std::array<Direction, 32> kBorders = [] {
  std::array<Direction, 32> borders{};
  borders[0] = {1, 0};
  for (unsigned k = 1; k < 32; ++k) {  // bisector of the centres on both sides
    const double c = cosine_of_odd(k - 1) + cosine_of_odd(k), s = sine_of_odd(k - 1) + sine_of_odd(k);
    borders[k] = {c, s};
  }
  return borders;
}();

constexpr std::array<Direction, kRecordPhis> kPhiCentres = [] {
  std::array<Direction, kRecordPhis> centres{};
  for (unsigned k = 0; k < kRecordPhis; ++k) centres[k] = {cosine_of_odd(k), sine_of_odd(k)};
  return centres;
}();

// Returns the part, 0 to 31, of a half turn that contains a direction with sine >= 0.
unsigned part_of_half_turn(double cosine, double sine) {
  unsigned k = 0;
  for (unsigned step = 16; step > 0; step /= 2) {
    const Direction& border = kBorders[k + step];
    if (sine * border.cosine >= cosine * border.sine) k += step;
  }
  return k;
}

constexpr std::uint32_t kDroppedBits = 0x7ff;  // keeps 13 of the 24 significant bits of a float

float round_up_to_13_bits(double value) {
  auto rounded = static_cast<float>(value);
  if (rounded < value) rounded = std::nextafter(rounded, std::numeric_limits<float>::infinity());
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(rounded);
  return std::bit_cast<float>((bits + kDroppedBits) & ~kDroppedBits);
}

// Returns the code of a coordinate; 0 for NaN.
std::uint16_t position_code(double offset, double per_unit) {
  const double code = offset * per_unit;
  if (!(code >= 0)) return 0;
  return static_cast<std::uint16_t>(std::min(code, kRecordPositions - 1.0));
}

// Constants of a RecordFrame for packing.
struct Packer {
  explicit Packer(const RecordFrame& frame) : weights_per_step(1 / double{frame.weight_step}) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = frame.lower[axis];
      per_unit[axis] = frame.cell[axis] > 0 ? 1 / double{frame.cell[axis]} : 0;
    }
  }
  [[nodiscard]] std::uint64_t pack(const glm::vec3& position, const glm::vec3& normal, float weight,
                                   std::uint8_t color) const {
    const double steps = weight * weights_per_step + 0.5;
    const auto area = steps >= 1 ? static_cast<std::uint64_t>(std::min<double>(steps, kRecordLargestWeight)) : 1;
    return std::uint64_t{position_code(position.x - lower[0], per_unit[0])} |
           std::uint64_t{position_code(position.y - lower[1], per_unit[1])} << 10 |
           std::uint64_t{position_code(position.z - lower[2], per_unit[2])} << 20 |
           std::uint64_t{normal_code(normal)} << 30 | area << 41 | std::uint64_t{color} << 56;
  }
  double lower[3], per_unit[3];
  double weights_per_step;
};

std::uint64_t load(const std::byte* p) {
  std::uint64_t bits = 0;
  for (int i = 7; i >= 0; --i) bits = bits << 8 | std::to_integer<std::uint64_t>(p[i]);
  return bits;
}

void store(std::uint64_t bits, std::byte* p) {
  for (int i = 0; i < 8; ++i) p[i] = static_cast<std::byte>(bits >> (8 * i));
}

}  // namespace

constinit const std::array<record_paths::PaddedNormal, kNormalCodes> record_paths::kNormals = kNormalTable;

Box RecordFrame::box() const {
  Box box;
  box.lower = lower;
  for (int axis = 0; axis < 3; ++axis)
    box.upper[axis] = static_cast<float>(double{lower[axis]} + double{kRecordPositions} * cell[axis]);
  return box;
}

RecordFrame frame_for(const Box& box, float largest_weight) {
  RecordFrame frame;
  frame.lower = box.lower;
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = double{box.upper[axis]} - double{box.lower[axis]};
    frame.cell[axis] = extent > 0 ? round_up_to_13_bits(extent / kRecordPositions) : 0;
  }
  // Keeps the step a normal float, so that results of dividing by it are finite.
  frame.weight_step = std::max(largest_weight / kRecordLargestWeight, std::numeric_limits<float>::min());
  return frame;
}

bool valid(const RecordFrame& frame) {
  constexpr double limit = std::numeric_limits<float>::max();
  for (int axis = 0; axis < 3; ++axis) {
    const float cell = frame.cell[axis];
    if (!(cell >= 0) || std::signbit(cell) || !std::isfinite(frame.lower[axis])) return false;
    if ((std::bit_cast<std::uint32_t>(cell) & kDroppedBits) != 0) return false;
    if (!(std::abs(double{frame.lower[axis]} + double{kRecordPositions} * cell) <= limit)) return false;
    if (!(kRecordPositions * double{cell} <= limit)) return false;
  }
  return frame.weight_step >= std::numeric_limits<float>::min() &&
         kRecordLargestWeight * double{frame.weight_step} <= limit;
}

unsigned normal_code(const glm::vec3& direction) {
  const double x = direction.x, y = direction.y, z = direction.z;
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) return 0;
  if (x == 0 && y == 0) return z < 0 ? kRecordThetas - 1 : 0;
  // The azimuth comes first: for any polar angle, the nearest azimuth is the centre of the sector that contains the
  // direction. Then projects the direction onto the half plane of that centre. The nearest polar angle is that of the
  // projection.
  const bool back = y < 0 || (y == 0 && x < 0);
  const unsigned phi = (back ? 32 : 0) + (back ? part_of_half_turn(-x, -y) : part_of_half_turn(x, y));
  const Direction& centre = kPhiCentres[phi];
  const unsigned theta = part_of_half_turn(z, x * centre.cosine + y * centre.sine);
  return theta + kRecordThetas * phi;
}

glm::vec3 normal_of(unsigned code) {
  const record_paths::PaddedNormal& n = kNormalTable[code % kNormalCodes];
  return {n.x, n.y, n.z};
}

RecordVector unpack_record(std::uint64_t bits, const RecordFrame& frame) {
  const auto coordinate = [](std::uint64_t code, float lower, float cell) {
    return lower + static_cast<float>(2 * (code & 1023) + 1) * (cell * 0.5f);
  };
  RecordVector v;
  v.position = {coordinate(bits, frame.lower.x, frame.cell.x), coordinate(bits >> 10, frame.lower.y, frame.cell.y),
                coordinate(bits >> 20, frame.lower.z, frame.cell.z)};
  v.normal = normal_of(static_cast<unsigned>(bits >> 30 & 2047));
  v.weight = static_cast<float>(std::max<std::uint32_t>(bits >> 41 & 32767, 1)) * frame.weight_step;
  v.color = static_cast<std::uint8_t>(bits >> 56);
  return v;
}

void pack_records(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                  std::span<const float> weights, std::span<const std::uint8_t> colors, const RecordFrame& frame,
                  std::byte* out) {
  const Packer packer(frame);
  for (std::size_t i = 0; i < positions.size(); ++i)
    store(packer.pack(positions[i], normals[i], weights[i], colors.empty() ? std::uint8_t{0} : colors[i]), out + 8 * i);
}

void record_paths::unpack_portable(const std::byte* records, std::size_t count, const RecordFrame& frame,
                                   const Outputs& out) {
  for (std::size_t i = 0; i < count; ++i) {
    const RecordVector v = unpack_record(load(records + kRecordBytes * i), frame);
    out.positions[i] = v.position;
    out.normals[i] = v.normal;
    out.weights[i] = v.weight;
    out.colors[i] = v.color;
  }
}

void unpack_records(std::span<const std::byte> records, const RecordFrame& frame, glm::vec3* positions,
                    glm::vec3* normals, float* weights, std::uint8_t* colors) {
  static const bool avx2 = record_paths::has_avx2();
  const std::size_t count = records.size() / kRecordBytes;
  const record_paths::Outputs out{positions, normals, weights, colors};
  if (avx2) {
    record_paths::unpack_avx2(records.data(), count, frame, out);
  } else {
    record_paths::unpack_portable(records.data(), count, frame, out);
  }
}

}  // namespace gs::qnv
