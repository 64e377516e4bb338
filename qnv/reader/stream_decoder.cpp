#include "qnv/reader/stream_decoder.h"

#include "qnv/codecs/payloads.h"
#include "qnv/codecs/values/chunk_places.h"
#include "qnv/container/cluster_directory.h"

namespace gs::qnv {

StreamDecoder::StreamDecoder(std::size_t most_vectors) : most_vectors_(most_vectors) {}
StreamDecoder::~StreamDecoder() = default;
StreamDecoder::StreamDecoder(StreamDecoder&&) noexcept = default;
StreamDecoder& StreamDecoder::operator=(StreamDecoder&&) noexcept = default;

bool StreamDecoder::push(std::span<const std::byte> bytes) {
  const bool good = reader_.push(
      bytes, [this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) { accept(type, payload, {}); });
  begin();
  return good;
}

void StreamDecoder::begin() {
  if (row_ || !header()) return;
  row_ = &row_of(*header());
  if (row_->decoder) decoder_ = row_->decoder(*header(), most_vectors_);
  if (decoder_) decoder_->show(shown_);
}

void StreamDecoder::show(const ShownComponent& component) {
  shown_ = component;
  if (decoder_) decoder_->show(component);
}

void StreamDecoder::finish() {
  reader_.finish(
      [this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) { accept(type, payload, {}); });
}

void StreamDecoder::add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) {
  begin();
  if (decoder_) decoder_->leave_order();
  accept(type, payload, missing);
}

// Adds the places of a chunk to the directory.
void StreamDecoder::add_places(std::span<const std::byte> payload) {
  if (header()->payload != Payload::values) {
    ++refused_chunks_;
    return;
  }
  if (!places_) places_ = std::make_unique<values::PlacesReader>();
  const std::size_t known = places_->places().size();
  if (!places_->add(payload)) return;
  const values::PlaceEntries entry_of(header()->grid, !header()->steps.times.empty());
  for (const values::ChunkPlace& place : std::span(places_->places()).subspan(known))
    directory_.push_back(entry_of(place));
}

void StreamDecoder::accept(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) {
  begin();
  if (!row_) return;
  if (!missing.empty() && type != ChunkType::records) {
    ++refused_chunks_;
  } else if (type == ChunkType::directory ||
             (type == ChunkType::cluster_directory && header()->payload == Payload::gaussians)) {
    if (!entries_) entries_ = std::make_unique<DirectoryReader>(*header());
    (void)entries_->add(type, payload, directory_);
  } else if (type == ChunkType::places) {
    add_places(payload);
  } else if (type == ChunkType::parity) {
    // Without the announcement, chunks were not kept.
    const auto found = [this](ChunkType whole, std::span<const std::byte> bytes) { take(whole, bytes, {}); };
    if (!decoder_ || row_->record_bytes > 0 || (header()->parity && !lost_.add(payload, found))) ++refused_chunks_;
  } else {
    take(type, payload, missing);
    if (header()->parity && decoder_ && row_->record_bytes == 0)
      lost_.keep(type, payload, [this](ChunkType whole, std::span<const std::byte> bytes) { take(whole, bytes, {}); });
  }
}

void StreamDecoder::take(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) {
  if (!decoder_ || !carries(*row_, type)) {
    ++refused_chunks_;
  } else if (type == ChunkType::piece) {
    const bool good =
        groups_.add(payload, [this](ChunkType whole, std::span<const std::byte> bytes) { take(whole, bytes, {}); });
    if (!good) ++refused_chunks_;
  } else {
    decoder_->add(type, payload, missing);
  }
}

GeometryBase StreamDecoder::base() const {
  return header() ? GeometryBase{header()->description, header()->color} : GeometryBase{};
}

Geometry StreamDecoder::geometry() const { return decoder_ ? decoder_->geometry(base()) : Splats(base()); }

Geometry StreamDecoder::geometry_to_draw() { return decoder_ ? decoder_->geometry_to_draw(base()) : Splats(base()); }

}  // namespace gs::qnv
