#include "app/formats/common/byte_order.h"
#include "app/formats/splats/splats.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kKsplatHeaderBytes = 4096, kSectionHeaderBytes = 1024, kCenterBytes = 12;
constexpr std::array<std::size_t, 4> kHarmonics = {0, 9, 24, 45};  // numbers per splat, by degree

/// Offsets in the bytes of a splat, per compression mode.
struct Mode {
  std::size_t base, scale, rotation, color, harmonic;  // `harmonic` is the size of one coefficient; all in bytes
};
constexpr std::array<Mode, 3> kModes = {{{44, 12, 24, 40, 4}, {24, 6, 12, 20, 2}, {24, 6, 12, 20, 1}}};

/// Section of the file. Its size was checked against the file.
struct Section {
  std::uint64_t splats = 0, bucket_size = 0, full_buckets = 0, partial_buckets = 0;
  std::uint64_t centers = 0, data = 0, end = 0;  // byte offsets in the file
  std::uint64_t splat_bytes = 0, sizes = 0;
  int harmonics = 0;             // degree of the spherical harmonics
  float quantum = 0, range = 0;  // world units per step; steps from a bucket's centre to its border
};

/// Reads a section. `header` and `start` are the offsets of its header and data. Returns a message on failure.
std::variant<Section, std::string> read_section(std::span<const std::byte> bytes, std::size_t header,
                                                std::uint64_t start, std::size_t mode) {
  const auto word = [&](std::size_t at) { return std::uint64_t{load_little<std::uint32_t>(&bytes[header + at])}; };
  Section section;
  section.splats = word(0);
  const std::uint64_t most = word(4), buckets = word(12);
  section.bucket_size = word(8);
  const auto block = load_little<float>(&bytes[header + 16]);
  const std::uint64_t center_bytes = load_little<std::uint16_t>(&bytes[header + 20]);
  const std::uint64_t stored_range = word(24);
  section.full_buckets = word(32);
  section.partial_buckets = word(36);
  const std::uint64_t degree = load_little<std::uint16_t>(&bytes[header + 40]);
  if (degree >= kHarmonics.size())
    return "a section with harmonics of degree " + std::to_string(degree) + "; expected 0 to 3";
  section.harmonics = static_cast<int>(degree);
  section.range = static_cast<float>(stored_range != 0 ? stored_range : mode == 0 ? 1 : 32767);
  section.quantum = block / 2 / section.range;
  section.splat_bytes = kModes[mode].base + kHarmonics[degree] * kModes[mode].harmonic;
  if (mode > 0 && (center_bytes < kCenterBytes || section.bucket_size == 0))
    return "a section without centres of buckets; expected 12 bytes each";
  if (mode > 0 && (section.full_buckets > buckets || section.partial_buckets > buckets - section.full_buckets))
    return "full and partial buckets of a section exceed its buckets";
  // Each factor has at most 32 bits, so the products cannot overflow.
  section.sizes = start;
  section.centers = start + section.partial_buckets * 4;
  section.data = section.centers + buckets * center_bytes;
  section.end = section.data + most * section.splat_bytes;
  if (section.splats > most) return "splats of a section exceed its capacity";
  if (section.data + section.splats * section.splat_bytes > bytes.size() || section.data < start)
    return "the file ends too early: a section of " + std::to_string(section.splats) + " splats exceeds it";
  // Buckets finds a centre by its index and needs this stride.
  if (mode > 0 && center_bytes != kCenterBytes)
    return "centres of buckets of " + std::to_string(center_bytes) + " bytes; expected 12";
  return section;
}

/// Iterator over the buckets of a section. A bucket has consecutive splats.
class Buckets {
 public:
  Buckets(std::span<const std::byte> bytes, const Section& section) : bytes_(bytes), section_(section) { enter(); }

  /// Sets `center` to the centre of the next splat's bucket. Returns false after the last splat of the last bucket.
  [[nodiscard]] bool next(glm::vec3& center) {
    while (left_ == 0) {
      if (++index_ >= section_.full_buckets + section_.partial_buckets) return false;
      enter();
    }
    --left_;
    center = center_;
    return true;
  }

 private:
  void enter() {
    if (index_ >= section_.full_buckets + section_.partial_buckets) return;
    const std::byte* from = bytes_.data() + section_.centers + index_ * kCenterBytes;
    for (int k = 0; k < 3; ++k) center_[k] = load_little<float>(from + 4 * k);
    left_ = index_ < section_.full_buckets
                ? section_.bucket_size
                : load_little<std::uint32_t>(bytes_.data() + section_.sizes + (index_ - section_.full_buckets) * 4);
  }
  std::span<const std::byte> bytes_;
  const Section& section_;
  std::uint64_t index_ = 0, left_ = 0;
  glm::vec3 center_{0};
};

float byte_value(std::byte b) { return static_cast<float>(std::to_integer<int>(b)); }

