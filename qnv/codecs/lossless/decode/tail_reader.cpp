#include "qnv/codecs/lossless/decode/tail_reader.h"

#include "qnv/codecs/lossless/exact_header.h"
#include "qnv/codecs/lossless/mesh_growth.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace gs::qnv::exact {
namespace {

/// Placeholder for the encoder's guide, which a decoder does not use.
struct NoGuide {};
using Growth = MeshGrowth<displaced::BinaryDecoder, NoGuide>;

}  // namespace

struct TailReader::Growing {
  std::vector<std::byte> bytes;  // all bytes received so far
  TailHeader header;
  NoGuide guide;
  std::optional<displaced::BinaryDecoder> decoder;  // decoder of the bytes after the header
  std::optional<Growth> growth;
};

TailReader::TailReader(std::size_t length, std::size_t most_vertices)
    : length_(length), most_vertices_(most_vertices), growing_(std::make_unique<Growing>()) {}

TailReader::TailReader(TailReader&&) noexcept = default;
TailReader& TailReader::operator=(TailReader&&) noexcept = default;
TailReader::~TailReader() = default;

void TailReader::push(std::span<const std::byte> more) {
  if (state_ != State::growing) return;
  Growing& g = *growing_;
  const auto taken = more.first(std::min(more.size(), length_ - g.bytes.size()));
  g.bytes.insert(g.bytes.end(), taken.begin(), taken.end());
  const bool all = g.bytes.size() == length_;
  constexpr std::size_t kCodeBytes = 4;  // bytes that a range decoder reads at its start
  const std::size_t head = tail_header_bytes(g.bytes);
  if (!all && (head == 0 || g.bytes.size() < head + kCodeBytes)) return;
  const auto body = std::span<const std::byte>(g.bytes).subspan(std::min(head, g.bytes.size()));
  if (!g.growth) {
    const auto header = decode_tail_header(g.bytes, length_);
    state_ = !header                                                                       ? State::refused
             : header->vertices > most_vertices_ || header->triangles / 2 > most_vertices_ ? State::full
                                                                                           : State::growing;
    if (state_ != State::growing) return;
    g.header = *header;
    g.decoder.emplace(body);
    g.growth.emplace(*g.decoder, g.header, g.guide, kMaxTrianglesAByte * g.bytes.size());
  }
  g.decoder->extend(body);
  const auto state = g.growth->run([&](std::size_t bytes) { return all || g.decoder->unread() >= bytes; });
  if (state == Growth::Growth::wrong) state_ = State::refused;
  if (state == Growth::Growth::whole) state_ = State::whole;
  if (state_ != State::growing) g.bytes = {};
}

std::size_t TailReader::triangles() const { return growing_->growth ? growing_->growth->triangles().size() : 0; }

std::size_t TailReader::all_triangles() const { return growing_->growth ? growing_->header.triangles : 0; }

bool TailReader::textured() const { return growing_->header.texture.bits > 0; }

ExactMesh TailReader::mesh() const {
  ExactMesh mesh;
  if (!growing_->growth) return mesh;
  const Growth& growth = *growing_->growth;
  mesh.bits = growing_->header.bits;
  mesh.finest = growing_->header.finest;
  mesh.crease_angle = growing_->header.crease_angle;
  mesh.vertices = growth.places();
  mesh.twins = growth.twins();
  mesh.triangles = growth.triangles();
  mesh.texture = growing_->header.texture;
  mesh.coordinates = growth.coordinates();
  mesh.colors.resize(growth.colors().size());
  for (std::size_t v = 0; v < mesh.colors.size(); ++v) (void)color_of(growth.colors()[v], mesh.colors[v]);
  return mesh;
}

}  // namespace gs::qnv::exact
