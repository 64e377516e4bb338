#include "base/bytes.h"
#include "qnv/codecs/lossless/exact_tail.h"
#include "qnv/codecs/progressive/progressive.h"
#include "qnv/codecs/progressive/progressive_header.h"
#include "qnv/entropy/binary_coder.h"

#include <utility>

namespace gs::qnv::progressive {
namespace {

constexpr std::size_t kMaxWaitingSegmentBytes = std::size_t{16} << 20, kWaitingSegmentCost = 96;

/// Placeholder for the encoder's guide, which a decoder does not use.
struct NoSplitGuide {};

std::optional<FrontHeader> decode_front(std::span<const std::byte> section) {
  ByteReader in(section);
  FrontHeader header;
  const auto mark = in.integer<std::uint8_t>();
  header.bits = in.integer<std::uint8_t>();
  const auto middles = in.integer<std::uint8_t>();
  const auto rule = in.integer<std::uint8_t>();
  header.shading.angle = in.integer<std::uint8_t>();
  header.vertices = in.integer<std::uint32_t>();
  header.triangles = in.integer<std::uint32_t>();
  if (!in.good() || mark != kFrontMark || header.bits < exact::kMinBits || header.bits > exact::kMaxBits || rule > 1 ||
      middles > 1 || header.shading.angle > 180 || header.vertices > SplitGrowth::kMaxVertices)
    return {};
  header.middles = middles == 1;
  header.shading.rule = static_cast<exact::Shading::Rule>(rule);
  return header;
}

}  // namespace

bool is_front(std::span<const std::byte> section) { return decode_front(section).has_value(); }

bool promises_more(std::span<const std::byte> section, std::size_t most_vertices) {
  const auto header = decode_front(section);
  // A triangle that is shaded separately has three vertices of its own.
  return header && (header->vertices > most_vertices || header->triangles > most_vertices / 3);
}

bool ProgressiveMesh::begin(std::span<const std::byte> front, std::size_t most_vertices) {
  const auto header = decode_front(front);
  if (!header || promises_more(front, most_vertices)) return false;
  auto mesh = exact::decode_tail(front.subspan(kFrontBytes), header->vertices);
  if (!mesh || !mesh->colors.empty() || mesh->bits > header->bits || mesh->triangles.size() > header->triangles)
    return false;
  bits_ = header->bits;
  shading_ = header->shading;
  vertices_ = header->vertices;
  triangles_ = header->triangles;
  const int coarse = mesh->bits;
  growth_.emplace(SplitMesh(std::move(*mesh)), coarse, bits_, vertices_, triangles_, header->middles);
  return true;
}

bool ProgressiveMesh::add(std::span<const std::byte> payload) {
  ByteReader in(payload);
  const std::size_t number = in.integer<std::uint16_t>();
  if (!in.good() || payload.size() <= kSegmentHeaderBytes || !growth_) return false;
  if (number < next_ || waiting_.contains(number)) return true;
  if (broken_) return false;
  if (number > next_) {
    if (waiting_bytes_ + payload.size() + kWaitingSegmentCost > kMaxWaitingSegmentBytes) return false;
    waiting_bytes_ += payload.size() + kWaitingSegmentCost;
    waiting_.emplace(number, std::vector<std::byte>(payload.begin(), payload.end()));
    return true;
  }
  bool good = read(payload);
  while (good && !waiting_.empty() && waiting_.begin()->first == next_) {
    const auto ready = waiting_.extract(waiting_.begin());
    waiting_bytes_ -= ready.mapped().size() + kWaitingSegmentCost;
    good = read(ready.mapped());
  }
  return good;
}

bool ProgressiveMesh::read(std::span<const std::byte> payload) {
  ByteReader in(payload.subspan(2));
  const std::size_t visits = in.integer<std::uint32_t>();
  displaced::BinaryDecoder decoder(payload.subspan(kSegmentHeaderBytes));
  exact::Decisions<displaced::BinaryDecoder> decisions(decoder);
  NoSplitGuide guide;
  broken_ = visits > kMaxVisitsAByte * payload.size();
  for (std::size_t i = 0; i < visits && !broken_; ++i) broken_ = !growth_->visit(decisions, guide);
  ++next_;
  if (broken_) waiting_.clear();
  return !broken_;
}

bool ProgressiveMesh::whole() const {
  return growth_ && !broken_ && growth_->size() == vertices_ && growth_->mesh().triangles().size() == triangles_ &&
         growth_->bits() == bits_ && growth_->between();
}

exact::ExactMesh ProgressiveMesh::mesh() const {
  exact::ExactMesh out;
  if (!growth_) return out;
  out.bits = bits_;
  out.crease_angle = shading_.angle;
  out.shading = shading_;
  out.triangles = growth_->mesh().triangles();
  out.twins = growth_->mesh().twins();
  out.vertices.reserve(growth_->size());
  for (std::uint32_t v = 0; v < growth_->size(); ++v) out.vertices.push_back(growth_->place(v));
  return out;
}

}  // namespace gs::qnv::progressive
