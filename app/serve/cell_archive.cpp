#include "app/serve/cell_archive.h"

#include "app/streams/cell_regions.h"
#include "app/streams/cell_wishes.h"
#include "qnv/codecs/payloads.h"
#include "qnv/codecs/values/chunk_places.h"
#include "qnv/container/cluster_directory.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <unistd.h>

namespace gs::app {
namespace {

// Size of ten symbols of the erasure code. This is the initial window of a server that does not know the path yet (RFC
// 6928).
constexpr std::size_t kBaseBytes = 12'000;
constexpr std::size_t kMaxDirectoryBytes = std::size_t{64} << 20;
// Clients request the chunks of a volume of this size by its directory.
constexpr std::uint64_t kLongVolume = std::uint64_t{1} << 20;

struct Place {
  std::uint64_t offset = 0;
  std::uint32_t bytes = 0;  // including the chunk header
  std::optional<net::CellBox> box;
};

/// Cell source of one stream file. The file stays open while clients use it.
class QnvSource : public net::CellSource {
 public:
  explicit QnvSource(net::ServedFile file) : file_(std::move(file)) {}
  /// Reads the header and the list of chunks. Returns the error, or nullopt.
  [[nodiscard]] std::optional<std::string> read();

  [[nodiscard]] std::uint32_t version() const override { return version_; }
  [[nodiscard]] std::span<const std::byte> base() const override { return base_; }
  [[nodiscard]] std::size_t streams() const override { return counts_.size(); }
  [[nodiscard]] bool records(std::size_t) const override { return payload_->record_bytes > 0; }
  [[nodiscard]] std::uint32_t chunks(std::size_t stream) const override { return counts_[stream]; }
  [[nodiscard]] std::optional<net::CellBox> box(std::size_t stream, std::uint32_t chunk) const override {
    const Place* const place = find(stream, chunk);
    return place ? place->box : std::nullopt;
  }
  [[nodiscard]] std::optional<net::CellChunk> chunk(std::size_t stream, std::uint32_t chunk) override;

 private:
  [[nodiscard]] std::vector<std::byte> bytes(std::uint64_t offset, std::size_t count) const;
  [[nodiscard]] std::vector<Place> from_directory(const qnv::StreamHeader& header) const;
  [[nodiscard]] std::vector<Place> from_chunks(std::uint64_t begin) const;
  [[nodiscard]] std::vector<Place> directory_chunks(const qnv::StreamHeader& header) const;
  [[nodiscard]] const Place* find(std::size_t stream, std::uint32_t chunk) const;

