#include "qnv/container/gaussian_coding.h"

#include "base/bytes.h"
#include "qnv/base/geometry.h"

#include <cstdint>
#include <cstdlib>

namespace gs::qnv {
namespace {

// Bit position of the version in the byte of the degree. Readers of earlier versions refuse the degree.
constexpr int kVersionShift = 4;
// Place of the number of fine bits in the flags.
constexpr int kFineShift = 4;

}  // namespace

std::vector<std::byte> encode_gaussian_coding(const GaussianCoding& coding) {
  std::vector<std::byte> out;
  ByteWriter write(out);
  write.integer(static_cast<std::int16_t>(coding.important));
  write.integer(static_cast<std::int16_t>(coding.finest));
  write.integer(static_cast<std::uint8_t>(coding.degree | static_cast<int>(coding.version) << kVersionShift));
  write.integer(static_cast<std::uint8_t>((coding.antialiased ? 1 : 0) | coding.fine << kFineShift));
  write.integer(static_cast<std::int8_t>(coding.steps));
  return out;
}

std::optional<GaussianCoding> decode_gaussian_coding(std::span<const std::byte> section) {
  ByteReader read(section);
  GaussianCoding coding;
  coding.important = read.integer<std::int16_t>();
  coding.finest = read.integer<std::int16_t>();
  const auto degree = read.integer<std::uint8_t>();
  const int version = degree >> kVersionShift;
  if (version > static_cast<int>(GaussianCoding::Version::tuned)) return std::nullopt;
  coding.version = static_cast<GaussianCoding::Version>(version);
  coding.degree = degree & ((1 << kVersionShift) - 1);
  const auto flags = read.integer<std::uint8_t>();
  coding.antialiased = (flags & 1) != 0;
  coding.fine = coding.version == GaussianCoding::Version::trained ? flags >> kFineShift : 0;
  coding.steps = read.integer<std::int8_t>();
  if (!read.good() || coding.degree > Gaussians::kMaxDegree || coding.fine > GaussianCoding::kMostFine ||
      coding.finest < 0 || coding.finest > GaussianCoding::kMostScale ||
      std::abs(coding.steps) > GaussianCoding::kMostSteps)
    return std::nullopt;
  return coding;
}

}  // namespace gs::qnv
