#include "qnv/codecs/lossless/cover.h"

#include "base/bytes.h"
#include "qnv/entropy/binary_coder.h"

#include <array>

namespace gs::qnv::exact {
namespace {

using displaced::BinaryDecoder;
using displaced::BinaryEncoder;

constexpr std::size_t kCoverHeaderBytes = 10;
constexpr int kMaxCoverStage = 15;
constexpr std::uint32_t kMaxPatches = 1u << 17;

/// Probability models for FORMAT.md, "Covered patches".
struct CoverModels {
  std::array<displaced::BitModel, 2> changes;  // index: 1 if the previous number changed, else 0
  displaced::BitModel less;
  displaced::NumberModel<6> by;
};

}  // namespace

std::vector<std::byte> encode_cover(const Cover& cover) {
  std::vector<std::byte> payload;
  ByteWriter out(payload);
  out.integer(static_cast<std::uint8_t>(cover.stage));
  out.integer(static_cast<std::uint8_t>(cover.parts));
  out.integer(static_cast<std::uint32_t>(cover.patches.size()));
  out.integer(cover.triangles);
  BinaryEncoder encoder;
  CoverModels models;
  std::size_t changed = 0;
  int last = 0;
  for (const int is : cover.patches) {
    encoder.put(models.changes[changed], is != last);
    changed = is != last ? 1 : 0;
    if (changed != 0) {
      encoder.put(models.less, is < last);
      models.by.put(encoder, static_cast<std::uint32_t>((is < last ? last - is : is - last) - 1));
    }
    last = is;
  }
  const std::vector<std::byte> body = encoder.finish();
  payload.insert(payload.end(), body.begin(), body.end());
  return payload;
}

std::optional<Cover> decode_cover(std::span<const std::byte> payload) {
  ByteReader in(payload);
  Cover cover;
  cover.stage = in.integer<std::uint8_t>();
  cover.parts = in.integer<std::uint8_t>();
  const auto patches = in.integer<std::uint32_t>();
  cover.triangles = in.integer<std::uint32_t>();
  if (!in.good() || cover.stage > kMaxCoverStage || cover.parts == 0 || patches > kMaxPatches) return {};
  BinaryDecoder decoder(payload.subspan(kCoverHeaderBytes));
  CoverModels models;
  std::size_t changed = 0;
  std::int64_t is = 0;
  for (std::uint32_t p = 0; p < patches; ++p) {
    changed = decoder.get(models.changes[changed]) ? 1 : 0;
    if (changed != 0) {
      const bool less = decoder.get(models.less);
      const std::int64_t by = std::int64_t{models.by.get(decoder)} + 1;
      is += less ? -by : by;
    }
    if (is < 0 || is > cover.parts || decoder.exhausted()) return {};
    cover.patches.push_back(static_cast<std::uint8_t>(is));
  }
  return cover;
}

}  // namespace gs::qnv::exact