  net::ServedFile file_;
  std::uint32_t version_ = 0;
  const qnv::PayloadRow* payload_ = qnv::payload_rows().data();
  std::vector<std::byte> base_;
  std::vector<Place> places_;
  std::vector<Place> directory_;             // its chunks, if clients may request them
  std::vector<std::uint32_t> counts_ = {0};  // chunks of each stream
};

// Reads `count` bytes at `offset`. Returns fewer bytes at the end of the file.
std::vector<std::byte> QnvSource::bytes(std::uint64_t offset, std::size_t count) const {
  if (offset >= file_.stamp.size) return {};
  std::vector<std::byte> all(static_cast<std::size_t>(std::min<std::uint64_t>(count, file_.stamp.size - offset)));
  std::size_t have = 0;
  while (have < all.size()) {
    const ssize_t got =
        ::pread(file_.descriptor.get(), all.data() + have, all.size() - have, static_cast<off_t>(offset + have));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    have += static_cast<std::size_t>(got);
  }
  all.resize(have);
  return all;
}

// Returns the chunks that the directory lists; empty if the directory is missing or damaged.
std::vector<Place> QnvSource::from_directory(const qnv::StreamHeader& header) const {
  if (header.directory == 0 || header.directory >= file_.stamp.size) return {};
  const std::uint64_t length = file_.stamp.size - header.directory;
  if (length > kMaxDirectoryBytes) return {};
  const auto raw = bytes(header.directory, static_cast<std::size_t>(length));
  std::vector<Place> places;
  // Give the reader the header first, because it accepts nothing else before.
  qnv::StreamReader reader;
  qnv::values::PlacesReader listed;
  qnv::DirectoryReader directory(header);
  const qnv::values::PlaceEntries entry_of(header.grid, !header.steps.times.empty());
  const auto on_chunk = [&](qnv::ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type == qnv::ChunkType::places && header.payload == qnv::Payload::values) {
      const std::size_t known = listed.places().size();
      if (!listed.add(payload)) return;
      for (const qnv::values::ChunkPlace& place : std::span(listed.places()).subspan(known))
        if (places.size() < kMaxNumbered)
          places.push_back({place.offset, place.bytes, cell_box(entry_of(place).box, header.description.box)});
    }
    std::vector<qnv::DirectoryEntry> entries;
    (void)directory.add(type, payload, entries);
    for (const qnv::DirectoryEntry& entry : entries)
      if (places.size() < kMaxNumbered && entry.bytes > qnv::kChunkHeaderBytes)
        places.push_back({entry.offset, entry.bytes, cell_box(entry.box, header.description.box)});
  };
  (void)reader.push(qnv::encode_header(header), on_chunk);
  (void)reader.push(raw, on_chunk);
  reader.finish(on_chunk);
  return places;
}

// Returns the directory chunks of a long volume or time series.
std::vector<Place> QnvSource::directory_chunks(const qnv::StreamHeader& header) const {
  std::vector<Place> places;
  if (header.payload != qnv::Payload::values || file_.stamp.size < kLongVolume) return places;
  for (std::uint64_t at = header.directory; at < file_.stamp.size && places.size() < net::kMaxChunks;) {
    const auto head = qnv::chunk_head(bytes(at, qnv::kChunkHeaderBytes));
    if (!head) break;
    if (qnv::is_listing(head->type)) places.push_back({at, static_cast<std::uint32_t>(head->bytes), {}});
    at += head->bytes;
  }
  return places;
}

// Returns the chunks of a file without a directory, by reading one header after the other. Stops at bytes that are no
// chunk.
std::vector<Place> QnvSource::from_chunks(std::uint64_t begin) const {
  std::vector<Place> places;
  while (places.size() < net::kMaxChunks) {
    const auto head = qnv::chunk_head(bytes(begin, qnv::kChunkHeaderBytes));
    if (!head) break;
    if (qnv::carries(*payload_, head->type)) places.push_back({begin, static_cast<std::uint32_t>(head->bytes), {}});
    begin += head->bytes;
  }
  return places;
}

std::optional<std::string> QnvSource::read() {
  const auto start = bytes(0, qnv::kMaxHeaderBytes);
  std::size_t header_bytes = 0;
  bool need_more = false;
  auto decoded = qnv::decode_header(start, header_bytes, need_more);
  if (const auto* problem = std::get_if<qnv::StreamProblem>(&decoded)) return problem->message;
  if (need_more || header_bytes == 0) return "the file ends within its header";
  const auto& header = std::get<qnv::StreamHeader>(decoded);
  payload_ = &qnv::row_of(header);
  std::vector<Place> all = from_directory(header);
  if (!all.empty()) directory_ = directory_chunks(header);
  if (all.empty()) all = from_chunks(header_bytes);
  // The protected base consists of the header and the following chunks that fit in kBaseBytes. Parity is left out,
  // because cells have their own.
  const auto append = [this](std::uint64_t offset, std::size_t count) {
    const std::vector<std::byte> part = bytes(offset, count);
    base_.insert(base_.end(), part.begin(), part.end());
    return part.size() == count;
  };
  bool good = append(0, header_bytes);
  std::size_t first = 0;
  std::uint64_t end = header_bytes;
  // Clients derive the offsets of its chunks from a directory, so that it then ends at the first parity.
  while (good && first < all.size() && all[first].offset >= end && (directory_.empty() || all[first].offset == end) &&
         base_.size() + all[first].bytes <= std::max<std::size_t>(kBaseBytes, header_bytes)) {
    end = all[first].offset + all[first].bytes;
    good = append(all[first].offset, all[first].bytes);
    ++first;
  }
  if (!good) return "the file cannot be read";
  places_.assign(all.begin() + static_cast<std::ptrdiff_t>(first), all.end());
  counts_ = cells_of_numbers(places_.size(), directory_.size());
  if (directory_.empty()) counts_.resize(1);
  const std::string tag = file_.stamp.etag();
  version_ = static_cast<std::uint32_t>(std::stoul(tag.substr(1, 8), nullptr, 16));
  return std::nullopt;
}

// Returns the place of a chunk, or null.
const Place* QnvSource::find(std::size_t stream, std::uint32_t chunk) const {
  const bool listed = stream == kPlacesStream;
  const std::vector<Place>& places = listed ? directory_ : places_;
  const std::size_t number = listed ? chunk : number_of_cell({static_cast<std::uint8_t>(stream), chunk});
  return number < places.size() ? &places[number] : nullptr;
}

std::optional<net::CellChunk> QnvSource::chunk(std::size_t stream, std::uint32_t number) {
  const Place* const found = find(stream, number);
  if (!found) return std::nullopt;
  const Place& place = *found;
  if (place.bytes > qnv::kChunkHeaderBytes + qnv::kMaxChunkBytes) return std::nullopt;
  const std::vector<std::byte> all = bytes(place.offset, place.bytes);
  // Cutting fails if the file has changed or its directory is wrong.
  std::optional<qnv::ChunkParts> parts;
  if (all.size() == place.bytes)
    parts = stream == kPlacesStream ? qnv::ChunkParts{{}, all} : qnv::cut_chunk(*payload_, all);
  if (!parts || !(net::stamp_of(file_.descriptor) == file_.stamp)) return std::nullopt;
  return net::CellChunk{{parts->head.begin(), parts->head.end()}, {parts->body.begin(), parts->body.end()}};
}

}  // namespace

std::variant<std::shared_ptr<CellArchive>, std::string> CellArchive::of_folder(const std::string& folder) {
  auto opened = net::ServedFolder::open(folder);
  if (auto* problem = std::get_if<std::string>(&opened)) return *problem;
  return std::shared_ptr<CellArchive>(new CellArchive(std::move(std::get<net::ServedFolder>(opened))));
}

std::variant<std::shared_ptr<net::CellSource>, std::string> CellArchive::open(const std::string& path) {
  const auto parsed = net::parse_request_path(path.starts_with('/') ? path : "/" + path);
  if (const auto* refusal = std::get_if<net::PathRefusal>(&parsed)) return refusal->message;
  const auto& names = std::get<net::RequestPath>(parsed);
  auto opened = folder_.open(names);
  if (const auto* refusal = std::get_if<net::PathRefusal>(&opened)) return refusal->message;
  auto& file = std::get<net::ServedFile>(opened);
  if (file.folder) return "this is a folder";
  std::erase_if(open_, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<net::CellSource>& known = open_[file.stamp.etag() + names.text()];
  if (auto source = known.lock()) return source;
  auto source = std::make_shared<QnvSource>(std::move(file));
  if (auto problem = source->read()) return "not a QNV stream: " + *problem;
  known = source;
  return std::shared_ptr<net::CellSource>(source);
}

}  // namespace gs::app