void read_splat(const std::byte* from, std::size_t mode, const Section& section, const glm::vec3& center,
                std::pair<float, float> harmonics, SplatModel& model) {
  std::array<glm::vec3, qnv::harmonic_count(qnv::Gaussians::kMaxDegree)> coefficients{};
  const Mode& at = kModes[mode];
  const auto number = [&](std::size_t offset, int k) {
    return mode == 0 ? load_little<float>(from + offset + 4 * k)
                     : float_of_half(load_little<std::uint16_t>(from + offset + 2 * k));
  };
  glm::dvec3 position;
  glm::vec3 scale, dc;
  for (int k = 0; k < 3; ++k) {
    position[k] =
        mode == 0 ? static_cast<double>(load_little<float>(from + 4 * k))
                  : static_cast<double>((static_cast<float>(load_little<std::uint16_t>(from + 2 * k)) - section.range) *
                                        section.quantum) +
                        static_cast<double>(center[k]);
    scale[k] = number(at.scale, k);
    dc[k] = (byte_value(from[at.color + static_cast<std::size_t>(k)]) / 255 - 0.5f) / kSphericalHarmonic0;
  }
  for (int degree = 1; degree <= section.harmonics; ++degree) {
    // Each degree has all its coefficients of red, then of green and of blue.
    const auto width = static_cast<std::size_t>(2 * degree + 1), first = qnv::harmonic_count(degree - 1);
    for (std::size_t n = 0; n < 3 * width; ++n) {
      const std::byte* const coded = from + kModes[mode].base + (3 * first + n) * kModes[mode].harmonic;
      const float value = mode == 0 ? load_little<float>(coded)
                          : mode == 1
                              ? float_of_half(load_little<std::uint16_t>(coded))
                              : harmonics.first + byte_value(*coded) / 255 * (harmonics.second - harmonics.first);
      coefficients[first + n % width][static_cast<int>(n / width)] = value;
    }
  }
  for (std::size_t n = 0; n < qnv::harmonic_count(model.degree); ++n) model.coefficients.push_back(coefficients[n]);
  model.positions.push_back(position);
  model.scales.push_back(scale);
  model.rotations.push_back(
      {number(at.rotation, 1), number(at.rotation, 2), number(at.rotation, 3), number(at.rotation, 0)});
  model.opacities.push_back(byte_value(from[at.color + 3]) / 255);
  model.dc.push_back(dc);
}

}  // namespace

ImportedVectors import_splats_ksplat(std::span<const std::byte> bytes, const WorldBudget& budget) {
  if (bytes.size() < kKsplatHeaderBytes) return "not a .ksplat file: expected a header of 4096 bytes";
  const auto word = [&](std::size_t at) { return load_little<std::uint32_t>(&bytes[at]); };
  if (bytes[0] != std::byte{0} || bytes[1] == std::byte{0})
    return "unknown .ksplat version " + std::to_string(std::to_integer<int>(bytes[0])) + "." +
           std::to_string(std::to_integer<int>(bytes[1])) + "; expected 0.1";
  const std::uint64_t most_sections = word(4);
  // Some writers leave the number of sections at 0, although their headers are complete.
  const std::uint64_t sections = word(8) == 0 && word(16) > 0 ? most_sections : word(8);
  const std::size_t mode = load_little<std::uint16_t>(&bytes[20]);
  if (mode >= kModes.size()) return "unknown compression mode " + std::to_string(mode) + "; expected 0, 1 or 2";
  if (sections > most_sections || most_sections > (bytes.size() - kKsplatHeaderBytes) / kSectionHeaderBytes)
    return "the file ends too early: expected " + std::to_string(most_sections) + " headers of sections";

  SplatModel model;
  model.format = "ksplat";
  // All sections get the highest degree. read_section() checks these numbers again.
  int degree = 0;
  for (std::uint64_t s = 0; s < sections; ++s) {
    const auto at = static_cast<std::size_t>(kKsplatHeaderBytes + s * kSectionHeaderBytes + 40);
    degree = std::max(degree, static_cast<int>(load_little<std::uint16_t>(&bytes[at])));
  }
  model.set_degree(degree);
  std::pair<float, float> harmonics{load_little<float>(&bytes[36]), load_little<float>(&bytes[40])};
  if (harmonics.first == 0) harmonics.first = -1.5f;
  if (harmonics.second == 0) harmonics.second = 1.5f;
  std::uint64_t start = kKsplatHeaderBytes + most_sections * kSectionHeaderBytes;
  for (std::uint64_t s = 0; s < sections; ++s) {
    auto read =
        read_section(bytes, static_cast<std::size_t>(kKsplatHeaderBytes + s * kSectionHeaderBytes), start, mode);
    if (auto* problem = std::get_if<std::string>(&read)) return std::move(*problem);
    const Section& section = std::get<Section>(read);
    if (auto problem = model.draw(budget, section.splats)) return std::move(*problem);
    model.announced += section.splats;
    // Mode 0 has buckets too, but its positions do not depend on them.
    std::optional<Buckets> buckets;
    if (mode > 0) buckets.emplace(bytes, section);
    glm::vec3 center(0);
    for (std::uint64_t i = 0; i < section.splats && (!buckets || buckets->next(center)); ++i)
      read_splat(bytes.data() + section.data + i * section.splat_bytes, mode, section, center, harmonics, model);
    start = section.end;
  }
  return import_result(model);
}

}  // namespace gs::app
