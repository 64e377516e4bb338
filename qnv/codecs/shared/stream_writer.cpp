#include "qnv/codecs/shared/stream_writer.h"

#include "qnv/codecs/shared/ranks.h"

#include <algorithm>
#include <span>
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

/// Chunks of a stream that several ranks write. Each rank writes consecutive chunks, and the parity or directory that
/// follows. Rank 0 also writes the header. A rank reads its chunks, and the earlier chunks that its parity protects.
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
  [[nodiscard]] std::optional<Listing> listing(std::span<const DirectoryEntry> entries, const Box& box) const override {
    return all_.listing(entries, box);
  }
  [[nodiscard]] std::size_t entry_bytes() const override { return all_.entry_bytes(); }

 private:
  const ChunkList& all_;
  PartSink& sink_;
  RankShare share_;
  std::uint64_t first_read_;
};

}  // namespace

std::size_t payload_budget(const StreamHeader& header, std::size_t max_bytes) {
  constexpr std::size_t kTypical = 1000;
  const std::size_t head = encode_header(header).size();
  if (max_bytes <= head) return 1;
  const std::size_t left = max_bytes - head;
  return std::max<std::size_t>(1, left * kTypical / (kTypical + kChunkHeaderBytes + kDirectoryEntryBytes));
}

void add_metadata(const std::vector<std::pair<std::string, std::string>>& metadata, Description& about) {
  std::vector<std::pair<std::string, std::string>> all = metadata;
  for (const auto& pair : about.metadata) {
    const auto same = [&](const auto& other) { return other.first == pair.first; };
    if (std::ranges::none_of(all, same)) all.push_back(pair);
  }
  about.metadata = std::move(all);
}

Protection equal_protection(const EncodeOptions& options) {
  const double loss = options.parity.value_or(0);
  return loss > 0 ? Protection{Protection::Kind::equal, loss} : Protection{};
}

std::variant<StreamHeader, EncodeError> write_stream(StreamHeader header, const ChunkList& chunks,
                                                     std::size_t max_bytes, StreamSink& sink,
                                                     const Protection& protection) {
  header.parity = protection.kind != Protection::Kind::none;
  ParityWriter parity(protection);
  std::vector<DirectoryEntry> directory;
  std::uint64_t at = 0;
  const auto append = [&](const std::vector<std::byte>& bytes) {
    at += bytes.size();
    return sink.write(bytes);
  };
  const auto append_chunk = [&](ChunkType type, const std::vector<std::byte>& payload) {
    if (sink.wants()) return append(encode_chunk(type, payload));
    at += kChunkHeaderBytes + payload.size();
    return sink.skip(kChunkHeaderBytes + payload.size());
  };
  // Reports whether a chunk fits. A directory needs another chunk header for every 2,000 entries.
  const auto fits = [&](std::size_t payload, bool listed) {
    const std::size_t entries = directory.size() + (listed ? 1 : 0);
    return max_bytes == 0 || at + kChunkHeaderBytes + payload + entries * chunks.entry_bytes() +
                                     kChunkHeaderBytes * (1 + entries / 2000) <=
                                 max_bytes;
  };
  const auto append_parity = [&](const std::vector<std::vector<std::byte>>& payloads) {
    return std::ranges::all_of(payloads, [&](const std::vector<std::byte>& payload) {
      return !fits(payload.size(), false) || append_chunk(ChunkType::parity, payload);
    });
  };
  const EncodeError stopped{"cannot write the stream"};
  header.vectors = 0;
  if (!append(encode_header(header))) return stopped;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    std::optional<OutgoingChunk> chunk = chunks.chunk(i);
    if (!chunk) return EncodeError{"cannot read the encoded data again"};
    if (!directory.empty() && !fits(chunk->payload.size(), true)) break;
    chunk->entry.offset = at;
    chunk->entry.bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + chunk->payload.size());
    directory.push_back(chunk->entry);
    header.vectors += chunk->entry.vectors - chunk->replaced;
    if (!append_chunk(chunk->type, chunk->payload) || !append_parity(parity.add(*chunk))) return stopped;
  }
  if (!append_parity(parity.finish())) return stopped;
  header.chunks = static_cast<std::uint32_t>(directory.size());
  header.directory = at;
  if (const auto listing = chunks.listing(directory, header.description.box)) {
    for (const std::vector<std::byte>& payload : listing->payloads)
      if (!append_chunk(listing->type, payload)) return stopped;
    directory.clear();
  }
  constexpr std::size_t kInOne = kMaxChunkBytes / kDirectoryEntryBytes;  // entries of a directory chunk
  for (std::span<const DirectoryEntry> rest = directory; !rest.empty();) {
    const auto some = rest.first(std::min(rest.size(), kInOne));
    if (!append(encode_directory(some, header.description.box))) return stopped;
    rest = rest.subspan(some.size());
  }
  if (!sink.rewrite_front(encode_header(header))) return stopped;
  return header;
}

std::variant<EncodedStream, EncodeError> write_together(StreamHeader header, const ChunkList& chunks,
                                                        const EncodeOptions& options, const Protection& protection) {
  EncodedStream stream;
  MemorySink memory(stream.bytes);
  Ranks alone;
  const Ranks& ranks = options.ranks ? *options.ranks : alone;
  PartSink sink(options.sink ? *options.sink : memory, ranks.rank() == 0);
  const PartChunks part(chunks, ranks, sink);
  auto written = write_stream(std::move(header), part, options.max_bytes, sink, protection);
  if (auto* problem = std::get_if<EncodeError>(&written)) return std::move(*problem);
  stream.header = std::move(std::get<StreamHeader>(written));
  if (options.sink) stream.written = sink.count();
  return stream;
}

EncodedStream write_stream(StreamHeader header, std::vector<OutgoingChunk> chunks, std::size_t max_bytes,
                           const Protection& protection) {
  /// The chunks in memory.
  class List final : public ChunkList {
   public:
    explicit List(std::vector<OutgoingChunk>& all) : all_(all) {}
    [[nodiscard]] std::size_t size() const override { return all_.size(); }
    [[nodiscard]] std::optional<OutgoingChunk> chunk(std::size_t i) const override { return std::move(all_[i]); }

   private:
    std::vector<OutgoingChunk>& all_;
  };
  EncodedStream stream;
  MemorySink sink(stream.bytes);
  auto written = write_stream(std::move(header), List(chunks), max_bytes, sink, protection);
  stream.header = std::move(std::get<StreamHeader>(written));
  return stream;
}

}  // namespace gs::qnv
