#include "qnv/codecs/values/encode/write_values.h"

#include "qnv/codecs/shared/ranks.h"

#include <string>
#include <utility>

namespace gs::qnv {
namespace {

/// Sink that counts the bytes of a stream. Passes on only the bytes that this process writes.
class PartSink final : public StreamSink {
 public:
  explicit PartSink(StreamSink& to, bool has_front) : to_(to), writes_(has_front), has_front_(has_front) {}
  bool write(std::span<const std::byte> bytes) override {
    count_ += bytes.size();
    return writes_ ? to_.write(bytes) : to_.skip(bytes.size());
  }
  bool rewrite_front(std::span<const std::byte> bytes) override { return !has_front_ || to_.rewrite_front(bytes); }
  [[nodiscard]] bool wants() const override { return writes_; }
  bool skip(std::uint64_t bytes) override {
    count_ += bytes;
    return to_.skip(bytes);
  }
  void set_writes(bool writes) { writes_ = writes; }
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  StreamSink& to_;
  bool writes_, has_front_;
  std::uint64_t count_ = 0;
};

/// Chunks of a stream that several ranks write. Each rank writes consecutive chunks, with the parity and the directory
/// after them. Rank 0 also writes the header. A rank reads only its chunks, and earlier ones that its parity protects.
class PartChunks final : public ChunkList {
 public:
  PartChunks(const ChunkList& all, const Ranks& ranks, PartSink& sink)
      : all_(all), sink_(sink), share_(share_of(ranks, all.size())), first_read_(share_.first) {
    for (std::uint64_t bytes = 0; share_.size() > 0 && first_read_ > 0 && bytes <= kParityReach;) {
      const auto before = all.outline(static_cast<std::size_t>(--first_read_));
      bytes += before ? kChunkHeaderBytes + before->payload.size() : 0;
    }
  }
  [[nodiscard]] std::size_t size() const override { return all_.size(); }
  [[nodiscard]] std::optional<OutgoingChunk> chunk(std::size_t i) const override {
    sink_.set_writes(i >= share_.first && i < share_.end);
    return i >= first_read_ && i < share_.end ? all_.chunk(i) : all_.outline(i);
  }
  [[nodiscard]] std::optional<std::vector<std::vector<std::byte>>> places(
      std::span<const DirectoryEntry> entries) const override {
    return all_.places(entries);
  }
  [[nodiscard]] std::size_t entry_bytes() const override { return all_.entry_bytes(); }

 private:
  const ChunkList& all_;
  PartSink& sink_;
  RankShare share_;
  std::uint64_t first_read_;
};

}  // namespace

Protection values_protection(const EncodeOptions& options) {
  return options.parity ? equal_protection(options) : Protection{Protection::Kind::unequal};
}

std::variant<EncodedStream, EncodeError> write_values(StreamHeader header, const ChunkList& chunks,
                                                      const EncodeOptions& options, std::string_view what) {
  EncodedStream stream;
  MemorySink memory_sink(stream.bytes);
  Ranks alone;
  Ranks& ranks = options.ranks ? *options.ranks : alone;
  PartSink sink(options.sink ? *options.sink : memory_sink, ranks.rank() == 0);
  const PartChunks part(chunks, ranks, sink);
  auto written = write_stream(std::move(header), part, options.max_bytes, sink, values_protection(options));
  if (auto* problem = std::get_if<EncodeError>(&written)) return std::move(*problem);
  stream.header = std::move(std::get<StreamHeader>(written));
  if (options.sink) stream.written = sink.count();
  if (options.max_bytes != 0 && stream.size() > options.max_bytes)
    return EncodeError{"a stream of the coarsest " + std::string(what) + " has " + std::to_string(stream.size()) +
                       " bytes; expected at most " + std::to_string(options.max_bytes)};
  return stream;
}

}  // namespace gs::qnv
